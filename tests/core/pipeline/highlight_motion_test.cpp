// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/highlight_motion.h"

#include <gtest/gtest.h>

#include "core/base/number_text.h"
#include "tests/core/pipeline/painted_scene.h"

/// Paint against highlights in rendered pictures: which is which is known from what was painted.
namespace glint::highlight_motion_tests {
namespace {

using namespace testing_support;
using Kind = MotionVerdict::Kind;

AnalyticSpec ball() { return sphere(0.5); }  // its top at the origin

Eigen::Vector3d onBall(double x, double y) { return {x, y, std::sqrt(0.25 - x * x - y * y) - 0.5}; }

Painted paintedBall() {
  Painted p;
  p.surface = ball();
  p.cameras = arc(12, 120);
  p.lamp.id = "lamp";
  p.lamp.lamp = lampAt(Eigen::Vector3d(0.3, 0.4, 2.0));
  p.paint = {{onBall(-0.12, -0.15), 0.03, 1.0}, {onBall(0.16, -0.05), 0.035, 0.95}};
  return p;
}

Painted paintedPlane() {
  Painted p = paintedBall();
  p.surface = sheet(0);
  p.paint = {{{-0.12, -0.15, 0}, 0.03, 1.0}, {{0.16, -0.05, 0}, 0.035, 0.95}};
  return p;
}

std::vector<Camera> shaken(std::vector<Camera> cameras, double px) {
  std::mt19937 engine(3);
  std::normal_distribution<double> gauss(0, px / 400);  // rad: pixels over the focal length
  for (Camera& c : cameras)
    c.camFromWorld = Eigen::AngleAxisd(gauss(engine), Eigen::Vector3d::UnitX()) *
                     Eigen::AngleAxisd(gauss(engine), Eigen::Vector3d::UnitY()) * c.camFromWorld;
  return cameras;
}

/// A row of docs/real.md.
void row(const std::string& scene, const Judged& j) {
  std::printf("motion: %s|%d|%d|%d|%d|%d|%d\n", scene.c_str(), j.all(true), j.count(true, Kind::Texture),
              j.count(true, Kind::CannotTell), j.all(false), j.count(false, Kind::Texture), j.count(false, Kind::CannotTell));
}

bool anySays(const Judged& j, const std::string& words) {
  for (const std::vector<MotionVerdict>& frame : j.verdicts)
    for (const MotionVerdict& v : frame)
      if (v.text().find(words) != std::string::npos) return true;
  return false;
}

TEST(HighlightMotion, NominalPaintIsRejectedAndHighlightsAreNot) {
  for (const Painted& p : {paintedBall(), paintedPlane()}) {
    const Judged j = judged(p);
    row(p.surface.type == "sphere" ? "ball" : "plane", j);
    EXPECT_EQ(j.all(false), 12);
    EXPECT_EQ(j.count(false, Kind::Unremarkable), 12);
    EXPECT_GE(j.all(true), 18);
    EXPECT_GE(j.count(true, Kind::Texture), j.all(true) - 1);
    EXPECT_TRUE(anySays(j, "texture: it stays on the surface in 9 of 9 views"));
  }
}

TEST(HighlightMotion, HighlightsAloneAreLeftAlone) {
  Painted p = paintedBall();
  p.paint.clear();
  p.roughness = 0.2;
  const Judged j = judged(p);
  row("ball without paint, roughness 0.2", j);
  EXPECT_EQ(j.all(false), 12);
  EXPECT_EQ(j.count(false, Kind::Unremarkable), 12);
}

TEST(HighlightMotion, ScaleOfLengthsAndValuesDoesNotMatter) {
  const Judged once = judged(paintedBall());
  Painted p = paintedBall();
  constexpr double kScale = 1000;
  p.surface.radius *= kScale;
  p.surface.worldFromSurface.translation() *= kScale;
  for (Camera& c : p.cameras) c.camFromWorld.translation() *= kScale;
  p.lamp.lamp = lampAt(kScale * p.lamp.lamp.position());
  p.gloss *= kScale;
  for (Paint& spot : p.paint) spot = {kScale * spot.at, kScale * spot.radius, kScale * spot.brightness};
  const Judged large = judged(p);
  ASSERT_EQ(large.all(true), once.all(true));
  EXPECT_EQ(large.count(true, Kind::Texture), once.count(true, Kind::Texture));
  for (std::size_t f = 0; f < once.verdicts.size(); ++f)
    for (std::size_t i = 0; i < once.verdicts[f].size(); ++i)
      EXPECT_NEAR(large.verdicts[f][i].lampWithin, kScale * once.verdicts[f][i].lampWithin,
                  0.05 * kScale * once.verdicts[f][i].lampWithin);
}

TEST(HighlightMotion, NoiseOfPicturesPosesAndSurfacesCostsAnswersAndMakesNoWrongOnes) {
  Painted p = paintedBall();
  p.noise = 0.03;
  Judged j = judged(p);
  row("ball, noise of the pixels 3 % of the paint", j);
  EXPECT_EQ(j.count(false, Kind::Texture), 0);
  EXPECT_GE(j.count(true, Kind::Texture), 16);
  p.noise = 0;
  for (const double px : {0.5, 2.0}) {
    j = judged(p, shaken(p.cameras, px));
    row(formatted("ball, poses off by %g px", px), j);
    EXPECT_EQ(j.count(false, Kind::Texture), 0) << px;
    EXPECT_EQ(j.count(true, Kind::Texture) >= 16, px == 0.5) << px;
  }
  AnalyticSpec larger = p.surface;
  larger.radius *= 1.01;  // a third of a percent of the cameras' distance
  j = judged(p, {}, &larger);
  row("ball, told 1 % larger than it is", j);
  EXPECT_EQ(j.count(false, Kind::Texture), 0);
  EXPECT_GE(j.count(true, Kind::Texture), 16);
  // 20 mm beside the surface paint moves as the highlight of a lamp 20 mm away from it.
  larger.radius = 1.04 * p.surface.radius;
  j = judged(p, {}, &larger);
  row("ball, told 4 % larger than it is", j);
  EXPECT_EQ(j.count(true, Kind::Texture), 0);
  EXPECT_TRUE(anySays(j, "of the surface would do that too"));
}

TEST(HighlightMotion, DegenerateCloseViewsCannotTell) {
  Painted p = paintedBall();
  p.cameras = arc(12, 3);
  Judged j = judged(p);
  row("ball, arc of 3 degrees", j);
  EXPECT_EQ(j.count(true, Kind::CannotTell), 24);
  EXPECT_EQ(j.count(false, Kind::CannotTell), 12);
  EXPECT_TRUE(anySays(j, "the views are too close"));
  p.cameras.assign(6, p.cameras.front());
  j = judged(p);
  EXPECT_EQ(j.count(true, Kind::CannotTell), j.all(true));
  EXPECT_EQ(j.count(false, Kind::CannotTell), 6);
}

TEST(HighlightMotion, AStillCameraUnderAMovingLampCannotTell) {
  Painted p = paintedBall();
  p.cameras.assign(6, p.cameras.front());
  for (int i = 0; i < 6; ++i) p.lampIn.emplace_back(-0.6 + 0.25 * i, 0.4, 2.0);
  const Judged j = judged(p);
  row("ball, 6 pictures, still camera, lamp moved", j);
  EXPECT_GT(j.count(true, Kind::CannotTell), 0);
  EXPECT_EQ(j.count(true, Kind::Texture) + j.count(false, Kind::Texture), 0);
}

/// An object that is turned before a still camera: the cameras move around it, and the lamp with them.
TEST(HighlightMotion, ATurningObjectUnderALampThatStandsWithTheCamera) {
  Painted p = paintedBall();
  p.lampOnCamera = true;
  p.lamp.lamp = lampAt(Eigen::Vector3d(0.5, -0.3, 0.2));
  const Judged j = judged(p);
  row("ball that is turned before a still camera and lamp", j);
  EXPECT_GE(j.all(false), 10);
  EXPECT_EQ(j.count(false, Kind::Texture), 0);
  EXPECT_GE(j.count(true, Kind::Texture), j.all(true) - 2);
}

/// A turntable between camera and lamp: the highlight on its axis stays on its point, and a lamp that stood still in the object's
/// frame would move it.
TEST(HighlightMotion, AHighlightOnTheAxisOfATurntable) {
  Painted p = paintedBall();
  p.paint.clear();
  p.cameras = arc(12, 330, 0.5);
  for (const Camera& c : p.cameras) p.lampIn.push_back(c.centreInWorld().cwiseProduct(Eigen::Vector3d(-1, -1, 1)));
  const Judged j = judged(p);
  row("ball that is turned about an axis through the highlight", j);
  EXPECT_EQ(j.count(false, Kind::CannotTell), 12);
}

/// The nearer the lamp, the less its highlight moves: at a hundredth of the cameras' distance it stays within a few pixels.
TEST(HighlightMotion, AHighlightOfALampCloseToTheSurfaceIsNotRejected) {
  for (Painted p : {paintedBall(), paintedPlane()}) {
    p.roughness = 0.35;  // so that there is a spot to detect
    for (const double height : {0.015, 0.03, 0.1}) {
      p.lamp.lamp = lampAt(Eigen::Vector3d(0, 0, height));
      const Judged j = judged(p);
      row(formatted("%s, roughness 0.35, lamp %g m above it", p.surface.type == "sphere" ? "ball" : "plane", height), j);
      EXPECT_EQ(j.all(false), 12) << height;
      EXPECT_EQ(j.count(false, Kind::Texture), 0) << height;
      EXPECT_GE(j.count(true, Kind::Texture), j.all(true) - 1) << height;
    }
  }
}

/// Rows of like spots: there is one wherever anything might be.
TEST(HighlightMotion, APatternOfSpotsWhoseTracksCross) {
  Painted p = paintedBall();
  p.paint.clear();
  for (int x = -3; x <= 3; ++x)
    for (int y = -3; y <= 3; ++y) p.paint.push_back({onBall(0.08 * x, 0.08 * y), 0.02, 0.9});
  const Judged j = judged(p);
  row("ball, rows of 49 like spots", j);
  EXPECT_GT(j.all(true), 100);
  EXPECT_EQ(j.count(false, Kind::Texture), 0);
  EXPECT_GT(j.count(true, Kind::Texture), 0);
}

/// What is found there by chance is missing in most views.
TEST(HighlightMotion, ViewsThatDoNotFindItSpeakAgainstIt) {
  Painted p = paintedBall();
  p.paint = {{onBall(0, 0.2), 0.04, 1.0}};
  Judged j = judged(p);
  const auto paintIn = [&](std::size_t f) {
    return static_cast<std::size_t>(std::find(j.painted[f].begin(), j.painted[f].end(), true) - j.painted[f].begin());
  };
  ASSERT_EQ(j.all(true), 12);
  ASSERT_EQ(j.count(true, Kind::Texture), 12);
  for (std::size_t f = 1; f < 12; ++f)
    if (f != 5 && f != 9) j.evidence[f].highlights.erase(j.evidence[f].highlights.begin() + static_cast<long>(paintIn(f)));
  const std::vector<int> panel{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const MotionVerdict v = motionVerdicts(j.scene, 0, panel, j.evidence, makeAnalytic(p.surface).get(), Settings()).at(paintIn(0));
  EXPECT_NE(v.kind, Kind::Texture);
}

/// Five pictures from one place are one view.
TEST(HighlightMotion, ViewsFromOneSideCountOnce) {
  Painted p = paintedBall();
  p.cameras = {p.cameras[0], p.cameras[6], p.cameras[6], p.cameras[6], p.cameras[6], p.cameras[6]};
  const Judged j = judged(p);
  EXPECT_GE(j.all(true), 10);
  EXPECT_EQ(j.count(true, Kind::Texture), 0);
}

TEST(HighlightMotion, WithoutOtherViewsOrASurfaceNothingIsSaid) {
  Painted p = paintedBall();
  p.cameras.resize(1);
  const Judged alone = judged(p);
  EXPECT_EQ(alone.count(true, Kind::Unremarkable) + alone.count(false, Kind::Unremarkable), alone.all(true) + alone.all(false));
  p.cameras = arc(3, 120);
  Judged j = judged(p);
  for (const MotionVerdict& v : motionVerdicts(j.scene, 0, {1, 2}, j.evidence, nullptr, Settings())) EXPECT_EQ(v.text(), "");
  // Frames that were not searched yet.
  j.evidence[1].frame = j.evidence[2].frame = -1;
  const std::shared_ptr<const Surface> surface = makeAnalytic(p.surface);
  for (const MotionVerdict& v : motionVerdicts(j.scene, 0, {1, 2}, j.evidence, surface.get(), Settings()))
    EXPECT_EQ(v.kind, Kind::Waiting);
}

TEST(HighlightMotion, PanelsAreSpreadOverFramesOfTheSameSurface) {
  Scene scene;
  scene.surfaces["body"] = ball();
  scene.surfaces["other"] = ball();
  scene.frames.resize(33);
  for (std::size_t f = 0; f < 33; ++f) scene.frames[f].surface = f < 30 ? "body" : f == 30 ? "" : "other";
  scene.frames[10].highlights.resize(1);  // by hand: not asked
  const std::vector<std::vector<int>> panels = motionPanels(scene, SurfaceCache(scene));
  EXPECT_EQ(panels[1],
            (std::vector<int>{0, 2, 4, 7, 9, 13, 15, 17, 20, 22, 25, 27}));  // floor(29 i / 12), past the tenth one further
  EXPECT_EQ(panels[0].size(), 11u);
  EXPECT_TRUE(panels[10].empty());
  EXPECT_TRUE(panels[30].empty());
  EXPECT_EQ(panels[31], std::vector<int>{32});
}

TEST(HighlightMotion, WithheldTexturesComeBackAsTheyWere) {
  Judged j = judged(paintedBall());
  FrameEvidence& e = j.evidence[0];
  const std::vector<Highlight> before = e.highlights;
  ASSERT_EQ(before.size(), 3u);
  FrameEvidence again = e;
  withholdTextures(e, j.verdicts[0], j.scene.frames[0].camera);
  ASSERT_EQ(e.highlights.size(), 1u);
  EXPECT_EQ(e.textures.size(), 2u);
  ASSERT_EQ(e.rejected.size(), 2u);
  EXPECT_NE(e.rejected[0].reason.find("texture"), std::string::npos);
  dropTextures(again, e.textures);
  ASSERT_EQ(again.highlights.size(), 1u);
  EXPECT_EQ(again.highlights[0].peak, e.highlights[0].peak);
  returnTextures(e);
  ASSERT_EQ(e.highlights.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(e.highlights[i].peak, before[i].peak);
  EXPECT_TRUE(e.rejected.empty());
  std::vector<MotionVerdict> all(3);
  for (MotionVerdict& v : all) v.kind = Kind::Texture;
  withholdTextures(e, all, j.scene.frames[0].camera);
  ASSERT_TRUE(e.failure);
  EXPECT_EQ(e.failure->reason, Reason::NoHighlight);
  returnTextures(e);
  EXPECT_FALSE(e.failure);
}

}  // namespace
}  // namespace glint::highlight_motion_tests
