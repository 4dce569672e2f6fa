// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/tradeoff/tradeoff.h"

namespace glint {

/// A page that needs no other file: the front as SVG, the points, what was pruned and why.
std::string tradeoffHtml(const Tradeoff& tradeoff);

}  // namespace glint
