// SPDX-License-Identifier: BSD-3-Clause
// Lamps that move with the camera and objects that move, against the same views in still coordinates and a path tracer's truth.
#include <gmock/gmock.h>

#include <functional>
#include <opencv2/imgcodecs.hpp>

#include "core/pipeline/inspection.h"
#include "core/pipeline/light_frame_choice.h"
#include "core/pipeline/live_prediction.h"
#include "core/pipeline/pipeline.h"
#include "core/pipeline/summary.h"
#include "core/surface/posed_surface.h"
#include "tests/core/pipeline/exact_scene.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/shared_data.h"

namespace glint::light_frame_tests {
namespace {
using namespace testing_support;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;

const Vector3d kFlash(0.05, -0.02, 0.01);  // in the camera's frame, m

AnalyticSpec body() {
  AnalyticSpec spec;
  spec.type = "ellipsoid";
  spec.semiAxes = {0.5, 0.4, 0.35};
  return spec;
}

Camera around(int i, int frames) {
  const double a = 2.0 * std::numbers::pi * i / frames;
  return lookingAt({1.6 * std::cos(a), 1.6 * std::sin(a), 0.7 + 0.3 * std::sin(2 * a)}, {0, 0, 0});
}

Isometry3d motionOf(int i) {
  Isometry3d m = Isometry3d::Identity();
  m.linear() = Eigen::AngleAxisd(0.5 * i, Vector3d(0.2, 0.1, 1).normalized()).toRotationMatrix();
  m.translation() = Vector3d(0.03 * i, -0.02 * i, 0.01 * i);
  return m;
}

/// Contours of limit angles on the body as it stands in each frame; `lampOf` says where the lamp is in the frame's world.
template <class LampOf>
std::shared_ptr<Scene> movingScene(int frames, const LampOf& lampOf, const std::function<Isometry3d(int)>& worldFromObject) {
  auto scene = std::make_shared<Scene>();
  scene->name = "moving";
  scene->surfaces["body"] = body();
  for (int i = 0; i < frames; ++i) {
    Frame f;
    f.id = "v" + std::to_string(i);
    f.camera = around(i, frames);
    f.surface = "body";
    f.worldFromObject = worldFromObject(i);
    AnalyticSpec there = body();
    there.worldFromSurface = f.worldFromObject;
    f.highlights = exactContours(there, f.camera, {"lamp", lampOf(f.camera)});
    scene->frames.push_back(std::move(f));
  }
  return scene;
}

std::shared_ptr<Scene> flashScene(int frames) {
  return movingScene(
      frames, [](const Camera& c) { return Vector3d(c.camFromWorld.inverse() * kFlash); },
      [](int) { return Isometry3d::Identity(); });
}

InspectionRequest asked(const std::string& train = "spread:6") {
  InspectionRequest request;
  request.models = {"canonical", "limit-angle"};
  request.train = train;
  return request;
}

double meanPct(const Inspection& in, const std::string& model) {
  const ModelSummary s = summarise(in, in.models.at(model));
  return s.matched > 0 && s.missed == 0 ? s.contourErrorPct.mean : std::nan("");
}

Light lightOfIt(const Inspection& in) { return *in.models.at("limit-angle").fits.front().fit->lightEstimate; }

TEST(LightFrame, AFlashIsFoundInTheCamerasFrame) {
  const Inspection in = inspect(flashScene(14), asked());
  EXPECT_EQ(in.lightFrame.frame, LightFrame::Camera) << in.lightFrame.reason;
  EXPECT_THAT(in.lightFrame.reason, HasSubstr("moves with the camera"));
  EXPECT_EQ(in.lightFrame.doubt, "");
  EXPECT_LT(meanPct(in, "limit-angle"), 0.01);
  EXPECT_LT((lightOfIt(in).position() - kFlash).norm(), 1e-4);
  for (const Frame& f : in.scene->frames) EXPECT_TRUE(f.camera.camFromWorld.isApprox(Isometry3d::Identity()));
  EXPECT_EQ(in.world, in.given);
}

TEST(LightFrame, AnObjectThatMovesEqualsCamerasThatMove) {
  // The same views in the object's coordinates are an ordinary scene; only the lamp must move along for both to agree, and it
  // does where it is on the camera.
  const Vector3d lamp(0.4, 0.3, 1.9);
  const auto moving = movingScene(
      14, [&](const Camera&) { return lamp; }, motionOf);
  const Inspection in = inspect(moving, asked());
  EXPECT_EQ(in.lightFrame.frame, LightFrame::World) << in.lightFrame.reason;
  EXPECT_LT(meanPct(in, "limit-angle"), 0.01);
  EXPECT_LT((lightOfIt(in).position() - lamp).norm(), 1e-4);
  // A still camera and lamp before the moving object, written in both ways.
  auto turning = movingScene(
      14, [&](const Camera&) { return lamp; }, motionOf);
  auto orbiting = std::make_shared<Scene>(*turning);
  for (std::size_t i = 0; i < turning->frames.size(); ++i) {
    Frame& f = turning->frames[i];
    f.camera = around(0, 14);
    AnalyticSpec there = body();
    f.worldFromObject = motionOf(int(i));
    there.worldFromSurface = f.worldFromObject;
    f.highlights = exactContours(there, f.camera, {"lamp", lamp});
    orbiting->frames[i] = f;
    orbiting->frames[i].camera.camFromWorld = f.camera.camFromWorld * f.worldFromObject;
    orbiting->frames[i].worldFromObject.setIdentity();
  }
  const Inspection a = inspect(turning, asked()), b = inspect(orbiting, asked());
  EXPECT_EQ(b.lightFrame.frame, LightFrame::Camera) << b.lightFrame.reason;
  EXPECT_NEAR(meanPct(a, "limit-angle"), meanPct(b, "limit-angle"), 1e-4);
  EXPECT_LT(meanPct(a, "limit-angle"), 0.01);
}

TEST(LightFrame, NoiseOfContoursDoesNotHideTheFrame) {
  for (const bool flash : {true, false}) {
    const auto scene = flash ? flashScene(14)
                             : movingScene(
                                   14, [](const Camera&) { return Vector3d(0.4, 0.3, 1.9); }, motionOf);
    InspectionRequest request = asked();
    request.noisePx = 0.3;
    const Inspection in = inspect(scene, request);
    EXPECT_EQ(in.lightFrame.frame, flash ? LightFrame::Camera : LightFrame::World) << in.lightFrame.reason;
    EXPECT_LT(meanPct(in, "limit-angle"), 0.5);
  }
}

TEST(LightFrame, AWrongStatementIsNamed) {
  InspectionRequest request = asked();
  request.settings.set("light.frame", std::string("world"));
  const Inspection in = inspect(flashScene(14), request);
  EXPECT_EQ(in.lightFrame.frame, LightFrame::World);
  EXPECT_THAT(in.lightFrame.doubt, HasSubstr("light.frame=world, but the lamp moves with the camera"));
  // Never an ok answer from the wrong frame.
  for (const ModelResult::Fit& fit : in.models.at("limit-angle").fits) {
    EXPECT_TRUE(!fit.fit || !fit.fit->poor.empty());
    // Whether it answers or not, it says what is wrong.
    EXPECT_THAT(fit.fit ? fit.fit->remarks : std::vector<std::string>{fit.failure()->detail},
                Contains(HasSubstr(in.lightFrame.doubt)));
  }
}

TEST(LightFrame, BeforeACameraThatStandsStillBothStatementsAreRight) {
  const auto scene = movingScene(
      14, [](const Camera&) { return Vector3d(0.4, 0.3, 1.9); }, motionOf);
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    Frame& f = scene->frames[i];
    f.camera = around(0, 14);
    AnalyticSpec there = body();
    there.worldFromSurface = f.worldFromObject;
    f.highlights = exactContours(there, f.camera, {"lamp", Vector3d(0.4, 0.3, 1.9)});
  }
  for (const std::string stated : {"auto", "world", "camera"}) {
    InspectionRequest request = asked();
    request.settings.set("light.frame", stated);
    const Inspection in = inspect(scene, request);
    EXPECT_EQ(in.lightFrame.doubt, "") << stated;
    EXPECT_LT(meanPct(in, "limit-angle"), 0.01) << stated;
  }
}

TEST(LightFrame, ASingleViewTellsNothing) {
  const Inspection in = inspect(flashScene(14), asked("first:1"));
  EXPECT_EQ(in.lightFrame.frame, LightFrame::World);
  EXPECT_FALSE(in.lightFrame.byLight.at("lamp").camera);
}

/// Each frame gets the depth of the body in place of the body, as a depth camera would measure it without noise.
void measureDepth(Scene& scene, const std::filesystem::path& folder) {
  const std::shared_ptr<const Surface> surface = makeAnalytic(body());
  for (Frame& f : scene.frames) {
    cv::Mat depth(f.camera.height, f.camera.width, CV_32F, cv::Scalar(0));
    for (int y = 0; y < depth.rows; ++y)
      for (int x = 0; x < depth.cols; ++x)
        if (const Outcome<SurfacePoint> hit = surface->firstHit(f.camera.ray({double(x), double(y)})))
          depth.at<float>(y, x) = static_cast<float>(f.camera.depth(hit->position));
    f.surface.clear();
    f.depth = folder / (f.id + ".tiff");
    ASSERT_TRUE(cv::imwrite(f.depth.string(), depth, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  }
}

TEST(LightFrame, DepthMapsOfTheFramesTellIt) {
  const TemporaryFolder folder;
  const auto scene = flashScene(8);
  measureDepth(*scene, folder.path());
  InspectionRequest request = asked("first:5");
  request.models = {"limit-angle"};
  const Inspection in = inspect(scene, request);
  EXPECT_EQ(in.lightFrame.frame, LightFrame::Camera) << in.lightFrame.reason;
  EXPECT_LT((lightOfIt(in).position() - kFlash).norm(), 0.02);  // 1 % of the distance: normals come from neighbouring pixels
  EXPECT_LT(meanPct(in, "limit-angle"), 0.5);
}

const Vector3d kStill(0.4, 0.3, 1.9);  // in the world, m

/// A flash on the camera beside a lamp that stands still, both on in each frame.
/// @param named  whether the scene says which highlight is whose
std::shared_ptr<Scene> bothKinds(int frames, bool named, double scale = 1) {
  auto scene = std::make_shared<Scene>();
  scene->name = "both";
  AnalyticSpec spec = body();
  spec.semiAxes *= scale;
  scene->surfaces["body"] = spec;
  for (int i = 0; i < frames; ++i) {
    Frame f;
    f.id = "v" + std::to_string(i);
    f.camera = around(i, frames);
    f.camera.camFromWorld.translation() *= scale;
    f.surface = "body";
    const Vector3d flash = f.camera.camFromWorld.inverse() * Vector3d(scale * kFlash);
    const std::vector<NamedLight> lights{{"flash", flash}, {"still", scale * kStill}};
    for (const NamedLight& light : lights)
      for (Highlight& h : exactContours(spec, f.camera, light)) f.highlights.push_back(std::move(h));
    if (named)
      f.lightsOn = {"flash", "still"};
    else
      for (Highlight& h : f.highlights) h.light.clear();
    scene->frames.push_back(std::move(f));
  }
  return scene;
}

const ModelResult::Fit& fitNamed(const Inspection& in, const std::string& light) {
  const std::vector<ModelResult::Fit>& fits = in.models.at("limit-angle").fits;
  const auto found = std::find_if(fits.begin(), fits.end(), [&](const ModelResult::Fit& f) { return f.light == light; });
  require(found != fits.end(), "fitNamed: no such light");
  return *found;
}

TEST(LightFrame, LampsOfBothKindsStandEachInItsOwnFrame) {
  for (const double scale : {1.0, 1e-2, 1e2}) {
    const Inspection in = inspect(bothKinds(14, true, scale), asked());
    EXPECT_EQ(in.lightFrame.frameOf("flash"), LightFrame::Camera) << in.lightFrame.reason;
    EXPECT_EQ(in.lightFrame.frameOf("still"), LightFrame::World) << in.lightFrame.reason;
    EXPECT_THAT(in.lightFrame.reason, HasSubstr("flash with the camera, still in the world"));
    EXPECT_EQ(in.lightFrame.doubt, "");
    ASSERT_TRUE(fitNamed(in, "flash").fit && fitNamed(in, "still").fit);
    EXPECT_EQ(fitNamed(in, "flash").fit->poor, "");
    EXPECT_LT((fitNamed(in, "flash").fit->lightEstimate->position() - scale * kFlash).norm(), 1e-4 * scale);
    EXPECT_LT((fitNamed(in, "still").fit->lightEstimate->position() - scale * kStill).norm(), 1e-4 * scale);
    EXPECT_LT(meanPct(in, "limit-angle"), 0.01);
  }
}

TEST(LightFrame, HighlightsThatNobodyNamedAreToldApartByTheFrame) {
  for (const double noise : {0.0, 0.2}) {
    InspectionRequest request = asked();
    request.noisePx = noise;
    const Inspection in = inspect(bothKinds(14, false), request);
    ASSERT_EQ(in.models.at("limit-angle").fits.size(), 2u) << in.lightFrame.reason;
    ASSERT_EQ(in.lightFrame.elsewhere.size(), 1u) << in.lightFrame.reason;
    for (const ModelResult::Fit& fit : in.models.at("limit-angle").fits) {
      ASSERT_TRUE(fit.fit);
      const Vector3d truth = in.lightFrame.frameOf(fit.light) == LightFrame::Camera ? kFlash : kStill;
      EXPECT_LT((fit.fit->lightEstimate->position() - truth).norm(), noise > 0 ? 0.02 : 1e-4) << fit.light;
    }
    EXPECT_LT(meanPct(in, "limit-angle"), noise > 0 ? 0.5 : 0.01);
  }
}

TEST(LightFrame, WhatIsDrawnOfAFrameStandsInItsScene) {
  const Inspection in = inspect(bothKinds(14, true), asked());
  ASSERT_EQ(in.lightFrame.frame, LightFrame::Camera) << "the flash counts as much as the lamp: the scene is the camera's";
  for (const int frame : {0, 5}) {
    const std::shared_ptr<const Inspection> there = inSceneAt(in, frame);
    const Isometry3d& camFromWorld = in.world->frames[std::size_t(frame)].camera.camFromWorld;
    EXPECT_LT((there->lightFor(frame, "still")->light.position() - camFromWorld * kStill).norm(), 1e-4) << frame;
    EXPECT_LT((there->lightFor(frame, "flash")->light.position() - kFlash).norm(), 1e-4) << frame;
    for (const TrainingView& v : there->views) EXPECT_TRUE(v.camera.camFromWorld.isApprox(Isometry3d::Identity(), 1e-9));
    for (const FrameComparison& c : there->models.at("limit-angle").frames) {
      if (c.frame != frame) continue;
      for (const PredictedHighlight& h : c.prediction.highlights()) {
        const std::optional<Pixel> seen = in.scene->frames[std::size_t(frame)].camera.project(h.brightest.point.position);
        ASSERT_TRUE(seen);
        EXPECT_LT((*seen - h.brightest.pixel).norm(), 1e-6);
      }
    }
  }
}

TEST(LightFrame, APoseThatComesLiveHasLampsOfBothKinds) {
  const auto all = bothKinds(14, true);
  const LivePredictor live(all, asked());
  const Camera unseen = [] {
    Camera c = lookingAt({1.2, -1.1, 0.8}, {0, 0, 0});
    return c;
  }();
  const Outcome<LiveAnswer> answer = live.predict("unseen", unseen.camFromWorld, unseen, std::nullopt);
  ASSERT_TRUE(answer);
  int compared = 0;
  for (const LiveHighlights& h : answer->highlights) {
    if (h.model != "limit-angle") continue;
    const Vector3d lamp = h.light == "flash" ? Vector3d(unseen.camFromWorld.inverse() * kFlash) : kStill;
    const std::vector<Highlight> truth = exactContours(body(), unseen, {h.light, lamp});
    ASSERT_EQ(truth.size(), 1u);
    ASSERT_EQ(h.prediction.highlights().size(), 1u) << h.light;
    EXPECT_LT((centroid(truth[0].contour) - centroid(h.prediction.highlights()[0].contour)).norm(), 0.02) << h.light;
    ++compared;
  }
  EXPECT_EQ(compared, 2);
}

TEST(LightFrame, ScaleChangesNothing) {
  for (const double scale : {1e-3, 1e3}) {
    auto scene = std::make_shared<Scene>(*flashScene(14));
    AnalyticSpec spec = body();
    spec.semiAxes *= scale;
    scene->surfaces["body"] = spec;
    for (Frame& f : scene->frames) f.camera.camFromWorld.translation() *= scale;
    const Inspection in = inspect(scene, asked());
    EXPECT_EQ(in.lightFrame.frame, LightFrame::Camera);
    EXPECT_LT(meanPct(in, "limit-angle"), 0.01);
  }
}

TEST(LightFrame, TheChoiceIsOfTheTrainingFramesAndAnswersAreTakenOver) {
  const std::shared_ptr<const Scene> scene = flashScene(14);
  Pipeline pipeline(scene);
  const auto first = pipeline.everything(asked());
  InspectionRequest other = asked();
  other.settings.set("light.frame", std::string("camera"));
  const auto second = pipeline.everything(other);
  EXPECT_EQ(second->scene, first->scene);  // the same coordinates: nothing is loaded again
  EXPECT_EQ(second->work.framesDetected, 0);
  other.settings.set("light.frame", std::string("world"));
  const auto third = pipeline.everything(other);
  EXPECT_EQ(third->scene, scene);
  EXPECT_EQ(third->work.framesDetected, 0);  // evidence does not depend on where lights stand
  const auto again = pipeline.everything(asked());
  EXPECT_EQ(again->scene, first->scene);
}

TEST(LightFrame, APoseThatComesLiveIsAnswered) {
  const LivePredictor live(flashScene(14), asked());
  ASSERT_FALSE(live.failure());
  const Camera camera = lookingAt({1.1, -1.2, 0.6}, {0, 0, 0});
  const auto answer = live.predict("new", camera.camFromWorld, camera);
  ASSERT_TRUE(answer);
  const std::vector<Highlight> exact = exactContours(body(), camera, {"lamp", camera.camFromWorld.inverse() * kFlash});
  ASSERT_EQ(exact.size(), 1u);
  bool any = false;
  for (const LiveHighlights& of : answer->highlights)
    for (const PredictedHighlight& h : of.prediction.highlights()) {
      if (of.model != "limit-angle") continue;
      any = true;
      for (const Pixel& p : h.contour.points) EXPECT_LT(distance(exact.front().contour, p), 0.05);
    }
  EXPECT_TRUE(any);
  // An object that moved, and a camera that moved with it, see the same.
  const Isometry3d moved = motionOf(3);
  const auto elsewhere = live.predict("new", camera.camFromWorld * moved.inverse(), camera, moved);
  ASSERT_TRUE(elsewhere);
  ASSERT_EQ(elsewhere->highlights.size(), answer->highlights.size());
  for (std::size_t i = 0; i < answer->highlights.size(); ++i)
    for (std::size_t k = 0; k < answer->highlights[i].prediction.highlights().size(); ++k)
      EXPECT_LT((answer->highlights[i].prediction.highlights()[k].brightest.pixel -
                 elsewhere->highlights[i].prediction.highlights()[k].brightest.pixel)
                    .norm(),
                1e-6);
}

TEST(LightFrame, APathTracersFlashAndTurntableAreAnswered) {
  GLINT_NEEDS_SHARED_DATA();
  for (const std::string name : {"flash", "turntable"}) {
    const std::string folder = std::string(GLINT_SHARED_DIR) + "/data/ladder/" + name;
    InspectionRequest request = asked();
    request.source = FrameSource::Image;
    request.truthFolder = folder + "/contours";
    request.models = {"canonical", "limit-angle", "reflectance"};
    const Inspection in = inspect(std::make_shared<const Scene>(readScene(folder + "/scene-analytic.json")), request);
    EXPECT_EQ(in.lightFrame.frame, LightFrame::Camera) << name << in.lightFrame.reason;
    EXPECT_LT(meanPct(in, "limit-angle"), 0.5) << name;
    EXPECT_LT(meanPct(in, "reflectance"), 0.12) << name;
    EXPECT_GT(summarise(in, in.models.at("canonical")).matched, 0) << name;
    if (name == "flash") EXPECT_LT((lightOfIt(in).position() - Vector3d(0.05, -0.02, 0)).head<2>().norm(), 0.01 * 0.8);
  }
}

}  // namespace
}  // namespace glint::light_frame_tests
