// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace glint {

/// Sizes that no one needs. An input beyond one of them is refused before memory is spent on it; `--limit NAME=VALUE` raises it.
enum class Limit {
  JsonMegabytes,
  JsonValues,
  MeshMegabytes,
  ImageMegabytes,
  ImageMegapixels,
  SynthFrames,
  JsonMemory,
  ImageMemory
};

/// All limits, in the order of `Limit`: name, value at the start, and what it counts, for people.
struct LimitInfo {
  std::string name;
  double standard;
  std::string counts;
};
const std::vector<LimitInfo>& limitInfos();

/// The limit in its own unit; that of images' memory is half of this machine's memory where that is less and nobody set it. Safe
/// from every thread.
double limitOf(Limit limit);

/// Sets one from "NAME=VALUE", for the whole process. InputError (place `--limit ...`) for an unknown name, or a value that is
/// not a number above 0.
void setLimit(const std::string& nameAndValue);

/// InputError (file, place) if `amount` is above the limit; the line names the option that raises it.
void requireWithin(Limit limit, double amount, const std::string& file, const std::string& place = "");

}  // namespace glint
