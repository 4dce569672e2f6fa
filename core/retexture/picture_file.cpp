// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/picture_file.h"

#include <cmath>
#include <limits>

#include "core/base/atomic_file.h"
#include "core/base/image_header.h"
#include "core/scene/scene.h"

namespace glint {
namespace {

/// A failure's detail begins with the file, which the error names itself.
std::string withoutFile(const std::string& detail, const std::filesystem::path& file) {
  const std::string start = file.string() + ": ";
  return detail.rfind(start, 0) == 0 ? detail.substr(start.size()) : detail;
}

}  // namespace

Image readBackground(const std::filesystem::path& file, const Camera& camera, const std::string& flag) {
  Frame frame;  // the one decoder of photographs, with its checks
  frame.image = file;
  frame.camera.width = camera.width;
  frame.camera.height = camera.height;
  const Outcome<Image> read = readLinear(frame, FrameSource::Image);
  if (!read) throw InputError(file.string(), flag, withoutFile(read.failure().detail, file));
  Image image(read->width, read->height, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const float v = read->data[read->channels == 3 ? i : i / 3];
    if (!std::isfinite(v) || v < 0)
      throw InputError(file.string(), flag,
                       "pixel (" + std::to_string(i / 3 % std::size_t(image.width)) + ", " +
                           std::to_string(i / 3 / std::size_t(image.width)) + ") is negative or not finite; light is neither");
    image.data[i] = v;
  }
  return image;
}

Image readTexture(const std::filesystem::path& file, const std::string& flag) {
  const ImageHeader header = readImageHeader(readFile(file, Limit::ImageMegabytes));
  if (!header.problem.empty()) throw InputError(file.string(), flag, header.problem);
  constexpr auto kMost = std::uint64_t(std::numeric_limits<int>::max());
  if (header.width > kMost || header.height > kMost) throw InputError(file.string(), flag, "the image is too large");
  Camera size;
  size.width = int(header.width);
  size.height = int(header.height);
  return readBackground(file, size, flag);
}

}  // namespace glint
