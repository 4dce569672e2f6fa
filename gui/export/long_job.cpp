// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/long_job.h"

#include <QProgressDialog>
#include <QWidget>
#include <utility>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kDialogAfterMs = 400;  // what is done sooner needs no window
}

LongJob::LongJob(QWidget* window) : QObject(window), window_(window) {}

void LongJob::start(const QString& title, Work work) {
  if (busy()) return void(emit problem(tr("Still running: %1").arg(title_)));
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
  const auto show = [this](const StageEvent& e) {
    const QString stage = toQString(e.stage);
    dialog_->setLabelText(e.total > 0 ? tr("%1: %2, %3 of %4").arg(title_, stage).arg(e.done).arg(e.total)
                                      : QStringLiteral("%1: %2").arg(title_, stage));
    dialog_->setMaximum(e.total);
    dialog_->setValue(e.done);
  };
  const auto run = [this, show, work = std::move(work)](const JobToken& token) {
    token_ = &token;
    return work(token.progress(show));
  };
  const auto end = [this](const JobResult<Deliver>& result) {
    dialog_->disconnect(this);
    dialog_->deleteLater();
    dialog_ = nullptr;
    if (result.stopped)
      emit message(tr("%1: stopped; nothing was written").arg(title_));
    else if (!result.failure().isEmpty())
      emit problem(result.failure());
    else if (*result.value)
      (*result.value)();
  };
  jobs_.start(run, end);
}

}  // namespace glint::gui
