// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// Error of a contour, in percent of the highlight's diameter: beyond, the predicted contour lies beside the highlight.
inline constexpr double kOwnSizePct = 100;

/// How far a number can be trusted. Unknown: it does not exist here, which is no fault.
enum class Verdict { Green, Amber, Red, Unknown };
const char* nameOf(Verdict verdict);

/// One number that tells whether an answer is determined by its data.
struct Finding {
  std::string id;     ///< "fit", "peaks", "rank", "gap", "signature", "angle", "views", "light", "residual"
  std::string title;  ///< "triangulation angle"
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string text;  ///< the value with its unit: "4.3°"
  Verdict verdict = Verdict::Unknown;
  std::string reason;  ///< one sentence: what the number means here and against which bound it was judged
};

/// How well one model of one light (and surface) is determined by its training views.
struct Conditioning {
  std::string model, light;
  std::optional<std::string> surface;
  bool poor = false;                   ///< the fit answers, and explains its training views badly
  std::vector<double> singularValues;  ///< of the linear system for Q*, descending; empty for models without one
  /// describe() of the linear solution's Q*: "ellipsoid", "hyperboloid of two sheets", ...; "" without one.
  std::string quadricKind;
  std::vector<Finding> findings;
  Verdict worst() const;  ///< of the findings; Unknown when none is known
};

/// One entry per fit of every model, in the models' order. A failed fit has a red finding with its reason, and the findings that
/// can still be made. The linear system for Q* is solved again here, whatever solver the fit used: `refined` with a prior is an
/// ellipsoid always, and only the linear solution shows that the contours alone would have given a hyperboloid.
/// Where a training peak lies outside its own contour (see outsideOfContour), a model that uses peaks has a red finding "peaks",
/// and nothing that rests on its views is green: a wide angle between rays that were never seen means nothing.
std::vector<Conditioning> conditioningOf(const Inspection& inspection);

/// Widest angle between two of the unit vectors, rad; 0 for fewer than two. Above 256 vectors, that many evenly spread ones are
/// compared.
double widestAngle(const std::vector<Eigen::Vector3d>& directions);

/// How many different directions there are: the diversity of order 2, n^2 / sum_ij z_ij, with the similarity z_ij = max(0, 1 -
/// angle_ij / independent). n equal directions count as one, n directions that are further apart than `independent` as n. As
/// widestAngle for many vectors.
/// @see Leinster and Cobbold, Measuring diversity: the importance of species similarity, Ecology 2012.
double effectiveNumber(const std::vector<Eigen::Vector3d>& directions, double independent);

/// What ModelFit::residualPx of a fit measures: "from the observed contour to the outline, one way, RMS". It is another number
/// than the contour error of the same frame, which goes both ways: a contour may lie along an outline that runs far beyond it.
std::string residualMeaning(const ModelFit& fit);
/// What LightEstimate::rmsPx means, in words.
std::string residualMeaning(const LightEstimate& light);

/// Standard deviations of the three semi-axes, m, to first order from the fit's uncertainty of the shape S: d a = v^T dS v / (2
/// a) along the axis v. Empty if the fit has no ellipsoid or tells no uncertainty; infinite for an axis of length 0.
std::optional<Eigen::Vector3d> semiAxesSigma(const ModelFit& fit);

/// Bounds of the verdicts, each with its reason.
namespace bounds {
/// Second last over first singular value. Detection knows a contour to about a thousandth of the highlight's size (0.1 px of 100
/// px), which the rows of some views average to a ten-thousandth; what the system says more weakly than that is noise. Red:
/// reconstructLinear's own bound, round-off.
inline constexpr double kRankAmber = 1e-4, kRankRed = 1e-9;
/// Last over second last. Red: reconstructLinear refuses above it. Amber: the second best quadric fits only five times worse than
/// the best.
inline constexpr double kGapAmber = 0.2, kGapRed = 0.5;
/// Rays that meet under the angle t turn an error across them into one along them that is 1 / sin t times as large: 11 times at 5
/// degrees, 38 times at 1.5 degrees, under which structure from motion discards points (COLMAP's default).
inline constexpr double kAngleAmberDeg = 5, kAngleRedDeg = 1.5;
/// An ellipsoid with a free centre needs three views, one with a known centre two (method.md section 7).
inline constexpr double kViewsAmber = 3, kViewsRed = 2;
/// Standard deviation of the light over its distance. A simple lobe alone puts the light off by 1 % (path-traced plane) to 9 %
/// (sphere), so below 1 % the noise does not matter beside the model, and above 10 % it is worse than any model.
inline constexpr double kLightAmber = 0.01, kLightRed = 0.10;
/// RMS of the fit over the diameter of the contours that were fitted. Above 1 % the paper's own canonical model would be no
/// better than its dual one on a plane (method.md section 9); above 5 % the outlines are not those of one ellipsoid.
inline constexpr double kResidualAmber = 0.01, kResidualRed = 0.05;
}  // namespace bounds

}  // namespace glint
