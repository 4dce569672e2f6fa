// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <functional>

#include "gui/base/job_queue.h"

class QProgressDialog;
class QWidget;

namespace glint::gui {

/// Work of seconds or minutes that leaves the interface free: one at a time, with a small window that names it, shows what
/// remains and stops it. Its destructor stops the running job and waits for it.
class LongJob : public QObject {
  Q_OBJECT
 public:
  using Deliver = std::function<void()>;  ///< runs on the interface thread when the work is done
  /// Runs on the worker; throws InputError, and Stopped where the progress function says so. It must not touch widgets.
  using Work = std::function<Deliver(const ProgressFn&)>;

  explicit LongJob(QWidget* window);
  /// @param title  "Writing masks". A second job is refused with a problem while one runs.
  void start(const QString& title, Work work);
  /// For the worker: runs something on the interface thread and waits for it, so that what has to be drawn there comes in slices.
  /// Throws what `work` throws; Stopped.
  void onInterface(const std::function<void()>& work) { token_->onOwner(work); }
  bool busy() const { return dialog_ != nullptr; }

 public slots:
  void cancel() { jobs_.stop(); }

 signals:
  void problem(const QString& oneLine);
  void message(const QString& oneLine);  ///< it was stopped

 private:
  QWidget* window_;
  QProgressDialog* dialog_ = nullptr;  ///< while something runs
  QString title_;
  const JobToken* token_ = nullptr;  ///< of what runs; the worker only
  JobQueue jobs_;
};

}  // namespace glint::gui
