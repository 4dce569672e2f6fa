// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/radiance_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/surface/brightest_point.h"
#include "tests/core/model/exact_views.h"

namespace glint {
namespace {

using namespace test;

constexpr double kPeakPx = 1e-3;  // stated accuracy of climb() is 1e-4 px

// A cosine power of H under a light at infinity is brightest where H = N: at the mirror point, which another search finds.
TEST(RadianceField, BlinnPhongPeaksAtTheMirrorPoint) {
  const Synthetic s = ellipsoidScene(6);
  const auto surface = makeAnalytic(s.surface);
  const Light light = Light::towards({0.3, -0.4, 0.8});
  for (const Camera& camera : s.cameras) {
    const auto mirror = predictedBrightestPoints(*surface, camera, light);
    if (!mirror) continue;
    const RadianceField field(*surface, camera, Lobe::BlinnPhong, 0.1, light);
    const auto peak = field.climb(mirror->front().pixel + Pixel(15, -12), 0);
    ASSERT_TRUE(peak);
    EXPECT_LT((peak->pixel - mirror->front().pixel).norm(), kPeakPx);
    EXPECT_NEAR(peak->logRadiance, 0, 1e-9);  // cos(0) to any power
  }
}

// On a plane with the light and the camera straight above each other everything is symmetric about the foot.
TEST(RadianceField, PeakOfASymmetricSceneIsItsCentre) {
  const auto surface = makeAnalytic(plane());
  const Camera camera = lookAt({0, 0, 2}, {0, 0, 0});
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::Phong, Lobe::BlinnPhong}) {
    const RadianceField field(*surface, camera, lobe, 0.2, Light::at({0, 0, 3}));
    const auto peak = field.climb(Pixel(350, 200), 0);
    ASSERT_TRUE(peak);
    EXPECT_LT((peak->pixel - Pixel(319.5, 239.5)).norm(), kPeakPx) << nameOf(lobe);
  }
}

// Torrance and Sparrow's off-specular shift: at slanted incidence the peak lies on the grazing side of the mirror point.
TEST(RadianceField, PeakIsShiftedTowardsGrazing) {
  const auto surface = makeAnalytic(plane());
  const Camera camera = lookAt({0, -2, 0.7}, {0, 0, 0});
  const Light light = Light::at({0, 2, 0.7});  // mirror point at the origin
  const RadianceField field(*surface, camera, Lobe::TorranceSparrow, 0.25, light);
  const auto peak = field.climb(*camera.project({0, 0, 0}), 0);
  ASSERT_TRUE(peak);
  EXPECT_GT(peak->point.position.y(), 0.02);
  EXPECT_NEAR(peak->point.position.x(), 0, 1e-5);
}

TEST(RadianceField, PeaksFindsAMaximumThatNoStartLeadsTo) {
  const auto surface = makeAnalytic(plane());
  const Camera camera = lookAt({0, 0, 2}, {0, 0, 0});
  const RadianceField field(*surface, camera, Lobe::TorranceSparrow, 0.1, Light::at({0.3, 0.2, 3}));
  const auto known = field.peaks({Pixel(319.5, 239.5)}, 0), scanned = field.peaks({}, 16);
  ASSERT_EQ(known.size(), 1u);
  ASSERT_EQ(scanned.size(), 1u);
  EXPECT_LT((known[0].pixel - scanned[0].pixel).norm(), 2 * kPeakPx);
}

// A maximum outside the image: inside, the radiance is largest at the border on that side.
TEST(RadianceField, PeakStaysInsideTheImageWhenAsked) {
  const auto surface = makeAnalytic(plane());
  const Camera camera = lookAt({0, 0, 2}, {0, 0, 0});
  const RadianceField field(*surface, camera, Lobe::TorranceSparrow, 0.3, Light::at({3, 0, 2}));
  const auto inside = field.climb(Pixel(500, 200), 0), anywhere = field.climb(Pixel(500, 200), 1000);
  ASSERT_TRUE(inside && anywhere);
  EXPECT_GT(anywhere->pixel.x(), camera.width);
  EXPECT_NEAR(inside->pixel.x(), camera.width - 1, 1e-3);
  EXPECT_NEAR(inside->pixel.y(), 239.5, 0.1);
  EXPECT_LT(inside->logRadiance, anywhere->logRadiance);
}

TEST(RadianceField, UndefinedWhereNothingIsLit) {
  const auto surface = makeAnalytic(sphere(0.5));
  const Camera camera = lookAt({0, -2, 0}, {0, 0, 0});
  const RadianceField field(*surface, camera, Lobe::Ggx, 0.2, Light::at({0, 3, 0}));  // behind the sphere
  EXPECT_FALSE(field.at(Pixel(319.5, 239.5)));
  EXPECT_FALSE(field.at(Pixel(1, 1)));
  EXPECT_TRUE(field.peaks({Pixel(319.5, 239.5)}, 16).empty());
}

}  // namespace
}  // namespace glint
