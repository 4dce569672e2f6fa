// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLabel>
#include <QTimer>

namespace glint::gui {

/// "updating…", or "out of date" once nothing runs, over a corner of a panel whose numbers belong to an older request.
/// Appears after a moment, so that results that come sooner leave no flicker, and takes no clicks.
class StaleBadge : public QLabel {
  Q_OBJECT
 public:
  static constexpr int kAfterMs = 150;
  /// @param corner  of the panel: Qt::TopRightCorner or Qt::BottomRightCorner.
  explicit StaleBadge(QWidget* panel, Qt::Corner corner = Qt::TopRightCorner);
  bool marks() const { return marks_; }

 public slots:
  void setStale(bool stale);
  void setUpdating(bool updating);  ///< the newer numbers are on their way; so it is at first

 signals:
  void marked(bool stale);  ///< it appears, or goes: what else marks the numbers goes with it

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void place();
  void mark(bool stale);

  Qt::Corner corner_;
  QTimer later_;
  bool marks_ = false;
};

}  // namespace glint::gui
