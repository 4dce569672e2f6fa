// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/model/walk.h"
#include "core/surface/local_quadric.h"

namespace glint {

/// The level set alpha = limit around one brightest point as a star: for n directions of T (at equal steps of the parameter of
/// the first-order ellipse) the walk on the surface, feet orthogonal to T, until alpha reaches the limit. Directions that fail
/// carry their reason; `onTangentPlane` is not used. The true component is this star only when every direction rises
/// monotonically and no other brightest point is inside; the caller checks that (a walk reports NotMonotonic where it meets a
/// fall).
CanonicalContour starContour(const TangentWalk& walk, const Surface& surface, const Camera& camera, double limit, int directions);

/// Contour, gaps, coverage of a highlight from the ends of its directions: closed through those that succeeded, with runs of
/// failed ones as gaps. Between neighbouring directions the curve is interpolated in the azimuth: straight chords would flatten
/// it.
void outlineOf(const CanonicalContour& c, PredictedHighlight& highlight);

/// Walks on a second-order patch end this close to the limit, rad: 1e-4 px where a limit angle of 5 degrees covers 100 px, far
/// below what the patch itself neglects, and one step of three less.
inline constexpr double kPatchToleranceRad = 1e-7;

/// Up to this curvature variation the patch costs less than half a percent of the diameter (measured: the error in percent is
/// 22 to 33 times the variation there, docs/performance.md).
inline constexpr double kLargestVariation = 0.016;

/// How far the surface's curvature varies over a highlight that was walked on the second-order patch: the largest angle
/// between the surface's and the patch's normal at four ends of the walk (azimuths 135 degrees apart, so that no two are
/// opposite), over the limit angle there. To first order it is (mean change of the shape operator) x (half the reach) / alpha:
/// dimensionless, 0 on planes, spheres and cylinders, and about half of it is the contour error as a share of the diameter
/// (docs/performance.md). Capped at 1, which also stands for an end where the surface has no foot. Costs four exact feet.
double curvatureVariation(const LocalQuadric& patch, const Surface& surface, const CanonicalContour& walked);

}  // namespace glint
