// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/camera_pixels.h"

#include "core/base/parallel.h"

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

}  // namespace glint
