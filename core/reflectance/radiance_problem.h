// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/reflectance/contour_evidence.h"
#include "core/reflectance/fit.h"
#include "core/reflectance/lamp.h"

/// The least squares problem behind fitRadiance; internal to core/reflectance.
namespace glint::lobe {

/// Share of the contours' radius: a wrong lobe leaves less, a wrong start leaves more.
inline constexpr double kPoorShare = 0.1;
/// A start or a long first round leads nowhere if it leaves this many times what a poor fit may leave. The best starts that led
/// to an explanation left at most 0.3 times that (wide lobes, grazing views, tubes); starts from mirrored images leave 8 to 30
/// times, in pictures 48 px wide 1.2 to 1.8 times.
inline constexpr double kHopeless = 1.5;

struct Attempt {
  State state;
  double cost = std::numeric_limits<double>::infinity();
  double noisePx = 0;  ///< of the residuals that neighbours on a contour do not share
  int iterations = 0;
  bool converged = false;
};

/// Contours of some views as residuals in pixels, of one lobe under one lamp.
class RadianceProblem {
 public:
  RadianceProblem(Lobe lobe, const std::vector<RadianceView>& views, ContourEvidence evidence, const RadianceFitOptions& options);

  /// Normalised from world coordinates and back.
  State start(const Lamp& lamp, const Roughness& roughness) const;
  Lamp inWorld(const State& state) const;

  /// The minimum that is reached from a state, with all unknowns of its shape free. A light at infinity stays there.
  Attempt solve(const State& start);

  /// Converged, with what remains below `share` of the radius, or the robust scale, once the noise is allowed for.
  bool explains(const Attempt& a, double share) const;
  /// What remains over what explains() would allow at most, whether it converged or not.
  double excess(const Attempt& a, double share) const;
  /// Nothing that neighbours on a contour share remains.
  bool leavesNoiseOnly(const Attempt& a) const;
  /// Whether the lobe is plausible: one that falls to half at 70 degrees and more makes no highlight.
  static bool tooWide(const State& state);

  /// The least squares step from a point lamp over L, log m and further columns: what `grown` changes against `plain`.
  struct ProbeColumn {
    State grown, plain;
  };
  struct Probe {
    double gain = 0;        ///< of the sum of squares, px^2, to first order
    Eigen::VectorXd extra;  ///< multiples of the further columns
  };
  Probe probe(State point, const std::vector<ProbeColumn>& columns);
  /// Rule, maxima, feet and weights of a state.
  void settle(const State& state);

  RadianceFit describe(const Attempt& a, std::size_t views);
  /// RMS residual of every view at a state, px, of contours that need not have been fitted. Not finite where a frame has no peak.
  std::vector<double> rmsOfViews(const State& state, std::size_t views);

  std::size_t lit() const;
  int points() const { return static_cast<int>(points_.size()); }

  // For the cost functions.
  const FramePeak& frame(int i) const { return frames_[static_cast<std::size_t>(i)]; }
  Lobe lobe() const { return lobe_; }
  const LampRule& rule() const { return rule_; }
  /// Finds every frame's maximum and log I there; `scan`: anywhere in the image, else uphill from the last one.
  void updatePeaks(const State& state, bool scan);

 private:
  void updateLogs(const State& state);
  double root(const Evidence& e, const Seen& s, const State& state) const;
  Eigen::Vector2d gradient(const Evidence& e, const Stencil& s, const State& state) const;
  double residual(const Evidence& e, const State& state) const;
  void chooseRule(const State& state);
  bool tooLarge(const State& state) const;
  bool judge(Attempt& a);
  Attempt solveFrom(const State& start);
  void relinearise(const State& state, bool moveFeet);
  void unbias(const State& state);
  void toFoot(Evidence& e, const State& state) const;
  double robust(double r) const;
  double robustCost(const State& state) const;
  double noiseOf(const State& state) const;
  void setUncertainty(State state, RadianceFit& fit) const;

  Lobe lobe_;
  LampRule rule_;
  double largestRatio_ = 0;  ///< of the lamp at any point, in lobe widths
  const std::vector<RadianceView>& views_;
  std::vector<Evidence> points_;
  std::vector<FramePeak> frames_;
  Eigen::Vector3d origin_;
  double scale_;
  double radiusPx_;  ///< of the contours' regions, mean
  RadianceFitOptions options_;
};

/// sqrt(u), continued by its tangent below a quarter of the level's: a start far off may put a contour point above the peak.
template <class T>
T rootOf(const T& u, double level) {
  using std::sqrt;
  const double knee = 0.25 * level * level;
  return u > T(knee) ? T(sqrt(u)) : T(std::sqrt(knee)) + (u - T(knee)) / T(2 * std::sqrt(knee));
}

}  // namespace glint::lobe
