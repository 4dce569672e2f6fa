// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/specular_separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>

#include "highlight_images.h"

/// Coloured scenes by the dichromatic model in closed form: the truth is the level set of the lobe alone.
namespace glint::specular_separation_test {
namespace {

using test::Blob;
using test::meanDistance;

using Colour = Eigen::Vector3d;
const Colour kLamp(1.0, 0.95, 0.85), kRed(0.6, 0.15, 0.1), kBlue(0.1, 0.2, 0.5), kGreen(0.15, 0.5, 0.15);

struct Painted {
  Blob blob;
  std::function<Colour(const Pixel&)> diffuse;
  std::function<double(const Pixel&)> lobe;  ///< empty = the blob's
  double noise = 0, clip = 0;
};

Image colourImage(const Painted& p, double factor = 1) {
  Image image(260, 200, 3);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, p.noise);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Pixel at(x, y);
      const Colour c = p.diffuse(at) + kLamp * (p.lobe ? p.lobe(at) : p.blob.at(at));
      for (int k = 0; k < 3; ++k) {
        double v = c[k] + (p.noise > 0 ? normal(random) : 0);
        if (p.clip > 0) v = std::min(v, p.clip);
        image.at(x, y, k) = static_cast<float>(factor * std::max(0.0, v));
      }
    }
  return image;
}

Blob blob() {
  Blob b;
  b.centre = {128.3, 97.6};
  b.a = 22;
  b.b = 15;
  b.height = 1;
  return b;
}

/// A shadow's soft border 12 px beside the highlight's middle: no quadratic follows it.
double shading(const Pixel& p) { return 0.25 + 0.6 / (1 + std::exp(-(p.x() - 140) / 6)); }
/// Two paints, meeting under the highlight in an edge a pixel wide.
double leftPaint(const Pixel& p) { return 1 / (1 + std::exp((p.x() - 0.3 * p.y() - 92) / 0.5)); }

struct Answer {
  bool separated = false;
  std::string reason;
  double plainPx = 0, separatedPx = 0;
  std::vector<Highlight> highlights;
  SpecularSeparation separation;
};
Answer answerOf(const Image& image, const Polyline& truth, double clip = 0) {
  DetectOptions options;
  options.clipValue = clip;
  Outcome<std::vector<Highlight>> found = detectHighlights(image, nullptr, options);
  Answer a;
  if (!found) return a.reason = "not found", a;
  // The one on the lobe: bright paint may be one, too.
  std::erase_if(*found, [&](const Highlight& h) { return !contains(h.contour, centroid(truth)); });
  if (found->empty()) return a.reason = "not found", a;
  a.plainPx = meanDistance(found->front().contour, truth);
  a.highlights = *found;
  a.separation = separateHighlights(image, nullptr, options, a.highlights);
  a.separated = a.separation.separated;
  a.reason = a.separation.reason;
  a.separatedPx = meanDistance(a.highlights.front().contour, truth);
  return a;
}

constexpr double kSeparatedPx = 0.05;  // chords of marching squares leave 0.02 px of this lobe

TEST(SeparateHighlights, NominalAShadowAndATexturesEdgeBendNoContour) {
  Painted shadow{blob(), [](const Pixel& p) { return Colour(shading(p) * kRed); }, {}};
  Painted paints{blob(), [](const Pixel& p) { return Colour(leftPaint(p) * kRed + (1 - leftPaint(p)) * kBlue); }, {}};
  Painted both{
      blob(), [](const Pixel& p) { return Colour(shading(p) * (leftPaint(p) * kRed + (1 - leftPaint(p)) * kGreen)); }, {}};
  const char* const names[] = {"soft shadow on red paint", "red beside blue paint", "shadow across red and green paint"};
  int index = 0;
  for (const Painted* const p : {&shadow, &paints, &both}) {
    const Answer a = answerOf(colourImage(*p), p->blob.levelSet(0.5));
    ASSERT_TRUE(a.separated) << a.reason;
    std::printf("separated: %s: %.2f px, separated %.3f px\n", names[index++], a.plainPx, a.separatedPx);
    EXPECT_LT(a.separatedPx, kSeparatedPx);
    EXPECT_GT(a.plainPx, 4 * a.separatedPx);
    EXPECT_LT((a.highlights.front().peak - p->blob.centre).norm(), 0.02);
    EXPECT_NEAR(a.highlights.front().peakValue, kLamp.mean(), 0.2);  // for pictures
  }
}

/// The tail of a long lobe is no background once what is diffuse is gone.
TEST(SeparateHighlights, NominalALongTailIsKept) {
  Painted p{blob(), [](const Pixel& q) { return Colour((0.3 + 0.001 * q.x()) * kRed); }, {}};
  p.lobe = [&](const Pixel& q) { return std::pow(1 - 0.41421356 / std::log(2.0) * std::log(p.blob.at(q)), -2); };
  const Answer a = answerOf(colourImage(p), p.blob.levelSet(0.5));
  ASSERT_TRUE(a.separated) << a.reason;
  std::printf("separated: long tail (GGX) on red paint: %.2f px, separated %.3f px\n", a.plainPx, a.separatedPx);
  EXPECT_LT(a.separatedPx, kSeparatedPx);
  EXPECT_GT(a.plainPx, 3 * a.separatedPx);
}

TEST(SeparateHighlights, ScaleOfValuesDoesNotMatter) {
  const Painted p{blob(), [](const Pixel& q) { return Colour(shading(q) * kRed); }, {}};
  for (const double factor : {1e-6, 1e6}) {
    const Answer a = answerOf(colourImage(p, factor), p.blob.levelSet(0.5));
    ASSERT_TRUE(a.separated) << a.reason;
    EXPECT_LT(a.separatedPx, kSeparatedPx) << factor;
    EXPECT_NEAR(a.highlights.front().peakValue / factor, kLamp.mean(), 0.2);
  }
}

TEST(SeparateHighlights, NoiseIsSaidAndMovesTheContourByWhatItSays) {
  Painted p{blob(), [](const Pixel& q) { return Colour(shading(q) * kRed); }, {}, 0.005};
  const Answer a = answerOf(colourImage(p), p.blob.levelSet(0.5));
  ASSERT_TRUE(a.separated) << a.reason;
  const SeparatedRegion& region = a.separation.regions.front();
  // s = channels . I, so its noise is that of a channel times the length of `channels`, here over a peak of 0.933.
  EXPECT_NEAR(region.noise, p.noise * region.channels.norm() / kLamp.mean(), 0.1 * region.noise);
  // Over the slope on the short axis, 2 sqrt(ln 2) 0.5 / b.
  EXPECT_LT(a.separatedPx, 2 * region.noise * p.blob.a / std::sqrt(std::log(2.0)));
  p.noise = 0.06;
  EXPECT_NE(answerOf(colourImage(p), p.blob.levelSet(0.5)).reason.find("noise"), std::string::npos);
}

TEST(SeparateHighlights, DegenerateScenesAreRefusedInWords) {
  const auto refused = [](const Painted& p, const std::string& word) {
    const Answer a = answerOf(colourImage(p), p.blob.levelSet(0.5), p.clip);
    EXPECT_FALSE(a.separated) << word;
    EXPECT_NE(a.reason.find(word), std::string::npos) << a.reason << " / " << word;
    EXPECT_EQ(a.plainPx, a.separatedPx) << word;  // left as it was
  };
  refused({blob(), [](const Pixel& p) { return Colour(shading(p) * 0.4 * kLamp); }, {}}, "the diffuse colour is the lamp's");
  refused({blob(), [](const Pixel&) { return Colour(0.001, 0.001, 0.002); }, {}}, "no diffuse light around");
  // Paint of the lamp's colour beside a red one, and four paints: the second has no combination, the first none that is free of
  // white.
  refused({blob(), [](const Pixel& p) { return Colour(leftPaint(p) * kRed + (1 - leftPaint(p)) * 0.4 * kLamp); }, {}},
          "the lamp's");
  refused({blob(),
           [](const Pixel& p) {
             const bool down = p.y() > 100;
             return Colour(
                 0.6 * (leftPaint(p) * (down ? kRed : kGreen) + (1 - leftPaint(p)) * (down ? kBlue : Colour(0.5, 0.45, 0.05))));
           },
           {}},
          "the lamp's");
  refused({blob(), [](const Pixel& p) { return Colour(shading(p) * kRed); }, {}, 0, 0.875}, "clipped");
}

TEST(SeparateHighlights, DegenerateImagesAreRefusedInWords) {
  Image grey(260, 200, 1), copies(260, 200, 3);
  const Blob b = blob();
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 260; ++x) {
      grey.at(x, y) = static_cast<float>(0.2 + b.at(Pixel(x, y)));
      for (int k = 0; k < 3; ++k) copies.at(x, y, k) = grey.at(x, y);
    }
  EXPECT_EQ(answerOf(grey, b.levelSet(0.5)).reason, "the image is grey");
  EXPECT_EQ(answerOf(copies, b.levelSet(0.5)).reason, "the image is grey");
  Highlight none;
  std::vector<char> usable(copies.data.size() / 3, 1);
  EXPECT_EQ(separateColours(copies, usable, 0, none, {}).failure().reason, Reason::NotAnEllipse);
  none.ellipse = Ellipse{{128, 98}, {20, 15}, 0};
  std::fill(usable.begin(), usable.end(), 0);
  EXPECT_EQ(separateColours(copies, usable, 0, none, {}).failure().reason, Reason::TooFewPoints);
}

/// The two parts add up to the image, and the specular one is the lobe.
TEST(SpecularPart, IsTheLobeInTheLampsColour) {
  const Painted p{blob(), [](const Pixel& q) { return Colour(shading(q) * kRed); }, {}};
  const Image image = colourImage(p);
  const Answer a = answerOf(image, p.blob.levelSet(0.5));
  ASSERT_TRUE(a.separated);
  const Image part = specularPart(image, a.separation);
  for (const Pixel& q : {Pixel(128, 98), Pixel(140, 90), Pixel(110, 105), Pixel(150, 110)})
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(part.at(static_cast<int>(q.x()), static_cast<int>(q.y()), k), kLamp[k] * p.blob.at(q), 0.12) << q.transpose();
  EXPECT_EQ(part.at(2, 2, 0), 0);
}

}  // namespace
}  // namespace glint::specular_separation_test
