// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <QThread>
#include <atomic>
#include <functional>

#include "core/base/progress.h"

class QProgressDialog;
class QWidget;

namespace glint::gui {

/// Work of seconds or minutes that leaves the interface free: one at a time on a thread of its own, with a small window that
/// names it, shows what remains and stops it.
class LongJob : public QObject {
  Q_OBJECT
 public:
  using Deliver = std::function<void()>;  ///< runs on the interface thread when the work is done
  /// Runs on the worker; throws InputError, and Stopped where the progress function says so. It must not touch widgets.
  using Work = std::function<Deliver(const ProgressFn&)>;

  explicit LongJob(QWidget* window);
  ~LongJob() override;  ///< stops what runs and waits for it
  /// @param title  "Writing masks". A second job is refused with a problem while one runs.
  void start(const QString& title, Work work);
  /// For the worker: runs something on the interface thread and waits for it, so that what has to be drawn there comes in slices.
  /// Throws what `work` throws; Stopped.
  void onInterface(const std::function<void()>& work);
  bool busy() const { return running_; }

 public slots:
  void cancel() { stop_ = true; }

 signals:
  void problem(const QString& oneLine);
  void message(const QString& oneLine);  ///< it was stopped

 private:
  void end(const Deliver& deliver, bool stopped, const QString& trouble);
  void show(const QString& stage, int done, int total);

  QWidget* window_;
  QProgressDialog* dialog_ = nullptr;
  QString title_;
  QThread thread_;
  QObject* worker_;
  std::atomic<bool> stop_{false};
  bool running_ = false;
};

}  // namespace glint::gui
