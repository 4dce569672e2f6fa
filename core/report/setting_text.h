// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/settings.h"

namespace glint {

/// A setting's value as people read it, without its unit: "0.5", "refined", "on".
std::string settingText(const SettingValue& value);

}  // namespace glint
