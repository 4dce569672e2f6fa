// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Tolerances of the tests, each with its reason. A test names one of these or says beside it why it needs another.
namespace glint::tolerance {
inline constexpr double kExact = 1e-12;              ///< a handful of double operations on numbers of order 1
inline constexpr double kSolve = 1e-8;               ///< one SVD or least-squares solve of a well-conditioned system
inline constexpr double kPixel = 1e-6;               ///< a pixel coordinate of order 1e3 after a chain of solves
inline constexpr double kReferencePeakPx = 1e-5;     ///< stated accuracy of peaks in shared/reference
inline constexpr double kReferenceContourPx = 1e-6;  ///< stated accuracy of contours in shared/reference
}  // namespace glint::tolerance
