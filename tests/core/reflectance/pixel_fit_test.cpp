// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/pixel_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "core/reflectance/pixel_problem.h"
#include "core/surface/analytic.h"
#include "tests/core/surface/surfaces.h"

/// Pixels of a glossy sphere under a point lamp. Everything that makes them stands here: the ray, the sphere, the normal and the
/// radiance in one line each (Walter et al. 2007), so that no code of the fit decides what is right.
namespace glint {
namespace {

struct Scene {
  double scale = 1;  ///< of all lengths; the sphere has a radius of 0.5 of them
  Eigen::Vector3d lamp{0.9, -0.5, 2.2};
  Lobe lobe = Lobe::Ggx;
  double roughness = 0.12;
  double albedo = 0;   ///< of a matt base; 1 shows about half the peak's radiance
  double ambient = 0;  ///< that the base shows everywhere, share of the peak
  double tilt = 0;     ///< slope of a further light across the image, share of the peak over its width
  double noise = 0;    ///< standard deviation, share of the peak
  double clip = 0;     ///< share of the peak at which values end; 0 = never
  double blurPx = 0;
  int views = 4;
  int sub = 3;  ///< samples across a pixel
  unsigned seed = 1;
};

constexpr int kWidth = 220, kHeight = 200;
constexpr double kFocal = 620;

Camera cameraOf(const Scene& s, int i) {
  const double a = -0.5 + 1.1 * i / std::max(1, s.views - 1);
  Camera c = test::lookAt(s.scale * Eigen::Vector3d(2.4 * std::sin(a), 0.4 - 0.3 * std::cos(2 * a), 2.4 * std::cos(a)),
                          s.scale * Eigen::Vector3d(0.1, -0.06, 0.3));
  c.width = kWidth;
  c.height = kHeight;
  c.pixelFromRay << kFocal, 0, (kWidth - 1) / 2.0, 0, kFocal, (kHeight - 1) / 2.0, 0, 0, 1;
  return c;
}

/// Specular radiance and the matt base's at the sphere along a ray, up to the lamp's strength; nothing beside the sphere.
struct Shade {
  double specular = 0, matt = 0;
};
std::optional<Shade> shade(const Scene& s, const Ray& ray) {
  const double radius = 0.5 * s.scale, b = ray.origin.dot(ray.direction), c = ray.origin.squaredNorm() - radius * radius;
  if (b * b < c) return std::nullopt;
  const Eigen::Vector3d x = ray.at(-b - std::sqrt(b * b - c)), n = x / radius, v = -ray.direction, to = s.scale * s.lamp - x,
                        l = to.normalized();
  const double r2 = to.squaredNorm() / (s.scale * s.scale), cosL = n.dot(l), cosV = n.dot(v), m = s.roughness;
  if (cosL <= 0 || cosV <= 0) return Shade{};
  const Eigen::Vector3d h = (l + v).normalized();
  const double cosH = n.dot(h), tan2 = 1 / (cosH * cosH) - 1, pi = std::numbers::pi;
  const auto tan = [](double cosine) { return std::sqrt(1 - cosine * cosine) / cosine; };
  double d, lambda = 0;
  if (s.lobe == Lobe::Ggx) {
    d = m * m / (pi * std::pow(cosH, 4) * std::pow(m * m + tan2, 2));
    for (const double cosine : {cosL, cosV}) lambda += (std::sqrt(1 + std::pow(m * tan(cosine), 2)) - 1) / 2;
  } else {
    d = std::exp(-tan2 / (m * m)) / (pi * m * m * std::pow(cosH, 4));
    for (const double cosine : {cosL, cosV}) {
      const double a = 1 / (m * tan(cosine));
      lambda += (std::erf(a) - 1) / 2 + std::exp(-a * a) / (2 * a * std::sqrt(pi));
    }
  }
  const double peak = 1 / (4 * pi * m * m);
  return Shade{d / (1 + lambda) / (4 * cosV) / r2 / peak, cosL / r2};
}

struct Photograph {
  Image image{kWidth, kHeight, 1};
  Highlight highlight;  ///< ellipse from the pixels above half the peak: a start, no more
  double top = 0;       ///< the specular part's peak
};
/// As single precision keeps it, so that pixels at it count as clipped.
double clipValue(const Scene& s, double top) { return float(s.clip * top); }

Photograph photograph(const Scene& s, int view) {
  const Camera camera = cameraOf(s, view);
  Photograph p;
  std::vector<double> value(kWidth * kHeight, 0), gloss(value);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int k = 0; k < s.sub * s.sub; ++k) {
        const Pixel at(x + (k % s.sub + 0.5) / s.sub - 0.5, y + (k / s.sub + 0.5) / s.sub - 0.5);
        if (const std::optional<Shade> here = shade(s, camera.ray(at))) {
          gloss[y * kWidth + x] += here->specular / double(s.sub * s.sub);
          value[y * kWidth + x] += (here->specular + s.albedo * here->matt) / double(s.sub * s.sub);
        }
      }
  const auto top = std::max_element(gloss.begin(), gloss.end());
  p.top = *top;
  if (s.blurPx > 0)
    for (const int stride : {1, kWidth}) {
      const std::vector<double> before = value;
      for (int i = 0; i < kWidth * kHeight; ++i) {
        double sum = 0, weight = 0;
        for (int d = -int(4 * s.blurPx); d <= int(4 * s.blurPx); ++d) {
          const int j = std::clamp(i + d * stride, 0, kWidth * kHeight - 1);
          const double w = std::exp(-0.5 * d * d / (s.blurPx * s.blurPx));
          sum += w * before[j];
          weight += w;
        }
        value[i] = sum / weight;
      }
    }
  std::mt19937_64 engine(100 * s.seed + view);
  std::normal_distribution<double> gauss(0, 1);
  int above = 0;
  Pixel sum(0, 0);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      double v = value[y * kWidth + x] + p.top * (s.ambient + s.tilt * x / kWidth + s.noise * gauss(engine));
      if (s.clip > 0) v = std::min(v, clipValue(s, p.top));
      p.image.at(x, y) = float(std::max(0.0, v));
      if (gloss[y * kWidth + x] < 0.5 * p.top) continue;
      ++above;
      sum += Pixel(x, y);
    }
  const double radius = std::sqrt(above / std::numbers::pi);
  p.highlight.light = "lamp";
  p.highlight.ellipse = Ellipse{sum / above, {radius, radius}, 0};
  p.highlight.peak = sum / above;
  for (int i = 0; i < 60; ++i)
    p.highlight.contour.points.push_back(sum / above + radius * Pixel(std::cos(i * 0.1047), std::sin(i * 0.1047)));
  p.highlight.contour.closed = true;
  p.highlight.areaPx2 = above;
  p.highlight.peakValue = p.top;
  return p;
}

std::shared_ptr<const Surface> surfaceOf(const Scene& s) {
  AnalyticSpec sphere;
  sphere.type = "sphere";
  sphere.radius = 0.5 * s.scale;
  return makeAnalytic(sphere);
}

std::vector<PixelPatch> patchesOf(const Scene& s) {
  std::vector<PixelPatch> patches;
  const std::shared_ptr<const Surface> surface = surfaceOf(s);
  for (int i = 0; i < s.views; ++i) {
    const Photograph p = photograph(s, i);
    const LinearPixels pixels = linearPixels(p.image, nullptr, clipValue(s, p.top));
    Outcome<PixelPatch> patch = pixelPatch(pixels, cameraOf(s, i), *surface, i, p.highlight, {});
    if (!patch) throw std::runtime_error(patch.failure().message());
    patches.push_back(*std::move(patch));
  }
  return patches;
}

const std::vector<Lobe> kAll{Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};

Outcome<PixelFit> fitted(const Scene& s, const std::vector<Lobe>& lobes = kAll, const PixelFitOptions& options = {}) {
  const std::vector<PixelPatch> patches = patchesOf(s);
  std::vector<const PixelPatch*> pointers;
  for (const PixelPatch& p : patches) pointers.push_back(&p);
  // A start as contours give it: ten degrees and a third of the distance off, roughness off by half.
  const Light start = Light::at(s.scale * (0.7 * s.lamp + Eigen::Vector3d(0.2, 0.2, 0)));
  return fitPixels(lobes, pointers, start, 1.5 * s.roughness, options);
}

double offBy(const PixelFit& fit, const Scene& s) {
  return (fit.model.lamp.position() / s.scale - s.lamp).norm() / s.lamp.norm();
}

// What nine samples a pixel and single precision leave of the light, m and the lobe.
constexpr double kLightTolerance = 2e-3, kRoughnessTolerance = 2e-3;

// 0: good; 1: one channel at the clip value; 2: infinite; 3: not a number; 4: below zero; 5: outside the mask.
TEST(LinearPixels, SaysWhichPixelsCountAndWhichAreClipped) {
  const float infinite = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  Image image(6, 1, 3), mask(6, 1, 1);
  image.data = {0.1f, 0.2f, 0.6f, 0.5f, 1, 0.6f, infinite, 0, 0, nan, 0, 0, -0.1f, 0.1f, 0.3f, 0.3f, 0.3f, 0.3f};
  mask.data = {1, 1, 1, 1, 1, 0};
  const LinearPixels p = linearPixels(image, &mask, 1);
  EXPECT_EQ(p.usable, (std::vector<char>{1, 0, 0, 0, 0, 0}));
  EXPECT_EQ(p.clipped, (std::vector<char>{0, 1, 1, 0, 0, 0}));
  EXPECT_NEAR(p.value.data[0], 0.3, 1e-6);  // the mean of the channels
  EXPECT_EQ(p.value.data[2], 0.f);
  // Values that never end are never clipped, an infinite one neither.
  const LinearPixels open = linearPixels(image, nullptr, 0);
  EXPECT_EQ(open.usable, (std::vector<char>{1, 1, 0, 0, 0, 1}));
  EXPECT_EQ(open.clipped, std::vector<char>(6, 0));
}

TEST(PixelFit, FindsLightRoughnessAndLobe) {
  for (const Lobe lobe : {Lobe::Ggx, Lobe::TorranceSparrow})
    for (const double albedo : {0.0, 0.4}) {
      Scene s;
      s.lobe = lobe;
      s.albedo = albedo;
      const Outcome<PixelFit> fit = fitted(s);
      ASSERT_TRUE(fit) << fit.failure().message();
      EXPECT_EQ(fit->model.lobe, lobe) << nameOf(fit->model.lobe);
      EXPECT_NEAR(fit->model.roughness / s.roughness, 1, kRoughnessTolerance);
      EXPECT_LT(offBy(*fit, s), kLightTolerance);
      EXPECT_FALSE(fit->poor);
      EXPECT_TRUE(fit->model.lamp.isPoint());
      EXPECT_LT(fit->model.blurPx(), 0.2);  // nine samples a pixel are not quite the pixel's mean
    }
}

TEST(PixelFit, StopsBetweenTwoLooksAtThePixels) {
  const Scene s;
  PixelFitOptions options;
  int asked = 0;
  options.progress = [&](const StageEvent&) { return ++asked < 5; };
  EXPECT_THROW((void)fitted(s, {Lobe::Ggx}, options), Stopped);
  EXPECT_EQ(asked, 5);
}

TEST(PixelFit, AMattBaseIsNamed) {
  Scene s;
  s.albedo = 0.4;
  const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx});
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->background, BackgroundKind::Cosine) << nameOf(fit->background);
}

Scene overexposedBaseInARoom() {
  Scene s;
  s.albedo = 0.15;
  s.ambient = 0.03;
  s.clip = 1.0 / 3;
  return s;
}

TEST(PixelFit, AMattBaseInARoomIsNamedAndDoesNotMoveTheLamp) {
  const Scene s = overexposedBaseInARoom();
  const Outcome<PixelFit> fit = fitted(s);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->background, BackgroundKind::AmbientCosine) << nameOf(fit->background);
  EXPECT_EQ(fit->model.lobe, Lobe::Ggx);
  EXPECT_NEAR(fit->model.roughness / s.roughness, 1, 2 * kRoughnessTolerance);
  EXPECT_LT(offBy(*fit, s), 2 * kLightTolerance);
}

TEST(PixelFit, AMattBaseInARoomOfAnyScale) {
  Scene unit = overexposedBaseInARoom();
  unit.views = 3;
  const Outcome<PixelFit> reference = fitted(unit, {Lobe::Ggx});
  ASSERT_TRUE(reference);
  for (const double scale : {1e-3, 1e3}) {
    Scene s = unit;
    s.scale = scale;
    const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx});
    ASSERT_TRUE(fit) << scale;
    EXPECT_EQ(fit->background, reference->background) << scale;
    EXPECT_LT((fit->model.lamp.position() / scale - reference->model.lamp.position()).norm(), 1e-5) << scale;
  }
}

TEST(PixelFit, NoiseOnAMattBaseInARoom) {
  Scene s = overexposedBaseInARoom();
  s.noise = 0.002;
  const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx});
  ASSERT_TRUE(fit) << fit.failure().message();
  const Eigen::Vector3d error = fit->model.lamp.position() - s.lamp;
  // 99.99 % of a chi-squared with three degrees of freedom.
  EXPECT_LT(error.dot(fit->positionCovariance.inverse() * error), 21.1);
}

// Both coefficients where there is a constant alone, and where there is nothing.
TEST(PixelFit, ABaseWithoutShadingLeavesTheLamp) {
  for (const double ambient : {0.0, 0.03}) {
    Scene s;
    s.ambient = ambient;
    PixelFitOptions options;
    options.background = BackgroundKind::AmbientCosine;
    const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx}, options);
    ASSERT_TRUE(fit) << fit.failure().message();
    EXPECT_LT(offBy(*fit, s), kLightTolerance) << ambient;
  }
}

TEST(PixelFit, AFurtherLightAcrossTheImageDoesNotMoveTheLamp) {
  Scene s;
  s.tilt = 0.2;
  const Outcome<PixelFit> fit = fitted(s);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->model.lobe, Lobe::Ggx);
  EXPECT_LT(offBy(*fit, s), kLightTolerance);
}

TEST(PixelFit, ClippedPixelsAreLeftOut) {
  Scene s;
  s.clip = 0.35;
  const Outcome<PixelFit> fit = fitted(s);
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_EQ(fit->model.lobe, Lobe::Ggx);
  EXPECT_NEAR(fit->model.roughness / s.roughness, 1, 2 * kRoughnessTolerance);
  EXPECT_LT(offBy(*fit, s), 2 * kLightTolerance);
}

TEST(PixelFit, ABlurIsFound) {
  Scene s;
  s.blurPx = 3;
  const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx});
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_NEAR(fit->model.blurPx(), s.blurPx, 0.1);
  EXPECT_NEAR(fit->model.roughness / s.roughness, 1, 0.01);
}

// Some renderers give every pixel the radiance at its centre. Taken for a mean, such pixels make small lobes too narrow.
TEST(PixelFit, PixelsThatAreSamplesAreTold) {
  Scene s;
  s.sub = 1;
  s.roughness = 0.03;
  const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx});
  ASSERT_TRUE(fit) << fit.failure().message();
  EXPECT_NEAR(fit->model.blurVariance, -1.0 / 12, 0.02);
  EXPECT_NEAR(fit->model.roughness / s.roughness, 1, kRoughnessTolerance);
}

// The same pixels at any scale of the scene: the answer scales to round-off of the pixels.
TEST(PixelFit, Scale) {
  Scene unit;
  unit.views = 3;
  const Outcome<PixelFit> reference = fitted(unit, {Lobe::Ggx});
  ASSERT_TRUE(reference);
  for (const double scale : {1e-3, 1e3}) {
    Scene s = unit;
    s.scale = scale;
    const Outcome<PixelFit> fit = fitted(s, {Lobe::Ggx});
    ASSERT_TRUE(fit) << scale;
    EXPECT_LT((fit->model.lamp.position() / scale - reference->model.lamp.position()).norm(), 1e-5) << scale;
    EXPECT_NEAR(fit->model.roughness, reference->model.roughness, 1e-7) << scale;
  }
}

// Independent noise of a hundredth of the peak on every pixel: errors average out, and the covariance covers them.
TEST(PixelFit, Noise) {
  double worst = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Scene s;
    s.noise = 0.01;
    s.views = 3;
    s.seed = seed;
    const Outcome<PixelFit> fit = fitted(s);
    ASSERT_TRUE(fit) << fit.failure().message();
    EXPECT_EQ(fit->model.lobe, Lobe::Ggx) << seed;
    const Eigen::Vector3d error = fit->model.lamp.position() - s.lamp;
    worst = std::max(worst, error.norm() / s.lamp.norm());
    // 99.99 % of a chi-squared with three degrees of freedom.
    EXPECT_LT(error.dot(fit->positionCovariance.inverse() * error), 21.1) << seed;
  }
  EXPECT_LT(worst, 0.03);
}

TEST(PixelFit, DegeneratePixelsAreRefused) {
  Scene s;
  s.views = 2;
  const std::shared_ptr<const Surface> surface = surfaceOf(s);
  Photograph p = photograph(s, 0);
  const Camera camera = cameraOf(s, 0);
  const auto patchOf = [&](const Image& image, const Highlight& h, double clip = 0) {
    return pixelPatch(linearPixels(image, nullptr, clip), camera, *surface, 0, h, {});
  };
  Image none(kWidth, kHeight, 1, std::nanf(""));
  EXPECT_EQ(patchOf(none, p.highlight).failure().reason, Reason::TooFewPoints);
  EXPECT_EQ(patchOf(Image(kWidth, kHeight, 1, 0.f), p.highlight).failure().reason, Reason::NoHighlight);
  EXPECT_EQ(patchOf(Image(kWidth, kHeight, 1, 1.f), p.highlight, 0.5).failure().reason, Reason::TooFewPoints);
  Highlight away = p.highlight;  // beside the sphere
  away.ellipse->centre = Pixel(-3000, -3000);
  EXPECT_EQ(patchOf(p.image, away).failure().reason, Reason::TooFewPoints);
  away.ellipse.reset();
  EXPECT_EQ(patchOf(p.image, away).failure().reason, Reason::NotSupported);

  // A flat image has no highlight: whatever is fitted, it must not pass as an explanation with a strength.
  const Outcome<PixelPatch> flat = patchOf(Image(kWidth, kHeight, 1, 1.f), p.highlight);
  ASSERT_TRUE(flat);
  const Outcome<PixelFit> fit = fitPixels({Lobe::Ggx}, {&*flat}, Light::at(s.lamp), 0.1);
  EXPECT_TRUE(!fit || fit->poor);
}

// Area of {specular > q peak} counted on a fine grid of its own, px^2.
double trueArea(const Scene& s, int view, double q) {
  constexpr int kFine = 8;
  const Camera camera = cameraOf(s, view);
  std::vector<double> values;
  double top = 0;
  for (int y = 0; y < kHeight * kFine; ++y)
    for (int x = 0; x < kWidth * kFine; ++x)
      if (const auto here = shade(s, camera.ray(Pixel((x + 0.5) / kFine - 0.5, (y + 0.5) / kFine - 0.5)))) {
        values.push_back(here->specular);
        top = std::max(top, here->specular);
      }
  return double(std::count_if(values.begin(), values.end(), [&](double v) { return v > q * top; })) / (kFine * kFine);
}

// A background that knows nothing of the lobe takes GGX's tail for its own and loses 2 % of the radius. With the lobe's
// background the contour lies where the radiance is half its peak.
TEST(ContourWithLobe, LiesAtItsLevelOnALongTailedLobe) {
  for (const double albedo : {0.0, 0.4}) {
    Scene s;
    s.albedo = albedo;
    const Photograph p = photograph(s, 1);
    DetectOptions options;
    const Outcome<std::vector<Highlight>> found = detectHighlights(p.image, nullptr, options);
    ASSERT_TRUE(found);
    std::vector<Highlight> before{found->front()};
    const LobeModel model{s.lobe, s.roughness, Light::at(s.lamp), 0};
    const Outcome<std::vector<Highlight>> again =
        contourWithLobe(linearPixels(p.image, nullptr, 0), cameraOf(s, 1), *surfaceOf(s), 1, before, {}, model,
                        albedo > 0 ? BackgroundKind::Cosine : BackgroundKind::None, options);
    ASSERT_TRUE(again) << again.failure().message();
    const double radius = std::sqrt(trueArea(s, 1, 0.5));
    EXPECT_NEAR(std::sqrt(again->front().areaPx2) / radius, 1, 1e-3) << albedo;
    EXPECT_LT(std::sqrt(before.front().areaPx2) / radius, 0.99) << "this is what is mended";
  }
}

// Noise of 2 % of the peak on every pixel. At a vertex of a contour between two such pixels the true radiance is off by about 0.8
// x 2 % (the mean size of a normal deviate). The lobe keeps the shape, so that a Gaussian window of a thirtieth of the radius,
// 0.65 px here, may average more pixels: white noise falls to 1 / (2 sqrt(pi) 0.65) = 0.43 of that.
TEST(ContourWithLobe, NoiseOfSinglePixelsIsEvenedOut) {
  Scene s;
  s.roughness *= 2;
  s.noise = 0.02;
  const Photograph p = photograph(s, 1);
  const Camera camera = cameraOf(s, 1);
  const LobeModel model{s.lobe, s.roughness, Light::at(s.lamp), 0};
  DetectOptions options;
  const Outcome<std::vector<Highlight>> again = contourWithLobe(linearPixels(p.image, nullptr, 0), camera, *surfaceOf(s), 1,
                                                                {p.highlight}, {}, model, BackgroundKind::None, options);
  ASSERT_TRUE(again) << again.failure().message();
  double sum = 0;
  for (const Pixel& at : again->front().contour.points) {
    const std::optional<Shade> here = shade(s, camera.ray(at));
    ASSERT_TRUE(here);
    sum += std::abs(here->specular / p.top - 0.5);
  }
  EXPECT_LT(sum / double(again->front().contour.points.size()), 0.55 * 0.8 * s.noise);
}

TEST(ContourWithLobe, ALobeThatExplainsNothingIsRefused) {
  Scene s;
  const Photograph p = photograph(s, 1);
  const LobeModel wrong{Lobe::Ggx, 0.02, Light::at(Eigen::Vector3d(-0.9, 0.9, 2)), 0};
  EXPECT_FALSE(contourWithLobe(linearPixels(p.image, nullptr, 0), cameraOf(s, 1), *surfaceOf(s), 1, {p.highlight}, {}, wrong,
                               BackgroundKind::None, DetectOptions{}));
}

// Clipped at a third of the peak: the contour at half the peak lies in clipped pixels, and the highlight says at which level it
// was found.
TEST(ContourWithLobe, AClippedHighlightKeepsItsContourAndNamesItsLevel) {
  Scene s;
  s.clip = 0.35;
  const Photograph p = photograph(s, 1);
  DetectOptions options;
  options.clipValue = clipValue(s, p.top);
  const Outcome<std::vector<Highlight>> found = detectHighlights(p.image, nullptr, options);
  ASSERT_TRUE(found);
  ASSERT_TRUE(found->front().clipped);
  const LobeModel model{s.lobe, s.roughness, Light::at(s.lamp), 0};
  const Outcome<std::vector<Highlight>> again =
      contourWithLobe(linearPixels(p.image, nullptr, options.clipValue), cameraOf(s, 1), *surfaceOf(s), 1, {found->front()}, {},
                      model, BackgroundKind::None, options);
  ASSERT_TRUE(again) << again.failure().message();
  const Highlight& h = again->front();
  EXPECT_TRUE(h.clipped);
  ASSERT_TRUE(h.trueLevel);
  // The contour that was found lies where the radiance is this share of the true peak.
  const double radius = std::sqrt(h.areaPx2);
  EXPECT_NEAR(radius / std::sqrt(trueArea(s, 1, *h.trueLevel)), 1, 0.03);
}

// ---- A step that leaves the lamp and the lobe as they are takes the sharp image and the background's terms from before. The
// same step with the roughness moved by one unit in the last place computes all anew.

/// Largest difference between the two ways, share of the largest entry.
double keptAgainstAnew(patch::PixelProblem& problem, const patch::State& at, double stepPx2) {
  patch::State kept = at;
  kept.blurVariance += stepPx2;
  patch::State anew = kept;
  anew.logRoughness = std::nextafter(anew.logRoughness, 0.0);
  Eigen::VectorXd a(problem.residuals()), b(problem.residuals());
  problem.differences(kept, stepPx2, a.data(), 1);
  problem.differences(anew, stepPx2, b.data(), 1);
  EXPECT_GT(b.cwiseAbs().maxCoeff(), 1e-6) << "the blur changes nothing";
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

TEST(PixelProblem, AStepOfTheBlurEqualsOneThatComputesAllAnew) {
  Scene s;
  s.albedo = 0.15;
  const std::vector<PixelPatch> patches = patchesOf(s);
  std::vector<const PixelPatch*> pointers;
  for (const PixelPatch& p : patches) pointers.push_back(&p);
  const patch::Normalised evidence = patch::normalised(pointers);
  constexpr double kStepPx2 = 0.01;
  constexpr double kRoundOff = 1e-8;  // of one unit in the last place of the roughness, over the step
  for (const BackgroundKind kind : {BackgroundKind::SlopedCosine, BackgroundKind::Quadratic}) {
    patch::PixelProblem problem(evidence, s.lobe, kind);
    std::vector<double> residuals(static_cast<std::size_t>(problem.residuals()));
    patch::State at;
    at.lamp = normalised(lampAt(s.lamp), evidence.origin, evidence.scale);
    at.lamp.shape = SphereShape<>{1e-4};
    at.logRoughness = std::log(s.roughness);
    problem.chooseRule(at);
    ASSERT_TRUE(problem.residualsAt(at, residuals.data()));
    EXPECT_LT(keptAgainstAnew(problem, at, kStepPx2), kRoundOff);
    // Another state: nothing of the first is left.
    at.blurVariance = 0.5;
    at.logRoughness += 0.2;
    ASSERT_TRUE(problem.residualsAt(at, residuals.data()));
    EXPECT_LT(keptAgainstAnew(problem, at, kStepPx2), kRoundOff);
    // A finer rule for a larger lamp, before the residuals are asked for again.
    patch::State larger = at;
    larger.lamp.shape = SphereShape<>{1};
    ASSERT_TRUE(problem.chooseRule(larger));
    EXPECT_LT(keptAgainstAnew(problem, at, kStepPx2), kRoundOff);
  }
}

}  // namespace
}  // namespace glint
