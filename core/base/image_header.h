// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace glint {

enum class ImageFormat { Png, Jpeg, Exr, Tiff, Bmp, Pnm, Hdr, Webp };

/// "PNG", "JPEG", ...
const char* nameOf(ImageFormat format);

/// What an image file says of itself before anything is decoded. Nothing of it is believed: every offset and length is checked
/// against the bytes that are there.
struct ImageHeader {
  ImageFormat format = ImageFormat::Png;
  std::uint64_t width = 0, height = 0;  ///< px; 0 with a problem
  int channels = 0;                     ///< as stored (a palette counts as 3); 0 = the header does not say
  bool severalChannels = false;         ///< an EXR with more than one, of which a reader takes some
  bool saysLinear = false;              ///< a PNG's gAMA chunk declares an exponent of 1
  std::string problem;                  ///< "" = whole, as far as the container tells without decoding
};

/// Recognises the format by its first bytes, never by a name. Truncated files, chunks and tables that lie outside of the file,
/// and blocks larger than the image are problems; so is what no decoder here is made for.
ImageHeader readImageHeader(std::string_view bytes);

/// Width and height of a JPEG, px, from its first bytes alone, which may end anywhere. Nothing if this is not a JPEG, or if they
/// do not reach its frame header. Does not check whether the rest of the file is there.
std::optional<std::array<int, 2>> jpegSizeAtStart(std::string_view start);

}  // namespace glint
