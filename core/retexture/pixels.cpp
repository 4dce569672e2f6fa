// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/pixels.h"

#include "core/base/progress.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/photograph.h"

namespace glint {

void forEachPixel(const Camera& camera, const std::function<void(std::size_t, const Pixel&)>& work, const ProgressFn& progress,
                  const std::string& stage) {
  parallelFor(
      camera.height,
      [&](int y) {
        for (int x = 0; x < camera.width; ++x) {
          const Pixel ideal = camera.undistorted(Pixel(x, y));
          if (ideal.allFinite()) work(std::size_t(y) * std::size_t(camera.width) + std::size_t(x), ideal);
        }
      },
      progress, stage);
}

void forEachSurfacePixel(const Camera& camera, const Surface& surface,
                         const std::function<void(std::size_t, const SurfacePoint&)>& work, const ProgressFn& progress,
                         const std::string& stage) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  forEachPixel(
      camera,
      [&](std::size_t i, const Pixel& ideal) {
        const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(ideal));
        if (hit) work(i, facing(*hit, eye));
      },
      progress, stage);
}

Outcome<FramePixels> framePixels(const Inspection& in, int frame) {
  const Frame& f = in.given->frames[std::size_t(frame)];
  if (f.image.empty() && !picturesAreSynthesised(in))
    return Failure{Reason::NotSupported, "frame " + f.id + " has no photograph, so nothing tells how bright a picture shows it"};
  const Outcome<Image> linear = linearImageOf(in, frame, FrameSource::Image);
  if (!linear) return linear.failure();
  const Outcome<std::optional<Image>> mask = readMask(f);
  if (!mask) return mask.failure();
  const double clip = detectOptionsFor(f, FrameSource::Image, in.request.settings).clipValue;
  FramePixels pixels{Image(linear->width, linear->height, 3), {}, {}};
  for (std::size_t i = 0; i < pixels.linear.data.size(); ++i)
    pixels.linear.data[i] = linear->data[linear->channels == 3 ? i : i / 3];
  pixels.glossy.assign(pixels.linear.data.size() / 3, 1);
  if (mask->has_value())
    for (std::size_t i = 0; i < pixels.glossy.size(); ++i) pixels.glossy[i] = (**mask).data[i] != 0;
  pixels.usable = linearPixels(pixels.linear, mask->has_value() ? &**mask : nullptr, clip).usable;
  return pixels;
}

}  // namespace glint
