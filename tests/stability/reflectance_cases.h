// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tests/stability/cases.h"

namespace glint::stability {

void addReflectanceCases(Cases& cases);  ///< reflectance: predictions and fits
void addLobeCases(Cases& cases);         ///< contours of all lobes, widths and levels

}  // namespace glint::stability
