// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/uncertainty.h"
#include "core/geometry/light.h"
#include "core/surface/brightest_point.h"

namespace glint {

/// Reflected ray of an observed brightest point: from P along r = reflect(V, N).
struct ReflectedRay {
  Eigen::Vector3d origin;     ///< P
  Eigen::Vector3d direction;  ///< r, unit
  Eigen::Vector3d normal;     ///< N, camera's side
};
ReflectedRay reflectedRay(const BrightestPoint& brightest, const Camera& camera);

struct Triangulation {
  Light light;
  double condition = 0;  ///< smallest over largest eigenvalue of sum (I - r r^T), in (0, 1]; small = nearly parallel
  Eigen::Matrix3d
      covariance;       ///< m^2 of the position, from the rays' residual spread (unit variance when exact); zero for a direction
  double residual = 0;  ///< RMS distance of the rays from the light, m (0 for a direction)
};

/// Closest point to the reflected rays, min sum |(I - r r^T)(L - P)|^2 (method.md section 4), by a QR or SVD of the stacked
/// rows. Rays nearly parallel (condition < minCondition) give a light at infinity along their mean.
/// TooFewViews (< 2 rays); LightBehindSurface (N.(L - P) <= 0 for any ray); NotFinite.
Outcome<Triangulation> triangulateLight(const std::vector<ReflectedRay>& rays, double minCondition = 1e-8);

/// Contour evidence of one view for the bundle.
struct BundleView {
  Camera camera;
  const Surface* surface = nullptr;
  std::vector<Pixel> contour;  ///< ideal pixels, about equally spaced
  std::optional<BrightestPoint> brightest;
};

struct BundleOptions {
  int pointsPerView = 72;  ///< contour points used, equally spaced in arc length
  double robustPx = 1.0;   ///< scale of the Huber/Cauchy loss, px
  int maxIterations = 100;
  bool holdLight = false;  ///< the start is known: only the limit angle is estimated
  int limitOrders = 0;  ///< 0: one limit angle; 1: also the extent of the light (directed_limit.h), from the second even order on
};

struct Bundle {
  Light light;
  double limitAngle = 0;                  ///< rad
  std::optional<Eigen::Matrix3d> extent;  ///< m^2 (rad^2 at infinity), see directed_limit.h; with limitOrders 1
  /// Covariance of the tangent coordinates of L (3) and alpha_lim in the solver's chart, scaled by the residual variance.
  Eigen::Matrix<double, 4, 4> covariance;
  Eigen::Matrix3d positionCovariance;  ///< m^2; not finite for a light at infinity
  double rmsPx = 0;
  std::vector<double> residualPx;  ///< per view, RMS
  /// rmsWithoutTail() per view: where alpha hardly changes over the image, a residual has no bound.
  std::vector<double> typicalPx;
  int iterations = 0;
  /// Uncertainty of L (homogeneous, |L| = 1: 4 entries), limitAngle (1), and the extent xx yy zz xy xz yz if estimated; world.
  /// Empty where the contours leave a direction of L open.
  std::optional<ParameterUncertainty> uncertainty;
};

/// Light and limit angle from whole contours (method.md section 4, `bundle`): minimises over (l, w) on the unit sphere, w >= 0,
/// and alpha_lim the robust sum of ((alpha(P_ij; L) - alpha_lim) / |d alpha / d pixel|)^2, residuals in pixels, by Ceres.
/// @param start  first guess (the triangulated light); other starts are tried when it converges badly.
/// TooFewPoints; PeakOffSurface when no contour point hits the surface; NotConverged; LightBehindSurface; NotFinite.
Outcome<Bundle> bundleLight(const std::vector<BundleView>& views, const Light& start, const BundleOptions& options = {});

/// RMS distances of left-out views' contour points from the level sets of the bundles of the other views, px (to first order),
/// one entry per place that was left out (placesOf()). NaN where fewer than five of its points are on a surface.
struct LeftOutErrors {
  std::vector<double> constant;  ///< with one limit angle
  std::vector<double> directed;  ///< with the extent of the light, see BundleOptions::limitOrders
};
/// Leaves the views of one place out at a time, evenly spread ones where there are more than `atMost` places. Rays are cast once
/// for all of them. The first failure of bundleLight() for any of them.
Outcome<LeftOutErrors> leftOutErrors(const std::vector<BundleView>& views, const Light& start, const BundleOptions& options,
                                     int atMost);

/// Triangulation::condition of any rays, also of those that give no light: smallest over largest eigenvalue of sum (I - r r^T),
/// in [0, 1]; small = nearly parallel. 0 below two rays.
double conditionOf(const std::vector<ReflectedRay>& rays);

struct PoseRefinement {
  Bundle bundle;                ///< with the refined cameras
  std::vector<Camera> cameras;  ///< one per view
  double movedPx = 0;           ///< RMS over views and axes of the correction, px at the surface
};

/// Light, limit angle and a small correction of every camera together: each view may turn by `sigmaPx` / f about each of its axes
/// and shift by `sigmaPx` Z / f along each (standard deviations of a Gaussian prior, Z its distance from the surface). Minimises
/// the robust sum of squared contour distances in pixels plus the prior, by Gauss-Newton steps on the joint Jacobian (QR), from a
/// bundle with the given cameras. Where the residuals of the plain bundle are white, or below 0.02 px, nothing speaks against the
/// poses and they stay as they are. The contours do not show what turns light and cameras alike (any rotation about a sphere's
/// centre), so nothing is gained there. The bundle's own failures.
Outcome<PoseRefinement> refinePoses(const std::vector<BundleView>& views, const Light& start, double sigmaPx,
                                    const BundleOptions& options = {});

}  // namespace glint
