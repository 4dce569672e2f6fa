// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// A number at one direction of the photograph about the observed contour's centroid: rad in (-pi, pi], 0 = right, pi/2 = down.
struct DirectionSample {
  double direction = 0;
  Pixel at{0, 0};               ///< the contour point there, ideal px
  std::optional<double> value;  ///< none if the contour has no answer in this direction
};

/// One matched highlight: predicted against observed, by direction.
struct PolarResidual {
  std::string model, light;
  int observed = -1;   ///< index into FrameEvidence::scored()
  int predicted = -1;  ///< index into the prediction's highlights
  Pixel centre{0, 0};  ///< centroid of the observed contour
  /// `at` is the observed point; px from it to the predicted contour, positive where the predicted one lies outside.
  std::vector<DirectionSample> samples;
  double meanAbsPx = 0, largestAbsPx = 0;  ///< NaN without samples
};

/// Every matched highlight of one frame and model, at `directions` equal steps. Directions where the nearest part of the
/// prediction only bridges failed directions, or where the image border cuts the observed contour, have no value. Empty if the
/// model or the frame has no match. std::invalid_argument unless directions >= 3.
std::vector<PolarResidual> polarResiduals(const Inspection& inspection, int frame, const std::string& model, int directions = 72);

/// The contour point furthest from `centre` in this direction; empty if the contour does not meet that ray.
std::optional<Pixel> contourPointAt(const Polyline& contour, const Pixel& centre, double direction);

/// Distance from `point` to a closed contour, px: positive inside it, negative outside. Empty if the nearest part is one of the
/// gaps (from vertex, to vertex), which are not part of the contour.
std::optional<double> depthInside(const Polyline& contour, const std::vector<std::pair<int, int>>& gaps, const Pixel& point);

/// Incident angle by direction of one observed highlight, given one light (method.md section 6).
struct AngleByDirection {
  std::string model, light;
  int observed = -1;
  Pixel centre{0, 0};
  std::optional<double> limitAngle;       ///< of the model or of the light's estimate, rad
  bool extended = false;                  ///< that is of a point: the lamp's extent changes it with the direction
  std::vector<DirectionSample> measured;  ///< alpha on the observed contour, rad
  /// Alpha on the predicted contour; empty if nothing was predicted for this highlight.
  std::vector<DirectionSample> predicted;
};

/// The light that a model's fit of this light and frame predicts with: its own, the one estimated for all models, or its
/// ellipsoid's centre. NoLight without any of them.
Outcome<Light> lightOfModel(const Inspection& inspection, int frame, const std::string& model, const std::string& light);

/// The surface that a frame's computations used, a corrected depth map included. It may have to be read, which takes its time.
/// NoSurface; FrameUnreadable.
Outcome<std::shared_ptr<const Surface>> surfaceOfFrame(const Inspection& inspection, int frame, const std::string& light);

/// alpha = angle(N, H) where the contours meet the surface. Directions where the ray misses it, or the light is behind it, have
/// no value.
/// @param surface  of the frame. Observed highlights whose light the model does not know are left out.
std::vector<AngleByDirection> limitAngles(const Inspection& inspection, int frame, const std::string& model,
                                          const Surface& surface, int directions = 72);

}  // namespace glint
