// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/stability/cases.h"

namespace glint::stability {

void addReflectanceCases(Cases& cases);  ///< reflectance: predictions and fits

}  // namespace glint::stability
