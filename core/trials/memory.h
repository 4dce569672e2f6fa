// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// Starts a new measurement of the process's peak resident memory: gives freed memory back to the system and resets the
/// kernel's high-water mark. False if the system does not allow that; then the peak counts from the program's start.
bool restartPeakMemory();
/// Peak resident memory since then, 2^20 bytes; NaN where the system does not tell.
double peakMemoryMb();

}  // namespace glint
