// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>

namespace glint {

/// Colours of the models, the same in every view and report, 8-bit sRGB; colour-blind safe (Okabe and Ito, 2008).
inline std::array<int, 3> modelRgb(const std::string& model) {
  if (model == "primal") return {230, 159, 0};
  if (model == "dual") return {86, 180, 233};
  if (model == "canonical") return {0, 158, 115};
  if (model == "limit-angle") return {213, 94, 0};
  if (model == "reflectance") return {204, 121, 167};
  return {153, 153, 153};
}

}  // namespace glint
