// SPDX-License-Identifier: BSD-3-Clause
// Where a texture lies on surfaces, against their parametrisations written down by hand.
#include "core/retexture/texture_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/surface/posed_surface.h"

namespace glint::texture_map_tests {

struct On {
  Scene scene;
  std::shared_ptr<const Surface> surface;
  explicit On(AnalyticSpec spec) : surface(makeAnalytic(spec)) {
    scene.surfaces["body"] = spec;
    scene.frames.resize(1);
    scene.frames[0].surface = "body";
  }
  Eigen::Vector2d at(const Eigen::Vector3d& p, TextureMapping m = TextureMapping::Natural, double repeat = 1,
                     const Eigen::Vector3d& n = {0, 0, 1}) const {
    return TextureCoordinates(scene, 0, *surface, m, repeat).at(SurfacePoint{p, n});
  }
};

AnalyticSpec named(const std::string& type) {
  AnalyticSpec s;
  s.type = type;
  return s;
}

void expectAt(const Eigen::Vector2d& found, double u, double v) {
  EXPECT_NEAR(found.x(), u, 1e-12);
  EXPECT_NEAR(found.y(), v, 1e-12);
}

TEST(TextureCoordinates, OfAnalyticSurfaces) {
  AnalyticSpec plane = named("plane");
  plane.worldFromSurface.translation() = Eigen::Vector3d(1, 2, 3);
  expectAt(On(plane).at({1.25, 2.25, 3}), 0.75, 0.25);
  expectAt(On(plane).at({1.25, 2.25, 3}, TextureMapping::Natural, 4), 3, 1);

  // A sheet of curvature 2: x = sin(2 s) / 2, z = (cos(2 s) - 1) / 2 at arc length s.
  AnalyticSpec sheet = named("sheet");
  sheet.curvature = 2;
  sheet.length = 1.5;
  sheet.width = 0.5;
  expectAt(On(sheet).at({std::sin(0.6) / 2, 0.1, (std::cos(0.6) - 1) / 2}), 0.5 + 0.3 / 1.5, 0.5 - 0.1 / 0.5);
  sheet.curvature = 0;
  expectAt(On(sheet).at({0.3, 0.1, 0}), 0.5 + 0.3 / 1.5, 0.3);

  AnalyticSpec ellipsoid = named("ellipsoid");
  ellipsoid.semiAxes = {0.6, 0.3, 0.2};
  expectAt(On(ellipsoid).at({0, 0.3, 0}), 0.25, 0.5);
  expectAt(On(ellipsoid).at({0, 0, 0.2}), 0, 0);
  expectAt(On(ellipsoid).at({-0.6 * std::sqrt(0.5), 0, -0.2 * std::sqrt(0.5)}), 0.5, 0.75);

  AnalyticSpec cylinder = named("cylinder");
  cylinder.radius = 0.5;
  expectAt(On(cylinder).at({0.5, 0.1 * M_PI, 0}), 0.25, 0.4);

  AnalyticSpec torus = named("torus");
  torus.majorRadius = 1;
  torus.minorRadius = 0.2;
  expectAt(On(torus).at({0, 1, 0.2}), 0.25, 0.75);
}

TEST(TextureCoordinates, OfOtherSurfacesAreTheBoxOrWhatIsAskedFor) {
  AnalyticSpec sphere = named("sphere");
  sphere.radius = 0.5;
  const On on(sphere);  // its box has the side 1
  expectAt(on.at({0.1, 0.2, 0.3}, TextureMapping::Planar), 0.6, 0.3);
  expectAt(on.at({0.1, 0.2, 0.3}, TextureMapping::Box, 1, {0.1, -0.9, 0.3}), 0.6, 0.2);
  expectAt(on.at({0.1, 0.2, 0.3}, TextureMapping::Box, 1, {-0.9, 0.1, 0.3}), 0.7, 0.2);
  expectAt(on.at({0, 0.4, 0}, TextureMapping::Spherical), 0.25, 0.5);
  // A surface that is no analytic one has no coordinates of its own.
  On mesh(sphere);
  mesh.scene.surfaces["body"] = MeshFile{{"/body.ply"}};
  expectAt(mesh.at({0.1, 0.2, 0.3}), 0.6, 0.3);
  EXPECT_NE(TextureCoordinates(mesh.scene, 0, *mesh.surface, TextureMapping::Natural, 1).words().find("seams"),
            std::string::npos);
}

/// A quarter turn about z and a shift carry each point and its normal with them; the texture stays on the object.
TEST(TextureCoordinates, MoveWithTheObject) {
  AnalyticSpec ellipsoid = named("ellipsoid");
  ellipsoid.semiAxes = {0.6, 0.3, 0.2};
  On on(ellipsoid);
  Eigen::Isometry3d pose(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  pose.translation() = Eigen::Vector3d(7, -2, 1);
  on.scene.frames[0].worldFromObject = pose;
  on.surface = movedTo(pose, on.surface);
  expectAt(on.at({6.7, -2, 1}), 0.25, 0.5);  // (0, 0.3, 0) of the object
  expectAt(on.at({7, -1.7, 1}, TextureMapping::Planar), 0.5 + 0.3 / 1.2, 0.5);
  expectAt(on.at({7, -1.7, 1}, TextureMapping::Box, 1, {0, 1, 0}), 0.5, 0.5);  // (0.3, 0, 0), its normal along x
}

Image checked() {
  Image t(8, 4, 3);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 8; ++x)
      for (int c = 0; c < 3; ++c) t.at(x, y, c) = float((x + y) % 2 ? 1 : 0.2 * c);
  return t;
}

TEST(TexturePyramid, IsTheTextureNearAndItsMeanFarAway) {
  const Image t = checked();
  const TexturePyramid pyramid(t);
  EXPECT_NEAR(pyramid.mean(), (3 + 0.0 + 0.2 + 0.4) / 6, 1e-7);
  for (int x = 0; x < 8; ++x)
    for (const double turns : {-3.0, 0.0, 2.0}) {
      const Eigen::Vector2d uv((x + 0.5) / 8 + turns, 2.5 / 4 - turns);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(pyramid.at(uv, 0)(c), t.at(x, 2, c), 1e-6);
      EXPECT_NEAR(pyramid.at(uv, 10)(1), 0.6, 1e-6);  // mean of 1 and 0.2
    }
  EXPECT_NEAR(pyramid.at({1.0 / 8, 0.5 / 4}, 0)(0), 0.5, 1e-6);  // between two pixels
  EXPECT_NEAR(pyramid.at({0, 0.5 / 4}, 0)(0), 0.5, 1e-6);        // and over the seam
}

TEST(TexturePyramid, OfOnePixel) {
  Image one(1, 1, 3, 0.25f);
  const TexturePyramid pyramid(one);
  EXPECT_NEAR(pyramid.at({0.3, 17.9}, 0.01)(2), 0.25, 1e-7);
  EXPECT_NEAR(pyramid.at({-5.3, 0}, 1e9)(2), 0.25, 1e-7);
  const Image none;
  EXPECT_THROW(TexturePyramid{none}, std::invalid_argument);
}

}  // namespace glint::texture_map_tests
