// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/diffuse_texture.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/pipeline/hand_edits.h"
#include "tests/core/pipeline/painted_scene.h"
#include "tests/core/pipeline/questions.h"
#include "tests/core/scene/scene_fixture.h"

/// A ball with squares of paint all over: the highlights are known from pictures of the same ball in black.
namespace glint::diffuse_texture_tests {
namespace {

using namespace testing_support;

struct Printed {
  double contrast = 5, noise = 0, metres = 1, values = 1;
  int views = 12;
  double ambient = 0.4;  ///< of the paint's brightness, beside Lambert's shading
};

Painted glossyBall(const Printed& p) {
  Painted ball;
  ball.surface = sphere(0.5);
  ball.cameras = arc(p.views, 120);
  ball.lamp.id = "lamp";
  ball.lamp.lamp = lampAt(Eigen::Vector3d(0.3, 0.4, 2.0));
  ball.gloss = 1;
  return ball;
}

double paintAt(const Eigen::Vector3d& x, const Printed& p) {
  const Eigen::Vector3d n = (x - Eigen::Vector3d(0, 0, -0.5)).normalized();
  const bool bright = (static_cast<int>(std::floor(12 * n.x())) + static_cast<int>(std::floor(12 * n.y()))) % 2 == 0;
  const Eigen::Vector3d toLamp = (Eigen::Vector3d(0.3, 0.4, 2.0) - x).normalized();
  return (bright ? 1 : 1 / p.contrast) * (p.ambient + (1 - p.ambient) * std::max(0.0, n.dot(toLamp)));
}

/// Adds the paint to a picture: the mean over nine points of each pixel.
void paint(Image& image, const Painted& ball, std::size_t frame, const Printed& p) {
  const std::shared_ptr<const Surface> surface = makeAnalytic(ball.surface);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int k = 0; k < 9; ++k)
        if (const auto hit = surface->firstHit(ball.cameras[frame].ray(Pixel(x + (k % 3 - 1) / 3.0, y + (k / 3 - 1) / 3.0))))
          image.at(x, y) += static_cast<float>(paintAt(hit->position, p) / 9);
}

std::shared_ptr<Scene> photographed(const Printed& p, const TemporaryFolder& folder, bool painted) {
  auto scene = std::make_shared<Scene>();
  const Painted ball = glossyBall(p);
  AnalyticSpec told = ball.surface;
  told.radius *= p.metres;
  told.worldFromSurface.translation() *= p.metres;
  scene->surfaces["ball"] = told;
  for (std::size_t f = 0; f < ball.cameras.size(); ++f) {
    Frame frame;
    frame.id = std::to_string(f);
    frame.camera = ball.cameras[f];
    frame.camera.camFromWorld.translation() *= p.metres;
    frame.surface = "ball";
    frame.lightsOn = {"lamp"};
    frame.radiance = folder / (frame.id + (painted ? "p.tiff" : ".tiff"));
    Image image = picture(ball, f);
    if (painted) paint(image, ball, f, p);
    std::mt19937 engine(static_cast<unsigned>(f) + 1);
    std::normal_distribution<double> gauss(0, p.noise);
    for (float& v : image.data) v = static_cast<float>(p.values * std::max(0.0, v + (p.noise > 0 ? gauss(engine) : 0)));
    cv::imwrite(frame.radiance.string(), cv::Mat(image.height, image.width, CV_32F, image.data.data()),
                {cv::IMWRITE_TIFF_COMPRESSION, 1});
    scene->frames.push_back(std::move(frame));
  }
  return scene;
}

InspectionRequest asked(const char* texture = "auto") {
  InspectionRequest q;
  q.models = {"limit-angle"};
  q.train = "spread:6";
  for (const auto& [key, value] : {std::pair("fit.evidence", "contours"), std::pair("detect.texture", texture)})
    q.settings.setFromText(key, value);
  return q;
}

/// Every frame's one highlight against that of the black ball.
void expectHighlights(const Inspection& seen, const Inspection& black, double centrePx, double areaShare) {
  ASSERT_EQ(seen.evidence.size(), black.evidence.size());
  for (std::size_t f = 0; f < seen.evidence.size(); ++f) {
    const std::vector<Highlight>&found = seen.evidence[f].highlights, &truth = black.evidence[f].highlights;
    ASSERT_EQ(truth.size(), 1u) << f;
    ASSERT_EQ(found.size(), 1u) << f;
    EXPECT_TRUE(seen.evidence[f].diffuse) << f;
    EXPECT_LT((centroid(found[0].contour) - centroid(truth[0].contour)).norm(), centrePx) << f;
    EXPECT_NEAR(found[0].areaPx2 / truth[0].areaPx2, 1, areaShare) << f;
  }
}

TEST(TextureUnderneath, HighlightsAreThoseOfTheBlackBall) {
  const TemporaryFolder folder;
  const Inspection seen = inspect(photographed({}, folder, true), asked()),
                   black = inspect(photographed({}, folder, false), asked());
  expectHighlights(seen, black, 0.2, 0.06);  // a radius of 3 %: squares of 12 px, a smooth background
  for (const FrameEvidence& e : black.evidence) EXPECT_FALSE(e.diffuse);
  const ModelResult::Fit& fit = seen.models.at("limit-angle").fits.at(0);
  ASSERT_TRUE(fit.fit);
  EXPECT_TRUE(std::any_of(fit.fit->remarks.begin(), fit.fit->remarks.end(),
                          [](const std::string& r) { return r.find("of 6 of 6 training frames") != std::string::npos; }));
}

TEST(TextureUnderneath, ScaleOfLengthsAndValuesDoesNotMatter) {
  const TemporaryFolder folder;
  Printed p;
  p.metres = 1e-3;
  p.values = 500;
  expectHighlights(inspect(photographed(p, folder, true), asked()), inspect(photographed({}, folder, false), asked()), 0.2, 0.06);
}

TEST(TextureUnderneath, NoiseAndUnequalExposuresMoveContoursByAFractionOfAPixel) {
  const TemporaryFolder folder;
  Printed p;
  p.noise = 0.01;
  const auto scene = photographed(p, folder, true);
  for (std::size_t f = 0; f < scene->frames.size(); f += 3) {
    cv::Mat image = cv::imread(scene->frames[f].radiance.string(), cv::IMREAD_UNCHANGED);
    image *= 0.6;
    cv::imwrite(scene->frames[f].radiance.string(), image, {cv::IMWRITE_TIFF_COMPRESSION, 1});
  }
  expectHighlights(inspect(scene, asked()), inspect(photographed({}, folder, false), asked()), 0.3, 0.08);
}

/// The stage alone: dozens of squares would be taken for highlights, and fitted.
std::vector<FrameEvidence> afterStage(const std::shared_ptr<Scene>& scene, const InspectionRequest& request) {
  Inspection r;
  r.scene = r.given = scene;
  r.request = request;
  r.surfaces = std::make_shared<SurfaceCache>(*scene);
  r.inputs.evidence = evidenceInputs(request, false);
  std::vector<int> frames;
  for (int f = 0; f < static_cast<int>(scene->frames.size()); ++f) {
    frames.push_back(f);
    r.evidence.push_back(evidenceFor(*scene, f, *r.inputs.evidence));
  }
  const std::shared_ptr<const Surface> surface = *r.surfaces->surfaceOf(0, {});
  takeTextureOff(r, frames, [&](int) { return surface; }, {});
  return r.evidence;
}

TEST(TextureUnderneath, WithTooFewViewsOrOffNothingIsTakenOff) {
  const TemporaryFolder folder;
  Printed few;
  few.views = 3;
  for (const FrameEvidence& e : afterStage(photographed(few, folder, true), asked())) {
    EXPECT_TRUE(e.structure.isTexture());
    EXPECT_FALSE(e.diffuse);
  }
  const auto scene = photographed({}, folder, true);
  for (const FrameEvidence& e : afterStage(scene, asked())) EXPECT_TRUE(e.diffuse);
  for (const FrameEvidence& e : afterStage(scene, asked("off"))) {
    EXPECT_FALSE(e.diffuse);
    EXPECT_EQ(e.structure.amount, 0);
  }
}

TEST(TextureUnderneath, OneFrameFirstAndTheRestLaterIsTheSame) {
  const TemporaryFolder folder;
  const auto scene = photographed({}, folder, true);
  const Inspection all = inspect(scene, asked()), one = inspectOneFrame(scene, asked(), 5),
                   rest = inspect(scene, asked(), {}, &one);
  for (std::size_t f = 0; f < all.evidence.size(); ++f) {
    ASSERT_EQ(rest.evidence[f].highlights.size(), all.evidence[f].highlights.size()) << f;
    for (std::size_t h = 0; h < all.evidence[f].highlights.size(); ++h)
      EXPECT_EQ(rest.evidence[f].highlights[h].peak, all.evidence[f].highlights[h].peak) << f;
  }
}

}  // namespace
}  // namespace glint::diffuse_texture_tests
