// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint::viz {

/// Text size in screen pixels for a window of this height.
int fontSizeFor(int windowHeight);
/// Largest of 1, 2, 5 times a power of ten that is not above `limit` (> 0).
double roundLength(double limit);
/// "0.5 m", "20 cm", "3 km".
std::string lengthText(double metres);

}  // namespace glint::viz
