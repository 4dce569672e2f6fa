// SPDX-License-Identifier: BSD-3-Clause
// The description of a 3D picture, against numbers that are worked out by hand: a camera above a mirror in the plane z = 0.
#include "core/draw/scene_drawing.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace glint::draw {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Vector = Eigen::Vector3d;

constexpr double kNear = 1e-12;

/// 100 px focal length, 101 x 101 px, at (0, 0, 2) with the world's x to the right and y upwards in the image: the pixel
/// (50 + u, 50 - v) shows the point (u / 50, v / 50, 0).
Camera above() {
  Camera camera;
  camera.width = camera.height = 101;
  camera.pixelFromRay << 100, 0, 50, 0, 100, 50, 0, 0, 1;
  camera.camFromWorld.linear() = Vector(1, -1, -1).asDiagonal();
  camera.camFromWorld.translation() = Vector(0, 0, 2);
  return camera;
}

/// A square about (0.5, 0, 0) whose sides are 0.2 long; the middle of the lower one is a vertex, too.
Polyline square() {
  Polyline line;
  line.points = {{70, 45}, {80, 45}, {80, 55}, {75, 55}, {70, 55}};
  return line;
}

SceneScale byHand() {
  SceneScale scale;
  scale.surfaceBox = {Vector(-1, -1, 0), Vector(1, 1, 0)};
  scale.sceneBox = {Vector(-1, -1, 0), Vector(1, 1, 2)};
  scale.surfaceSize = std::sqrt(8);
  scale.sceneSize = std::sqrt(12);
  scale.cameraDepth = 0.5;
  return scale;
}

/// What was observed in one frame that does not train, a light in the direction in which its brightest point reflects, and a
/// model that explains it badly.
Inspection smallOne() {
  auto scene = std::make_shared<Scene>();
  AnalyticSpec plane;
  plane.type = "plane";
  scene->surfaces["table"] = plane;
  Frame frame;
  frame.id = "7";
  frame.camera = above();
  frame.surface = "table";
  scene->frames.push_back(frame);
  scene->lights = {{"near", sphereLamp(Light::at(Vector(1.25, 0, 3)), 0.1)}, {"sun", lampTowards(Vector(0, 0, 1))}};

  Inspection inspection;
  inspection.scene = inspection.given = scene;
  inspection.surfaces = std::make_shared<SurfaceCache>(*scene);
  Highlight seen;
  seen.light = "lamp";
  seen.contour = square();
  seen.peak = {75, 50};
  FrameEvidence evidence;
  evidence.frame = 0;
  evidence.highlights = {seen};
  inspection.evidence = {evidence};
  LightEstimate light;
  light.light = Light::at(Vector(1.25, 0, 3));
  inspection.lights.insert_or_assign({"lamp"}, light);

  ModelFit fit;
  fit.model = "canonical";
  fit.light = "lamp";
  fit.poor = "it misses its own training views";
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation() = Vector(0, 0, 1);
  const Ellipsoid ellipsoid(place, Vector(0.3, 0.2, 0));
  fit.family = EllipsoidFit{ellipsoid.dual(), ellipsoid};
  fit.lightEstimate = Light::at(Vector(0, 0, 100));
  PredictedHighlight predicted;
  predicted.contour = square();
  predicted.gaps = {{1, 2}};
  FrameComparison comparison;
  comparison.frame = comparison.fit = 0;
  comparison.light = "lamp";
  comparison.prediction = std::vector{predicted};
  ModelResult result;
  result.model = "canonical";
  result.fits.push_back({"lamp", {}, fit, {}});
  result.frames = {comparison};
  inspection.models["canonical"] = result;
  inspection.request.models = {"canonical"};
  return inspection;
}

std::vector<SceneThing> of(SceneRole role, const SceneDrawing& all) {
  std::vector<SceneThing> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found), [&](const SceneThing& t) { return t.role == role; });
  return found;
}

void expectAt(const Vector& at, const Vector& wanted) { EXPECT_LT((at - wanted).norm(), 1e-9) << at.transpose(); }

class SceneDrawingTest : public testing::Test {
 protected:
  void SetUp() override {
    options_.scale = byHand();
    const auto surface = inspection_.surfaces->surfaceOf(0, NormalPolicy::Interpolated);
    ASSERT_TRUE(surface);
    frame_ = frameThings(inspection_, 0, *surface, options_);
    scene_ = sceneThings(inspection_, options_);
  }
  Inspection inspection_ = smallOne();
  DrawingOptions options_;
  SceneDrawing frame_, scene_;
};

TEST_F(SceneDrawingTest, ACameraIsItsImagePlaneItsEdgesAndATickAboveIt) {
  const std::vector<SceneThing> cameras = of(SceneRole::Camera, frame_);
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0].frame, 0);
  EXPECT_EQ(cameras[0].label, "frame 7");
  expectAt(cameras[0].position(), {0, 0, 2});
  ASSERT_EQ(cameras[0].chains.size(), 6u);
  constexpr double kHalf = 50.5 / 100 * 0.5;  // of the image plane, 0.5 in front of the camera
  ASSERT_EQ(cameras[0].chains[0].size(), 5u);
  expectAt(cameras[0].chains[0][0], {-kHalf, kHalf, 1.5});
  expectAt(cameras[0].chains[0][2], {kHalf, -kHalf, 1.5});
  expectAt(cameras[0].chains[0][4], cameras[0].chains[0][0]);
  expectAt(cameras[0].chains[3][0], {0, 0, 2});
  EXPECT_GT(cameras[0].chains[5][1].y(), kHalf) << "up in the image is +y of the world";
}

TEST_F(SceneDrawingTest, AHighlightHasItsMirrorInTheTangentPlane) {
  const std::vector<SceneThing> points = of(SceneRole::BrightestPoint, frame_), planes = of(SceneRole::TangentPlane, frame_),
                                virtuals = of(SceneRole::VirtualCamera, frame_);
  ASSERT_EQ(points.size(), 1u);  // the prediction has no tangent plane
  ASSERT_EQ(planes.size(), 1u);
  ASSERT_EQ(virtuals.size(), 1u);
  expectAt(points[0].position(), {0.5, 0, 0});
  expectAt(points[0].normal, {0, 0, 1});
  EXPECT_EQ(points[0].highlight, 0);
  EXPECT_EQ(points[0].light, "lamp");
  EXPECT_EQ(points[0].model, "");
  EXPECT_NEAR(planes[0].radius, 3 * std::hypot(0.1, 0.1), 1e-9);
  for (const Vector& p : planes[0].chains.at(0)) {
    EXPECT_NEAR(p.z(), 0, kNear);
    EXPECT_NEAR((p - Vector(0.5, 0, 0)).norm(), planes[0].radius, 1e-9);
  }
  expectAt(virtuals[0].position(), {0, 0, -2});
  expectAt(virtuals[0].chains[0][0], {-50.5 / 200, 50.5 / 200, -1.5});
  EXPECT_EQ(virtuals[0].label, "virtual camera 7");
  EXPECT_EQ(colourOf(virtuals[0]), kVirtualCamera);
}

TEST_F(SceneDrawingTest, TheReflectedRayGoesALittleBeyondTheLight) {
  const std::vector<SceneThing> seen = of(SceneRole::ViewRay, frame_), out = of(SceneRole::ReflectedRay, frame_);
  ASSERT_EQ(seen.size(), 1u);
  ASSERT_EQ(out.size(), 1u);
  expectAt(seen[0].chains.at(0).front(), {0, 0, 2});
  expectAt(seen[0].chains[0].back(), {0.5, 0, 0});
  expectAt(out[0].chains.at(0).front(), {0.5, 0, 0});
  // To the camera (-0.5, 0, 2), mirrored (0.5, 0, 2): the light is at 1.5 of it, and the ray ends at 1.1 of that.
  expectAt(out[0].chains[0].back(), {0.5 + 1.65 * 0.5, 0, 1.65 * 2});
}

TEST_F(SceneDrawingTest, ContoursLieOnTheSurfaceAndGapsAreApart) {
  const std::vector<SceneThing> observed = of(SceneRole::ObservedContour, frame_),
                                predicted = of(SceneRole::PredictedContour, frame_);
  ASSERT_EQ(observed.size(), 1u);
  ASSERT_EQ(observed[0].chains.size(), 1u);
  ASSERT_EQ(observed[0].chains[0].size(), 6u) << "closed";
  expectAt(observed[0].chains[0][0], {0.4, 0.1, 0});
  expectAt(observed[0].chains[0][2], {0.6, -0.1, 0});
  EXPECT_EQ(colourOf(observed[0]), kObserved);
  ASSERT_EQ(predicted.size(), 2u);
  EXPECT_FALSE(predicted[0].gap);
  EXPECT_TRUE(predicted[1].gap);
  for (const SceneThing& part : predicted) {
    EXPECT_TRUE(part.poor);
    EXPECT_EQ(part.model, "canonical");
    EXPECT_EQ(colourOf(part), pale(modelColour("canonical")));
  }
  const WorldChain& bridge = predicted[1].chains.at(0);  // the right side, from top to bottom
  expectAt(bridge.front(), {0.6, 0.1, 0});
  expectAt(bridge.back(), {0.6, -0.1, 0});
  for (const WorldChain& chain : predicted[0].chains)
    for (std::size_t i = 1; i < chain.size(); ++i)
      EXPECT_LT(0.5 * (chain[i] + chain[i - 1]).x(), 0.6 - 1e-6) << "what is predicted does not bridge the gap";
}

TEST_F(SceneDrawingTest, AnEllipsoidIsItsBodyWithItsPrincipalEllipses) {
  const std::vector<SceneThing> bodies = of(SceneRole::Ellipsoid, scene_);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_TRUE(bodies[0].poor);
  EXPECT_EQ(bodies[0].problem, "");
  expectAt(bodies[0].position(), {0, 0, 1});
  ASSERT_EQ(bodies[0].chains.size(), 3u);
  expectAt(bodies[0].chains[0][0], {0.3, 0, 1});
  expectAt(bodies[0].chains[0][24], {0, 0.2, 1});
  expectAt(ballOf(*bodies[0].body, 0) * Vector(0.6, 0, 0.8), {0.18, 0, 1});
  expectAt(ballOf(*bodies[0].body, 0.01) * Vector(0, 0, 1), {0, 0, 1.003});
  ModelFit far = *inspection_.models["canonical"].fits[0].fit;
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation() = Vector(0, 0, 51 * std::sqrt(12) + 1);
  const Ellipsoid away(place, Vector(0.3, 0.2, 0.1));
  far.family = EllipsoidFit{away.dual(), away};
  EXPECT_THAT(ellipsoidThing(far, options_.scale)->problem, HasSubstr("farther away"));
  far.family = EllipsoidFit{{Eigen::Vector4d(-0.01, 0.02, 0.02, 1).asDiagonal()}};
  EXPECT_THAT(ellipsoidThing(far, options_.scale)->problem, HasSubstr("hyperboloid of two sheets"));
  far.family = LimitAngleFit{};
  EXPECT_FALSE(ellipsoidThing(far, options_.scale));
}

TEST_F(SceneDrawingTest, LampsAreOutlinedAndFarOnesAreArrows) {
  const std::vector<SceneThing> estimates = of(SceneRole::Light, scene_), fitted = of(SceneRole::FittedLamp, scene_),
                                truth = of(SceneRole::TrueLamp, scene_);
  ASSERT_EQ(estimates.size(), 1u);
  expectAt(estimates[0].position(), {1.25, 0, 3});
  EXPECT_EQ(estimates[0].label, "light lamp (estimate)");
  EXPECT_TRUE(estimates[0].chains.empty()) << "a point has no outline";
  ASSERT_EQ(fitted.size(), 1u);
  EXPECT_EQ(fitted[0].label, "canonical light, 99 m away");
  EXPECT_FALSE(fitted[0].shared);
  ASSERT_TRUE(fitted[0].arrow);
  expectAt(fitted[0].arrow->first, {0, 0, 0.6 * std::sqrt(8)});
  expectAt(fitted[0].arrow->second, {0, 0, 1.1 * std::sqrt(8)});
  ASSERT_EQ(truth.size(), 2u);
  ASSERT_EQ(truth[0].chains.size(), 3u);
  expectAt(truth[0].chains[0][0], {1.35, 0, 3});
  EXPECT_FALSE(truth[0].arrow);
  EXPECT_EQ(truth[1].label, "truth: light sun, at infinity");
  EXPECT_TRUE(truth[1].chains.empty());
  expectAt(truth[1].arrow->second, {0, 0, 1.1 * std::sqrt(8)});
  // Ringed so that it is seen, and as it is where it is large enough.
  EXPECT_NEAR(trueLampThing(inspection_.scene->lights[0], 0.5, options_.scale).chains[0][0].x(), 1.75, kNear);
  EXPECT_NEAR(trueLampThing(inspection_.scene->lights[0], 0.05, options_.scale).chains[0][0].x(), 1.35, kNear);
  inspection_.models["canonical"].fits[0].fit->lightEstimate = Light::at(Vector(1.25, 0, 3));
  EXPECT_TRUE(fittedLampThing(inspection_, *inspection_.models["canonical"].fits[0].fit, options_.scale)->shared);
}

TEST_F(SceneDrawingTest, EveryRoleHasAName) {
  EXPECT_STREQ(nameOf(SceneRole::Surface), "surface");
  EXPECT_STREQ(nameOf(SceneRole::PredictedContour), "predicted-contour");
  EXPECT_STREQ(nameOf(SceneRole::TrueLamp), "true-lamp");
  ASSERT_EQ(of(SceneRole::Surface, frame_).size(), 1u);
  EXPECT_EQ(*of(SceneRole::Surface, frame_)[0].surface, inspection_.surfaces->keyOf(0));
  EXPECT_THROW(frameThings(inspection_, 1, nullptr, options_), std::invalid_argument);
  EXPECT_EQ(frameThings(inspection_, 0, nullptr, options_).size(), 1u) << "without a surface the camera alone";
}

TEST(SceneScale, CamerasAndPointsAreSizedByTheScene) {
  const Inspection inspection = smallOne();
  const SceneScale scale = sceneScale(inspection, Eigen::AlignedBox3d(Vector(-1, -1, 0), Vector(1, 1, 0)), {0}, 2);
  EXPECT_NEAR(scale.surfaceSize, std::sqrt(8), kNear);
  EXPECT_NEAR(scale.sceneSize, std::sqrt(12), kNear);
  EXPECT_NEAR(scale.cameraDepth, 2 * 0.1 * std::sqrt(12), kNear) << "one camera has no neighbour: as large as it may be";
  EXPECT_NEAR(scale.point, 2 * 0.006 * std::sqrt(8), kNear);
}

}  // namespace
}  // namespace glint::draw
