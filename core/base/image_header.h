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

/// FocalLengthIn35mmFilm of the EXIF data of a JPEG, PNG, WebP or TIFF: the focal length, mm, at which a frame of 36 x 24 mm has
/// the same angle of view across its diagonal. Nothing if the file has no such entry, says 0 (unknown), or is damaged before
/// it. Every offset is checked against the bytes that are there.
/// @see CIPA DC-008 (Exif 2.32), 4.6.5: tag 0xA405 in the Exif IFD, which tag 0x8769 of the first IFD points to.
std::optional<double> focalLength35mm(std::string_view file);

/// How a viewer turns the picture, 1 to 8: 1 = as stored (or if the file does not say, or is damaged before it), 3 = by 180
/// degrees, 6 = by 90 degrees clockwise, 8 = by 90 degrees counter-clockwise; 2, 4, 5 and 7 also mirror. From 5 on width and
/// height change places. Glint applies no quarter turns; of TIFF files OpenCV applies 2 to 4. Formats and checks as above.
/// @see CIPA DC-008 (Exif 2.32), 4.6.4: tag 0x0112 in the first IFD.
int exifOrientation(std::string_view file);

}  // namespace glint
