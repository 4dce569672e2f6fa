// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QCache>
#include <QImage>
#include <QList>
#include <QObject>
#include <atomic>
#include <memory>

#include "gui/base/decoded_frames.h"
#include "gui/base/job_queue.h"

namespace glint::gui {

/// Small pictures of frames, read (or rendered for a what-if) off the interface thread when they are wished for, and
/// kept.
class Thumbnails : public QObject {
  Q_OBJECT
 public:
  explicit Thumbnails(QObject* parent = nullptr) : QObject(parent) {}
  void setScene(std::shared_ptr<const Scene> scene);
  /// Results whose pictures are wished for from now on; null or not synthesised: the scene's. Those before stay until they are
  /// replaced.
  void setInspection(std::shared_ptr<const Inspection> inspection);
  /// Null while it is missing; frames without a readable picture stay so.
  QImage find(int frame) const;
  /// Reads the missing ones of these, in this order; earlier wishes that were not reached are dropped.
  void want(const QList<int>& frames, int heightPx);
  bool busy() const { return jobs_.busy(); }
  int reads() const { return reads_; }  ///< pictures made so far

 signals:
  void arrived();

 private:
  struct Kept {
    QImage picture;
    QString pictures;  ///< key of those that it belongs to
  };
  void forgetWishes();

  FramePictures pictures_;
  QCache<int, Kept> kept_{4096};  ///< number of pictures, some 10 KB each
  QList<int> wished_;
  std::atomic<int> reads_{0};
  JobQueue jobs_;
};

}  // namespace glint::gui
