// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/uncertainty.h"
#include "core/geometry/ellipsoid.h"
#include "core/geometry/light.h"

namespace glint {

/// One view for the reconstruction of an ellipsoid from its outlines: the conic and the (real or virtual) projection.
struct ConicView {
  Projection projection;      ///< P or P M
  Ellipse ellipse;            ///< measured outline, px
  std::vector<Pixel> points;  ///< contour points for `refined`; may be empty (then sampled from the ellipse)
};

struct ReconstructOptions {
  double minRankRatio = 1e-9;  ///< second last over first singular value: below, several views show the same geometry
  double maxGapRatio = 0.5;    ///< last over second last: above, the solution is not unique
};

struct Reconstruction {
  DualQuadric quadric;                              ///< Q*, (3,3) = +1 where possible
  std::optional<Ellipsoid> ellipsoid;               ///< empty when Q* is not one (only `linear` may return that)
  std::vector<double> singularValues;               ///< of the normalised linear system, descending
  double gapRatio = 0;                              ///< last / second last; near 1 = ambiguous
  double condition = 0;                             ///< first / second last
  std::vector<double> residualPx;                   ///< per view, RMS distance of the contour points to the outline
  std::string solver;                               ///< "linear", "anchored", "refined"
  int iterations = 0;                               ///< of the refinement
  std::optional<ParameterUncertainty> uncertainty;  ///< of (centre (3), S xx yy zz xy xz yz (6)); `refined` only
  std::vector<std::string> remarks;                 ///< warnings in words, for the user: what makes the answer doubtful
  std::string brief() const;                        ///< "4 views, gap 1.2e-4, worst 0.83 px (view 2)"
};

/// Linear: s_i vech(C_i*) = vech(P_i Q* P_i^T), images and world normalised, smallest singular vector. The scales s_i are
/// eliminated by projecting across the measured conics, which leaves ten unknowns and the same null space (method.md section 7;
/// nullities in style.md rule 18). Returns Q* even when it is no ellipsoid (`ellipsoid` is then empty). TooFewViews (< 3);
/// RankDeficient (judged by the second last singular value, then by the gap); NotFinite.
/// @param origin  a point near the answer (the light), for normalisation; if empty, the views' mean axis point.
Outcome<Reconstruction> reconstructLinear(const std::vector<ConicView>& views, const std::optional<Eigen::Vector3d>& origin = {},
                                          const ReconstructOptions& options = {});

/// Anchored: the centre is fixed at `centre`; linear in S (6 unknowns + scales), S projected on the semidefinite cone.
/// TooFewViews (< 2); RankDeficient; NotAnEllipsoid (the projected S has two empty axes); NotFinite.
Outcome<Reconstruction> reconstructAnchored(const std::vector<ConicView>& views, const Eigen::Vector3d& centre,
                                            const ReconstructOptions& options = {});

/// Prior on the centre for `refined`.
struct CentrePrior {
  Eigen::Vector3d mean;
  Eigen::Matrix3d covariance;  ///< m^2, positive definite
};

/// Refined: minimises contour distances (px, points to the outline) over the centre and the positive semidefinite S, from
/// `start`, with the prior on the centre when there is one. Never worse than the start.
/// TooFewViews (< 3 without a prior, < 2 with one); NotAnEllipsoid when the start has none; NotFinite; RankDeficient;
/// NotConverged where the iteration ends far from a minimum (the next step is longer than the ellipsoid). Running out of
/// iterations closer to it is no failure: the result is still better than the start, and `solver` says so.
Outcome<Reconstruction> reconstructRefined(const std::vector<ConicView>& views, const Ellipsoid& start,
                                           const std::optional<CentrePrior>& prior = {}, int maxIterations = 100);

}  // namespace glint
