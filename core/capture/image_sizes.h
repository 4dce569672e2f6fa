// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/capture: sizes of the many images of one capture.

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "core/capture/parts.h"

namespace glint::capture {

/// As sizeOfImage, for one image after the other. A PNG says its size in its first bytes, and those of a capture mostly say the
/// same: such an image is not read whole, which for 2000 photographs would be a gigabyte from the disk. What is damaged further
/// on, its decoder tells.
class ImageSizes {
 public:
  std::array<int, 2> of(const std::filesystem::path& image, const std::string& file, const std::string& place) {
    std::string start = startOf(image);
    if (!start.empty() && start == start_) return size_;
    size_ = sizeOfImage(image, file, place);
    start_ = std::move(start);
    return size_;
  }

 private:
  /// Of a PNG, up to the end of its size; "" for everything else.
  static std::string startOf(const std::filesystem::path& image) {
    std::error_code ignored;  // what cannot be asked about is not there; a pipe would make the program wait
    if (!std::filesystem::is_regular_file(image, ignored)) return "";
    constexpr std::size_t kSize = 24;  // bytes: signature 8, length 4, "IHDR" 4, width 4, height 4
    std::string start(kSize, '\0');
    std::ifstream in(image, std::ios::binary);
    if (!in.read(start.data(), kSize)) return "";
    const bool isPng = std::string_view(start).substr(0, 8) == "\x89PNG\r\n\x1a\n" && start.compare(12, 4, "IHDR") == 0;
    return isPng ? start : "";
  }

  std::string start_;  ///< of the image that was read whole last
  std::array<int, 2> size_{};
};

}  // namespace glint::capture
