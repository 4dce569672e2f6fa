// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/fall_profile.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr double kStep = 0.05;       // of rho: twenty across the inside of the contour
constexpr double kFadeFrom = 3.4;    // rho from which the profile is led to 0, so that it ends without an edge
constexpr double kCoreUntil = 1.3;   // rho up to which a clipped core is continued from: beyond, long tails are no Gaussian
constexpr double kLeastFall = 1e-3;  // of k in exp(-k rho^2): a highlight falls to about half at rho = 1, where k is 0.7

struct Block {
  double value, weight;
  std::size_t first, last;
};

/// Weighted least squares under the order value[0] >= value[1] >= ...
std::vector<double> fallingFit(const std::vector<double>& values, const std::vector<double>& weights) {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < values.size(); ++i) {
    blocks.push_back({values[i], weights[i], i, i});
    while (blocks.size() > 1 && blocks[blocks.size() - 2].value < blocks.back().value) {
      const Block b = blocks.back();
      blocks.pop_back();
      Block& a = blocks.back();
      a.value = (a.value * a.weight + b.value * b.weight) / (a.weight + b.weight);
      a.weight += b.weight;
      a.last = b.last;
    }
  }
  std::vector<double> fit(values.size());
  for (const Block& b : blocks) std::fill(fit.begin() + long(b.first), fit.begin() + long(b.last) + 1, b.value);
  return fit;
}

double middleOf(std::size_t step) { return (double(step) + 0.5) * kStep; }

/// log value = a - k rho^2 by weighted least squares over the steps given; nothing if it does not fall.
struct GaussianCore {
  double logPeak, k;
};
std::optional<GaussianCore> gaussianCore(const std::vector<double>& rho, const std::vector<double>& value,
                                         const std::vector<double>& weight) {
  double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < rho.size(); ++i) {
    if (!(value[i] > 0) || rho[i] > kCoreUntil) continue;
    const double x = rho[i] * rho[i], y = std::log(value[i]), w = weight[i];
    s += w, sx += w * x, sy += w * y, sxx += w * x * x, sxy += w * x * y;
  }
  const double determinant = s * sxx - sx * sx;
  if (!(determinant > 0)) return std::nullopt;
  const GaussianCore core{(sxx * sy - sx * sxy) / determinant, -(s * sxy - sx * sy) / determinant};
  return core.k > kLeastFall && std::isfinite(core.logPeak) ? std::optional(core) : std::nullopt;
}

}  // namespace

Outcome<FallProfile> FallProfile::learn(const std::vector<Sample>& samples) {
  constexpr std::size_t kSteps = std::size_t(kEnd / kStep + 0.5);
  std::vector<std::vector<double>> inStep(kSteps);
  int used = 0, inside = 0;
  for (const Sample& s : samples) {
    if (!(s.rho >= 0) || !(s.rho < kEnd) || !std::isfinite(s.value)) continue;
    inStep[std::size_t(s.rho / kStep)].push_back(s.value);
    ++used;
    inside += s.rho <= 1;
  }
  if (used < kLeastSamples || inside == 0)
    return Failure{Reason::TooFewPoints, "the training frames show too few unclipped pixels of the highlight"};
  std::vector<double> rho, value, weight;
  for (std::size_t i = 0; i < kSteps; ++i) {
    if (inStep[i].empty()) continue;
    rho.push_back(middleOf(i));
    value.push_back(upperMedian(inStep[i]));
    weight.push_back(double(inStep[i].size()));
  }
  const std::vector<double> fall = fallingFit(value, weight);
  if (!(fall.front() > 0) || !(fall.back() < fall.front()))
    return Failure{Reason::NoHighlight, "the pixels of the training frames do not fall from the highlight's middle outwards"};

  FallProfile profile;
  const bool coreIsSeen = rho.front() < 2 * kStep;  // the innermost steps of a small highlight may hold no pixel's centre
  std::optional<GaussianCore> core;
  if (!coreIsSeen) {
    core = gaussianCore(rho, fall, weight);
    if (!core) return Failure{Reason::NoHighlight, "the core is clipped in the training frames, and around it nothing falls"};
    profile.observedFrom_ = rho.front() - kStep / 2;
  }
  profile.share_.resize(kSteps);
  std::size_t k = 0;
  for (std::size_t i = 0; i < kSteps; ++i) {
    const double at = middleOf(i);
    while (k + 1 < rho.size() && rho[k + 1] <= at) ++k;
    double v = fall[k];
    if (at < rho.front())
      v = core ? std::max(fall.front(), std::exp(core->logPeak - core->k * at * at)) : fall.front();
    else if (k + 1 < rho.size())
      v += (fall[k + 1] - fall[k]) * (at - rho[k]) / (rho[k + 1] - rho[k]);
    profile.share_[i] = std::max(0.0, v);
  }
  profile.peakOverContour_ = profile.share_.front();
  for (std::size_t i = 0; i < kSteps; ++i) profile.share_[i] /= profile.peakOverContour_;
  profile.beforeEnd_ = profile.share_[std::size_t(kFadeFrom / kStep)];
  for (std::size_t i = 0; i < kSteps; ++i) profile.share_[i] *= std::clamp((kEnd - middleOf(i)) / (kEnd - kFadeFrom), 0.0, 1.0);
  return profile;
}

double FallProfile::at(double rho) const {
  require(rho >= 0, "FallProfile::at: rho >= 0");
  if (rho >= kEnd) return 0;
  const double place = rho / kStep - 0.5;
  if (place <= 0) return share_.front();
  const std::size_t i = std::size_t(place);
  if (i + 1 >= share_.size()) return share_.back() * (kEnd - rho) / (kStep / 2);
  return share_[i] + (place - double(i)) * (share_[i + 1] - share_[i]);
}

}  // namespace glint
