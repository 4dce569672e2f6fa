// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/exif.h"

#include <cstdint>

namespace glint {
namespace {

/// Numbers of a TIFF structure, which states its byte order; offsets count from its start.
class TiffNumbers {
 public:
  TiffNumbers(std::string_view bytes, bool bigEndian) : bytes_(bytes), big_(bigEndian) {}
  std::optional<std::uint32_t> number(std::uint64_t at, unsigned size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    std::uint32_t v = 0;
    for (unsigned i = 0; i < size; ++i)
      v = v << 8 | static_cast<unsigned char>(bytes_[static_cast<std::size_t>(at) + (big_ ? i : size - 1 - i)]);
    return v;
  }
  /// The value of an entry of one number in a directory; nothing where there is no such tag of this type.
  std::optional<std::uint32_t> valueOf(std::uint32_t directory, std::uint32_t tag, std::uint32_t type) const {
    constexpr unsigned kEntry = 12;  // bytes: tag, type, count, value
    constexpr std::uint32_t kShort = 3;
    const std::optional<std::uint32_t> count = number(directory, 2);
    for (std::uint32_t i = 0; count && i < *count; ++i) {
      const std::uint64_t at = std::uint64_t(directory) + 2 + std::uint64_t(kEntry) * i;
      const auto found = number(at, 2);
      if (!found) return std::nullopt;
      if (*found == tag && number(at + 2, 2) == type && number(at + 4, 4) == 1u) return number(at + 8, type == kShort ? 2 : 4);
    }
    return std::nullopt;
  }

 private:
  std::string_view bytes_;
  bool big_;
};

std::optional<double> focalIn(std::string_view tiff) {
  constexpr std::uint32_t kExifDirectory = 0x8769, kFocal35 = 0xA405, kShort = 3, kLong = 4;
  const bool big = tiff.substr(0, 2) == "MM";
  if (!big && tiff.substr(0, 2) != "II") return std::nullopt;
  const TiffNumbers in(tiff, big);
  constexpr std::uint32_t kMagic = 42;
  const std::optional<std::uint32_t> first = in.number(4, 4);
  if (in.number(2, 2) != kMagic || !first) return std::nullopt;
  const std::optional<std::uint32_t> exif = in.valueOf(*first, kExifDirectory, kLong);
  const std::optional<std::uint32_t> focal = exif ? in.valueOf(*exif, kFocal35, kShort) : std::nullopt;
  return focal && *focal > 0 ? std::optional<double>(*focal) : std::nullopt;
}

}  // namespace

std::optional<double> focalLength35mm(std::string_view file) {
  const TiffNumbers in(file, true);  // a JPEG's own numbers are big-endian
  constexpr std::uint32_t kStart = 0xFFD8, kApp1 = 0xFFE1, kScan = 0xFFDA, kAnyMarker = 0xFF00;
  constexpr std::string_view kExif("Exif\0\0", 6);
  if (in.number(0, 2) != kStart) return std::nullopt;
  for (std::uint64_t at = 2;;) {
    const std::optional<std::uint32_t> marker = in.number(at, 2), length = in.number(at + 2, 2);
    if (!marker || !length || *marker < kAnyMarker || *marker == kScan || *length < 2) return std::nullopt;
    const std::string_view content = file.substr(static_cast<std::size_t>(at) + 4, *length - 2);
    if (*marker == kApp1 && content.substr(0, kExif.size()) == kExif) return focalIn(content.substr(kExif.size()));
    at += 2 + *length;
  }
}

}  // namespace glint
