// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "core/base/number_text.h"
#include "core/base/settings.h"
#include "core/model/model.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/fit.h"

namespace glint {

inline constexpr double kWidestStart = 1.3;  ///< rad, of the first guess of a lobe's width

/// The lobes that `fit.lobe` admits.
inline std::vector<Lobe> lobesOf(const Settings& settings) {
  const std::string& name = settings.text("fit.lobe");
  if (name != "auto") return {*lobeOf(name)};
  return allLobes();
}

/// The shapes of a lamp, beside a point, that `fit.light_size` admits.
inline LampChoices lampChoicesOf(const Settings& settings) { return lampChoices(settings.text("fit.light_size")); }

/// The levels of `fit.levels`: numbers between commas.
inline std::vector<double> listedLevels(const Settings& settings) {
  std::vector<double> levels;
  std::istringstream list(settings.text("fit.levels"));
  for (std::string entry; std::getline(list, entry, ',');) {
    entry.erase(0, entry.find_first_not_of(' '));
    levels.push_back(numberFrom(entry).value_or(0));
  }
  return levels;
}

inline RadianceFitOptions radianceFitOptionsOf(const Settings& settings) {
  RadianceFitOptions options;
  options.pointsPerView = settings.integer("light.bundle_points");
  options.robustPx = settings.number("light.robust_px");
  return options;
}

}  // namespace glint
