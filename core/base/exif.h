// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace glint {

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
