// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/settings.h"

namespace glint {

namespace {

std::vector<ParamSpec> filterParams() {
  return {
      {.key = "predict.filter_area",
       .title = "Filter by area",
       .symbol = "A_min",
       .defaultValue = false,
       .help = "Leave out predicted highlights that are smaller than detection takes (detect.min_area). Views draw them faintly; "
               "nothing "
               "compares them. Kept: area A >= A_min.",
       .stage = "predict"},
      {.key = "predict.filter_brightness",
       .title = "Filter by brightness",
       .symbol = "b_min",
       .defaultValue = 0.0,
       .max = 1.0,
       .step = 0.01,
       .help =
           "Leave out predicted highlights that are fainter than this share of the brightest one in the same frame; 0 keeps all. "
           "Models without a light keep all. Kept: I / I_brightest >= b_min, log I = log q (tan α / tan α_lim)².",
       .stage = "predict"},
      {.key = "predict.filter_shadow",
       .title = "Filter own shadow",
       .symbol = "P L",
       .defaultValue = false,
       .help = "Leave out predicted highlights whose middle the object itself hides from the lamp. Models without a light keep "
               "all. Kept: P + t (L - P) meets no surface for 0 < t < 1; a filtered one = a shadow.",
       .stage = "predict"}};
}

}  // namespace

std::vector<ParamSpec> withFilterParams(std::vector<ParamSpec> others) {
  const auto last =
      std::find_if(others.rbegin(), others.rend(), [](const ParamSpec& p) { return p.key.rfind("predict.", 0) == 0; });
  const std::vector<ParamSpec> filters = filterParams();
  others.insert(last.base(), filters.begin(), filters.end());
  return others;
}

}  // namespace glint
