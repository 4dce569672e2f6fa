// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace glint {

/// FocalLengthIn35mmFilm of a JPEG's EXIF data: the focal length, mm, at which a frame of 36 x 24 mm has the same angle of view across its
/// diagonal. Nothing where the file is no JPEG, has no such entry, says 0 (unknown), or is damaged before it. Every offset is checked against the
/// bytes that are there.
/// @see CIPA DC-008 (Exif 2.32), 4.6.5: tag 0xA405 in the Exif IFD, which tag 0x8769 of the first IFD points to.
std::optional<double> focalLength35mm(std::string_view file);

}  // namespace glint
