// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/light.h"
#include "core/model/level_set_prediction.h"
#include "core/model/model.h"
#include "core/reflectance/radiance_field.h"
#include "core/surface/part_bounds.h"

namespace glint {

/// A scalar field over a surface, quadratic at its minima (-log I, alpha^2), whose level set may be a star around each of them.
struct StarField {
  /// Value at a point whose normal faces the camera, without shadows; NaN where it is undefined. Inside = value < level.
  std::function<double(const SurfacePoint& facingCamera)> value;
  Light light;
  double lightReach = 0;  ///< of an extended light, see BoundedParts::partsThatMay
  /// An upper bound of (level - value) over parts of the surface.
  std::function<Eight(const PartBounds&, double level)> above;
};

/// A minimum of a field that is quadratic there.
struct Summit {
  Pixel pixel;         ///< to about 1e-4 of the region's size
  SurfacePoint point;  ///< normal faces the camera
  double value = 0;
  Eigen::Matrix2d hessian;  ///< of the value by the pixel, positive definite
};

/// The minimum downhill from a place near it, by Newton's method, by differences over a tenth of the region { value < minimum +
/// rise }. SurfaceEnded where the field is undefined around it; NotConverged where it is not convex or does not settle, so that
/// no smooth single minimum is near.
Outcome<Summit> summitNear(const StarField& field, const Camera& camera, const Surface& surface, const BrightestPoint& start,
                           double rise);

/// The outline of one region as a star around its summit: pixel(t) = centre + reach(t) frame (cos t, sin t).
struct StarOutline {
  Pixel centre{0, 0};
  Eigen::Matrix2d frame, inverse;    ///< px: to second order the region is the image of the unit disc
  std::vector<double> reach;         ///< at equal steps of t from 0
  std::vector<Pixel> pixels;         ///< of the ends
  std::vector<SurfacePoint> points;  ///< there
  double least = 0, most = 0;        ///< of the reaches
  /// Reach of a pixel over that of the outline in its direction; below 1 inside.
  double relativeReach(const Pixel& p) const;
  /// A lower bound of it, faster.
  double leastRelativeReach(const Pixel& p) const { return (inverse * (p - centre)).norm() / most; }
  /// Whether that reach is certainly below 1; faster.
  bool surelyInside(const Pixel& p) const { return (inverse * (p - centre)).squaredNorm() < least * least; }
};

/// The outline of { value < level } around a summit by walks along pixel rays in equal steps of t: starting with half of
/// `directions`, doubled until the curve between them, checked half-way between all neighbours, is known to 0.01 % of the
/// diameter on the average. SurfaceEnded (or the field), NotMonotonic, NotReached where a direction fails; NotConverged where the
/// curve stays unknown, because the region is not a smooth star.
Outcome<StarOutline> starAround(const StarField& field, const Camera& camera, const Surface& surface, const Summit& summit,
                                double level, int directions);

/// The contours of { value < level } as stars around all summits that lie below the level, as predictLevelSet would return them.
/// Where that is not certain, the reason: OutsideImage (a summit, or an outline by more than the margin), what starAround says,
/// Occluded (hidden or in shadow at an end), NotMonotonic (an outline encloses another summit), NotSupported (the surface may
/// reach the level elsewhere).
Outcome<std::vector<PredictedHighlight>> starHighlights(const StarField& field, const Camera& camera, const Surface& surface,
                                                        const std::vector<Summit>& summits, double level,
                                                        const Settings& settings);

/// The contours of a reflectance fit and its light by one walk per direction around the maxima beside the mirror points: those of
/// predictLevelSet, to 0.01 % of the diameter, at a twentieth of its time. Where that is not certain, the reason: that of
/// summitNear or starHighlights, or NoBrightestPoint where the brightest maximum lies `faintest` or more (in log I) down the
/// lobe.
Outcome<std::vector<PredictedHighlight>> radianceStars(const RadianceField& radiance, const ReflectanceFit& fit,
                                                       const Light& light, const std::vector<BrightestPoint>& mirrorPoints,
                                                       double faintest, const Camera& camera, const Surface& surface,
                                                       const Settings& settings);

/// Why it is not certain that, between two corners of the image, only what the outlines enclose of the visible, lit surface is
/// inside { value < level }; empty where it is certain. Surfaces that know bounds of their parts rule out all others by them;
/// elsewhere a grid of rays stands for the parts. Rays a few pixels apart look at what remains and is not near an outline.
std::optional<Failure> somethingElseInside(const StarField& field, const Camera& camera, const Surface& surface,
                                           const std::vector<StarOutline>& outlines, double level, const Pixel& min,
                                           const Pixel& max);

}  // namespace glint
