// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>

#include "tests/core/pipeline/exact_scene.h"

namespace glint::testing_support {

/// A ball with three small balls on it, as one mesh: on each of those a prediction finds a speck of a highlight, smaller than
/// detection takes. The contours that are given are the exact ones of the large ball.
class EaredBall {
 public:
  EaredBall() {
    std::filesystem::create_directories(folder_);
    std::ofstream file(folder_ / "ears.obj");
    file.precision(17);
    add(file, {0, 0, -kRadius}, kRadius, 192);
    for (int ear = 0; ear < 3; ++ear) {
      const double a = 2 * std::numbers::pi * ear / 3;
      add(file, Eigen::Vector3d(0.7 * std::cos(a), 0.7 * std::sin(a), 0.714) * kRadius + Eigen::Vector3d(0, 0, -kRadius), kEar,
          24);
    }
  }
  ~EaredBall() { std::filesystem::remove_all(folder_); }

  std::shared_ptr<Scene> scene() const {
    std::shared_ptr<Scene> scene = exactScene(sphere(kRadius), 9);
    scene->surfaces.at("body") = MeshFile{{folder_ / "ears.obj"}};
    return scene;
  }

 private:
  static constexpr double kRadius = 0.5, kEar = 0.02;  // m

  /// With exact normals.
  void add(std::ofstream& file, const Eigen::Vector3d& centre, double radius, int spokes) {
    const int rings = spokes / 2;
    for (int i = 0; i <= rings; ++i)
      for (int j = 0; j < spokes; ++j) {
        const double t = std::numbers::pi * i / rings, p = 2 * std::numbers::pi * j / spokes;
        const Eigen::Vector3d n(std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)), v = centre + radius * n;
        file << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << "\nvn " << n.x() << ' ' << n.y() << ' ' << n.z() << '\n';
      }
    const auto corner = [&](int i, int j) { return std::to_string(written_ + i * spokes + j % spokes + 1); };
    const auto face = [&](const std::string& a, const std::string& b, const std::string& c) {
      file << "f " << a << "//" << a << ' ' << b << "//" << b << ' ' << c << "//" << c << '\n';
    };
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < spokes; ++j) {
        if (i > 0) face(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + 1 < rings) face(corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1));
      }
    written_ += (rings + 1) * spokes;
  }

  const std::filesystem::path folder_ = std::filesystem::temp_directory_path() / ("glint-ears-" + std::to_string(::getpid()));
  int written_ = 0;
};

}  // namespace glint::testing_support
