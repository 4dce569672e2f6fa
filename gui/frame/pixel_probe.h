// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <QThread>
#include <atomic>
#include <memory>

#include "core/pipeline/probe.h"

namespace glint::gui {

/// Asks, on a thread of its own, what lies under the mouse: values of photograph and radiance, surface and incident angles. Only
/// the newest wish is answered.
class PixelProbeWorker : public QObject {
  Q_OBJECT
 public:
  explicit PixelProbeWorker(QObject* parent = nullptr);
  ~PixelProbeWorker() override;
  /// @param inspection  may be null: then only the values are read.
  void want(std::shared_ptr<const Scene> scene, std::shared_ptr<const Inspection> inspection, int frame, const Pixel& at);
  /// What is under way is not answered any more.
  void forget() { ++newest_; }
  bool busy() const { return pending_ > 0; }

 signals:
  void probed(const QString& text);

 private:
  struct Images;  ///< of the frame asked for last; used by the thread only
  void deliver(int ticket, const QString& text);

  std::shared_ptr<Images> images_;
  QThread thread_;
  QObject* worker_;
  std::atomic<int> newest_{0};
  int pending_ = 0;
};

/// "x 12.00  y 3.50   sRGB 1 2 3   radiance …   depth … m   N …   α …": one line, as in the status bar.
QString probeText(const Pixel& at, const QString& values, const Outcome<PixelProbe>* probe);

}  // namespace glint::gui
