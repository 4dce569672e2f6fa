// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/outcome.h"
#include "core/light/estimate.h"

namespace glint {

/// A surface point as a camera sees it.
struct EvidencePoint {
  Eigen::Vector3d position, normal, toCamera;  ///< unit vectors away from the surface
};

/// One contour point of a bundle. Its place does not depend on the light, so rays are cast once; weight and bias belong to one
/// solution.
struct ContourEvidence {
  static constexpr double kStepPx = 0.5;  ///< of the finite differences that turn an angle into pixels
  EvidencePoint at;
  std::optional<EvidencePoint> left, right, up, down;  ///< of the pixels kStepPx away; empty where the surface ended
  std::optional<EvidencePoint> leftUp, rightUp, leftDown,
      rightDown;  ///< along both diagonals: one alone would tell an image from its mirror image
  int view = 0;
  Pixel pixel{0, 0};
  double cameraDistance = 0;   ///< m
  double pixelsPerRadian = 1;  ///< 1 / |d alpha / d pixel| for the light of the last reweighting
  double biasPx = 0;           ///< by how much noise displaces the residual on average
};

/// The contours on their surfaces, world, m. Points that miss the surface, or whose neighbours do on both sides, are left out.
/// NotFinite for a contour point; PeakOffSurface when there were points and none is on its surface.
Outcome<std::vector<ContourEvidence>> contoursOnSurfaces(const std::vector<BundleView>& views, int pointsPerView);

/// In coordinates (x - origin) / scale, origin the points' middle and scale their mean distance from the cameras, m.
struct NormalisedContours {
  std::vector<ContourEvidence> points;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 1;
};
/// TooFewPoints below five; NotFinite.
Outcome<NormalisedContours> normalised(std::vector<ContourEvidence> points);

/// bundleLight() and leftOutErrors() for points whose rays were cast before: several solutions for the same views.
/// @param evidence  of contoursOnSurfaces()
/// @param views     how many there are
Outcome<Bundle> bundleLight(const std::vector<ContourEvidence>& evidence, std::size_t views, const Light& start,
                            const BundleOptions& options);

/// Distance of every view's contour from the level set alpha = limitAngle under a light that was found elsewhere, px to first
/// order: the rmsWithoutTail() of its points. NaN for a view without a point on its surface, and for all of them below five
/// points.
std::vector<double> typicalResidualsPx(const std::vector<ContourEvidence>& evidence, std::size_t views, const Light& light,
                                       double limitAngle);
/// @param places    of placesOf(), one per view
Outcome<LeftOutErrors> leftOutErrors(const std::vector<ContourEvidence>& evidence, const std::vector<int>& places,
                                     const Light& start, const BundleOptions& options, int atMost);

}  // namespace glint

namespace glint::refining {

// What the refinements of poses, depth and normals agree on.

/// Share of the points that count as independent, from which residuals are noise. Below it they keep their sign along contours,
/// and something systematic is left; white noise leaves nearly all of them.
inline constexpr double kSystematic = 0.5;
/// The accuracy of detection (px): below it poses, depth and normals would be bent to round-off.
inline constexpr double kLeastNoisePx = 0.02;

}  // namespace glint::refining
