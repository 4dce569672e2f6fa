// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "core/advise/explain.h"
#include "core/model/model.h"

// What the steps of an explanation read from, and how they write their numbers. Used by the steps alone.
namespace glint::explain_steps {

ExplainNumber one(const std::string& symbol, const std::string& name, double value, const std::string& unit = "");
ExplainNumber point(const std::string& symbol, const std::string& name, const Eigen::Vector3d& p, const std::string& unit = "m");
ExplainNumber pixel(const std::string& symbol, const std::string& name, const Pixel& p);

struct Case {
  const Inspection& inspection;
  Explanation& out;
  const Highlight* highlight = nullptr;
  std::shared_ptr<const Surface> surface{};
  const ModelResult* result = nullptr;
  const ModelResult::Fit* fit = nullptr;
  const FrameComparison* comparison = nullptr;
  const FrameComparison::Row* row = nullptr;
  Camera camera() const { return inspection.cameraFor(out.frame, out.light); }
  /// The prediction of this highlight; if it was missed, the one beside it.
  const PredictedHighlight* predicted() const;
  /// Whether a frame has the same light and models as this one: with a model for each surface, only where it sees the same
  /// surface.
  bool sharesModel(int frame) const;
  /// The light that the contours of all these frames tell; null without such a light.
  const LightEstimate* common() const;
  /// The model's own light, if it differs from the common one; else null.
  const Light* own() const;
};

/// Whether the steps have a brightest point to start from; else the step says why not.
bool reached(const Case& c, ExplainStep& step);
/// What a model takes the surface for.
ModelTraits::Assumes assumes(const std::string& model);
/// How many of 72 equally spaced contour points lie where the camera sees the surface end: its edge cuts the highlight.
int endsAtEdge(const TrainingView& view);

void virtualCameraStep(const Case& c, ExplainStep& step);
void lightStep(const Case& c, ExplainStep& step);
/// Tells, in a step based on the common light, that the model has another one.
void addOtherLight(const Case& c, ExplainStep& step);

}  // namespace glint::explain_steps
