// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/fit.h"

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/reflectance/lobe_terms.h"
#include "tests/core/reflectance/radiance_views.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using namespace test;

constexpr double kRoughness = 0.09;

const std::vector<Lobe> kLobes{Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};

/// About as far off as a triangulated light: a tenth of the distance, and sideways by a part of the lobe's width.
Light nearby(const RadianceScene& s) {
  const Eigen::Vector3d truth = s.geometry.light.lamp.position();
  return Light::at(truth +
                   truth.norm() * (0.1 * truth.normalized() + 0.3 * s.material.roughness * Eigen::Vector3d(0.7, 0.4, -0.6)));
}

TEST(LobeTerms, DerivativesAgreeWithDifferences) {
  using Dual = ceres::Jet<double, 4>;
  const Eigen::Vector3d n = Eigen::Vector3d::UnitZ(), v = Eigen::Vector3d(0.5, 0.2, 1).normalized();
  const Eigen::Vector3d l(-0.7, -0.1, 1.1);
  const double m = 0.3, h = 1e-6;
  const auto value = [&](Lobe lobe, const Eigen::Vector3d& light, double width) {
    return lobe::terms<double>(lobe, width, n, light.normalized().eval(), v).total();
  };
  for (const Lobe lobe : kLobes) {
    Eigen::Matrix<Dual, 3, 1> light;
    for (int i = 0; i < 3; ++i) light(i) = Dual(l(i), i);
    const Eigen::Matrix<Dual, 3, 1> unit = light / sqrt(light.squaredNorm());
    const Dual total = lobe::terms<Dual>(lobe, Dual(m, 3), n, unit, v).total();
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d d = h * Eigen::Vector3d::Unit(i);
      EXPECT_NEAR(total.v(i), (value(lobe, l + d, m) - value(lobe, l - d, m)) / (2 * h), 1e-6) << nameOf(lobe) << " " << i;
    }
    EXPECT_NEAR(total.v(3), (value(lobe, l, m + h) - value(lobe, l, m - h)) / (2 * h), 1e-6) << nameOf(lobe);
  }
}

TEST(FitRadiance, Nominal) {
  for (const Lobe lobe : kLobes) {
    const RadianceScene s = radianceScene(ellipsoidScene(6), lobe, kRoughness);
    const auto fit = fitRadiance(lobe, radianceViews(s), nearby(s), 1.3 * kRoughness);
    ASSERT_TRUE(fit) << nameOf(lobe) << " " << fit.failure().message();
    EXPECT_NEAR(fit->roughness, kRoughness, kRecovered * kRoughness) << nameOf(lobe);
    EXPECT_LT(lightError(*fit, s), kRecovered) << nameOf(lobe);
    EXPECT_LT(fit->rmsPx, 5e-3) << nameOf(lobe);
    EXPECT_FALSE(fit->poor) << nameOf(lobe);
    EXPECT_EQ(radiusOf(fit->lamp), 0) << nameOf(lobe);  // a point light shows no size
  }
}

TEST(FitRadiance, StopsAfterAnIteration) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::Ggx, kRoughness);
  RadianceFitOptions options;
  int asked = 0;
  options.progress = [&](const StageEvent&) { return ++asked < 3; };
  EXPECT_THROW((void)fitRadiance(Lobe::Ggx, radianceViews(s), nearby(s), 1.3 * kRoughness, options), Stopped);
  EXPECT_EQ(asked, 3);
}

TEST(FitRadiance, NominalOnWideLobesAndOtherLevels) {
  for (const double level : {0.2, 0.8})
    for (const double roughness : {0.03, 0.25}) {
      RadianceScene s = radianceScene(sheetScene(0.4), Lobe::TorranceSparrow, roughness);
      s.level = level;
      const auto fit = fitRadiance(Lobe::TorranceSparrow, radianceViews(s), nearby(s), 1.2 * roughness);
      ASSERT_TRUE(fit) << fit.failure().message();
      EXPECT_NEAR(fit->roughness, roughness, 2 * kRecovered * roughness) << level;
    }
}

// Whoever cut the contours, beyond the image or inside it: the cuts are straight and no evidence.
TEST(FitRadiance, NominalOnContoursThatWereCut) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, 0.12);
  std::vector<RadianceView> views = radianceViews(s);
  for (RadianceView& v : views) {
    const double cut = v.peak.x() - 3;
    std::vector<Pixel> kept;
    for (std::size_t i = 0; i < v.contour.size(); ++i) {
      const Pixel &p = v.contour[i], &q = v.contour[(i + 1) % v.contour.size()];
      if (p.x() >= cut) kept.push_back(p);
      if ((p.x() < cut) != (q.x() < cut)) kept.push_back({cut, p.y() + (cut - p.x()) / (q.x() - p.x()) * (q.y() - p.y())});
    }
    v.contour = kept;
  }
  const auto fit = fitRadiance(Lobe::TorranceSparrow, views, nearby(s), 0.1);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_NEAR(fit->roughness, 0.12, kRecovered * 0.12);
  EXPECT_LT(lightError(*fit, s), 2 * kRecovered);
}

TEST(FitRadiance, NominalWithTheLightAtInfinity) {
  RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kRoughness);
  s.geometry.light.lamp = lampTowards(Eigen::Vector3d(0.3, -0.4, 0.8).normalized());
  for (const Light& start : {Light::towards({0.3, -0.45, 0.8}), Light::at({3, -5, 9})}) {
    const auto fit = fitRadiance(Lobe::TorranceSparrow, radianceViews(s), start, kRoughness);
    ASSERT_TRUE(fit) << fit.failure().message();
    const Eigen::Vector3d found = fit->light().directionFrom(Eigen::Vector3d::Zero());
    EXPECT_LT(found.cross(Eigen::Vector3d(s.geometry.light.lamp.centre.head<3>())).norm(), kRecovered);
    EXPECT_NEAR(fit->roughness, kRoughness, kRecovered * kRoughness);
  }
}

// A lamp of a tenth of its distance blurs a narrow lobe visibly. The frames integrate over the lamp by another quadrature (a
// cone of directions) than the fit (points of a disc).
TEST(FitRadiance, NominalSizeOfTheLight) {
  RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, 0.06);
  s.geometry.light.lamp = withRadius(s.geometry.light.lamp, 0.25);
  const auto views = radianceViews(s);
  const auto sized = fitRadiance(Lobe::TorranceSparrow, views, nearby(s), 0.08);
  ASSERT_TRUE(sized) << sized.failure().message();
  EXPECT_NEAR(radiusOf(sized->lamp), 0.25, 0.02);
  EXPECT_NEAR(sized->roughness, 0.06, 0.001);
  RadianceFitOptions point;
  point.lightSize = false;
  const auto blind = fitRadiance(Lobe::TorranceSparrow, views, nearby(s), 0.08, point);
  ASSERT_TRUE(blind);
  EXPECT_EQ(radiusOf(blind->lamp), 0);
  EXPECT_GT(blind->roughness, 0.062);  // takes the lamp's width for the lobe's
  EXPECT_LT(sized->cost, 0.5 * blind->cost);
}

// A lamp about twice as wide as the lobe: what is seen is the lamp, a little blurred.
TEST(FitRadiance, NominalSizeOfALightWiderThanTheLobe) {
  RadianceScene s = radianceScene(ellipsoidScene(4), Lobe::Ggx, 0.03);
  s.geometry.light.lamp = withRadius(s.geometry.light.lamp, 0.25);
  const auto views = radianceViews(s);
  const auto fit = fitRadiance(Lobe::Ggx, views, nearby(s), 0.08);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_NEAR(radiusOf(fit->lamp), 0.25, 0.01);
  EXPECT_NEAR(fit->roughness, 0.03, 0.002);
  EXPECT_LT(fit->rmsPx, 0.02);
}

// A cosine power can hide behind a lamp of any size; sums over one that is many lobes wide took minutes. Bounded by the work, not
// by a clock: a size attempt may take 25 iterations, and a size that survives is at most 2.5 lobe widths.
TEST(FitRadiance, DegenerateLobeDoesNotHideBehindAHugeLamp) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, 0.05);
  for (const Lobe lobe : {Lobe::Phong, Lobe::BlinnPhong}) {
    RadianceFitOptions point;
    point.lightSize = false;
    const auto without = fitRadiance(lobe, radianceViews(s), nearby(s), 0.05, point);
    const auto with = fitRadiance(lobe, radianceViews(s), nearby(s), 0.05);
    ASSERT_TRUE(without && with);
    EXPECT_LE(with->iterations, without->iterations + 2 * 25 + 20);  // the last round of each of the two attempts may end late
    const double distance = s.geometry.light.lamp.position().norm();
    EXPECT_LT(radiusOf(with->lamp) / distance / with->roughness, 2 * 2.5 * 1.1);  // half the angle turns the half vector
  }
}

TEST(FitRadiance, NoiseIsNotTakenForASize) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kRoughness);
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const auto fit = fitRadiance(Lobe::TorranceSparrow, radianceViews(s, 1, seed), nearby(s), kRoughness);
    ASSERT_TRUE(fit);
    EXPECT_EQ(radiusOf(fit->lamp), 0) << seed;
  }
}

// Highlights some 20 px wide: what noise leaves is a large share of their radius, but neighbours do not share it.
TEST(FitRadiance, ThreePixelsOfNoiseAreNoPoorFit) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kRoughness);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const auto fit = fitRadiance(Lobe::TorranceSparrow, radianceViews(s, 3, seed), nearby(s), kRoughness);
    ASSERT_TRUE(fit) << seed << " " << fit.failure().message();
    EXPECT_FALSE(fit->poor) << seed;
    EXPECT_NEAR(fit->roughness, kRoughness, 0.1 * kRoughness) << seed;
  }
}

TEST(FitRadiance, ScaleOfTheWorldDoesNotMatter) {
  const auto run = [](double scale) {
    const RadianceScene s = radianceScene(moved(ellipsoidScene(6), pose(0.7, {0.3, -0.2, 0.5}), scale), Lobe::Ggx, kRoughness);
    const auto fit = fitRadiance(Lobe::Ggx, radianceViews(s), nearby(s), kRoughness);
    if (!fit) throw std::runtime_error(fit.failure().message());
    return std::pair(fit->roughness, Eigen::Vector3d(fit->light().position() / scale));
  };
  const auto [roughness, position] = run(1);
  for (const double scale : {1e-4, 1e4}) {
    const auto [r, p] = run(scale);
    // The contours are traced anew at every scale: their vertices differ, and with them the chords' sagitta.
    EXPECT_NEAR(r, roughness, kRecovered * roughness) << scale;
    EXPECT_LT((p - position).norm(), kRecovered * position.norm()) << scale;
  }
}

TEST(FitRadiance, NoiseStaysWithinTheCovariance) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kRoughness);
  constexpr int kTrials = 24;
  double mahalanobis = 0, roughness = 0;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const auto fit = fitRadiance(Lobe::TorranceSparrow, radianceViews(s, 0.5, seed), nearby(s), kRoughness);
    ASSERT_TRUE(fit) << fit.failure().message();
    const Eigen::Vector3d d = fit->light().position() - s.geometry.light.lamp.position();
    mahalanobis += d.dot(fit->positionCovariance.ldlt().solve(d)) / kTrials;
    roughness += fit->roughness / kTrials;
    EXPECT_NEAR(fit->rmsPx, 0.5, 0.05);  // 432 points: four standard deviations are 0.07
  }
  // Mean of chi^2 with 3 degrees of freedom: 3, standard deviation sqrt(2 * 3 / 24) = 0.5.
  EXPECT_GT(mahalanobis, 1.5);
  EXPECT_LT(mahalanobis, 5);
  // Contours with noise of sigma px around a region of radius R grow by sigma^2 / (2 R); linearised at the measured pixels they
  // would grow by three times that, and the roughness with them (1.5 % here).
  EXPECT_NEAR(roughness, kRoughness, 0.006 * kRoughness);
}

TEST(FitRadiance, DegenerateInputIsNamed) {
  const RadianceScene s = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kRoughness);
  std::vector<RadianceView> off = radianceViews(s);
  for (RadianceView& v : off)
    for (Pixel& p : v.contour) p += Pixel(1e4, 0);
  const auto missed = fitRadiance(Lobe::TorranceSparrow, off, nearby(s), kRoughness);
  ASSERT_FALSE(missed);
  EXPECT_EQ(missed.failure().reason, Reason::PeakOffSurface);

  std::vector<RadianceView> few = radianceViews(s);
  few.resize(1);
  few[0].contour.resize(4);
  const auto starved = fitRadiance(Lobe::TorranceSparrow, few, nearby(s), kRoughness);
  ASSERT_FALSE(starved);
  EXPECT_EQ(starved.failure().reason, Reason::TooFewPoints);

  std::vector<RadianceView> bad = radianceViews(s);
  bad[2].contour[5].x() = std::nan("");
  const auto notFinite = fitRadiance(Lobe::TorranceSparrow, bad, nearby(s), kRoughness);
  ASSERT_FALSE(notFinite);
  EXPECT_EQ(notFinite.failure().reason, Reason::NotFinite);

  // A light inside the ellipsoid lights nothing: another start leads to the answer, the fit says that it is poor, or it fails.
  const auto inside = fitRadiance(Lobe::TorranceSparrow, radianceViews(s), Light::at({0, 0, 0.01}), kRoughness);
  if (inside && !inside->poor) {
    EXPECT_LT(lightError(*inside, s), 0.01);
  }
}

TEST(FitRadiance, OneViewIsEnoughOnACurvedSurfaceAndSaysHowWell) {
  Synthetic one = ellipsoidScene(6);
  one.cameras.resize(1);
  const RadianceScene s = radianceScene(one, Lobe::TorranceSparrow, kRoughness);
  const auto fit = fitRadiance(Lobe::TorranceSparrow, radianceViews(s), nearby(s), kRoughness);
  const RadianceScene six = radianceScene(ellipsoidScene(6), Lobe::TorranceSparrow, kRoughness);
  const auto better = fitRadiance(Lobe::TorranceSparrow, radianceViews(six, 0.1), nearby(six), kRoughness);
  const auto alone = fitRadiance(Lobe::TorranceSparrow, radianceViews(s, 0.1), nearby(s), kRoughness);
  ASSERT_TRUE(fit && better && alone);
  EXPECT_GT(alone->positionCovariance.trace(), 10 * better->positionCovariance.trace());
}

// The residual tells the lobe (method.md section 7): each lobe's contours are explained best by that lobe.
TEST(FitRadiance, TheResidualChoosesTheLobe) {
  for (const Lobe truth : kLobes) {
    const RadianceScene s = radianceScene(ellipsoidScene(6), truth, 0.15);
    const auto views = radianceViews(s);
    double right = 0, wrong = std::numeric_limits<double>::infinity();
    RadianceFitOptions point;
    point.lightSize = false;  // a size would hide a part of a wrong lobe
    for (const Lobe lobe : kLobes) {
      const auto fit = fitRadiance(lobe, views, nearby(s), 0.15, point);
      const double cost = fit ? fit->cost : std::numeric_limits<double>::infinity();
      if (lobe == truth)
        right = cost;
      else
        wrong = std::min(wrong, cost);
    }
    EXPECT_LT(right, 0.1 * wrong) << nameOf(truth);
  }
}

}  // namespace
}  // namespace glint
