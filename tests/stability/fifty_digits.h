// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/stability: fifty decimal digits for reference values.

#include <boost/multiprecision/cpp_bin_float.hpp>

namespace glint {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

}  // namespace glint
