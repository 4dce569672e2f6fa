// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/advise/lobe_samples.h"
#include "core/geometry/polyline.h"
#include "core/reflectance/lobe.h"

namespace glint {

/// The pixels of one highlight under one lobe: I = height S(m) + offset, S the lobe's radiance from a point light at each pixel's
/// own directions and distance. The offset is what the fit of the background took of the lobe's tail.
struct LobeMatch {
  Lobe lobe = Lobe::TorranceSparrow;
  double m = 0;                         ///< roughness
  double rmsPct = 0;                    ///< of the residuals, in % of the best lobe's peak; clipped pixels are not among them
  double offsetPct = 0;                 ///< in % of that peak
  double logUnit = 0;                   ///< the radiance S, whose logarithm this is, is the best lobe's peak
  bool asGood = false;                  ///< the pixels do not tell it from the best one, as far as their noise is independent
  std::vector<double> profile;          ///< at the bins of `measured`: means over the same pixels, share of the best lobe's peak
  std::optional<Failure> failure = {};  ///< NotConverged if the pixels do not tell its width, or do not fall as it does
};

struct LobeComparison {
  struct Bin {
    double alpha = 0;   ///< rad, mean of its pixels
    double mean = 0;    ///< share of the best lobe's peak
    double spread = 0;  ///< standard deviation
    int pixels = 0;
  };
  std::vector<Bin> measured;       ///< by alpha, at equal steps
  std::vector<LobeMatch> matches;  ///< every lobe that there is, in its usual order
  int best = -1;                   ///< index of the match with the least residual
  int pixels = 0;                  ///< that were fitted, at most about kMostLobePixels
  int clipped = 0;                 ///< left out
};

inline constexpr int kMostLobePixels =
    900;  ///< evenly thinned: a fit takes a hundred passes over them, and three numbers need no more

/// Fits every lobe to the pixels around one highlight, all weighted equally.
/// @return  TooFewPoints below 24 pixels; NotConverged if no lobe fits.
Outcome<LobeComparison> compareLobes(const LobeSamples& samples);

/// Where the radiance of a match is a fraction `level` of the best lobe's peak: the curve of `profile` against the same level, in
/// the photograph. In pieces, where the grid of the samples ends or the surface does.
/// @return  stored px; empty if the match failed or does not reach the level.
std::vector<Polyline> lobeContours(const LobeGrid& grid, const LobeMatch& match, double level);

}  // namespace glint
