// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/plane.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint {
namespace {
using tolerance::kExact;

TEST(EqMirror, IsAnInvolutionThatFlipsHandedness) {
  const Plane plane{{0, 0.6, 0.8}, 3.0};
  const Eigen::Matrix4d m = plane.reflection();
  EXPECT_NEAR((m * m - Eigen::Matrix4d::Identity()).norm(), 0, kExact);
  EXPECT_NEAR(m.determinant(), -1.0, kExact);
  // By hand: the origin lies 3 in front of the plane, so its image is -6 n.
  EXPECT_NEAR(((m * Eigen::Vector4d(0, 0, 0, 1)).head<3>() - Eigen::Vector3d(0, -3.6, -4.8)).norm(), 0, kExact);
  EXPECT_NEAR((plane.reflected({0, 0, 0}) - Eigen::Vector3d(0, -3.6, -4.8)).norm(), 0, kExact);
}

TEST(Plane, ThroughAPoint) {
  const Plane p = Plane::through({1, 2, 3}, {0, 0, 1});
  EXPECT_NEAR(p.signedDistance({7, 8, 5}), 2, kExact);
  EXPECT_NEAR((p.projected({7, 8, 5}) - Eigen::Vector3d(7, 8, 3)).norm(), 0, kExact);
}

TEST(TangentBasis, IsRightHandedForEveryNormal) {
  std::mt19937 rng(7);
  std::normal_distribution<double> g;
  int up = 0, down = 0;
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d n = i == 0   ? Eigen::Vector3d(0, 0, 1)
                              : i == 1 ? Eigen::Vector3d(0, 0, -1)
                              : i == 2 ? Eigen::Vector3d(1e-9, 0, -1).normalized()
                                       : Eigen::Vector3d(g(rng), g(rng), g(rng)).normalized();
    ++(n.z() > 0 ? up : down);
    const Eigen::Matrix<double, 3, 2> b = tangentBasis(n);
    EXPECT_NEAR(b.col(0).norm(), 1, kExact);
    EXPECT_NEAR(b.col(1).norm(), 1, kExact);
    EXPECT_NEAR((b.col(0).cross(b.col(1)) - n).norm(), 0, kExact);
  }
  EXPECT_GT(up, 50);
  EXPECT_GT(down, 50);
}

TEST(VirtualCamera, AgreesWithTheReferenceProjections) {
  GLINT_NEEDS_SHARED_DATA();
  std::ifstream in(std::string(GLINT_SHARED_DIR) + "/reference/plane_to_cylinder.json");
  ASSERT_TRUE(in);
  const nlohmann::json file = nlohmann::json::parse(in);
  int checked = 0;
  for (const auto& step : file["steps"])
    for (const auto& frame : step["frames"]) {
      Camera camera;
      Eigen::Matrix<double, 3, 4> expected;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 4; ++j) {
          if (j < 3) camera.pixelFromRay(i, j) = file["K"][i][j];
          camera.camFromWorld.matrix()(i, j) = frame["camera_from_world"][i][j];
          expected(i, j) = frame["virtual_projection"][i][j];
        }
      const Eigen::Vector3d p(frame["brightest_point"][0], frame["brightest_point"][1], frame["brightest_point"][2]);
      const Eigen::Vector3d n(frame["normal"][0], frame["normal"][1], frame["normal"][2]);
      const Projection got = virtualCamera(camera, Plane::through(p, n));
      EXPECT_NEAR((got.matrix / got.matrix.norm() - expected / expected.norm()).norm(), 0, kExact);
      EXPECT_LT(got.matrix.leftCols<3>().determinant(), 0);
      // A point of the mirror keeps its pixel.
      EXPECT_NEAR((got.project(p) - *camera.project(p)).norm(), 0, 1e-9);
      ++checked;
    }
  EXPECT_EQ(checked, 30);
}

}  // namespace
}  // namespace glint
