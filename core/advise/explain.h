// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// A number of a step with the symbol of method.md: "alpha_lim", "4.31 deg".
struct ExplainNumber {
  std::string symbol;          ///< "P_B", "kappa_1"
  std::string name;            ///< "brightest point"
  std::vector<double> values;  ///< one, or the components of a point
  std::string unit;            ///< "m", "px", "deg", "%", "" for none
  double least = 0;            ///< in `unit`: what is smaller is rounding and noise of the arithmetic; 0 = every value counts
};

/// An assumption of the method that this scene breaks: `id` names its sentence in resources/explain, `numbers` show it.
struct BrokenAssumption {
  std::string id;
  std::vector<ExplainNumber> numbers;
};

/// One step of the way from a photograph to a predicted highlight. Its title, text, equation and what is shown with it are in
/// resources/explain/steps.json under the same id.
struct ExplainStep {
  std::string id;
  std::vector<ExplainNumber> numbers;
  std::vector<BrokenAssumption> broken;
  std::optional<Failure> failure;  ///< the data does not get this far, and why
};

/// The whole way for one highlight of one frame and one model.
struct Explanation {
  int frame = -1;
  int highlight = -1;        ///< index in the frame's evidence; -1 = it has none
  std::string light, model;  ///< "" without one
  /// The view of this highlight, with its canonical contour if a light is known, whether the frame trains or not.
  std::optional<TrainingView> view;
  std::optional<Light> lightUsed;  ///< for the canonical contour
  std::vector<ExplainStep> steps;  ///< all of `explainSteps()`, in that order
};

/// peak, tangent-plane, virtual-camera, light, contour, limit-angles, canonical-ellipse, ellipsoid, projection, inverse-walk,
/// comparison.
const std::vector<std::string>& explainSteps();

/// The wanted model; where it is "" or was not computed, the richest with an ellipsoid, else the richest; "" without any.
std::string modelToExplain(const Inspection& inspection, const std::string& wanted);

/// Pure; takes milliseconds. @param highlight  index in the frame's evidence; out of range = the first.
/// @param model  see modelToExplain().
Explanation explain(const Inspection& inspection, int frame, int highlight, const std::string& model);

}  // namespace glint
