// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/light.h"
#include "core/geometry/plane.h"
#include "core/geometry/polyline.h"
#include "core/model/model.h"
#include "core/surface/brightest_point.h"
#include "core/surface/local_quadric.h"
#include "core/surface/surface.h"

namespace glint {

struct WalkOptions {
  double toleranceRad = 1e-10;  ///< the walk ends when alpha is this close to the limit angle
  int maxSteps = 60;            ///< marching steps before NotReached; steps grow, so this spans 1e4 first steps
};

/// The walks of method.md section 6 from one brightest point: along a direction v of the tangent plane T, either on T
/// itself (constant normal) or on the surface S by feet orthogonal to T. Holds references: the surface and the camera must
/// outlive it.
class TangentWalk {
 public:
  /// @param brightest  normal towards the camera.
  TangentWalk(const Surface& surface, const Camera& camera, const BrightestPoint& brightest, const Light& light,
              const WalkOptions& options = {});

  const Plane& tangentPlane() const { return plane_; }
  const BrightestPoint& brightest() const { return brightest_; }
  /// Unit direction in T; azimuth 0 is the direction that projects closest to +x in the image, so that azimuths are
  /// comparable between views.
  Eigen::Vector3d direction(double azimuth) const;
  Eigen::Vector3d direction(double cosine, double sine) const { return cosine * basis_.col(0) + sine * basis_.col(1); }
  /// Azimuth of the orthogonal projection of (point - P_B) on T.
  double azimuthOf(const Eigen::Vector3d& point) const;

  /// alpha at a point of T, where the normal is that of P_B. NaN where the light or the camera is behind.
  double alphaOnPlane(const Eigen::Vector3d& pointOnPlane) const;
  /// alpha at a surface point (normal turned to the camera's side). Named: Occluded (turned away from the camera),
  /// LightBehindSurface.
  Outcome<double> alphaOnSurface(const SurfacePoint& p) const;

  /// Distance along `direction` on T at which alpha first rises through `limit`. @param scale first step, m.
  /// NotReached; NotMonotonic.
  Outcome<double> reachOnPlane(const Eigen::Vector3d& direction, double limit, double scale) const;
  /// The same on S. NotReached; NotMonotonic; SurfaceEnded; Occluded; LightBehindSurface.
  struct Reach {
    double distance;     ///< along the direction on T, m
    SurfacePoint point;  ///< foot, normal towards the camera
  };
  Outcome<Reach> reachOnSurface(const Eigen::Vector3d& direction, double limit, double scale) const;
  /// The same where the end of a neighbouring direction is known: a few secant steps from the expected distance. Marches as above
  /// when alpha there is not within a quarter of the limit, or when the steps do not settle near the expected distance.
  /// @param expected  distance, m; > 0.  @param neighbour  where the neighbouring walk ended: feet are searched from there.
  Outcome<Reach> reachNear(const Eigen::Vector3d& direction, double limit, double expected, const SurfacePoint& neighbour,
                           double scale) const;
  /// Walk on S until the foot's pixel leaves the contour. @param contour closed, ideal pixels, around the peak.
  Outcome<Reach> reachContour(const Eigen::Vector3d& direction, const Polyline& contour, double scale) const;

  /// First order of alpha around P_B: J (2x2, rad/m) with alpha(s) = |J (cos a, sin a)| s + O(s^2) along the azimuth a, on S:
  /// J = B^T dH B - (N.H) S with the shape operator S (zero where the surface has no curvature, as on facets).
  Eigen::Matrix2d angularRate() const;

  /// A length on T that corresponds to `pixels` at P_B, m.
  double metresPerPixel() const;
  /// Homography from plane coordinates (a, b, 1) - P_B + a u + b v - to pixels.
  Eigen::Matrix3d pixelFromPlane() const;

 private:
  Outcome<SurfacePoint> foot(const Eigen::Vector3d& onPlane, const SurfacePoint& previous) const;
  /// sin(alpha - limit) at a lit surface point that faces the camera, NaN elsewhere: the root's function without atan2.
  double sineAbove(const SurfacePoint& p, double sineLimit, double cosineLimit) const;
  /// reachNear on a local quadric at P_B, by its closed forms; nothing where the general walk is needed.
  std::optional<Reach> reachOnPatch(const Eigen::Vector3d& direction, double limit, double expected) const;
  /// Part of a walk: distances on T, pixels of the feet at both ends, and the last foot.
  struct Step {
    double a, b;
    Pixel from, to;
    SurfacePoint end;
  };
  /// Where the foot's pixel lies on the line of a contour's edge, within a step that crosses it; on the line of a neighbouring
  /// edge where the path bends. BehindCamera; NotConverged; the failures of foot().
  Outcome<Reach> reachOnEdge(const Eigen::Vector3d& direction, const Polyline& contour, std::size_t edge, const Step& step) const;

  const Surface& surface_;
  const Camera& camera_;
  BrightestPoint brightest_;
  Light light_;
  WalkOptions options_;
  Eigen::Vector3d eye_;
  Plane plane_;
  Eigen::Matrix<double, 3, 2> basis_;  ///< u, v in T
  /// The patch that is walked, when its origin is P_B, with eye and light (homogeneous) in its frame, N towards the camera.
  const LocalQuadric* patch_ = nullptr;
  double side_ = 1;  ///< of N against the patch's own normal
  Eigen::Vector3d eyeOnPatch_, lightOnPatch_;
};

/// Guesses the reach of a direction from those of the directions before it (equal steps of the azimuth or another parameter):
/// the quadratic through the last three, or fewer.
class ReachGuess {
 public:
  /// Reach over its first guess in the next direction.
  double next() const {
    return count_ >= 3 ? 3 * last_[0] - 3 * last_[1] + last_[2] : count_ == 2 ? 2 * last_[0] - last_[1] : last_[0];
  }
  bool known() const { return count_ > 0; }
  void add(double ratio) {
    last_[2] = last_[1];
    last_[1] = last_[0];
    last_[0] = ratio;
    ++count_;
  }
  /// A direction failed: the directions before it no longer tell how the ratio bends.
  void interrupt() { count_ = count_ > 0 ? 1 : 0; }

 private:
  double last_[3] = {1, 1, 1};
  int count_ = 0;
};

/// Canonical contour of an observed highlight: for n directions walk on S to the contour, read the limit angle there, and
/// walk on T to the same angle (method.md section 6). Never fails as a whole: each direction carries its result, and the
/// ellipse is empty when fewer than five directions succeeded.
CanonicalContour canonicalContour(const TangentWalk& walk, const Camera& camera, const Polyline& contour, int directions);

/// Ends of walks (one per direction; those with a failure are skipped): fails the directions whose end is hidden or behind the
/// camera, and stores position and pixel of the others.
void keepVisible(CanonicalContour& contour, const std::vector<SurfacePoint>& ends, const Surface& surface, const Camera& camera);

/// Inverse: from the ellipse on T (given in pixels; T is fixed by the mirror, so real and virtual camera see the same
/// pixels) to the predicted points on S (method.md section 8).
CanonicalContour predictFromEllipse(const TangentWalk& walk, const Surface& surface, const Camera& camera, const Ellipse& ellipse,
                                    int directions);

}  // namespace glint
