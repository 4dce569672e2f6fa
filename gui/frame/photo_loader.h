// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QCache>
#include <QImage>
#include <QObject>
#include <QString>
#include <QThread>
#include <atomic>
#include <memory>

#include "core/scene/scene.h"

namespace glint::gui {

/// Reads photographs on a thread of its own and keeps the last ones. Only the newest wish is answered:
/// scrubbing over hundreds of frames reads those that one stops at.
class PhotoLoader : public QObject {
  Q_OBJECT
 public:
  explicit PhotoLoader(QObject* parent = nullptr);
  ~PhotoLoader() override;
  void setScene(std::shared_ptr<const Scene> scene);
  /// Answers with loaded() or failed(), at once when the photograph is kept.
  void want(int frame);
  bool busy() const { return pending_ > 0; }

 signals:
  void loaded(int frame, const QImage& photograph);
  void failed(int frame, const QString& reason);
  void idle();

 private:
  void deliver(int ticket, int frame, const QImage& image, const QString& reason);

  std::shared_ptr<const Scene> scene_;
  QCache<int, QImage> kept_{256};  ///< cost in MiB
  QThread thread_;
  QObject* worker_;
  std::atomic<int> newest_{0};
  int pending_ = 0;
};

}  // namespace glint::gui
