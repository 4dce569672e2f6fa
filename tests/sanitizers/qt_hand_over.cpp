// SPDX-License-Identifier: BSD-3-Clause
// For the thread sanitizer only. Qt is not compiled with it: that the event queue orders what one thread posts before what another one runs
// is invisible to it (futexes and atomics inside the library), and every result that a worker hands over would look like a race. Rather than
// silence all that happens below Qt's event loop, which is all that the workers do, the two calls that hand work over are told to the
// sanitizer: what was done before invokeMethod() is before what the slot does, and what the slots did is before the return of QThread::wait().
// Linked into the executable, these definitions take the place of the library's for our own calls.
#include <dlfcn.h>

#include <QDeadlineTimer>
#include <QMetaObject>
#include <QObject>
#include <QThread>
#include <cstdlib>

extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}

namespace {

char workDone;  // its address stands for all that slots have done

template <class Function>
Function real(const char* name) {
  void* const found = dlsym(RTLD_NEXT, name);
  if (!found) std::abort();  // another Qt: the names below are those of Qt 5.15
  return reinterpret_cast<Function>(found);
}

/// Calls another slot object. Its own memory passes from thread to thread unseen, hence no_sanitize.
class HandedOver : public QtPrivate::QSlotObjectBase {
 public:
  __attribute__((no_sanitize("thread"))) explicit HandedOver(QtPrivate::QSlotObjectBase* slot) : QSlotObjectBase(&run), slot_(slot) {}

 private:
  __attribute__((no_sanitize("thread"))) static void run(int which, QSlotObjectBase* self, QObject* receiver, void** arguments, bool* same) {
    auto* const handed = static_cast<HandedOver*>(self);
    QtPrivate::QSlotObjectBase* const slot = handed->slot_;
    __tsan_acquire(slot);
    if (which == Call) {
      slot->call(receiver, arguments);
      __tsan_release(slot);  // whoever drops the last reference destroys what the call used
      __tsan_release(&workDone);
    } else if (which == Compare) {
      *same = false;
    } else if (which == Destroy) {
      slot->destroyIfLastRef();
      delete handed;
    }
  }
  QtPrivate::QSlotObjectBase* slot_;
};

}  // namespace

bool QMetaObject::invokeMethodImpl(QObject* object, QtPrivate::QSlotObjectBase* slot, Qt::ConnectionType type, void* result) {
  using Function = bool (*)(QObject*, QtPrivate::QSlotObjectBase*, Qt::ConnectionType, void*);
  static const auto function = real<Function>("_ZN11QMetaObject16invokeMethodImplEP7QObjectPN9QtPrivate15QSlotObjectBaseEN2Qt14ConnectionTypeEPv");
  __tsan_release(slot);
  const bool done = function(object, new HandedOver(slot), type, result);
  __tsan_acquire(&workDone);  // of a blocking call
  return done;
}

bool QThread::wait(QDeadlineTimer deadline) {
  using Function = bool (*)(QThread*, QDeadlineTimer);
  static const auto function = real<Function>("_ZN7QThread4waitE14QDeadlineTimer");
  const bool done = function(this, deadline);
  __tsan_acquire(&workDone);
  return done;
}
