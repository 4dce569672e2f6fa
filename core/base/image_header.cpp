// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/image_header.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <optional>

#include "core/base/bytes.h"

namespace glint {
namespace {

bool startsWith(std::string_view bytes, std::string_view start) { return bytes.substr(0, start.size()) == start; }

ImageHeader failed(ImageHeader header, const std::string& problem) {
  header.width = header.height = 0;
  header.problem = problem;
  return header;
}

ImageHeader truncated(const ImageHeader& header) {
  return failed(header, std::string("the ") + nameOf(header.format) + " is truncated");
}

ImageHeader damaged(const ImageHeader& header, const std::string& what) {
  return failed(header, std::string("the ") + nameOf(header.format) + " is damaged: " + what);
}

/// @see PNG specification, third edition, 5: chunks of length, type, data and checksum, from IHDR to IEND.
ImageHeader pngHeader(std::string_view bytes, ImageHeader h) {
  const NumbersInBytes in(bytes, true);
  constexpr std::uint64_t kSignature = 8, kAround = 12;  // bytes; of a chunk: length, type and checksum
  std::uint64_t at = kSignature;
  for (bool first = true;; first = false) {
    const std::optional<std::uint64_t> length = in.number(at, 4);
    if (!length || *length > in.size() || in.size() - at < kAround || *length > in.size() - at - kAround) return truncated(h);
    const std::string_view type = bytes.substr(static_cast<std::size_t>(at) + 4, 4);
    if (first) {
      constexpr std::uint64_t kHeaderLength = 13;
      if (type != "IHDR" || *length != kHeaderLength) return damaged(h, "it does not begin with its header");
      h.width = *in.number(at + 8, 4);
      h.height = *in.number(at + 12, 4);
      const std::uint64_t colour = *in.number(at + 17, 1);
      h.channels = colour == 0 ? 1 : colour == 4 ? 2 : colour == 6 ? 4 : 3;
    }
    // gAMA holds 100000 times the exponent: 100000 declares linear values.
    if (type == "gAMA" && *length == 4) h.saysLinear = *in.number(at + 8, 4) == 100000;
    if (type == "IEND") return h;
    at += kAround + *length;
  }
}

/// @see ITU T.81, B.1: segments of a marker and a length up to the start of the scan; the frame header has the size.
ImageHeader jpegFrame(std::string_view bytes, ImageHeader h) {
  const NumbersInBytes in(bytes, true);
  std::uint64_t at = 2;
  while (true) {
    const std::optional<std::uint64_t> marker = in.number(at, 1);
    const std::optional<std::uint64_t> code = in.number(at + 1, 1);
    if (!marker || !code) return truncated(h);
    // Every decoder skips bytes between segments, and any number of FF before a marker.
    if (*marker != 0xff || *code == 0xff || *code == 0) {
      ++at;
      continue;
    }
    const bool bare = *code == 0x01 || (*code >= 0xd0 && *code <= 0xd8);
    if (*code == 0xd9 || *code == 0xda) return damaged(h, "it has no frame header");
    if (bare) {
      at += 2;
      continue;
    }
    const std::optional<std::uint64_t> length = in.number(at + 2, 2);
    if (!length || *length < 2) return truncated(h);
    const bool frame = *code >= 0xc0 && *code <= 0xcf && *code != 0xc4 && *code != 0xc8 && *code != 0xcc;
    if (frame) {
      const auto height = in.number(at + 5, 2), width = in.number(at + 7, 2), channels = in.number(at + 9, 1);
      if (!channels) return truncated(h);
      h.height = *height;
      h.width = *width;
      h.channels = static_cast<int>(*channels);
      return h;
    }
    at += 2 + *length;
  }
}

ImageHeader jpegHeader(std::string_view bytes, ImageHeader h) {
  // Where there is no end marker, half of the image is missing.
  return bytes.rfind("\xff\xd9") == std::string_view::npos ? truncated(h) : jpegFrame(bytes, h);
}

/// What the attributes of an EXR's first part say.
struct ExrFacts {
  std::uint64_t end = 0;  ///< the byte behind the empty name that ends them
  std::optional<std::int64_t> width, height, tileWidth, tileHeight;
  bool severalChannels = false;
};

std::int64_t signed32(std::uint64_t v) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(v)); }

/// @see OpenEXR File Layout: attributes (name, type, size, value) up to an empty name.
std::optional<ExrFacts> exrFacts(std::string_view bytes) {
  const NumbersInBytes in(bytes, false);
  ExrFacts facts;
  std::size_t at = 8;
  while (at < bytes.size() && bytes[at] != 0) {
    const std::size_t name = bytes.find('\0', at);
    const std::size_t type = name == std::string_view::npos ? name : bytes.find('\0', name + 1);
    if (type == std::string_view::npos) return std::nullopt;
    const std::optional<std::uint64_t> size = in.number(type + 1, 4);
    if (!size || *size > bytes.size() - type - 5) return std::nullopt;
    const std::string_view named = bytes.substr(at, name - at);
    const std::uint64_t value = type + 5;
    if (named == "dataWindow" && *size == 16) {
      facts.width = signed32(*in.number(value + 8, 4)) - signed32(*in.number(value, 4)) + 1;
      facts.height = signed32(*in.number(value + 12, 4)) - signed32(*in.number(value + 4, 4)) + 1;
    } else if (named == "tiles" && *size >= 8) {
      facts.tileWidth = static_cast<std::int64_t>(*in.number(value, 4));
      facts.tileHeight = static_cast<std::int64_t>(*in.number(value + 4, 4));
    } else if (named == "channels") {
      constexpr std::uint64_t kBehindName = 18;  // bytes: its 0, type and sampling, and the 0 that ends a list of one
      const std::size_t first = bytes.find('\0', static_cast<std::size_t>(value));
      facts.severalChannels = first != std::string_view::npos && first - value + kBehindName < *size;
    }
    at = static_cast<std::size_t>(value + *size);
  }
  if (at >= bytes.size()) return std::nullopt;
  facts.end = at + 1;
  return facts;
}

/// Whether every block that the offset table names lies inside the file. Only single-part scan-line files are checked (what
/// cameras and renderers write for one image); the decoder judges the others.
/// @see OpenEXR File Layout: offsets, blocks (y, size, data).
bool exrBlocksLieInside(std::string_view bytes, std::uint64_t table) {
  const NumbersInBytes in(bytes, false);
  constexpr std::uint64_t kBlockHead = 8;  // bytes
  // The table ends where the first block starts, so its length follows from the smallest offset in it.
  std::uint64_t smallest = bytes.size();
  for (std::uint64_t entry = table; entry + 8 <= smallest; entry += 8) {
    const std::uint64_t offset = *in.number(entry, 8);
    if (offset <= table || bytes.size() < kBlockHead || offset > bytes.size() - kBlockHead) return false;
    if (*in.number(offset + 4, 4) > bytes.size() - kBlockHead - offset) return false;
    smallest = std::min(smallest, offset);
  }
  return smallest < bytes.size();
}

/// The widest strip or tile that is believed, relative to the image: encoders pad the last ones to whole tiles.
bool fitsImage(std::uint64_t blockWidth, std::uint64_t blockHeight, const ImageHeader& h) {
  constexpr std::uint64_t kSmallestTile = 4096;  // px a side: tiles up to it are usual for images of any size
  return blockWidth <= std::max(2 * h.width, kSmallestTile) && blockHeight <= std::max(2 * h.height, kSmallestTile);
}

ImageHeader exrHeader(std::string_view bytes, ImageHeader h) {
  const std::optional<std::uint64_t> version = NumbersInBytes(bytes, false).number(4, 4);
  if (!version) return truncated(h);
  const std::optional<ExrFacts> facts = exrFacts(bytes);
  if (!facts) return truncated(h);
  if (!facts->width || !facts->height || *facts->width < 1 || *facts->height < 1) return damaged(h, "it has no data window");
  h.width = static_cast<std::uint64_t>(*facts->width);
  h.height = static_cast<std::uint64_t>(*facts->height);
  h.severalChannels = facts->severalChannels;
  if (facts->tileWidth &&
      (*facts->tileWidth < 1 || *facts->tileHeight < 1 ||
       !fitsImage(static_cast<std::uint64_t>(*facts->tileWidth), static_cast<std::uint64_t>(*facts->tileHeight), h)))
    return damaged(h, "its tiles are larger than the image");
  constexpr std::uint64_t kTiledDeepOrMultiPart = 0x1A;
  if (*version >> 8 & kTiledDeepOrMultiPart) return h;
  return exrBlocksLieInside(bytes, facts->end) ? h : truncated(h);
}

/// Where a directory of TIFF begins, and the widths of its numbers. BigTIFF has 8 bytes where TIFF has 4.
struct TiffKind {
  unsigned count, entry, value;            ///< bytes: number of entries, an entry, a value in it
  std::optional<std::uint64_t> directory;  ///< its first byte
};

/// The tags that matter here; the first of each counts, as for the decoder.
struct TiffTags {
  // Not checked for strips: "all rows" is often 2^32 - 1.
  std::optional<std::uint64_t> width, height, channels, tileWidth, tileHeight;
  std::optional<std::uint64_t> colours, reduced, make, parts, dng;
  std::optional<std::uint64_t>* at(std::uint64_t tag) {
    switch (tag) {
      case 254: return &reduced;
      case 256: return &width;
      case 257: return &height;
      case 262: return &colours;
      case 271: return &make;
      case 277: return &channels;
      case 322: return &tileWidth;
      case 323: return &tileHeight;
      case 330: return &parts;
      case 50706: return &dng;
      default: return nullptr;
    }
  }
  static bool isSize(std::uint64_t tag) { return tag == 256 || tag == 257 || tag == 277 || tag == 322 || tag == 323; }
  /// Raw files of cameras are TIFF as well: samples behind a mosaic of colours (or linear, of DNG), DNG's own tag, or a camera's
  /// small preview before the pixels.
  bool isRaw() const {
    constexpr std::uint64_t kMosaic = 32803, kLinearRaw = 34892;
    return dng || colours == kMosaic || colours == kLinearRaw || (make && parts && reduced.value_or(0) % 2 == 1);
  }
};

constexpr const char* kRaw = "the file is a raw file of a camera: develop it to TIFF or PNG first";

/// @see TIFF 6.0, 2: entries (tag, type, count, value). @see AWare Systems, The BigTIFF File Format Proposal, 2008.
ImageHeader tiffHeader(std::string_view bytes, ImageHeader h) {
  const NumbersInBytes in(bytes, startsWith(bytes, "MM"));
  constexpr std::uint64_t kBigTiff = 43;
  const TiffKind kind = in.number(2, 2) == kBigTiff ? TiffKind{8, 20, 8, in.number(8, 8)} : TiffKind{2, 12, 4, in.number(4, 4)};
  if (kind.value == 4 && bytes.substr(std::min<std::size_t>(8, bytes.size()), 2) == "CR") return failed(h, kRaw);  // Canon's CR2
  const std::optional<std::uint64_t> entries = kind.directory ? in.number(*kind.directory, kind.count) : std::nullopt;
  if (!entries) return truncated(h);
  TiffTags tags;
  for (std::uint64_t i = 0; i < *entries; ++i) {
    const std::uint64_t at = *kind.directory + kind.count + i * kind.entry, valueAt = at + 4 + kind.value;
    const auto tag = in.number(at, 2), type = in.number(at + 2, 2);
    if (!tag || !type || !in.number(valueAt, kind.value)) return truncated(h);
    std::optional<std::uint64_t>* const found = tags.at(*tag);
    if (!found || *found) continue;
    constexpr std::uint64_t kShort = 3, kLong = 4, kLong8 = 16;
    const bool whole = *type == kShort || *type == kLong || (*type == kLong8 && kind.value == 8);
    // The decoder takes other types too, some of them elsewhere in the file; no program writes a size so.
    if (!whole && TiffTags::isSize(*tag)) return damaged(h, "a size is not a 16- or 32-bit whole number");
    *found = in.number(valueAt, *type == kShort ? 2 : *type == kLong8 ? kind.value : 4);
  }
  if (tags.isRaw()) return failed(h, kRaw);
  h.width = tags.width.value_or(0);
  h.height = tags.height.value_or(0);
  h.channels = static_cast<int>(std::min<std::uint64_t>(tags.channels.value_or(1), std::numeric_limits<int>::max()));
  constexpr std::uint64_t kMostPixels = std::numeric_limits<std::int32_t>::max();
  if (h.width == 0 || h.height == 0) return damaged(h, "its size is missing");
  if (h.width > kMostPixels || h.height > kMostPixels) return damaged(h, "it is too large");
  if (tags.tileWidth && tags.tileHeight && !fitsImage(*tags.tileWidth, *tags.tileHeight, h))
    return damaged(h, "its tiles are larger than the image");
  return h;
}

/// What telephones, cameras and programs write besides: "a HEIC picture"; "" = none of them.
std::string_view unsupportedKind(std::string_view bytes) {
  constexpr std::size_t kBrandsEnd = 64;  // bytes: the file's own brand, and those that it is compatible with
  const std::string_view head = bytes.substr(0, kBrandsEnd);
  if (head.substr(std::min<std::size_t>(4, head.size()), 4) == "ftyp") {
    if (head.find("avif") != std::string_view::npos || head.find("avis") != std::string_view::npos) return "an AVIF picture";
    for (const std::string_view brand : {"heic", "heix", "heim", "heis", "hevc", "hevx", "mif1", "msf1"})
      if (head.find(brand) != std::string_view::npos) return "a HEIC picture";
    return "a video";
  }
  struct Kind {
    std::string_view start, words;
  };
  for (const Kind& kind : {Kind{"GIF8", "a GIF picture"}, Kind{"8BPS", "a Photoshop picture"},
                           Kind{"\xff\x0a", "a JPEG XL picture"}, Kind{{"\0\0\0\x0cJXL ", 8}, "a JPEG XL picture"},
                           Kind{{"\0\0\0\x0cjP  ", 8}, "a JPEG 2000 picture"}, Kind{"\xff\x4f\xff\x51", "a JPEG 2000 picture"}})
    if (startsWith(bytes, kind.start)) return kind.words;
  return "";
}

/// The first bytes of raw files that are no TIFF: Fujifilm, Olympus, Panasonic, Canon (CRW, CR3), Minolta, Sigma.
bool isOtherRaw(std::string_view bytes) {
  for (const std::string_view start :
       {std::string_view("FUJIFILMCCD-RAW"), std::string_view("IIRO"), std::string_view("IIRS"), std::string_view("MMOR"),
        std::string_view("IIU\0", 4), std::string_view("\0MRM", 4), std::string_view("FOVb")})
    if (startsWith(bytes, start)) return true;
  const auto part = [&](std::size_t at, std::size_t length) { return bytes.substr(std::min(at, bytes.size()), length); };
  return part(6, 8) == "HEAPCCDR" || part(4, 8) == "ftypcrx ";
}

ImageHeader bmpHeader(std::string_view bytes, ImageHeader h) {
  const NumbersInBytes in(bytes, false);
  constexpr std::uint64_t kOldHeader = 12;  // bytes; sizes of 16 bits
  const std::optional<std::uint64_t> size = in.number(14, 4);
  if (!size) return truncated(h);
  const auto width = *size == kOldHeader ? in.number(18, 2) : in.number(18, 4);
  const auto height = *size == kOldHeader ? in.number(20, 2) : in.number(22, 4);
  if (!width || !height) return truncated(h);
  h.width = *width;
  // A negative height says that the rows run downwards.
  h.height = *size == kOldHeader ? *height : static_cast<std::uint64_t>(std::abs(signed32(*height)));
  return h;
}

/// A whole number in a text header, behind blanks and comments.
std::optional<std::uint64_t> textNumber(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size()) {
    if (bytes[at] == '#') {
      while (at < bytes.size() && bytes[at] != '\n') ++at;
    } else if (bytes[at] != ' ' && bytes[at] != '\t' && bytes[at] != '\r' && bytes[at] != '\n') {
      break;
    } else {
      ++at;
    }
  }
  constexpr std::size_t kDigits = 9;  // more is no size of an image, and would not fit the arithmetic
  std::uint64_t value = 0;
  const std::size_t start = at;
  while (at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9' && at - start < kDigits)
    value = 10 * value + static_cast<std::uint64_t>(bytes[at++] - '0');
  if (at == start) return std::nullopt;
  return value;
}

ImageHeader pnmHeader(std::string_view bytes, ImageHeader h) {
  std::size_t at = 2;
  const std::optional<std::uint64_t> width = textNumber(bytes, at), height = textNumber(bytes, at);
  if (!width || !height) return truncated(h);
  h.width = *width;
  h.height = *height;
  h.channels = bytes[1] == '3' || bytes[1] == '6' || bytes[1] == 'F' ? 3 : 1;
  return h;
}

/// @see Radiance file formats: lines up to an empty one, then "-Y height +X width".
ImageHeader hdrHeader(std::string_view bytes, ImageHeader h) {
  std::size_t at = bytes.find("\n\n");
  constexpr std::size_t kLongestHeader = 1 << 16;  // bytes
  if (at == std::string_view::npos || at > kLongestHeader) return truncated(h);
  at += 2;
  if (bytes.substr(at, 3) != "-Y ") return failed(h, "the row order of the HDR is not supported");
  at += 3;
  const std::optional<std::uint64_t> height = textNumber(bytes, at);
  if (bytes.substr(std::min(at, bytes.size()), 4) != " +X ") return truncated(h);
  at += 4;
  const std::optional<std::uint64_t> width = textNumber(bytes, at);
  if (!width || !height) return truncated(h);
  h.width = *width;
  h.height = *height;
  h.channels = 3;
  return h;
}

/// @see WebP container specification: RIFF, then VP8 (lossy), VP8L (lossless) or VP8X (extended).
ImageHeader webpHeader(std::string_view bytes, ImageHeader h) {
  const NumbersInBytes in(bytes, false);
  const std::optional<std::uint64_t> size = in.number(4, 4);
  if (!size || *size > bytes.size() - 8 || !in.number(26, 4)) return truncated(h);
  const std::string_view kind = bytes.substr(12, 4);
  constexpr std::uint64_t k14Bits = 0x3fff;
  if (kind == "VP8 ") {
    h.width = *in.number(26, 2) & k14Bits;
    h.height = *in.number(28, 2) & k14Bits;
  } else if (kind == "VP8L") {
    const std::uint64_t packed = *in.number(21, 4);
    h.width = (packed & k14Bits) + 1;
    h.height = (packed >> 14 & k14Bits) + 1;
  } else if (kind == "VP8X") {
    h.width = *in.number(24, 3) + 1;
    h.height = *in.number(27, 3) + 1;
  } else {
    return damaged(h, "it does not begin with an image");
  }
  return h;
}

struct Magic {
  ImageFormat format;
  std::string_view start;
  ImageHeader (*read)(std::string_view, ImageHeader);
};

constexpr std::string_view kPng("\x89PNG\r\n\x1a\n", 8), kLittleTiff("II*\0", 4), kBigEndianTiff("MM\0*", 4),
    kLittleBigTiff("II+\0", 4), kBigBigTiff("MM\0+", 4);

}  // namespace

const char* nameOf(ImageFormat format) {
  switch (format) {
    case ImageFormat::Png: return "PNG";
    case ImageFormat::Jpeg: return "JPEG";
    case ImageFormat::Exr: return "EXR";
    case ImageFormat::Tiff: return "TIFF";
    case ImageFormat::Bmp: return "BMP";
    case ImageFormat::Pnm: return "PNM";
    case ImageFormat::Hdr: return "HDR";
    case ImageFormat::Webp: return "WebP";
  }
  return "";
}

std::optional<std::array<int, 2>> jpegSizeAtStart(std::string_view start) {
  if (!startsWith(start, "\xff\xd8")) return std::nullopt;
  const ImageHeader header = jpegFrame(start, {});
  if (!header.problem.empty() || header.width < 1 || header.height < 1) return std::nullopt;
  return std::array<int, 2>{int(header.width), int(header.height)};  // of 16 bits each
}

ImageHeader readImageHeader(std::string_view bytes) {
  static const Magic kMagics[] = {
      {ImageFormat::Png, kPng, pngHeader},
      {ImageFormat::Jpeg, "\xff\xd8", jpegHeader},
      {ImageFormat::Exr, "\x76\x2f\x31\x01", exrHeader},
      {ImageFormat::Tiff, kLittleTiff, tiffHeader},
      {ImageFormat::Tiff, kBigEndianTiff, tiffHeader},
      {ImageFormat::Tiff, kLittleBigTiff, tiffHeader},
      {ImageFormat::Tiff, kBigBigTiff, tiffHeader},
      {ImageFormat::Bmp, "BM", bmpHeader},
      {ImageFormat::Hdr, "#?RADIANCE", hdrHeader},
      {ImageFormat::Hdr, "#?RGBE", hdrHeader},
  };
  ImageHeader header;
  if (bytes.empty()) return failed(header, "the file is empty (0 bytes)");
  for (const Magic& m : kMagics)
    if (startsWith(bytes, m.start)) {
      header.format = m.format;
      return m.read(bytes, header);
    }
  if (startsWith(bytes, "RIFF") && bytes.substr(std::min<std::size_t>(8, bytes.size()), 4) == "WEBP") {
    header.format = ImageFormat::Webp;
    return webpHeader(bytes, header);
  }
  if (isOtherRaw(bytes)) return failed(header, kRaw);
  // P7 (PAM) names its fields in words and is not read here.
  if (bytes.size() > 2 && bytes[0] == 'P' && ((bytes[1] >= '1' && bytes[1] <= '6') || bytes[1] == 'F' || bytes[1] == 'f')) {
    header.format = ImageFormat::Pnm;
    return pnmHeader(bytes, header);
  }
  if (const std::string_view kind = unsupportedKind(bytes); !kind.empty())
    return failed(header, "the file is " + std::string(kind) + ", which is not supported: convert it to PNG, JPEG or TIFF first");
  return failed(header, "the file is not a supported image (PNG, JPEG, EXR, TIFF, BMP, PNM, HDR, WebP)");
}

}  // namespace glint
