// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <optional>

#include "core/surface/occlusion.h"

namespace glint {

/// A field's value at the visible surface point of a pixel.
struct PixelSample {
  SurfacePoint point;  ///< normal faces the camera
  double value = 0;
};

/// Evaluates a field by pixels. Near a known point the surface is followed from there, which on a mesh costs a tenth of a ray.
/// The place it finds may be hidden by another part, which the caller checks.
class PixelSampler {
 public:
  using Value = std::function<double(const SurfacePoint& facingCamera)>;

  /// References: all must outlive the sampler.
  PixelSampler(const Value& value, const Camera& camera, const Surface& surface)
      : value_(value),
        surface_(surface),
        eye_(camera.centreInWorld()),
        worldFromPixel_((camera.pixelFromRay * camera.camFromWorld.linear()).inverse()),
        // Meshes answer many occlusions in packets, and only they are slower by rays than by steps.
        follows_(dynamic_cast<const ManyOcclusions*>(&surface) != nullptr) {}

  const Eigen::Vector3d& eye() const { return eye_; }
  /// Whether `near` may return hidden places.
  bool follows() const { return follows_; }

  Ray ray(const Pixel& p) const { return {eye_, (worldFromPixel_ * p.homogeneous()).normalized()}; }

  /// The sample by a ray. Nothing where the ray meets no surface or the value is not finite.
  std::optional<PixelSample> at(const Pixel& p) const {
    Outcome<SurfacePoint> hit = surface_.firstHit(ray(p));
    return hit ? sample(*hit) : std::nullopt;
  }
  /// The sample by a step from a surface point close by.
  std::optional<PixelSample> near(const Pixel& p, const SurfacePoint& from) const {
    if (!follows_) return at(p);
    const Ray r = ray(p);
    const Outcome<SurfacePoint> foot = surface_.foot(r.origin, r.direction, from);
    return foot && (foot->position - eye_).dot(r.direction) > 0 ? sample(*foot) : at(p);
  }

 private:
  std::optional<PixelSample> sample(const SurfacePoint& p) const {
    PixelSample s{facing(p, eye_), 0};
    s.value = value_(s.point);
    return std::isfinite(s.value) ? std::optional<PixelSample>(s) : std::nullopt;
  }

  const Value& value_;
  const Surface& surface_;
  Eigen::Vector3d eye_;
  Eigen::Matrix3d worldFromPixel_;
  bool follows_;
};

}  // namespace glint
