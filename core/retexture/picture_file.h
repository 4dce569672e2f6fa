// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

#include "core/base/image.h"
#include "core/geometry/camera.h"

namespace glint {

/// A picture that a person gives, in linear light: 8- and 16-bit codes through the inverse sRGB curve (16 bits that say so are
/// linear), float as stored. 3 channels. Header, size and limits are checked before anything is decoded.
/// @param flag  for the message, "--texture".
/// InputError (file, flag): missing, damaged, beyond a limit, or values that are negative or not finite.
Image readTexture(const std::filesystem::path& file, const std::string& flag);

/// The same, of the size of the camera's frames; InputError names both sizes.
Image readBackground(const std::filesystem::path& file, const Camera& camera, const std::string& flag);

}  // namespace glint
