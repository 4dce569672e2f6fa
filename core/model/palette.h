// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

#include "core/base/number_text.h"
#include "core/model/model.h"

namespace glint {

/// Colour of a model (ModelTraits::rgb); grey for an unknown one.
inline std::array<int, 3> modelRgb(const std::string& model) {
  const HighlightModel* const found = findModel(model);
  return found ? found->traits().rgb : std::array<int, 3>{153, 153, 153};
}

/// The same as HTML writes it, "#d55e00".
inline std::string modelHex(const std::string& model) {
  const std::array<int, 3> c = modelRgb(model);
  return formatted("#%02x%02x%02x", c[0], c[1], c[2]);
}

}  // namespace glint
