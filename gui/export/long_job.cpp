// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/long_job.h"

#include <QElapsedTimer>
#include <QProgressDialog>
#include <QWidget>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <utility>

#include "gui/base/background.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kShowEveryMs = 40;     // progress on screen needs no more
constexpr int kDialogAfterMs = 400;  // what is done sooner needs no window
constexpr std::chrono::milliseconds kAskAgain(50);

/// Something that the worker waits for.
struct Call {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false, abandoned = false;
  std::exception_ptr trouble;
};
}  // namespace

LongJob::LongJob(QWidget* window) : QObject(window), window_(window), worker_(new QObject) {
  worker_->moveToThread(&thread_);
  connect(&thread_, &QThread::finished, worker_, &QObject::deleteLater);
  startInBackground(thread_);
}

LongJob::~LongJob() {
  stop_ = true;
  thread_.quit();
  thread_.wait();
}

void LongJob::start(const QString& title, Work work) {
  if (running_) return void(emit problem(tr("Still running: %1").arg(title_)));
  running_ = true;
  stop_ = false;
  title_ = title;
  dialog_ = new QProgressDialog(title, tr("Stop"), 0, 0, window_);
  dialog_->setObjectName(QStringLiteral("longJob"));
  dialog_->setWindowTitle(title);
  dialog_->setWindowModality(Qt::NonModal);
  dialog_->setAutoClose(false);
  dialog_->setAutoReset(false);
  dialog_->setMinimumWidth(380);
  dialog_->setMinimumDuration(kDialogAfterMs);
  dialog_->setValue(0);
  connect(dialog_, &QProgressDialog::canceled, this, &LongJob::cancel);
  QMetaObject::invokeMethod(
      worker_,
      [this, work = std::move(work)] {
        Deliver deliver;
        QString trouble;
        bool stopped = false;
        try {
          QElapsedTimer shown;
          deliver = work([&](const StageEvent& e) {
            if (stop_) return false;
            if (shown.isValid() && shown.elapsed() < kShowEveryMs) return true;
            shown.start();
            QMetaObject::invokeMethod(
                this, [this, stage = toQString(e.stage), done = e.done, total = e.total] { show(stage, done, total); },
                Qt::QueuedConnection);
            return true;
          });
        } catch (const Stopped&) {
          stopped = true;
        } catch (const std::exception& e) {
          trouble = toQString(e.what());
        }
        QMetaObject::invokeMethod(
            this, [this, deliver, stopped, trouble] { end(deliver, stopped, trouble); }, Qt::QueuedConnection);
      },
      Qt::QueuedConnection);
}

void LongJob::onInterface(const std::function<void()>& work) {
  auto call = std::make_shared<Call>();
  QMetaObject::invokeMethod(
      this,
      [this, call, &work] {
        const std::lock_guard<std::mutex> lock(call->mutex);
        if (call->abandoned) return;  // `work` is gone
        try {
          if (stop_) throw Stopped{};
          work();
        } catch (...) {
          call->trouble = std::current_exception();
        }
        call->done = true;
        call->ended.notify_one();
      },
      Qt::QueuedConnection);
  std::unique_lock<std::mutex> lock(call->mutex);
  while (!call->ended.wait_for(lock, kAskAgain, [&] { return call->done; })) {
    if (!stop_) continue;
    call->abandoned = true;
    throw Stopped{};
  }
  if (call->trouble) std::rethrow_exception(call->trouble);
}

void LongJob::show(const QString& stage, int done, int total) {
  if (!running_ || !dialog_) return;
  dialog_->setLabelText(total > 0 ? tr("%1: %2, %3 of %4").arg(title_, stage).arg(done).arg(total)
                                  : QStringLiteral("%1: %2").arg(title_, stage));
  dialog_->setMaximum(total);
  dialog_->setValue(done);
}

void LongJob::end(const Deliver& deliver, bool stopped, const QString& trouble) {
  running_ = false;
  dialog_->disconnect(this);
  dialog_->deleteLater();
  dialog_ = nullptr;
  if (stopped)
    emit message(tr("%1: stopped; nothing was written").arg(title_));
  else if (!trouble.isEmpty())
    emit problem(trouble);
  else if (deliver)
    deliver();
}

}  // namespace glint::gui
