// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/background.h"

#ifdef __linux__
#include <sys/resource.h>
#endif

namespace glint::gui {

namespace {
constexpr int kNice = 10;  // about a tenth of the time that a thread of the interface gets, when both want all of it
}

void startInBackground(QThread& thread) {
#ifdef __linux__
  // Qt's priorities have no effect on Linux, where the ordinary scheduler knows one for all; "nice" is per thread there.
  QObject::connect(
      &thread, &QThread::started, &thread, [] { setpriority(PRIO_PROCESS, 0, kNice); }, Qt::DirectConnection);
  thread.start();
#else
  thread.start(QThread::LowPriority);
#endif
}

}  // namespace glint::gui
