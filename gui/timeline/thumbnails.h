// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QCache>
#include <QImage>
#include <QList>
#include <QObject>
#include <QThread>
#include <atomic>
#include <memory>
#include <string>

#include "core/pipeline/inspection.h"

namespace glint::gui {

/// Small pictures of frames, read (or rendered for a what-if) on a thread of their own when they are wished for, and kept.
class Thumbnails : public QObject {
  Q_OBJECT
 public:
  explicit Thumbnails(QObject* parent = nullptr);
  ~Thumbnails() override;
  void setScene(std::shared_ptr<const Scene> scene);
  /// Results whose pictures are wished for from now on; null or not synthesised: the scene's. Those before stay until they are
  /// replaced.
  void setInspection(std::shared_ptr<const Inspection> inspection);
  /// Null while it is not there; frames without a readable picture stay so.
  QImage find(int frame) const;
  /// Reads the missing ones of these, in this order; earlier wishes that were not reached are dropped.
  void want(const QList<int>& frames, int heightPx);
  bool busy() const { return pending_ > 0; }
  int reads() const { return reads_; }  ///< pictures decoded so far

 signals:
  void arrived();

 private:
  std::shared_ptr<const Scene> scene_;
  struct Kept {
    QImage picture;
    std::string pictures;  ///< pictureKey() that it belongs to
  };
  std::shared_ptr<const Inspection> synthesis_;  ///< null: the scene's files
  std::string pictures_;
  QCache<int, Kept> kept_{4096};  ///< number of pictures, some 10 KB each
  QList<int> wished_;
  QThread thread_;
  QObject* worker_;
  std::atomic<int> newest_{0}, reads_{0};
  int pending_ = 0;
};

}  // namespace glint::gui
