// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core, as json_dom.h.

#include "core/base/json_dom.h"
#include "core/base/json_text.h"
#include "core/base/settings.h"

namespace glint {

json_dom::Json toJson(const SettingValue& value);
/// All settings, defaults too: a later program may have other defaults.
json_dom::Json toJson(const Settings& settings);
/// Reads those that the object names. InputError (place) for an unknown one, another type, or a value outside of its range.
Settings readSettings(const JsonNode& node);

}  // namespace glint
