// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "core/model/model.h"

namespace glint {

/// Colour of a model (ModelTraits::rgb); grey for an unknown one.
inline std::array<int, 3> modelRgb(const std::string& model) {
  const HighlightModel* const found = findModel(model);
  return found ? found->traits().rgb : std::array<int, 3>{153, 153, 153};
}

}  // namespace glint
