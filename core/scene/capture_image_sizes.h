// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/scene: sizes of the many images of one capture.

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "core/base/found_file.h"
#include "core/base/image_header.h"
#include "core/scene/capture_parts.h"

namespace glint::capture {

/// As sizeOfImage, for one image after the other. A PNG says its size in its first bytes, and those of a capture mostly say the
/// same; a JPEG says it behind what its camera noted. Such images are not read whole, which for 2000 photographs would be a
/// gigabyte from the disk. What is damaged further on, its decoder tells.
class ImageSizes {
 public:
  std::array<int, 2> of(const std::filesystem::path& image, const std::string& file, const std::string& place) {
    constexpr std::size_t kStart = 3 << 15;  // bytes: a JPEG's notes with a thumbnail are a segment of at most two thirds of it
    std::string start = firstBytes(image, kStart);
    if (const auto size = jpegSizeAtStart(start)) return *size;
    start = pngStart(start);
    if (!start.empty() && start == start_) return size_;
    size_ = sizeOfImage(image, file, place);
    start_ = std::move(start);
    return size_;
  }

 private:
  /// The start of a PNG, up to the end of its size; "" for everything else.
  static std::string pngStart(const std::string& start) {
    constexpr std::size_t kSize = 24;  // bytes: signature 8, length 4, "IHDR" 4, width 4, height 4
    const bool isPng = start.size() >= kSize && start.starts_with("\x89PNG\r\n\x1a\n") && start.compare(12, 4, "IHDR") == 0;
    return isPng ? start.substr(0, kSize) : "";
  }

  std::string start_;  ///< of the image that was read whole last
  std::array<int, 2> size_{};
};

}  // namespace glint::capture
