// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core, as json_dom.h.

#include "core/base/json_dom.h"
#include "core/choice/tradeoff.h"

namespace glint {

/// docs/formats.md, "tradeoff --json", as a document; tradeoffJson() is its text.
json_dom::Json toJson(const Tradeoff& tradeoff);

}  // namespace glint
