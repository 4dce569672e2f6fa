// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace glint::testing_support {

/// Largest single allocation by operator new since it was set to 0.
extern std::size_t largestAllocation;

}  // namespace glint::testing_support
