// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>

#include "core/geometry/conic.h"
#include "core/highlight/highlight.h"
#include "core/highlight/iso_contour.h"
#include "highlight_images.h"

namespace glint::streaks_test {
namespace {

/// An ellipse with semi-axes a, b about the origin, on whose upper side a bar of half-width w and length l stands at x = 0.
struct EllipseWithBar {
  double a = 60, b = 25, w = 1.2, l = 20;

  Polyline line(double scale = 1, double step = 0.7) const {
    Polyline result;
    const double foot = std::asin(w / a);  // of the angle at which the bar begins, from the short axis
    const int n = static_cast<int>(2 * M_PI * a / step);
    for (int i = 0; i <= n; ++i) {
      const double t = M_PI / 2 + foot + (2 * M_PI - 2 * foot) * i / n;
      result.points.push_back(scale * Pixel(a * std::cos(t), b * std::sin(t)));
    }
    const double y = b * std::cos(foot);
    for (double s = step; s < l; s += step) result.points.push_back(scale * Pixel(w, y + s));
    for (double s = l; s > 0; s -= step) result.points.push_back(scale * Pixel(-w, y + s));
    return result;
  }
};

Polyline ellipseLine(double a, double b, int n = 600) {
  Polyline line;
  for (int i = 0; i < n; ++i) line.points.push_back(Pixel(a * std::cos(2 * M_PI * i / n), b * std::sin(2 * M_PI * i / n)));
  return line;
}

/// What may be left of the bar: half of the opening disc's radius, its bulge between the corners at the bar's foot, and a sample.
double stumpPx(const StreakCut& cut, double w) {
  const double r = 0.1 * cut.radiusPx;
  return 0.5 * r + r - std::sqrt(r * r - w * w) + 0.3;
}

TEST(WithoutStreaks, NominalABarIsCutOff) {
  const EllipseWithBar shape;
  const StreakCut cut = withoutStreaks(shape.line());
  EXPECT_NEAR(cut.radiusPx, shape.b, 0.5);
  EXPECT_NEAR(cut.cutPx2, 2 * shape.w * (shape.l - 0.5 * stumpPx(cut, shape.w)), 2 * shape.w * stumpPx(cut, shape.w));
  EXPECT_LT(test::largestDistance(cut.line, ellipseLine(shape.a, shape.b)), stumpPx(cut, shape.w));
  const Outcome<Ellipse> with = fitEllipse(shape.line().points), without = fitEllipse(cut.line.points);
  ASSERT_TRUE(with && without);
  EXPECT_NEAR(without->semiAxes.y(), shape.b, 0.15);
  EXPECT_GT(std::abs(with->semiAxes.y() - shape.b), 0.5);  // the bar matters
}

TEST(WithoutStreaks, ScaleTheSameShareIsCutOff) {
  const EllipseWithBar shape;
  const double share = withoutStreaks(shape.line()).cutPx2;
  EXPECT_GT(share, 30);
  for (const double scale : {0.2, 3.0, 30.0}) {
    const StreakCut cut = withoutStreaks(shape.line(scale));
    EXPECT_NEAR(cut.cutPx2 / (scale * scale), share, 0.05 * share) << scale;
  }
}

TEST(WithoutStreaks, NoiseLeavesTheEllipseAlone) {
  const EllipseWithBar shape;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.15);
  Polyline plain = ellipseLine(shape.a, shape.b, 400), barred = shape.line();
  for (Polyline* line : {&plain, &barred})
    for (Pixel& p : line->points) p += Pixel(normal(random), normal(random));
  EXPECT_LT(withoutStreaks(plain).cutPx2, 1e-3 * M_PI * shape.a * shape.b);
  EXPECT_LT(test::largestDistance(withoutStreaks(barred).line, ellipseLine(shape.a, shape.b)), 1.5 + 0.6);
}

TEST(WithoutStreaks, DegenerateShapesStayAsTheyAre) {
  Polyline square, twoDiscs;
  for (const auto& [from, to] : {std::pair(Pixel(0, 0), Pixel(40, 0)), std::pair(Pixel(40, 0), Pixel(40, 40)),
                                 std::pair(Pixel(40, 40), Pixel(0, 40)), std::pair(Pixel(0, 40), Pixel(0, 0))})
    for (int i = 0; i < 40; ++i) square.points.push_back(from + i / 40.0 * (to - from));
  for (int side = 0; side < 2; ++side)  // two discs of radius 20, joined by a neck of half-width 1
    for (int i = 0; i <= 200; ++i) {
      const double foot = std::asin(1.0 / 20), t = foot + (2 * M_PI - 2 * foot) * i / 200 + side * M_PI;
      twoDiscs.points.push_back(Pixel(side == 0 ? -25 : 25, 0) + 20 * Pixel(std::cos(t), std::sin(t)));
    }
  for (const Polyline& line : {square, ellipseLine(90, 6, 2000), ellipseLine(1.5, 1.2), ellipseLine(30, 30)}) {
    const StreakCut cut = withoutStreaks(line);
    EXPECT_EQ(cut.cutPx2, 0);
    EXPECT_EQ(cut.line.points, line.points);
  }
  const double whole = signedArea(twoDiscs);
  EXPECT_NEAR(signedArea(withoutStreaks(twoDiscs).line), whole, 0.02 * whole);
  for (const Polyline& line : {Polyline{}, Polyline{{{1, 1}}}, Polyline{{{0, 0}, {5, 5}, {9, 9}}}}) {
    const StreakCut cut = withoutStreaks(line);
    EXPECT_EQ(cut.line.points, line.points);
    EXPECT_EQ(cut.radiusPx, 0);
  }
}

/// A clipped blob with a streak and a piece of another beside it: the streak is no part of the highlight, the piece none of its
/// own.
TEST(DetectHighlights, StreaksOfAClippedCoreAreCutOffAndNamed) {
  test::Blob blob;
  blob.a = 40, blob.b = 30, blob.angle = 0, blob.height = 4, blob.centre = {100, 80};
  const Image image = test::drawn(240, 160, [&](const Pixel& p) {
    const double streak = std::exp(-std::pow((p.y() - 80) / 1.2, 2)) * (p.x() > 100 && p.x() < 185 ? 0.9 : 0);
    const double piece = std::exp(-std::pow((p.y() - 130) / 1.0, 2) - std::pow((p.x() - 100) / 12, 2));
    return std::min(1.0, blob.at(p) + streak + piece);
  });
  DetectOptions options;
  options.removeBackground = false;
  options.clipValue = 1;
  std::vector<RejectedCandidate> rejected;
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options, &rejected);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  const Highlight& h = found->front();
  EXPECT_TRUE(h.clipped);
  EXPECT_GT(h.cutPx2, 20);
  // Level 0.5 of the clip value, 1/8 of the true peak.
  const double s = std::sqrt(std::log(8.0));
  ASSERT_TRUE(h.ellipse);
  EXPECT_NEAR(h.ellipse->semiAxes.x(), s * blob.a, 1.0);
  EXPECT_NEAR(h.ellipse->semiAxes.y(), s * blob.b, 0.3);
  ASSERT_EQ(rejected.size(), 1u);
  EXPECT_LT((rejected[0].place - Pixel(100, 130)).norm(), 3);
  EXPECT_NE(rejected[0].reason.find("beside a clipped highlight"), std::string::npos);
}

}  // namespace
}  // namespace glint::streaks_test
