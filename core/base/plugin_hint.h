// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// How a refusal of an unknown model, lobe, surface, reader or layer ends: it may be one that a plugin adds, and neither sessions
/// nor scenes say which plugins they were made with.
inline constexpr const char* kPluginHint = "; if a plugin adds it, give --plugin FILE";

}  // namespace glint
