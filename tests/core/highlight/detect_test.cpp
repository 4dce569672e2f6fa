// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <limits>

#include "core/highlight/clipped_flank.h"
#include "core/highlight/highlight.h"
#include "highlight_images.h"

namespace glint {
namespace {

using test::Blob;
using test::drawn;
using test::largestDistance;
using test::meanDistance;

DetectOptions specular() {
  DetectOptions options;
  options.removeBackground = false;
  return options;
}

constexpr double kPeakPx = 1e-3;

/// What marching squares can keep of a level set: linear interpolation over a pixel is off by |f''/(8 f')| (along the short
/// axis), and a chord across one cell, up to sqrt(2) px long, by 2/8 of the curvature of the ellipse's tip.
double marchingSquaresPx(const Blob& blob, double level) {
  const double s = std::sqrt(-std::log(level));
  return std::abs(1 / s - 2 * s) / (8 * blob.b) + 0.25 * blob.a / (blob.b * blob.b * s);
}

TEST(DetectHighlights, Nominal) {
  const Blob blob;
  const Image image = drawn(200, 160, [&](const Pixel& p) { return blob.at(p); });
  for (const double level : {0.5, 0.2, 0.8}) {
    DetectOptions options = specular();
    options.level = level;
    const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
    ASSERT_TRUE(found) << found.failure().message();
    ASSERT_EQ(found->size(), 1u);
    const Highlight& h = found->front();
    EXPECT_LT(largestDistance(h.contour, blob.levelSet(level)), marchingSquaresPx(blob, level)) << level;
    EXPECT_LT((h.peak - blob.centre).norm(), kPeakPx);
    EXPECT_NEAR(h.peakValue, blob.height, 1e-5 * blob.height);  // float pixels
    EXPECT_NEAR(h.areaPx2, -M_PI * std::log(level) * blob.a * blob.b, marchingSquaresPx(blob, level) * length(h.contour));
    ASSERT_TRUE(h.ellipse);
    EXPECT_NEAR(h.ellipse->semiAxes.x(), blob.a * std::sqrt(-std::log(level)), marchingSquaresPx(blob, level));
    EXPECT_NEAR(h.ellipse->angle, blob.angle, 1e-3);
    EXPECT_FALSE(h.clipped);
    EXPECT_FALSE(h.touchesBorder);
    EXPECT_GT(signedArea(h.contour), 0);
    EXPECT_TRUE(h.contour.closed);
  }
}

/// Lights of unequal strength: each contour lies at the level of its own peak, the weaker of two peaks of one light at that of
/// the stronger.
TEST(DetectHighlights, SeparatePeaksHaveTheirOwnLevels) {
  Blob strong, weak, weaker;
  strong.centre = {70, 80};
  weak.centre = {190, 80};
  weak.height = 0.3 * strong.height;
  weaker.centre = {310, 80};
  weaker.height = 0.7 * weak.height;
  const Image image = drawn(380, 160, [&](const Pixel& p) { return strong.at(p) + weak.at(p) + weaker.at(p); });
  const Outcome<std::vector<Highlight>> common = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(common);
  EXPECT_EQ(common->size(), 1u);  // the others stay below half of the strongest
  DetectOptions options = specular();
  options.separatePeaks = true;
  const Outcome<std::vector<Highlight>> own = detectHighlights(image, nullptr, options);
  ASSERT_TRUE(own) << own.failure().message();
  ASSERT_EQ(own->size(), 3u);
  const Blob* blobs[] = {&strong, &weak, &weaker};
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(largestDistance((*own)[i].contour, blobs[i]->levelSet(0.5)), marchingSquaresPx(*blobs[i], 0.5)) << i;
    EXPECT_LT(((*own)[i].peak - blobs[i]->centre).norm(), kPeakPx) << i;
  }
  options.references = {{weaker.centre, weak.height}};
  const Outcome<std::vector<Highlight>> shared = detectHighlights(image, nullptr, options);
  ASSERT_TRUE(shared);
  ASSERT_EQ(shared->size(), 3u);
  const double level = 0.5 / 0.7;
  EXPECT_LT(largestDistance((*shared)[2].contour, weaker.levelSet(level)), marchingSquaresPx(weaker, level));
}

TEST(DetectHighlights, Scale) {
  const Blob blob;
  for (const double factor : {1e-20, 1e-6, 1.0, 1e6, 1e20}) {
    const Image image = drawn(200, 160, [&](const Pixel& p) { return factor * blob.at(p); });
    for (const bool background : {false, true}) {
      DetectOptions options;
      options.removeBackground = background;
      const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
      ASSERT_TRUE(found) << factor << found.failure().message();
      EXPECT_LT((found->front().peak - blob.centre).norm(), kPeakPx) << factor;
      EXPECT_LT(largestDistance(found->front().contour, blob.levelSet(0.5)), marchingSquaresPx(blob, 0.5)) << factor;
      EXPECT_NEAR(found->front().peakValue / factor, blob.height, 2e-4);  // the background fit leaves 1e-4
    }
  }
}

TEST(DetectHighlights, SmallAndLargeBlobs) {
  for (const double a : {3.0, 6.0, 60.0}) {
    Blob blob;
    blob.a = a;
    blob.b = 0.8 * a;
    const Image image = drawn(260, 240, [&](const Pixel& p) { return blob.at(p); });
    const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
    ASSERT_TRUE(found) << a << " " << found.failure().message();
    EXPECT_LT((found->front().peak - blob.centre).norm(), kPeakPx) << a;
    EXPECT_LT(meanDistance(found->front().contour, blob.levelSet(0.5)), marchingSquaresPx(blob, 0.5)) << a;
  }
}

TEST(DetectHighlights, Noise) {
  // 1 % of the peak. A contour point moves by sigma / |gradient| = 0.02 / 0.077 = 0.26 px at most, along the long axis.
  const Blob blob;
  const Image clean = drawn(200, 160, [&](const Pixel& p) { return blob.at(p); });
  double contour = 0, peak = 0;
  constexpr int kSeeds = 20;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Image image = clean;
    test::addNoise(image, 0.02, static_cast<unsigned>(seed));
    const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
    ASSERT_TRUE(found);
    ASSERT_EQ(found->size(), 1u);
    contour += meanDistance(found->front().contour, blob.levelSet(0.5)) / kSeeds;
    peak += (found->front().peak - blob.centre).norm() / kSeeds;
  }
  EXPECT_LT(contour, 0.26);
  EXPECT_LT(peak, 0.3);
}

// Noise turns cells of the grid into saddles. A contour through one was lost, and the highlight with it. The area is that of the
// exact level set: noise of 3 % moves the contour to and fro by about 1 px, and its area by far less than 3 %.
TEST(DetectHighlights, AContourThroughSaddlesIsOneContour) {
  Blob blob;
  blob.a = blob.b = 26;
  for (unsigned seed = 0; seed < 25; ++seed) {
    Image image = drawn(240, 200, [&](const Pixel& p) { return blob.at(p) + 0.25; });
    test::addNoise(image, 0.06, seed);
    const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, {});
    ASSERT_TRUE(found) << seed << ": " << found.failure().message();
    EXPECT_NEAR(found->front().areaPx2 / (M_PI * blob.a * blob.b * std::log(2.0)), 1, 0.03) << seed;
  }
}

TEST(DetectHighlights, DiffuseBackgroundIsRemoved) {
  // A Lambert-like bowl as bright as a third of the highlight: the contour must be that of the highlight alone.
  const Blob blob;
  const Image image = drawn(320, 260, [&](const Pixel& p) {
    const Pixel d = (p - Pixel(180, 60)) / 400.0;
    return blob.at(p) + 0.7 * std::sqrt(1 - d.squaredNorm());
  });
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, {});
  ASSERT_TRUE(found) << found.failure().message();
  ASSERT_EQ(found->size(), 1u);
  const double diameter = std::sqrt(4 * found->front().areaPx2 / M_PI);
  EXPECT_LT(meanDistance(found->front().contour, blob.levelSet(0.5)), 0.001 * diameter);
  EXPECT_NEAR(found->front().peakValue, blob.height, 0.005 * blob.height);
  // Without it the same image gives a much larger contour: the test can fail.
  const Outcome<std::vector<Highlight>> plain = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(plain);
  EXPECT_GT(meanDistance(plain->front().contour, blob.levelSet(0.5)), 0.02 * diameter);
}

TEST(DetectHighlights, TwoBlobsAndALevelRelativeToTheStronger) {
  Blob strong, weak;
  strong.centre = {60.25, 70.5};
  strong.a = strong.b = 14;
  weak.centre = {150.5, 90.25};
  weak.a = weak.b = 12;
  weak.height = 1.4;
  const Image image = drawn(200, 160, [&](const Pixel& p) { return strong.at(p) + weak.at(p); });
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 2u);
  EXPECT_LT(largestDistance((*found)[0].contour, strong.levelSet(0.5)), marchingSquaresPx(strong, 0.5));
  EXPECT_LT(largestDistance((*found)[1].contour, weak.levelSet(0.5 * 2.0 / 1.4)), marchingSquaresPx(weak, 0.5 * 2.0 / 1.4));
  DetectOptions choosy = specular();
  choosy.minRelativePeak = 0.9;
  const Outcome<std::vector<Highlight>> one = detectHighlights(image, nullptr, choosy);
  ASSERT_TRUE(one);
  EXPECT_EQ(one->size(), 1u);
}

TEST(DetectHighlights, MergedBlobsAreOneHighlightWithItsStrongestPeak) {
  Blob strong, weak;
  strong.centre = {80, 80};
  weak.centre = {112, 80};
  strong.a = strong.b = weak.a = weak.b = 14;
  weak.height = 1.9;
  const Image image = drawn(200, 160, [&](const Pixel& p) { return strong.at(p) + weak.at(p); });
  DetectOptions options = specular();
  options.level = 0.3;  // the saddle between them lies at 0.53 of the peak
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_LT((found->front().peak - strong.centre).norm(), 0.5);
  EXPECT_TRUE(contains(found->front().contour, weak.centre));
  options.level = 0.8;
  const Outcome<std::vector<Highlight>> split = detectHighlights(image, nullptr, options);
  ASSERT_TRUE(split);
  EXPECT_EQ(split->size(), 2u);
}

TEST(DetectHighlights, BorderIsClosedAndFlagged) {
  Blob blob;
  blob.centre = {4, 80};
  blob.a = blob.b = 20;
  const Image image = drawn(200, 160, [&](const Pixel& p) { return blob.at(p); });
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->front().touchesBorder);
  EXPECT_LT((found->front().peak - blob.centre).norm(), kPeakPx);
  // Area of a disc cut at 4 px from its centre by the line through the border pixels' centres.
  const double r = 20 * std::sqrt(std::log(2.0)), d = 4;
  EXPECT_NEAR(found->front().areaPx2, M_PI * r * r - (r * r * std::acos(d / r) - d * std::sqrt(r * r - d * d)), 1.0);
}

TEST(DetectHighlights, ClippedIsFlaggedWithTheEllipseCentre) {
  const Blob blob;
  const Image image = drawn(200, 160, [&](const Pixel& p) { return std::min(blob.at(p), 1.5); });
  DetectOptions options = specular();
  options.clipValue = 1.5;
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->front().clipped);
  EXPECT_LT((found->front().peak - blob.centre).norm(), 0.01);
  EXPECT_EQ(found->front().peakValue, 0);
  // The contour is at the level asked for, of the peak that the slope continues.
  ASSERT_TRUE(found->front().flank && found->front().flank->outsideCore);
  EXPECT_LT(meanDistance(found->front().contour, blob.levelSet(0.5)), 2 * found->front().flank->sigmaPx);
}

TEST(DetectHighlights, MaskHidesWhatIsNotGlossy) {
  Blob on, off;
  on.centre = {60, 80};
  off.centre = {150, 80};
  on.a = on.b = off.a = off.b = 14;
  off.height = 9;
  const Image image = drawn(200, 160, [&](const Pixel& p) { return on.at(p) + off.at(p); });
  const Image mask = drawn(200, 160, [](const Pixel& p) { return p.x() < 105 ? 1.0 : 0.0; });
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, &mask, specular());
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_LT(largestDistance(found->front().contour, on.levelSet(0.5)), marchingSquaresPx(on, 0.5));
}

TEST(DetectHighlights, HotPixelsDoNotSetTheLevel) {
  const Blob blob;
  Image image = drawn(200, 160, [&](const Pixel& p) { return blob.at(p); });
  image.at(10, 10) = 1000;
  image.at(180, 30) = 1000;
  image.at(181, 30) = 900;
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(found);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_LT(largestDistance(found->front().contour, blob.levelSet(0.5)), marchingSquaresPx(blob, 0.5));
}

TEST(DetectHighlights, ThreeChannelsAreAveraged) {
  const Blob blob;
  Image image(200, 160, 3);
  for (int y = 0; y < 160; ++y)
    for (int x = 0; x < 200; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(c * blob.at(Pixel(x, y)));
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->front().peakValue, blob.height, 1e-5 * blob.height);
}

struct Case {
  const char* name;
  Image image;
  Reason expected;
};

TEST(DetectHighlights, DegenerateIsRefusedByName) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const Blob blob;
  Image nanInside = drawn(200, 160, [&](const Pixel&p) { return blob.at(p); }), infInside = nanInside, negativeInside = nanInside;
  nanInside.at(100, 80) = nan;
  infInside.at(105, 80) = inf;
  negativeInside.at(100, 85) = -1;
  Image noise(200, 160, 1, 0.5f);
  test::addNoise(noise, 0.05, 3);
  const Case cases[] = {
      {"black", Image(50, 40, 1, 0.f), Reason::NoHighlight},  {"flat", Image(50, 40, 1, 0.7f), Reason::NoHighlight},
      {"all NaN", Image(50, 40, 1, nan), Reason::NotFinite},  {"all infinite", Image(50, 40, 1, inf), Reason::NotFinite},
      {"NaN at the peak", nanInside, Reason::NotFinite},      {"infinity near the peak", infInside, Reason::NotFinite},
      {"negative inside", negativeInside, Reason::NotFinite}, {"noise only", noise, Reason::NoHighlight},
      {"one pixel", Image(1, 1, 1, 1.f), Reason::NoHighlight}};
  for (const Case& c : cases) {
    const Outcome<std::vector<Highlight>> found = detectHighlights(c.image, nullptr, {});
    ASSERT_FALSE(found) << c.name;
    EXPECT_EQ(found.failure().reason, c.expected) << c.name << ": " << found.failure().message();
  }
}

TEST(DetectHighlights, BadPixelsElsewhereDoNotMatter) {
  const Blob blob;
  Image image = drawn(200, 160, [&](const Pixel& p) { return blob.at(p); });
  image.at(5, 5) = std::numeric_limits<float>::quiet_NaN();
  image.at(190, 150) = std::numeric_limits<float>::infinity();
  image.at(190, 10) = -3;
  const Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, specular());
  ASSERT_TRUE(found);
  EXPECT_LT(largestDistance(found->front().contour, blob.levelSet(0.5)), marchingSquaresPx(blob, 0.5));
}

}  // namespace
}  // namespace glint
