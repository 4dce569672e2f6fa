// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core, as json_dom.h.

#include "core/base/json_dom.h"
#include "core/base/json_text.h"
#include "core/pipeline/what_if.h"

namespace glint {

/// As sessions keep it (resources/session.schema.json, "what_if"). What is switched off with `synthesise` is not kept.
json_dom::Json toJson(const WhatIf& whatIf);
/// InputError with file, place and reason.
WhatIf readWhatIf(const JsonNode& node);

}  // namespace glint
