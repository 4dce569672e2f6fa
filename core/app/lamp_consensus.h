// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/app: one lamp in the fit, and what contradicts the rest of it.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/app/ball_observation.h"
#include "core/app/lamp_answer.h"
#include "core/app/lamp_problem.h"

namespace glint {

/// A lamp on its way through the fit.
struct LampInFit {
  std::string frame;
  LampUnknowns unknowns;
  std::vector<const LampObservation*> sources;  ///< of each peak
  std::vector<DroppedSighting> dropped;
  std::optional<Failure> failure;
};

/// The peak as evidence. @param ideal  the peak freed of the lens
WeightedPeak weightedPeak(const LampObservation& seen, const Pixel& ideal);

/// Start and least squares of one lamp, outlines as they are. The failure stays with the lamp.
void fitAlone(const LampProblem& problem, LampInFit& lamp);

/// The same lamp at infinity, to the least sum of squares. Nothing if that does not converge.
std::optional<LampUnknowns> distantFrom(const LampProblem& problem, const LampUnknowns& lamp);

/// What the redundant equations of one lamp leave: their sum of squares, over the noise promised, and their number.
struct Misfit {
  double chiSquared = 0;
  int degreesOfFreedom = 0;
  double rmsPx = 0;
};
Misfit misfitOf(const LampProblem& problem, const LampUnknowns& lamp);

/// Drops the peaks that contradict the others of their lamp, by more than both four standard deviations and a share of the ball's
/// radius. Where two peaks disagree, other bright places of their balls are tried; a lamp that stays in doubt gets a failure.
/// @param lamps  fitted. @param ideal  frees a pixel of the lens.
/// @return  whether anything changed
bool dropContradictions(const LampProblem& problem, std::vector<LampInFit>& lamps,
                        const std::function<Pixel(const Pixel&)>& ideal);

}  // namespace glint
