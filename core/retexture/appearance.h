// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/polyline.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/training.h"
#include "core/retexture/fall_profile.h"

namespace glint {

/// A contour as a star around a place inside: rho of a pixel is its distance from there over the contour's in the same direction.
class ContourStar {
 public:
  /// NotReached if no place inside is found: a contour without area.
  /// @param around  the brightest pixel; where it lies outside of the contour, the centroid is taken
  /// @param gaps    segments of the contour (from vertex, to vertex) that bridge directions without an answer
  static Outcome<ContourStar> of(const Polyline& contour, const Pixel& around, const std::vector<std::pair<int, int>>& gaps = {});
  double rho(const Pixel& ideal) const;
  bool inGap(const Pixel& ideal) const;  ///< the pixel lies in a direction that the prediction does not cover

 private:
  std::size_t sector(const Pixel& ideal) const;
  Pixel centre_{0, 0};
  std::vector<double> reach_;  ///< px, at equal steps of the direction
  std::vector<char> gap_;
};

/// What a highlight of one light looks like in photographs, learned from the training frames: colour, strength, fall.
/// The radiance of a frame is, in linear light (codes through the inverse sRGB curve, 1 = the largest code):
///   Lobe       strength exp(log I - logReference), log I the model's own field (model reflectance);
///   Angle      strength f(alpha / limit angle), the model's own level sets (model limit-angle);
///   Contour    strength f(rho), rho by ContourStar: models that predict a contour only.
struct HighlightAppearance {
  enum class Kind { Lobe, Angle, Contour };
  Kind kind = Kind::Contour;
  Eigen::Vector3d strength{0, 0, 0};   ///< per channel, the median of the training views'
  double logReference = 0;             ///< Lobe
  std::optional<FallProfile> profile;  ///< Angle, Contour
  int views = 0;                       ///< that were used
  double spread = 0;                   ///< (largest - smallest) / median of the strength over them
  std::vector<std::string> remarks;    ///< what makes it doubtful, for the user
};

/// "lobe", "level sets of alpha", "contour".
const char* nameOf(HighlightAppearance::Kind kind);

/// @param fit  that serves a frame, with its key.
/// NotSupported if no training frame of the light has a photograph (a picture of codes, not radiance alone); the reason why
/// the last view failed where none could be used.
Outcome<HighlightAppearance> learnAppearance(const Inspection& inspection, const ModelFit& fit, const FitKey& key);

/// Appearances that were learned before, for pictures one after another: learning reads the photographs of all training frames.
/// Those of the newest inputs alone are kept. For one caller at a time.
class LearnedAppearances {
 public:
  /// learnAppearance(), or its earlier answer for the same scene, model and inputs of the fits.
  Outcome<HighlightAppearance> of(const Inspection& inspection, const std::string& model, const ModelResult::Fit& fit);

 private:
  std::shared_ptr<const Scene> given_;
  StageInputs inputs_;
  std::map<std::pair<std::string, FitKey>, Outcome<HighlightAppearance>> known_;
};

/// alpha of a visible point (normal towards the camera) over the limit angle, where the model's contour is 1; nothing if the
/// light is behind the surface.
std::optional<double> angleRho(const LimitAngleFit& fit, const Light& light, const SurfacePoint& point,
                               const Eigen::Vector3d& eye);

}  // namespace glint
