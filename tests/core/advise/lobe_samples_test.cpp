// SPDX-License-Identifier: BSD-3-Clause
// Images of a lobe that is exactly I = K' exp(-(alpha/m)^2), so that height and width are known.
#include "core/advise/lobe_samples.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {
using namespace testing_support;

constexpr double kWidth = 0.07;
const Eigen::Vector3d kLamp(0.1, 0.2, 1.4);

struct Lobe {
  std::shared_ptr<const Surface> surface = makeAnalytic(sheet(0));
  Camera camera = lookingAt({0.2, -0.6, 1.5}, {0, 0, 0});
  Image image;
  Highlight highlight;
};

Lobe lobe(double height, double background, double noise = 0) {
  Lobe l;
  l.image = Image(l.camera.width, l.camera.height, 1);
  const Eigen::Vector3d eye = l.camera.centreInWorld();
  std::mt19937 engine(7);
  std::normal_distribution<double> gauss(0, noise > 0 ? noise : 1);
  for (int y = 0; y < l.image.height; ++y)
    for (int x = 0; x < l.image.width; ++x) {
      const Outcome<SurfacePoint> hit = l.surface->firstHit(l.camera.ray(Pixel(x, y)));
      if (!hit) continue;
      const SurfacePoint p = facing(*hit, eye);
      const double alpha = incidentAngle(p.normal, (kLamp - p.position).normalized(), (eye - p.position).normalized());
      l.image.at(x, y) =
          float(height * std::exp(-alpha * alpha / (kWidth * kWidth)) + background + (noise > 0 ? gauss(engine) : 0));
    }
  // The contour of level 0.5 is that of the limit angle m sqrt(log 2).
  l.highlight = exactContours(sheet(0), l.camera, {"lamp", kLamp}, kWidth * std::sqrt(std::log(2.0))).front();
  if (!l.highlight.ellipse) l.highlight.ellipse = *fitEllipse(l.highlight.contour.points);
  return l;
}

Outcome<LobeSamples> samplesOf(const Lobe& l, const LobeOptions& options = {}) {
  return lobeSamples(l.image, nullptr, l.highlight, l.camera, *l.surface, Light::at(kLamp), options);
}

TEST(LobeSamples, Nominal) {
  const Outcome<LobeSamples> s = samplesOf(lobe(2.0, 0));
  ASSERT_TRUE(s);
  ASSERT_TRUE(s->fit);
  EXPECT_NEAR(s->fit->m, kWidth, 0.002 * kWidth);  // the background fit takes a trace of the tail for shading
  EXPECT_NEAR(std::exp(s->fit->logHeight), 2.0, 0.01);
  EXPECT_LT(s->fit->rms, 0.005);
  EXPECT_NEAR(s->fit->alphaAt(0.5), kWidth * std::sqrt(std::log(2.0)), 0.002 * kWidth);
  EXPECT_EQ(s->fit->alphaAt(1), 0);
  EXPECT_LT(int(s->samples.size()), 2 * LobeOptions{}.mostSamples);
  EXPECT_GT(int(s->samples.size()), LobeOptions{}.mostSamples / 3);
  for (const LobeSample& sample : s->samples)
    if (sample.fitted) {
      EXPECT_NEAR(sample.logI, std::log(2.0) - std::pow(sample.alpha / kWidth, 2), 0.02);
    }
}

TEST(LobeSamples, ScaleOfTheRadianceAndAConstantBackgroundDoNotMatter) {
  const Outcome<LobeSamples> one = samplesOf(lobe(2.0, 0)), thousand = samplesOf(lobe(2000.0, 0)),
                             lifted = samplesOf(lobe(2.0, 0.3));
  ASSERT_TRUE(one && thousand && lifted && one->fit && thousand->fit && lifted->fit);
  EXPECT_NEAR(thousand->fit->m, one->fit->m, 1e-5);
  EXPECT_NEAR(thousand->fit->logHeight - one->fit->logHeight, std::log(1000.0), 1e-5);
  EXPECT_NEAR(lifted->fit->m, one->fit->m, 1e-4);
  EXPECT_NEAR(lifted->background, 0.3, 0.01);
}

TEST(LobeSamples, Noise) {  // 2 % of the height on every pixel; hundreds of pixels enter the fit
  const Outcome<LobeSamples> s = samplesOf(lobe(2.0, 0.3, 0.04));
  ASSERT_TRUE(s && s->fit);
  EXPECT_NEAR(s->fit->m, kWidth, 0.02 * kWidth);
  EXPECT_NEAR(s->fit->rms, 0.03, 0.02);
}

TEST(LobeSamples, Degenerate) {
  Lobe flat = lobe(2.0, 0);
  for (float& v : flat.image.data) v = 0.5f;
  EXPECT_EQ(samplesOf(flat).failure().reason, Reason::NoHighlight);
  Lobe clipped = lobe(2.0, 0);
  LobeOptions options;
  options.clipValue = 1.0;  // everything above half the height is gone
  const Outcome<LobeSamples> rest = samplesOf(clipped, options);
  ASSERT_TRUE(rest);
  EXPECT_GT(rest->clipped, 100);
  for (const LobeSample& s : rest->samples) EXPECT_LT(s.logI, 0);
  Lobe missing = lobe(2.0, 0);
  missing.highlight.ellipse.reset();
  EXPECT_EQ(samplesOf(missing).failure().reason, Reason::NotAnEllipse);
  Lobe bad = lobe(2.0, 0);
  bad.image.at(int(bad.highlight.peak.x()), int(bad.highlight.peak.y())) = std::nanf("");
  const Outcome<LobeSamples> without = samplesOf(bad);
  ASSERT_TRUE(without && without->fit);
  EXPECT_TRUE(std::isfinite(without->fit->m));
  const Outcome<LobeSamples> behind =
      lobeSamples(bad.image, nullptr, bad.highlight, bad.camera, *bad.surface, Light::at({0, 0, -1}), {});
  ASSERT_FALSE(behind);
  EXPECT_EQ(behind.failure().reason, Reason::TooFewPoints);
}

}  // namespace
}  // namespace glint
