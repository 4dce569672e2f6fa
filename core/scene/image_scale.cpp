// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/image_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/atomic_file.h"
#include "core/base/image_header.h"
#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr int kSmallest = 16;  // px: below, a pixel of tolerance fits by chance

/// Width and height of the frame's picture; nothing where it cannot be read.
std::optional<std::array<int, 2>> pictureSize(const Frame& frame) {
  const auto& file = frame.image.empty() ? frame.radiance : frame.image;
  if (file.empty() || frame.ofVideo) return std::nullopt;
  try {
    const ImageHeader header = readImageHeader(readFile(file, Limit::ImageMegabytes));
    constexpr std::uint64_t kMost = 65536;  // px
    if (!header.problem.empty() || header.width < 1 || header.height < 1 || header.width > kMost || header.height > kMost)
      return std::nullopt;
    return std::array<int, 2>{int(header.width), int(header.height)};
  } catch (const InputError&) {
    return std::nullopt;  // the reader of the picture reports it
  }
}

bool fits(double scale, int width, int height, const Camera& camera) {
  return std::abs(width - scale * camera.width) < 1 && std::abs(height - scale * camera.height) < 1;
}

}  // namespace

std::optional<double> imageScale(int width, int height, const Camera& camera) {
  if (width == camera.width && height == camera.height) return std::nullopt;
  if (std::min({width, height, camera.width, camera.height}) < kSmallest) return std::nullopt;
  constexpr int kMostFold = 16;
  for (int n = 2; n <= kMostFold; ++n)
    for (const double scale : {1.0 / n, double(n)})
      if (fits(scale, width, height, camera)) return scale;
  const double scale = double(width) / camera.width;
  return fits(scale, width, height, camera) ? std::optional(scale) : std::nullopt;
}

Camera resized(const Camera& camera, int width, int height) {
  const double x = double(width) / camera.width, y = double(height) / camera.height;
  Eigen::Matrix3d k = camera.pixelFromRay;
  k.row(0) *= x;
  k.row(1) *= y;
  k(0, 2) += 0.5 * (x - 1);
  k(1, 2) += 0.5 * (y - 1);
  Camera result = camera;
  result.pixelFromRay = k;
  result.width = width;
  result.height = height;
  return result;
}

std::optional<Correction> imageScaleCorrection(const Scene& scene) {
  std::optional<double> scale;
  for (const Frame& frame : scene.frames) {
    const auto size = pictureSize(frame);
    if (!size) continue;
    const std::optional<double> own = imageScale((*size)[0], (*size)[1], frame.camera);
    if (!own || (scale && !fits(*scale, (*size)[0], (*size)[1], frame.camera))) return std::nullopt;
    if (!scale) scale = own;
  }
  if (!scale) return std::nullopt;
  return Correction{formatted("image-scale=%.10g", *scale),
                    formatted("Fit the cameras to photographs of %.4g of their size", *scale)};
}

std::optional<Correction> cameraScaleCorrection(const Scene& scene) {
  constexpr int kMostFold = 16;
  constexpr double kOffMiddle = 0.1;  // of half the picture: lenses are centred better
  std::optional<int> fold;
  for (const Frame& frame : scene.frames) {
    const Camera& c = frame.camera;
    const Eigen::Array2d halves = (c.pixelFromRay.topRightCorner<2, 1>().array() + 0.5) / Eigen::Array2d(c.width, c.height) * 2;
    const double n = std::round(halves.mean());
    if (!(n >= 2 && n <= kMostFold) || ((halves / n - 1).abs() > kOffMiddle).any() || (fold && *fold != int(n)))
      return std::nullopt;
    fold = int(n);
  }
  if (!fold) return std::nullopt;
  return Correction{formatted("camera-scale=%.10g", 1.0 / *fold),
                    formatted("Fit the intrinsics to photographs of 1/%d of their size", *fold)};
}

void applyImageScale(Scene& scene, double scale) {
  for (Frame& frame : scene.frames) {
    std::array<int, 2> size{std::max(1, int(std::lround(scale * frame.camera.width))),
                            std::max(1, int(std::lround(scale * frame.camera.height)))};
    if (const auto own = pictureSize(frame); own && fits(scale, (*own)[0], (*own)[1], frame.camera)) size = *own;
    const Camera before = frame.camera;
    frame.camera = resized(before, size[0], size[1]);
    const Eigen::Array2d factor(double(size[0]) / before.width, double(size[1]) / before.height);
    const auto moved = [&](const Pixel& p) { return Pixel((p.array() + 0.5) * factor - 0.5); };
    for (Highlight& h : frame.highlights) {
      h.peak = moved(h.peak);
      for (Pixel& p : h.contour.points) p = moved(p);
    }
  }
}

}  // namespace glint
