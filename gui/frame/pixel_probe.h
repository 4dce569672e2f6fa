// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <memory>

#include "core/pipeline/probe.h"
#include "gui/base/latest_job.h"

namespace glint::gui {

/// Asks, off the interface thread, what lies under the mouse: values of photograph and radiance, surface and incident angles.
/// Only the newest wish is answered.
class PixelProbeWorker : public QObject {
  Q_OBJECT
 public:
  explicit PixelProbeWorker(QObject* parent = nullptr);
  /// @param inspection  may be null: then only the values are read.
  void want(std::shared_ptr<const Scene> scene, std::shared_ptr<const Inspection> inspection, int frame, const Pixel& at);
  /// Running jobs give no answer.
  void forget() { job_.drop(); }
  bool busy() const { return job_.busy(); }

 signals:
  void probed(const QString& text);

 private:
  struct Images;  ///< of the frame asked for last; used by its jobs only

  std::shared_ptr<Images> images_;
  LatestJob job_;
};

/// "x 12.00  y 3.50   sRGB 1 2 3   radiance …   depth … m   N …   α …": one line, as in the status bar.
QString probeText(const Pixel& at, const QString& values, const Outcome<PixelProbe>* probe);

}  // namespace glint::gui
