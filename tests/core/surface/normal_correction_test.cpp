// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "core/surface/mesh.h"
#include "tests/core/surface/surfaces.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kExact = 1e-12;  // a few ulp

TriangleMesh square(int cells, double size) {
  TriangleMesh mesh;
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) mesh.vertices.emplace_back(size * (2.0 * i / cells - 1), size * (2.0 * j / cells - 1), 0);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int n = j * (cells + 1) + i;
      mesh.triangles.emplace_back(n, n + 1, n + cells + 2);
      mesh.triangles.emplace_back(n, n + cells + 2, n + cells + 1);
    }
  return mesh;
}

// On the plane z = 0 a height h turns the normal to (-h_x, -h_y, 1), normalised: the normal of the graph z = h(x, y).
TEST(EqTurned, APlanesNormalIsThatOfTheGraph) {
  const double size = 2, height = 0.05, length = 0.7 * size;
  const NormalCorrection one{{Vector3d(0.25 * size, -0.5 * size, 0)}, Eigen::VectorXd::Constant(1, height), length};
  const auto plane = makeMesh(square(8, size), NormalPolicy::Interpolated);
  const Outcome<std::shared_ptr<const Surface>> turned = correctedMesh(*plane, NormalPolicy::Interpolated, one);
  ASSERT_TRUE(turned) << turned.failure().message();
  int steep = 0;
  for (const double x : {-0.5, 0.0, 0.75})
    for (const double y : {-0.25, 0.5}) {
      const Outcome<SurfacePoint> p = (*turned)->firstHit({Vector3d(x * size, y * size, 1), Vector3d(0, 0, -1)});
      ASSERT_TRUE(p);
      const double dx = x * size - 0.25 * size, dy = y * size + 0.5 * size;
      const double h = height * std::exp(-(dx * dx + dy * dy) / (2 * length * length));
      const Vector3d expected = Vector3d(dx * h, dy * h, length * length).normalized();
      EXPECT_LT((p->normal - expected).norm(), kExact) << x << " " << y;
      EXPECT_EQ(p->position.z(), 0) << "positions stay";
      steep += std::abs(expected.x()) > 1e-3;
    }
  EXPECT_GT(steep, 3) << "the test could not fail";
}

// A height that is larger with everything else turns normals by the same angle.
TEST(CorrectedMesh, Scale) {
  for (const double scale : {1e-6, 1e6}) {
    const NormalCorrection c{{Vector3d(0.5 * scale, 0, 0)}, Eigen::VectorXd::Constant(1, 0.01 * scale), 0.5 * scale};
    const auto plane = makeMesh(square(8, scale), NormalPolicy::Interpolated);
    const Outcome<std::shared_ptr<const Surface>> turned = correctedMesh(*plane, NormalPolicy::Interpolated, c);
    ASSERT_TRUE(turned) << scale;
    const Outcome<SurfacePoint> p = (*turned)->firstHit({Vector3d(0, 0, scale), Vector3d(0, 0, -1)});
    ASSERT_TRUE(p);
    const double slope = 0.01 / 0.5 * std::exp(-0.5);  // h' one length from the centre
    EXPECT_NEAR(p->normal.x() / p->normal.z(), -slope, kExact) << scale;
  }
}

// The curvature that searches rely on is the corrected one: on a flat mesh it is the bump's own.
TEST(CorrectedMesh, BendsThePlane) {
  const double height = 0.02, length = 1;
  const NormalCorrection c{{Vector3d::Zero()}, Eigen::VectorXd::Constant(1, height), length};
  const auto plane = makeMesh(square(64, 1.0), NormalPolicy::Interpolated);
  const auto turned = *correctedMesh(*plane, NormalPolicy::Interpolated, c);
  const Outcome<SurfacePoint> top = turned->firstHit({Vector3d(0.003, 0.005, 1), Vector3d(0, 0, -1)});
  ASSERT_TRUE(top);
  const Outcome<Curvature> k = turned->curvatureAt(*top);
  ASSERT_TRUE(k);
  EXPECT_NEAR(k->k1, height / (length * length), 1e-2 * height);  // 1 %: triangles of 1/32 of the length
  EXPECT_NEAR(k->k2, height / (length * length), 1e-2 * height);
}

TEST(CorrectedMesh, Degenerate) {
  const NormalCorrection c{{Vector3d::Zero()}, Eigen::VectorXd::Constant(1, 0.02), 1};
  const auto facets = makeMesh(square(4, 1), NormalPolicy::Facet);
  EXPECT_EQ(correctedMesh(*facets, NormalPolicy::Facet, c).failure().reason, Reason::NotSupported);
  const auto plane = makeMesh(square(4, 1), NormalPolicy::Interpolated);
  EXPECT_THROW((void)correctedMesh(*plane, NormalPolicy::Interpolated, {{Vector3d::Zero()}, Eigen::VectorXd::Zero(2), 1}),
               std::invalid_argument);
  EXPECT_THROW((void)correctedMesh(*plane, NormalPolicy::Interpolated, {{Vector3d::Zero()}, Eigen::VectorXd::Zero(1), 0}),
               std::invalid_argument);
  EXPECT_FALSE(NormalCorrection().changesAnything());
  EXPECT_FALSE((NormalCorrection{{Vector3d::Zero()}, Eigen::VectorXd::Zero(1), 1}.changesAnything()));
  EXPECT_TRUE(c.changesAnything());
}

}  // namespace
}  // namespace glint
