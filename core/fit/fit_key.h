// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <optional>
#include <string>

namespace glint {

/// Whose estimate, fit or correction it is: that of a light, on one surface alone where every surface has its own models
/// (TrainSpec::perSurface).
struct FitKey {
  std::string light;                        ///< id
  std::optional<std::string> surface = {};  ///< SurfaceCache::keyOf(); none: of all surfaces together
  friend auto operator<=>(const FitKey&, const FitKey&) = default;
};

/// "lamp", or "lamp@g03": for people, and in the names of key results.
inline std::string textOf(const FitKey& key) { return key.surface ? key.light + "@" + *key.surface : key.light; }

}  // namespace glint
