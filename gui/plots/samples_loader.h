// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <memory>

#include "core/draw/plots.h"
#include "gui/base/latest_job.h"

namespace glint::gui {

using FrameSamplesPtr = std::shared_ptr<const draw::FrameSamples>;

/// Samples frames (draw::frameSamples: reads the image and the surface) off the interface thread. Only the newest wish is
/// answered.
class SamplesLoader : public QObject {
  Q_OBJECT
 public:
  explicit SamplesLoader(QObject* parent = nullptr) : QObject(parent) {}
  /// Answers with loaded(). @param inspection  null = nothing is wanted.
  void want(std::shared_ptr<const Inspection> inspection, int frame, const std::string& model);
  bool busy() const { return job_.busy(); }

 signals:
  void loaded(const glint::gui::FrameSamplesPtr& samples);

 private:
  LatestJob job_;
};

}  // namespace glint::gui
