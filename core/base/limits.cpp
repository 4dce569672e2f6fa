// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/limits.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr std::size_t kCount = 8;

/// What `setLimit` set; 0 = the standard.
std::array<std::atomic<double>, kCount> given{};

/// MB; of the machine, without what a container allows.
double halfOfMemory() {
  constexpr double kMegabyte = 1e6;
  static const double half = 0.5 * double(::sysconf(_SC_PHYS_PAGES)) * double(::sysconf(_SC_PAGESIZE)) / kMegabyte;
  return half > 0 ? half : std::numeric_limits<double>::infinity();
}

/// Whole numbers as such, others with few digits, and never rounded down to the limit itself.
std::string shown(double v) { return formatted(v == std::floor(v) ? "%.0f" : "%.4g", v); }

}  // namespace

const std::vector<LimitInfo>& limitInfos() {
  // A scene of 10,000 frames with two contours of 200 points each has 200 MB of text and 10 million values.
  static const std::vector<LimitInfo> infos = {{"json.megabytes", 512, "MB of JSON text"},
                                               {"json.values", 2e7, "values in a JSON text"},
                                               {"mesh.megabytes", 4096, "MB of mesh data"},
                                               {"image.megabytes", 1024, "MB of image data"},
                                               {"image.megapixels", 200, "million pixels"},
                                               {"synth.frames", 10000, "frames"},
                                               {"json.memory_megabytes", 1000, "MB of values when it is read"},
                                               {"image.memory_megabytes", 16000, "MB of pixels while a frame is worked on"}};
  return infos;
}

double limitOf(Limit limit) {
  const auto i = static_cast<std::size_t>(limit);
  const double set = given[i];
  if (set > 0) return set;
  const double standard = limitInfos()[i].standard;
  return limit == Limit::ImageMemory ? std::min(standard, halfOfMemory()) : standard;
}

void setLimit(const std::string& nameAndValue) {
  const std::size_t equals = nameAndValue.find('=');
  const std::string name = nameAndValue.substr(0, equals);
  const std::string text = equals == std::string::npos ? "" : nameAndValue.substr(equals + 1);
  std::string known;
  for (std::size_t i = 0; i < kCount; ++i) {
    known += (known.empty() ? "" : ", ") + limitInfos()[i].name;
    if (limitInfos()[i].name != name) continue;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) || !(value > 0))
      throw InputError("", "--limit " + nameAndValue, "expected a positive number after '='");
    given[i] = value;
    return;
  }
  throw InputError("", "--limit " + nameAndValue, "unknown limit '" + name + "'; known: " + known);
}

void requireWithin(Limit limit, double amount, const std::string& file, const std::string& place) {
  const double most = limitOf(limit);
  if (!(amount > most)) return;
  const LimitInfo& info = limitInfos()[static_cast<std::size_t>(limit)];
  throw InputError(file, place,
                   "contains " + shown(amount) + " " + info.counts + "; the limit is " + shown(most) + " (--limit " + info.name +
                       "=" + shown(std::ceil(amount)) + " raises it)");
}

}  // namespace glint
