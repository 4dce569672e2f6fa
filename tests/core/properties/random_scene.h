// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/scene/scene.h"

namespace glint::testing_support {

enum class Kind { Plane, Sphere, Cylinder, Ellipsoid, Mesh };
constexpr int kKinds = 5;
const char* nameOf(Kind kind);

/// What a random scene is; the numbers in it follow from the seed.
struct Draw {
  Kind kind = Kind::Plane;
  int lights = 1;
  bool noisy = false;
  bool radiance = false;  ///< contours are level sets of a lobe's radiance; else of the incident angle
  unsigned seed = 1;
  std::string text() const;
};
/// The scene with this number: any ten from a multiple of ten on hold every kind with one and with two lights, exact and noisy;
/// any twenty hold every kind with both contours too.
Draw draw(int number, unsigned seed);

/// A scene whose frames give their highlights, with a mesh as a file beside it.
struct RandomScene {
  Draw what;
  std::shared_ptr<const Scene> scene;
  std::vector<std::string> training;  ///< ids
  double size = 1;                    ///< unit of length: the cameras are about 1.5 of it away, the highlights about 0.1 wide
};

constexpr int kTraining = 5, kHeldOut = 1;
constexpr double kNoisePx = 0.2;

/// Cameras 641 x 481 with a random roll, lights, a surface that touches the origin. Contours are 72 points on the level set, at
/// equal distances along it, so that resampling to 72 gives them again. @param folder  for the mesh.
RandomScene randomScene(const Draw& what, const std::filesystem::path& folder);

/// x -> scale (motion x) of surfaces, cameras and lights. Highlights stay as they are.
RandomScene moved(const RandomScene& s, const Eigen::Isometry3d& motion, double scale, const std::filesystem::path& folder);
/// The world and the photographs in a mirror: x -> (-x, y, z) of the world, pixel -> (width - 1 - u, v).
RandomScene mirrored(const RandomScene& s, const std::filesystem::path& folder);
/// p -> zoom (p + 1/2) - 1/2 of all pixels: the photographs with another number of pixels.
RandomScene zoomed(const RandomScene& s, int zoom);
/// Frames in the order of `order`.
RandomScene reordered(const RandomScene& s, const std::vector<int>& order);
/// With one more frame "ID again" for each of `frames`, which trains where the frame does. @param turned  its contours start at
/// another vertex: the same evidence, but not the same numbers.
RandomScene repeated(const RandomScene& s, const std::vector<int>& frames, bool turned = false);

}  // namespace glint::testing_support
