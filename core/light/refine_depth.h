// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/light/estimate.h"

namespace glint {

/// Smooth systematic error of a depth camera: the true depth at an ideal pixel is the stored one times 1 + sum of c_k x^i y^j
/// over i + j <= 4, where (x, y) is the pixel from the image's centre in units of half its diagonal. One correction holds for all
/// frames.
struct DepthCorrection {
  static constexpr int kOrder = 4, kTerms = 15;
  using Terms = Eigen::Matrix<double, kTerms, 1>;
  Terms coefficients = Terms::Zero();
  double factorAt(const Camera& camera, const Pixel& ideal) const;
  bool changesAnything() const { return coefficients.any(); }
};

struct DepthRefinement {
  Light light;            ///< with the corrected depth
  double limitAngle = 0;  ///< rad
  double rmsPx = 0;       ///< of the residuals
  DepthCorrection correction;
  /// Standard deviation of each coefficient over that of its prior, in (0, 1]: 1 where the contours say nothing or the term is
  /// not used.
  DepthCorrection::Terms openShare = DepthCorrection::Terms::Ones();
  /// The same as Bundle::uncertainty, with the depth's own uncertainty in it. Empty where nothing was refined.
  std::optional<ParameterUncertainty> uncertainty;
};

/// Light, limit angle and a smooth correction of the depth together. Every view's surface is the depth map of its own camera, so
/// that a corrected depth moves the point along the view ray and turns the normal in closed form. Minimises the robust sum of
/// squared contour distances in pixels plus a Gaussian prior: coefficients of degree n have the standard deviation sigma / max(1,
/// n), a depth error of about `sigma` (relative) near the image's border. Where the residuals of the plain bundle are white, or
/// below 0.02 px, nothing speaks against the depth and it stays as it is. Terms up to the second or the fourth degree are used
/// only where they predict left-out views better by more than the standard error of the gain. A depth that is tilted alike in all
/// views is nearly the same as a light that is moved where the cameras look in one direction: openShare tells. The bundle's own
/// failures; std::invalid_argument unless sigma > 0.
Outcome<DepthRefinement> refineDepth(const std::vector<BundleView>& views, const Light& start, double sigma,
                                     const BundleOptions& options = {});

}  // namespace glint
