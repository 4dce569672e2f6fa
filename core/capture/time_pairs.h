// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/capture: which moments of two lists belong together.

#include <cstddef>
#include <vector>

namespace glint::capture {

inline constexpr double kApart = 0.02 + 5e-7;  // s: TUM's own limit of 20 ms, to half of the last digit (1 us) of its times

/// Seconds of a time as programs write it. One beyond the year 5138 in seconds is in milliseconds, microseconds or nanoseconds
/// (ROS, EuRoC): in each of these units the years from 1973 on have numbers of their own.
double secondsOf(double time);

/// The index that means "no partner".
inline constexpr std::size_t kNoPair = static_cast<std::size_t>(-1);

/// For each time (s) the index of the one among `others` that belongs to it, else kNoPair: again and again the two closest that
/// are left become a pair, as long as they are at most kApart apart, as TUM's associate.py does with the table of all pairs.
///
/// On the line of time the two closest of different kind are neighbours (one between them would be closer to one of them),
/// so only neighbours matter. The whole table would be quadratic if a file repeats a time.
std::vector<std::size_t> timePairs(const std::vector<double>& times, const std::vector<double>& others);

}  // namespace glint::capture
