// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/pipeline/texture_panel.h"

namespace glint {

/// What several views show of one surface point beside their highlights.
using PointSamples = std::vector<TexturePanel::Sample>;

/// Points whose mean is bright enough for ratios, as at least three views show them; empty where they are too few.
std::vector<PointSamples> brightSightings(const TexturePanel& panel);

/// Shares of terms in what views show of the same points: v_ij = g_i D_j (1 + sum_k c_k f_ijk) + tails of the spots, with a gain
/// for each view, the point's own D_j eliminated.
struct SightingFit {
  Eigen::VectorXd terms, sigma;
  double left = 0;  ///< robust sum of squares of what remains, each value as a share of its point's mean
  std::size_t samples = 0;
};
/// Values of the terms at one sample, as shares of its point's mean. @param mean  of the point's samples
using SightingTerms = std::function<std::vector<double>(const TexturePanel::Sample& sample, double mean)>;

/// Robust least squares. @param points  brightSightings(), not empty. @param views  how many the panel has
SightingFit fittedSightings(const std::vector<PointSamples>& points, std::size_t views, const SightingTerms& terms);

}  // namespace glint
