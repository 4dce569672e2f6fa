// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/exif.h"

#include <cstdint>

#include "core/base/numbers_in_bytes.h"

namespace glint {
namespace {

/// The value of an entry of one number in a directory of a TIFF structure, whose offsets count from its start; nothing where there is no such
/// tag of this type.
std::optional<std::uint64_t> valueOf(const NumbersInBytes& in, std::uint64_t directory, std::uint64_t tag, std::uint64_t type) {
  constexpr unsigned kEntry = 12;  // bytes: tag, type, count, value
  constexpr std::uint64_t kShort = 3;
  const std::optional<std::uint64_t> count = in.number(directory, 2);
  for (std::uint64_t i = 0; count && i < *count; ++i) {
    const std::uint64_t at = directory + 2 + kEntry * i;
    const auto found = in.number(at, 2);
    if (!found) return std::nullopt;
    if (*found == tag && in.number(at + 2, 2) == type && in.number(at + 4, 4) == 1u)
      return in.number(at + 8, type == kShort ? 2 : 4);
  }
  return std::nullopt;
}

std::optional<double> focalIn(std::string_view tiff) {
  constexpr std::uint64_t kExifDirectory = 0x8769, kFocal35 = 0xA405, kShort = 3, kLong = 4;
  const bool big = tiff.substr(0, 2) == "MM";
  if (!big && tiff.substr(0, 2) != "II") return std::nullopt;
  const NumbersInBytes in(tiff, big);
  constexpr std::uint64_t kMagic = 42;
  const std::optional<std::uint64_t> first = in.number(4, 4);
  if (in.number(2, 2) != kMagic || !first) return std::nullopt;
  const std::optional<std::uint64_t> exif = valueOf(in, *first, kExifDirectory, kLong);
  const std::optional<std::uint64_t> focal = exif ? valueOf(in, *exif, kFocal35, kShort) : std::nullopt;
  return focal && *focal > 0 ? std::optional<double>(*focal) : std::nullopt;
}

}  // namespace

std::optional<double> focalLength35mm(std::string_view file) {
  const NumbersInBytes in(file, true);  // a JPEG's own numbers are big-endian
  constexpr std::uint64_t kStart = 0xFFD8, kApp1 = 0xFFE1, kScan = 0xFFDA, kAnyMarker = 0xFF00;
  constexpr std::string_view kExif("Exif\0\0", 6);
  if (in.number(0, 2) != kStart) return std::nullopt;
  for (std::uint64_t at = 2;;) {
    const std::optional<std::uint64_t> marker = in.number(at, 2), length = in.number(at + 2, 2);
    if (!marker || !length || *marker < kAnyMarker || *marker == kScan || *length < 2) return std::nullopt;
    const std::string_view content = file.substr(static_cast<std::size_t>(at) + 4, *length - 2);
    if (*marker == kApp1 && content.substr(0, kExif.size()) == kExif) return focalIn(content.substr(kExif.size()));
    at += 2 + *length;
  }
}

}  // namespace glint
