// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace glint {

/// What the residuals of a robust fit say about the noise.
struct ResidualSpread {
  double factor = 0;            ///< covariance of the parameters = factor (J^T J)^-1, J of the plain residuals
  double noisePx = 0;           ///< standard deviation of one residual, robust
  double degreesOfFreedom = 0;  ///< of these estimates, fewer where neighbouring residuals go together
};

/// What the residuals of one view lie along: a contour, whose last is the first one's neighbour, or lines with ends.
enum class Neighbours { Closed, Open };

/// The factor by which correlation along the contour raises the variance of a sum: 1 + 2 sum rho_k. n points then tell as much as
/// n / inflation independent ones. The sum ends at the first lag whose correlation is no larger than white residuals show,
/// 2 / sqrt(n). The first lag below twice that, and all later ones, count in part, so that the result has no jumps.
/// @param values  in contour order within a view, one view after the other. @param views  of each value; same size.
double correlationInflation(const std::vector<double>& values, const std::vector<int>& views, Neighbours neighbours);

/// For a Huber loss of scale `robustScale` that was held: K^2 (sum psi^2 / (n - p)) / (mean psi')^2, times the inflation
/// 1 + 2 sum rho_k of residuals that are correlated along their contour (a detected contour, or a model that does not quite fit):
/// then n points tell less than n. On closed contours it does not matter where they start and which way they go.
/// @see Huber, Robust Regression: Asymptotics, Conjectures and Monte Carlo, 1973, eq. 6.11.
/// @param residuals  in contour order within a view, one view after the other. @param views  of each residual; same size.
ResidualSpread residualSpread(const std::vector<double>& residuals, const std::vector<int>& views, int parameters,
                              double robustScale, Neighbours neighbours = Neighbours::Closed);

/// Root of the mean square of one view's residuals without their tail: what is larger than twice the size below which two thirds
/// of them stay counts as just that. A few points with unbounded residuals then do not affect the others; if more than a
/// third are large, they are what is measured. Equal to the RMS where nothing sticks out (a sine), 5 % less for normal noise.
/// 0 of none; NaN where one is not finite.
double rmsWithoutTail(const std::vector<double>& residuals);

}  // namespace glint
