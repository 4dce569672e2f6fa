// SPDX-License-Identifier: BSD-3-Clause
// Images and depth maps: the header that is checked before anything is decoded, and the decoders behind it.
#include <opencv2/core.hpp>

#include "core/base/image_header.h"
#include "core/scene/image_decode.h"
#include "tests/fuzz/readers.h"

namespace glint::fuzz {
namespace {

constexpr std::uint64_t kMostPixels = 1 << 16;  // a larger image takes time in proportion, and shows nothing else

ImageHeader checkedHeader(const std::string& bytes) {
  const ImageHeader header = readImageHeader(bytes);
  if (!header.problem.empty() && (header.width != 0 || header.height != 0))
    throw Finding{"a size beside the problem " + header.problem};
  if (header.channels < 0) throw Finding{"a negative number of channels"};
  if (const int turn = exifOrientation(bytes); turn < 1 || turn > 8) throw Finding{"an orientation that EXIF does not have"};
  if (const std::optional<double> focal = focalLength35mm(bytes); focal && !(*focal >= 1 && *focal <= 65535))
    throw Finding{"a focal length that no EXIF number can be"};
  return header;
}

}  // namespace

bool feedImageHeader(const std::string& bytes) { return checkedHeader(bytes).problem.empty(); }

bool feedImage(const std::string& bytes) {
  const ImageHeader header = checkedHeader(bytes);
  if (!header.problem.empty() || header.width > kMostPixels || header.height > kMostPixels ||
      header.width * header.height > kMostPixels)
    return false;
  const Outcome<cv::Mat> pixels = decodeImage(bytes, header);
  if (!pixels) {
    if (pixels.failure().detail.empty()) throw Finding{"an image refused without words"};
    return false;
  }
  // Who passes the check of the header by another size than the decoder sees can make it take any amount of memory.
  if (static_cast<std::uint64_t>(pixels->cols) > header.width || static_cast<std::uint64_t>(pixels->rows) > header.height)
    throw Finding{"decoded " + std::to_string(pixels->cols) + " x " + std::to_string(pixels->rows) +
                  ", more than its header says"};
  if (pixels->channels() != 1 && pixels->channels() != 3) throw Finding{std::to_string(pixels->channels()) + " channels"};
  return true;
}

}  // namespace glint::fuzz
