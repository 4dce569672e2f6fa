// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace glint {

/// What a setting costs; smaller is better in both.
struct Cost {
  double errorPct = 0, us = 0;
};

/// `a` is at least as good in both and better in one.
bool dominates(const Cost& a, const Cost& b);
/// Even with `a`'s error and time multiplied by the slacks (>= 1) it dominates: the difference is beyond what noise explains.
bool clearlyDominates(const Cost& a, const Cost& b, double errorSlack, double timeSlack);
/// True for the costs that no other dominates; equal ones all stay. A cost that is not finite is never on the front.
std::vector<char> paretoFront(const std::vector<Cost>& costs);

/// Indices of the presets among `costs`; all of them lie on the front.
struct Presets {
  int fast = -1, balanced = -1, exact = -1;  ///< -1 if no cost is finite
};
/// Above this error a predicted contour is a wrong contour: a tenth of the highlight's diameter, an overlap of about 0.7.
inline constexpr double kUsableErrorPct = 10;
/// Errors nearer than this are the same: contours resolve ten times more, and the ways to the same contour differ by less.
inline constexpr double kSameErrorPct = 0.005;
/// Logarithms begin here: an exact scene has no error, and less than this (% of the diameter) is round-off.
inline constexpr double kSmallestErrorPct = 1e-6;
/// A nanosecond (us): less cannot be measured.
inline constexpr double kSmallestUs = 1e-3;
/// exact: the smallest error, and of those that are the same the fastest. fast: the smallest time among points under
/// kUsableErrorPct (of all when none is). balanced: the point of the front nearest to (the time of fast, the error of exact) with
/// both axes logarithmic and scaled by the distance between the two, so that it does not depend on units.
Presets presetsOf(const std::vector<Cost>& costs);

}  // namespace glint
