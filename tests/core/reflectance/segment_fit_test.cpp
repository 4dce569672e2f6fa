// SPDX-License-Identifier: BSD-3-Clause
// A lamp with a length from contours. The frames integrate over a tube of 3 cm by another quadrature than the fit (24 nodes along
// and 3 across it, every one with its own shadow).
#include <gtest/gtest.h>

#include <cmath>

#include "core/reflectance/contour_evidence.h"
#include "core/reflectance/extended_fit.h"
#include "core/reflectance/fit.h"
#include "tests/core/reflectance/radiance_views.h"

namespace glint {
namespace {

using namespace test;

constexpr double kSegmentRoughness = 0.08, kHalfLength = 0.3;
const Eigen::Vector3d kMiddle = 2 * Eigen::Vector3d(1.2, -1.0, 2.2).normalized();
const Eigen::Vector3d kAxis = Eigen::Vector3d(0.6, 0.8, 0);

RadianceScene longLamp(Synthetic geometry, double scale = 1) {
  geometry.light = {};
  geometry.light.id = "tube";
  geometry.light.lamp = segmentLamp(Eigen::Vector3d(scale * (kMiddle - kHalfLength * kAxis)),
                                    Eigen::Vector3d(scale * (kMiddle + kHalfLength * kAxis)));
  geometry.light.lamp = withRadius(geometry.light.lamp, 0.015 * scale);
  return radianceScene(std::move(geometry), Lobe::TorranceSparrow, kSegmentRoughness);
}

struct Found {
  double centreM = 0, axisDeg = 0, halfLength = 0;
};

Found compared(const RadianceFit& fit, double scale = 1) {
  const auto* const segment = std::get_if<SegmentShape<>>(&fit.lamp.shape);
  const Eigen::Vector3d halfAxis = segment ? segment->halfAxis : Eigen::Vector3d::Zero();
  return {(fit.light().position() / scale - kMiddle).norm(),
          std::asin(std::min(1.0, halfAxis.normalized().cross(kAxis).norm())) * 180 / M_PI, halfAxis.norm() / scale};
}

/// Off by a tenth of the distance and some degrees, as a triangulated light is.
Light guess(double scale = 1) { return Light::at(scale * (1.1 * kMiddle + Eigen::Vector3d(0.08, 0.05, -0.1))); }

Outcome<RadianceFit> search(const std::vector<RadianceView>& views, const Light& light) {
  return searchRadiance(kMicrofacets, views, light, widthOf(Lobe::TorranceSparrow, 1.5 * kSegmentRoughness, 0.5),
                        lampChoices("auto"));
}

// Before the first round moves them, they choose how finely a lamp is sampled.
TEST(ContourEvidence, FeetBeginAtTheMeasuredPixels) {
  const auto evidence = lobe::gatherEvidence(radianceViews(longLamp(ellipsoidScene(6))), 16);
  ASSERT_TRUE(evidence) << evidence.failure().message();
  ASSERT_EQ(evidence->points.size(), 6u * 16);
  for (const lobe::Evidence& e : evidence->points) {
    EXPECT_EQ(e.foot.at.position, e.measured.at.position);
    EXPECT_EQ(e.foot.at.toCamera, e.measured.at.toCamera);
    EXPECT_EQ(e.foot.at.axes.normal, e.measured.at.axes.normal);
  }
}

TEST(FitSegment, NominalLampOfSixtyCentimetres) {
  const RadianceScene s = longLamp(ellipsoidScene(6));
  const auto fit = search(radianceViews(s), guess());
  ASSERT_TRUE(fit) << fit.failure().message();
  const Found f = compared(*fit);
  EXPECT_EQ(fit->lobe, Lobe::TorranceSparrow);
  EXPECT_LT(f.centreM, 5e-3);  // "a few mm"
  EXPECT_LT(f.axisDeg, 0.5);
  EXPECT_NEAR(f.halfLength, kHalfLength, 0.01 * kHalfLength);
  EXPECT_NEAR(fit->roughness, kSegmentRoughness, 0.01 * kSegmentRoughness);  // the tube's own width counts as the lobe's
  EXPECT_LT(fit->rmsPx, 0.02);
}

TEST(FitSegment, ScaleOfTheWorldDoesNotMatter) {
  for (const double scale : {1e-3, 1e3}) {
    Synthetic g = ellipsoidScene(6);
    const RadianceScene s = longLamp(moved(g, Eigen::Isometry3d::Identity(), scale), scale);
    const auto fit = search(radianceViews(s), guess(scale));
    ASSERT_TRUE(fit) << fit.failure().message();
    const Found f = compared(*fit, scale);
    EXPECT_LT(f.centreM, 5e-3) << scale;
    EXPECT_LT(f.axisDeg, 0.5) << scale;
    EXPECT_NEAR(f.halfLength, kHalfLength, 0.01 * kHalfLength) << scale;
  }
}

// One pixel on highlights some 60 px long: the length stays within a tenth, and its uncertainty holds the error.
TEST(FitSegment, NoiseStaysWithinTheUncertainty) {
  const RadianceScene s = longLamp(ellipsoidScene(6));
  int found = 0, inside = 0;
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const auto fit = search(radianceViews(s, 1, seed), guess());
    ASSERT_TRUE(fit) << fit.failure().message();
    const auto* const segment = std::get_if<SegmentShape<>>(&fit->lamp.shape);
    if (!segment) continue;
    ++found;
    const Found f = compared(*fit);
    EXPECT_NEAR(f.halfLength, kHalfLength, 0.1 * kHalfLength) << seed;
    ASSERT_TRUE(fit->uncertainty);
    ASSERT_EQ(fit->uncertainty->root.rows(), 8);
    const Eigen::VectorXd byLength = segment->halfAxis.normalized().transpose() * fit->uncertainty->root.bottomRows(3);
    inside += std::abs(f.halfLength - kHalfLength) < 3 * byLength.norm();
  }
  EXPECT_EQ(found, 2);
  EXPECT_EQ(inside, found);
}

// A point lamp stays one: exact, with noise, and under a lobe that is not its own.
TEST(FitSegment, DegenerateAPointHasNoLength) {
  for (const double noise : {0.0, 0.3, 1.0}) {
    const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kSegmentRoughness);
    const Light near = Light::at(1.05 * s.geometry.light.lamp.position());
    for (const std::vector<Lobe>& lobes : {kMicrofacets, std::vector<Lobe>{Lobe::Ggx}}) {
      const auto fit = searchRadiance(lobes, radianceViews(s, noise, 7), near,
                                      widthOf(Lobe::TorranceSparrow, kSegmentRoughness, 0.5), lampChoices("auto"));
      ASSERT_TRUE(fit) << fit.failure().message();
      if (lobes.size() > 1) {
        EXPECT_FALSE(endsOf(fit->lamp)) << noise;
      }
    }
  }
}

TEST(FitSegment, DegenerateTwoFramesCannotLeaveOneOut) {
  const RadianceScene s = longLamp(ellipsoidScene(2));
  EXPECT_FALSE(fitExtended(SegmentShape<>{}, kMicrofacets, radianceViews(s), nullptr, guess(), 0.1));
}

}  // namespace
}  // namespace glint
