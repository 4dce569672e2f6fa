// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/report/share_parts.h"

namespace glint::share {
namespace {

using json_dom::Json;

std::string dumped(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Without zeros at the end, which say nothing.
std::string shortest(double value, int decimals) {
  std::string text = formatted("%.*f", decimals, value);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

void removeTimes(Json& value) {
  if (value.is_object()) {
    for (const char* key : {"time_us", "predict_us", "exact_predict_us"}) value.erase(key);
    for (auto& member : value.items()) removeTimes(member.value());
  } else if (value.is_array()) {
    for (Json& element : value) removeTimes(element);
  }
}

}  // namespace

std::string quoted(const std::string& text) { return dumped(Json(text)); }
std::string exactly(double value) { return dumped(json_dom::numberOrNull(value)); }

Rounding::Rounding(double size) {
  constexpr double kParts = 1e6;  // finer than a pixel of any screen
  const double step = std::isfinite(size) && size > 0 ? size / kParts : 1 / kParts;
  decimals_ = std::clamp(static_cast<int>(std::ceil(-std::log10(step))), 0, 15);
}

std::string Rounding::world(double length) const { return std::isfinite(length) ? shortest(length, decimals_) : "null"; }

std::string Rounding::world(const Eigen::Vector3d& p) const {
  return p.allFinite() ? "[" + world(p.x()) + "," + world(p.y()) + "," + world(p.z()) + "]" : "null";
}

std::string Rounding::world(const std::vector<Eigen::Vector3d>& chain) const {
  std::string text;
  for (const Eigen::Vector3d& p : chain)
    if (p.allFinite()) text += (text.empty() ? "" : ",") + world(p.x()) + "," + world(p.y()) + "," + world(p.z());
  return "[" + text + "]";
}

std::string Rounding::pixels(const std::vector<Pixel>& line) {
  std::string text;
  for (const Pixel& p : line)
    if (p.allFinite()) text += (text.empty() ? "" : ",") + shortest(p.x(), 2) + "," + shortest(p.y(), 2);
  return "[" + text + "]";
}

std::string untimed(const std::string& evaluation) {
  Json json = Json::parse(evaluation);
  removeTimes(json);
  return dumped(json);
}

}  // namespace glint::share
