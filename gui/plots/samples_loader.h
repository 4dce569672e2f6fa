// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QThread>
#include <atomic>
#include <memory>

#include "viz/plots/plots.h"

namespace glint::gui {

using FrameSamplesPtr = std::shared_ptr<const viz::FrameSamples>;

/// Samples frames (viz::frameSamples: reads the image and the surface) on a thread of its own. Only the newest wish is answered.
class SamplesLoader : public QObject {
  Q_OBJECT
 public:
  explicit SamplesLoader(QObject* parent = nullptr);
  ~SamplesLoader() override;
  /// Answers with loaded().
  void want(std::shared_ptr<const Inspection> inspection, int frame, const std::string& model);
  bool busy() const { return pending_ > 0; }

 signals:
  void loaded(const glint::gui::FrameSamplesPtr& samples);

 private:
  QThread thread_;
  QObject* worker_;
  std::atomic<int> newest_{0};
  int pending_ = 0;
};

}  // namespace glint::gui

Q_DECLARE_METATYPE(glint::gui::FrameSamplesPtr)
