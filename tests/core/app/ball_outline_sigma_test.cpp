// SPDX-License-Identifier: BSD-3-Clause
// Whether the standard deviation of a ball's outline covers its error, over many balls whose rims are faint, blurred, hidden in
// part, or beside a reflection.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "core/app/ball_outline.h"
#include "tests/core/app/ball_pictures.h"

namespace glint::ball_outline_sigma_tests {

using namespace ball_pictures;

/// A ball in its room, and the camera's faults.
struct Case {
  BallOutline truth;
  Scene scene;
  double blur = 1, noise = 0;
  int jpeg = 0, photographs = 1;
  double hidden = 0;      ///< share of the height, from below
  double givenSigma = 0;  ///< px, of the outline that is given
};

using Random = std::mt19937;
double between(Random& random, double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

/// A ball in front of even grey that reflects a room of soft lights.
Case plain(Random& random, double least, double most) {
  Case c;
  const double r = between(random, least, most);
  c.truth = {{1.4 * r + between(random, 0, 1), 1.4 * r + between(random, 0, 1)}, r};
  c.scene.principal = c.truth.centre;
  c.scene.balls = {ballOf(c.scene, c.truth)};
  c.scene.mirrors = between(random, 0.3, 0.9);
  const double back = between(random, 0.05, 0.5), slope = between(random, -0.6, 0.6) * back, turn = between(random, 0, 6.28);
  const double front = between(random, 0, 0.2) * back;
  c.scene.light = [=](const Eigen::Vector3d& d) {
    const double side = std::cos(turn) * d.x() + std::sin(turn) * d.y();
    return d.z() > 0.999
               ? back
               : std::max(0.0, front + (back - front) * std::pow(0.5 + 0.5 * d.z(), 4) + slope * side * (0.5 - 0.5 * d.z()));
  };
  c.blur = between(random, 0.6, 1.5);
  c.noise = between(random, 0, 1.5);
  return c;
}

struct Tally {
  int pictures = 0, answered = 0, covered = 0, coveredCentre = 0;
  double worst = 0, meanSigma = 0, meanError = 0, bias = 0, pull = 0, pullCentre = 0;
};

Tally tally(const std::function<Case(Random&)>& make, int pictures, unsigned seed) {
  Tally t;
  Random random(seed);
  for (int i = 0; i < pictures; ++i) {
    const Case c = make(random);
    const int size = static_cast<int>(2.8 * c.truth.radius) + 2;
    cv::Mat linear = render(c.scene, Eigen::Vector2d::Zero(), size, size, 4);
    const int floor = static_cast<int>(c.truth.centre.y() + (1 - 2 * c.hidden) * c.truth.radius);
    if (c.hidden > 0)
      for (int y = floor; y < size; ++y)
        for (int x = 0; x < size; ++x) linear.at<double>(y, x) = 0.2 + 0.2 * between(random, 0, 1);
    std::vector<Image> images;
    for (int k = 0; k < c.photographs; ++k) images.push_back(photograph(linear, c.blur, c.noise, random(), c.jpeg));
    std::normal_distribution<double> normal(0, 1);
    const BallOutline given{c.truth.centre + c.givenSigma * Eigen::Vector2d(normal(random), normal(random)),
                            c.truth.radius + c.givenSigma * normal(random)};
    RefinedOutline byHand;
    byHand.outline = given;
    byHand.covariance.setIdentity();
    const OutlineChoice choice = chosenOutline(refineBallOutline(images, Eigen::Vector2d::Zero(), given), byHand);
    ++t.pictures;
    if (!choice.refused.empty()) continue;
    const RefinedOutline* found = &choice.outline;
    ++t.answered;
    const double error = found->outline.radius - c.truth.radius, sigma = std::sqrt(found->covariance(2, 2));
    const Eigen::Vector2d off = found->outline.centre - c.truth.centre;
    t.covered += std::abs(error) <= 3 * sigma;
    t.coveredCentre += std::abs(off.x()) <= 3 * std::sqrt(found->covariance(0, 0)) &&
                       std::abs(off.y()) <= 3 * std::sqrt(found->covariance(1, 1));
    t.pullCentre = std::max({t.pullCentre, std::abs(off.x()) / std::sqrt(found->covariance(0, 0)),
                             std::abs(off.y()) / std::sqrt(found->covariance(1, 1))});
    t.worst = std::max(t.worst, std::abs(error));
    t.meanSigma += sigma, t.meanError += std::abs(error), t.bias += error;
    t.pull = std::max(t.pull, std::abs(error) / sigma);
  }
  const double n = std::max(1, t.answered);
  t.meanSigma /= n, t.meanError /= n, t.bias /= n;
  return t;
}

using Make = std::function<Case(Random&)>;

void expectCovered(const char* name, const Make& make, int pictures, unsigned seed) {
  const Tally t = tally(make, pictures, seed);
  std::printf(
      "%-26s refined %2d of %2d, radius covered %2d, centre %2d, mean error %.3f px (bias %+.3f, worst %.2f), mean sigma %.3f "
      "px, "
      "worst in sigmas %.1f, %.1f\n",
      name, t.answered, t.pictures, t.covered, t.coveredCentre, t.meanError, t.bias, t.worst, t.meanSigma, t.pull, t.pullCentre);
  EXPECT_GE(t.covered, 0.95 * t.answered) << name;
  EXPECT_GE(t.coveredCentre, 0.95 * t.answered) << name;
}

Make ofRadius(double least, double most) {
  return [=](Random& random) { return plain(random, least, most); };
}

/// The room within an angle of what is behind the ball is as bright as that; beyond it is dark: a circle inside of the rim.
Make ringed(double leastMirrors, double mostMirrors) {
  return [=](Random& random) {
    Case c = plain(random, 40, 80);
    const double share = between(random, 0.95, 0.995), ring = 2 * share * share - 1;
    const double back = between(random, 0.05, 0.5), dark = between(random, 0, 0.2) * back;
    c.scene.mirrors = between(random, leastMirrors, mostMirrors);
    c.scene.light = [=](const Eigen::Vector3d& d) { return d.z() > ring ? back : dark; };
    return c;
  };
}

/// What is behind the ball is nearly as dark as the ball at its rim.
Case faint(Random& random) {
  Case c = plain(random, 40, 80);
  const double back = between(random, 0.0, 0.01), front = between(random, 0.002, 0.05);
  c.scene.mirrors = between(random, 0.5, 1);
  c.scene.light = [=](const Eigen::Vector3d& d) { return back + front * 0.5 * (1 - d.z()); };
  return c;
}

/// The same with another fault.
Make with(const Make& make, const std::function<void(Case&, Random&)>& fault) {
  return [=](Random& random) {
    Case c = make(random);
    fault(c, random);
    return c;
  };
}
void byHand(Case& c, Random&) { c.givenSigma = 1; }
void eight(Case& c, Random&) { c.photographs = 8; }
void noisy(Case& c, Random& random) { c.noise = between(random, 2, 6); }
void jpeg(Case& c, Random&) { c.jpeg = 80; }
void blurred(Case& c, Random& random) { c.blur = between(random, 2, 4); }
void hidden(Case& c, Random& random) { c.hidden = between(random, 0.1, 0.4); }
void clean(Case& c, Random&) { c.noise = 0; }

TEST(BallOutlineSigma, Nominal) {
  expectCovered("nominal", ofRadius(40, 80), 40, 1);
  expectCovered("outline by hand", with(ofRadius(40, 80), byHand), 40, 2);
  expectCovered("8 photographs", with(ofRadius(40, 80), eight), 10, 3);
}

TEST(BallOutlineSigma, Scale) {
  expectCovered("radius 15 to 30", ofRadius(15, 30), 60, 11);
  expectCovered("radius 200 to 300", ofRadius(200, 300), 6, 12);
}

TEST(BallOutlineSigma, Noise) {
  expectCovered("noise of 2 to 6 levels", with(ofRadius(40, 80), noisy), 40, 21);
  expectCovered("the same, 8 photographs", with(with(ofRadius(40, 80), noisy), eight), 10, 22);
  expectCovered("JPEG", with(ofRadius(40, 80), jpeg), 40, 23);
}

/// The given outline is the true one: who has nothing but the edges takes the circle inside for the rim.
TEST(BallOutlineSigma, CircleInside) {
  expectCovered("circle inside, rim seen", ringed(0.4, 0.7), 40, 31);
  expectCovered("the same, rim faint", ringed(0.8, 0.97), 40, 32);
  expectCovered("the same, rim unseen", ringed(1, 1), 40, 33);
  expectCovered("the same, 8 photographs", with(ringed(0.8, 0.97), eight), 10, 35);
}

TEST(BallOutlineSigma, Faint) {
  expectCovered("faint", faint, 40, 41);
  expectCovered("the same without noise", with(faint, clean), 40, 42);
  expectCovered("the same, 8 photographs", with(faint, eight), 10, 43);
  expectCovered("the same, JPEG", with(faint, jpeg), 40, 44);
}

TEST(BallOutlineSigma, BlurredOrHidden) {
  expectCovered("blurred", with(ofRadius(40, 80), blurred), 40, 51);
  expectCovered("hidden in part", with(ofRadius(40, 80), hidden), 40, 52);
  expectCovered("hidden, circle inside", with(ringed(0.5, 0.95), hidden), 40, 53);
}

/// A ball of 60 px whose rim mirrors what is behind it: the circle inside, at 59.1 px, replaced the true outline at a stated
/// 0.005 px.
TEST(BallOutlineSigma, AnOutlineInsideOfTheGivenOneSaysHowFar) {
  Random random(7);
  Case c = ringed(1, 1)(random);
  c.truth = {{84.2, 83.7}, 60};
  c.scene.principal = c.truth.centre;
  c.scene.balls = {ballOf(c.scene, c.truth)};
  c.scene.light = [](const Eigen::Vector3d& d) { return d.z() > 0.94 ? 0.15 : 0.02; };
  const Image image = photograph(render(c.scene, Eigen::Vector2d::Zero(), 168, 168, 6), 1);
  RefinedOutline given;
  given.outline = c.truth;
  given.covariance.setIdentity();
  const OutlineChoice choice = chosenOutline(refineBallOutline(std::span(&image, 1), Eigen::Vector2d::Zero(), c.truth), given);
  EXPECT_TRUE(choice.refused.empty()) << choice.refused;
  EXPECT_NEAR(choice.withinPx, 0.9, 0.1);
  EXPECT_LT(c.truth.radius - choice.outline.outline.radius, 3 * std::sqrt(choice.outline.covariance(2, 2)));
  EXPECT_EQ(chosenOutline(Failure{Reason::TooFewPoints, "nothing"}, given).outline.outline.radius, 60);
}

}  // namespace glint::ball_outline_sigma_tests
