// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QThread>
#include <atomic>
#include <functional>

namespace glint::gui {

/// Runs small jobs on a thread of its own; the newest wins: what waits is dropped, and the answer of a job that a newer one
/// overtook is not delivered.
class LatestJob : public QObject {
  Q_OBJECT
 public:
  using Deliver = std::function<void()>;  ///< runs on the thread of this object

  explicit LatestJob(QObject* parent = nullptr);
  ~LatestJob() override;  ///< waits for what runs
  /// @param work  runs on the worker and says what to do with its result; it must not touch widgets.
  void run(std::function<Deliver()> work);
  /// Nothing of what was asked for is of use any more.
  void drop() {
    ++newest_;
    awaited_ = false;
  }
  bool busy() const { return pending_ > 0; }
  /// An answer will be delivered: the newest job runs and was not dropped. (A dropped one may still be busy.)
  bool awaited() const { return awaited_; }

 private:
  QThread thread_;
  QObject* worker_;
  std::atomic<int> newest_{0};
  int pending_ = 0;       ///< interface thread only
  bool awaited_ = false;  ///< interface thread only
};

}  // namespace glint::gui
