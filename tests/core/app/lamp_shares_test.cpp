// SPDX-License-Identifier: BSD-3-Clause
// What each ball's highlights leave free, and what each photograph says of the outlines. Truths: noise that is drawn here, and
// identities of least squares.
#include <gmock/gmock.h>

#include "core/app/lamp_fit.h"
#include "tests/core/app/ball_scene.h"

namespace glint::lamp_shares_tests {
using namespace ball_scene;

/// Two balls and a distant camera: a ball's numbers are its circle, so that its covariance is the prior's as it stands.
struct Circles {
  double px = 1;                             ///< length of everything
  double outlineSigma = 0.4;                 ///< px, of centre and radius
  std::vector<double> peakSigmas{0.1, 0.3};  ///< px, of each ball's highlights
  std::vector<Eigen::Vector3d> balls{{300, 320, 0}, {900, 260, 0}};
  std::vector<double> radii{200, 150};
  int lamps = 6;

  BallPhotographs photographs(unsigned seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    BallPhotographs p;
    for (std::size_t k = 0; k < balls.size(); ++k) {
      RefinedOutline o;
      const double s = px * outlineSigma;
      o.outline.centre = px * balls[k].head<2>() + s * Pixel(normal(random), normal(random));
      o.outline.radius = px * radii[k] + s * normal(random);
      o.covariance = s * s * Eigen::Matrix3d::Identity();
      p.balls.push_back(o);
    }
    for (int i = 0; i < lamps; ++i) {
      const Eigen::Vector3d to = Eigen::Vector3d(std::cos(1.1 * i), std::sin(1.1 * i), -0.8 - 0.1 * i).normalized();
      for (std::size_t k = 0; k < balls.size(); ++k) {
        const Eigen::Vector3d at = mirrorPoint(px * balls[k], px * radii[k], {{0, 0, -1}, true}, {to, true});
        const double s = px * peakSigmas[k];
        p.seen.push_back(seenOn(k, "shot" + std::to_string(i), at.head<2>() + s * Pixel(normal(random), normal(random)), s));
      }
    }
    return p;
  }
};

/// trace(C) of the outlines in units of their prior.
double leftOfPrior(const BallLamps& fit, double sigma) {
  double sum = 0;
  for (const FittedBall& b : fit.balls) sum += b.sigmaPx.squaredNorm() / std::pow(sigma * fit.noiseFactor, 2);
  return sum;
}

double sharesOf(const BallLamps& fit) {
  double sum = 0;
  for (const LampAnswer& lamp : fit.lamps) sum += lamp.outlineShare.value_or(NAN);
  return sum;
}

TEST(BallShares, AddUpToOneWithTheEdges) {
  const Circles a;
  const auto fit = fitBallLamps(a.photographs(1));
  ASSERT_TRUE(fit);
  const double edges = leftOfPrior(*fit, a.outlineSigma) / 6;
  EXPECT_NEAR(sharesOf(*fit) + edges, 1, 1e-9);
  EXPECT_GT(sharesOf(*fit), 0.05);
  for (const LampAnswer& lamp : fit->lamps) EXPECT_GT(*lamp.outlineShare, 0) << lamp.frames[0];
}

TEST(BallShares, DegreesOfFreedomAddUpToThoseOfTheFit) {
  const Circles a;
  const auto fit = fitBallLamps(a.photographs(2));
  ASSERT_TRUE(fit);
  double ofLamps = 0;
  for (const LampAnswer& lamp : fit->lamps) ofLamps += lamp.degreesOfFreedom;
  EXPECT_EQ(ofLamps, fit->degreesOfFreedom);
  const double ofOutlines = 6 - leftOfPrior(*fit, a.outlineSigma);
  EXPECT_NEAR(fit->balls[0].highlightDegreesOfFreedom + fit->balls[1].highlightDegreesOfFreedom + ofOutlines,
              fit->degreesOfFreedom, 1e-9);
  EXPECT_EQ(fit->balls[0].highlights, a.lamps);
}

TEST(BallShares, Scale) {
  Circles small, large;
  large.px = 1e3;
  const auto a = fitBallLamps(small.photographs(3)), b = fitBallLamps(large.photographs(3));
  ASSERT_TRUE(a && b);
  constexpr double kSame = 1e-3;  // of the number: distances of distant lamps are so open that the fits end 1e-4 apart
  for (std::size_t k = 0; k < 2; ++k) {
    const FittedBall &one = a->balls[k], &other = b->balls[k];
    EXPECT_NEAR(other.highlightDegreesOfFreedom / one.highlightDegreesOfFreedom, 1, kSame);
    EXPECT_NEAR(other.highlightResidualPx / one.highlightResidualPx, 1e3, 1e3 * kSame);
  }
  for (std::size_t i = 0; i < a->lamps.size(); ++i) EXPECT_NEAR(*a->lamps[i].outlineShare, *b->lamps[i].outlineShare, kSame);
}

// The squared residuals of a ball over the variance of its noise are as many as its degrees of freedom: over 400 draws of about
// 10 and 2 of them the mean spreads by 2 and 5 %.
TEST(BallShares, NoiseLeavesWhatTheDegreesOfFreedomSay) {
  const Circles a;
  std::vector<double> squares(2), promised(2);
  constexpr int kDraws = 400;
  for (unsigned seed = 1; seed <= kDraws; ++seed) {
    const auto fit = fitBallLamps(a.photographs(seed));
    ASSERT_TRUE(fit);
    for (std::size_t k = 0; k < 2; ++k) {
      const FittedBall& b = fit->balls[k];
      squares[k] += b.highlights * std::pow(b.highlightResidualPx / a.peakSigmas[k], 2) / kDraws;
      promised[k] += b.highlightDegreesOfFreedom / kDraws;
    }
  }
  EXPECT_GT(promised[1], 2 * promised[0]);  // the ball with the larger noise has the larger residuals
  for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(squares[k] / promised[k], 1, 0.2) << k;
}

TEST(BallShares, DegenerateOneBallLeavesNothingFree) {
  Circles a;
  a.balls.resize(1);
  const auto fit = fitBallLamps(a.photographs(4));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->balls[0].highlightDegreesOfFreedom, 0, 1e-9);
  for (const LampAnswer& lamp : fit->lamps) {
    EXPECT_EQ(lamp.degreesOfFreedom, 0);
    EXPECT_NEAR(*lamp.outlineShare, 0, 1e-12);
  }
  // Outlines that are taken as they are learn nothing from the highlights.
  const auto given = fitBallLamps(Circles().photographs(4), false);
  ASSERT_TRUE(given);
  EXPECT_EQ(sharesOf(*given), 0);
  EXPECT_NEAR(given->balls[0].highlightDegreesOfFreedom + given->balls[1].highlightDegreesOfFreedom, given->degreesOfFreedom,
              1e-9);
}

}  // namespace glint::lamp_shares_tests
