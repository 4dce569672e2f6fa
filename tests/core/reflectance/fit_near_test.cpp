// SPDX-License-Identifier: BSD-3-Clause
// Fits that start from one for other cameras. The truth is the lamp whose exact contours are fitted.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/model.h"
#include "core/reflectance/fit.h"
#include "tests/core/reflectance/radiance_views.h"

namespace glint {
namespace {

using namespace test;

constexpr double kNearRoughness = 0.09;

/// As a calibration that is off: the principal point by a pixel, the focal length by a percent.
std::vector<RadianceView> misread(std::vector<RadianceView> views) {
  for (RadianceView& v : views) {
    v.camera.pixelFromRay.topLeftCorner<2, 2>() *= 1.01;
    v.camera.pixelFromRay.topRightCorner<2, 1>().array() += 1;
  }
  return views;
}

RadianceFit fitFor(const std::vector<RadianceView>& views, const RadianceScene& s, Lobe lobe) {
  const Lamp& truth = s.geometry.light.lamp;
  const Light guess = truth.atInfinity() ? glint::lightOf(truth) : Light::at(1.1 * truth.position());
  const auto fit = searchRadiance({lobe}, views, guess, widthOf(lobe, kNearRoughness, 0.5), lampChoices("auto"));
  if (!fit) throw std::runtime_error(fit.failure().message());
  return *fit;
}

TEST(FitNear, Nominal) {
  for (const Lobe lobe : kMicrofacets) {
    const RadianceScene s = radianceScene(ellipsoidScene(6), lobe, kNearRoughness);
    const std::vector<RadianceView> views = radianceViews(s);
    const RadianceFit off = fitFor(misread(views), s, lobe);
    ASSERT_GT(lightError(off, s), 10 * kRecovered);  // else nothing is shown
    const auto fit = fitNear(kMicrofacets, views, off);
    ASSERT_TRUE(fit) << fit.failure().message();
    EXPECT_EQ(fit->lobe, lobe);
    EXPECT_LT(lightError(*fit, s), kRecovered) << nameOf(lobe);
    EXPECT_NEAR(fit->roughness, kNearRoughness, kRecovered * kNearRoughness) << nameOf(lobe);
  }
}

TEST(FitNear, NominalSizeOfTheLightIsKept) {
  RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, 0.06);
  s.geometry.light.lamp = withRadius(s.geometry.light.lamp, 0.25);
  const std::vector<RadianceView> views = radianceViews(s);
  const auto off = searchRadiance({Lobe::TorranceSparrow}, misread(views), Light::at(1.1 * s.geometry.light.lamp.position()),
                                  widthOf(Lobe::TorranceSparrow, 0.08, 0.5), lampChoices("sphere"));
  ASSERT_TRUE(off && radiusOf(off->lamp) > 0);
  const auto fit = fitNear({Lobe::TorranceSparrow}, views, *off);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_NEAR(radiusOf(fit->lamp), 0.25, 0.02);  // as FitRadiance.NominalSizeOfTheLight
  EXPECT_NEAR(fit->roughness, 0.06, 0.001);
}

TEST(FitNear, ScaleOfTheWorldDoesNotMatter) {
  for (const double scale : {1e-4, 1e4}) {
    const RadianceScene s =
        radianceScene(moved(ellipsoidScene(6), Eigen::Isometry3d::Identity(), scale), Lobe::Ggx, kNearRoughness);
    const std::vector<RadianceView> views = radianceViews(s);
    const auto fit = fitNear(kMicrofacets, views, fitFor(misread(views), s, Lobe::Ggx));
    ASSERT_TRUE(fit) << fit.failure().message();
    EXPECT_LT(lightError(*fit, s), kRecovered) << scale;
  }
}

// As an estimator of its own: the error is that of the noise, by the covariance, not that of the start.
TEST(FitNear, NoiseStaysWithinTheCovariance) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kNearRoughness);
  const RadianceFit off = fitFor(misread(radianceViews(s)), s, Lobe::TorranceSparrow);
  constexpr int kTrials = 12;
  double mahalanobis = 0;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const auto fit = fitNear({Lobe::TorranceSparrow}, radianceViews(s, 0.5, seed), off);
    ASSERT_TRUE(fit) << fit.failure().message();
    const Eigen::Vector3d d = fit->light().position() - s.geometry.light.lamp.position();
    mahalanobis += d.dot(fit->positionCovariance.ldlt().solve(d)) / kTrials;
  }
  // Mean of chi^2 with 3 degrees of freedom: 3, standard deviation sqrt(2 * 3 / 12) = 0.71; three of them.
  EXPECT_GT(mahalanobis, 0.9);
  EXPECT_LT(mahalanobis, 5.2);
}

TEST(FitNear, DegenerateStartSaysSo) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kNearRoughness);
  const std::vector<RadianceView> views = radianceViews(s);
  RadianceFit behind = fitFor(views, s, Lobe::TorranceSparrow);
  behind.lamp = Light::at(-s.geometry.light.lamp.position());
  const auto fit = fitNear(kMicrofacets, views, behind);
  EXPECT_TRUE(!fit || fit->poor || lightError(*fit, s) < kRecovered);
}

// The model searches as ever where the fit that it was handed leads nowhere.
TEST(FitNear, TheModelSearchesWhereTheStartLeadsNowhere) {
  Synthetic scene = ellipsoidScene(6);
  scene.material.emplace().lobe = Lobe::TorranceSparrow;
  scene.material->roughness = kNearRoughness;
  FitInput input = fitInput(scene, {});
  ModelFit behind;
  behind.family = ReflectanceFit{Lobe::TorranceSparrow, kNearRoughness};
  behind.lightEstimate = Light::at(-scene.light.lamp.position());
  input.near = std::make_shared<const ModelFit>(behind);
  const Outcome<ModelFit> fit = modelByName("reflectance").fit(input, {});
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_LT((fit->lightEstimate->position() - scene.light.lamp.position()).norm(),
            kRecovered * scene.light.lamp.position().norm());
  EXPECT_NEAR(fit->as<ReflectanceFit>()->roughness, kNearRoughness, kRecovered * kNearRoughness);
}

}  // namespace
}  // namespace glint
