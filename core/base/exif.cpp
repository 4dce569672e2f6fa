// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>

#include "core/base/bytes.h"
#include "core/base/image_header.h"

namespace glint {
namespace {

/// The value of an entry of one number in a directory of a TIFF structure, whose offsets count from its start; nothing where
/// there is no such tag of this type.
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

/// The TIFF structure that EXIF data are, or nothing if they begin as none.
struct Tiff {
  NumbersInBytes in;
  std::uint64_t first;  ///< byte of the first directory
};

std::optional<Tiff> tiffIn(std::string_view exif) {
  const bool big = exif.substr(0, 2) == "MM";
  if (!big && exif.substr(0, 2) != "II") return std::nullopt;
  const NumbersInBytes in(exif, big);
  constexpr std::uint64_t kMagic = 42;
  const std::optional<std::uint64_t> first = in.number(4, 4);
  if (in.number(2, 2) != kMagic || !first) return std::nullopt;
  return Tiff{in, *first};
}

constexpr std::string_view kExif("Exif\0\0", 6);

std::string_view withoutMark(std::string_view exif) { return exif.starts_with(kExif) ? exif.substr(kExif.size()) : exif; }

std::string_view exifOfJpeg(std::string_view file) {
  const NumbersInBytes in(file, true);  // a JPEG's own numbers are big-endian
  constexpr std::uint64_t kApp1 = 0xFFE1, kScan = 0xFFDA, kAnyMarker = 0xFF00;
  for (std::uint64_t at = 2;;) {
    const std::optional<std::uint64_t> marker = in.number(at, 2), length = in.number(at + 2, 2);
    if (!marker || !length || *marker < kAnyMarker || *marker == kScan || *length < 2) return {};
    const std::string_view content =
        file.substr(std::min<std::size_t>(static_cast<std::size_t>(at) + 4, file.size()), *length - 2);
    if (*marker == kApp1 && content.starts_with(kExif)) return withoutMark(content);
    at += 2 + *length;
  }
}

/// The content of the first chunk of a name. PNG writes length, name, content and a checksum; RIFF writes name and length, and
/// fills up to an even length.
std::string_view chunkOf(std::string_view file, std::string_view name, bool png) {
  const NumbersInBytes in(file, png);
  constexpr std::uint64_t kHead = 8;
  for (std::uint64_t at = png ? 8 : 12;;) {
    const std::optional<std::uint64_t> length = in.number(png ? at : at + 4, 4);
    if (!length || at + kHead > file.size()) return {};
    if (file.substr(static_cast<std::size_t>(png ? at + 4 : at), 4) == name)
      return withoutMark(file.substr(static_cast<std::size_t>(at + kHead), static_cast<std::size_t>(*length)));
    at += kHead + *length + (png ? 4 : *length % 2);
  }
}

/// The EXIF data of a file, or nothing.
std::string_view exifOf(std::string_view file) {
  if (file.starts_with("\xFF\xD8")) return exifOfJpeg(file);
  if (file.starts_with("\x89PNG\r\n\x1a\n")) return chunkOf(file, "eXIf", true);
  if (file.starts_with("RIFF")) return chunkOf(file, "EXIF", false);
  return file;  // a TIFF holds the same directories itself
}

}  // namespace

std::optional<double> focalLength35mm(std::string_view file) {
  constexpr std::uint64_t kExifDirectory = 0x8769, kFocal35 = 0xA405, kShort = 3, kLong = 4;
  const std::optional<Tiff> tiff = tiffIn(exifOf(file));
  const std::optional<std::uint64_t> exif = tiff ? valueOf(tiff->in, tiff->first, kExifDirectory, kLong) : std::nullopt;
  const std::optional<std::uint64_t> focal = exif ? valueOf(tiff->in, *exif, kFocal35, kShort) : std::nullopt;
  return focal && *focal > 0 ? std::optional<double>(*focal) : std::nullopt;
}

int exifOrientation(std::string_view file) {
  constexpr std::uint64_t kOrientation = 0x0112, kShort = 3, kMost = 8;
  const std::optional<Tiff> tiff = tiffIn(exifOf(file));
  const std::optional<std::uint64_t> found = tiff ? valueOf(tiff->in, tiff->first, kOrientation, kShort) : std::nullopt;
  return found && *found >= 1 && *found <= kMost ? static_cast<int>(*found) : 1;
}

}  // namespace glint
