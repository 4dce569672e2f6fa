// SPDX-License-Identifier: BSD-3-Clause
#include "viz/scene_view.h"

#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>

#include "core/app/lamp_answer.h"
#include "core/draw/contrast.h"
#include "tests/tolerances.h"
#include "tests/viz/image_checks.h"
#include "tests/viz/small_inspection.h"
#include "viz/layers.h"
#include "viz/offscreen.h"
#include "viz/scene_questions.h"
#include "viz/solver_runs.h"
#include "viz/style.h"
#include "viz/view_camera.h"

namespace glint::viz {
namespace {

using test::smallInspection;
using test::TemporaryFolder;

using test::countDifferent;
using test::countNear;
using test::isNear;

/// Puts the eye at a frame's camera, with its vertical field of view and the middle of the ball straight ahead.
void standAt(SceneView& view, int frame) {
  const Camera camera = smallInspection(TemporaryFolder().path())->scene->frames[static_cast<std::size_t>(frame)].camera;
  const Eigen::Matrix3d axes = camera.camFromWorld.linear();
  const Eigen::Vector3d eye = camera.centreInWorld(), forward = axes.row(2).transpose(), down = axes.row(1).transpose();
  const double angle = 2 * std::atan(0.5 * camera.height / camera.pixelFromRay(1, 1)) * 180 / std::numbers::pi;
  view.setViewPoint({eye, eye + eye.norm() * forward, -down, angle});
}

class SceneViewPicture : public test::PictureTest {
 protected:
  TemporaryFolder folder_;
};

TEST_F(SceneViewPicture, EveryLayerIsSeenAndGoesAwayWhenItIsSwitchedOff) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  LampAnswer lamp;  // no inspection has measured ones
  lamp.id = "measured";
  lamp.direction = Eigen::Vector3d(-0.6, -0.8, 0);
  view.setLamps(std::make_shared<const std::vector<LampAnswer>>(1, lamp));
  SolverRun run;
  run.answer = true;
  run.start = Eigen::Vector4d(0.2, 0, 0.4, 1);
  run.end = Eigen::Vector4d(0.3, 0.3, 0.6, 1);
  view.setRuns(std::make_shared<const std::vector<DrawnRuns>>(1, DrawnRuns{"canonical", "lamp", {run}}));
  // Those that lie over others: they are switched on alone, below.
  const std::set<std::string> over{"walk", "cones"};
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, over.count(layer.name) == 0);
  const Image all = render(view);
  const Image again = render(view);
  ASSERT_EQ(countDifferent(all, again), 0);
  for (const Layer& layer : sceneLayers()) {
    SCOPED_TRACE(layer.name);
    if (over.count(layer.name)) {
      const auto story = std::make_shared<const WalkStory>(test::shortWalk(*smallInspection(folder_.path())));
      view.setWalk(story, story->steps() - 1);
      view.setLayerVisible(layer.name, true);
      EXPECT_GT(countDifferent(all, render(view)), 12);
      view.setLayerVisible(layer.name, false);
      EXPECT_EQ(countDifferent(all, render(view)), 0);
      continue;
    }
    view.setLayerVisible(layer.name, false);
    EXPECT_FALSE(view.layerVisible(layer.name));
    const Image without = render(view);
    EXPECT_GT(countDifferent(all, without), 12);  // the thinnest, a contour, changes 20; equal pictures differ in 0
    view.setLayerVisible(layer.name, true);
    EXPECT_EQ(countDifferent(all, render(view)), 0);
  }
}

TEST_F(SceneViewPicture, NothingIsDrawnWithoutLayersButTheFrameOfThePicture) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, false);
  const Image image = render(view);
  EXPECT_GT(countNear(image, kDarkBackground, 0.02), 0.95 * kWidth * kHeight);
  view.setDarkBackground(false);
  EXPECT_GT(countNear(render(view), kLightBackground, 0.02), 0.95 * kWidth * kHeight);
}

/// Cameras that look down steeply, all from one side, have an upwards of their own that points away from them: the picture must
/// not lie on its side for that.
TEST_F(SceneViewPicture, TheHorizonStaysLevelWhereCamerasLookDownSteeply) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  auto scene = std::make_shared<Scene>(*inspection->scene);
  const double n = static_cast<double>(scene->frames.size()), elevation = 75 * std::numbers::pi / 180;
  for (std::size_t i = 0; i < scene->frames.size(); ++i) {
    const double azimuth = (static_cast<double>(i) / (n - 1) - 0.5) * std::numbers::pi / 2;
    const Eigen::Vector3d back(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                               std::sin(elevation));
    const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(back).normalized();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() << right.transpose(), -back.cross(right).transpose(), -back.transpose();
    pose.translation() = -(pose.linear() * (1.7 * back));
    scene->frames[i].camera.camFromWorld = pose;
  }
  // Even if z is downwards: all of it turned over, or all cameras about their own axes. (What finds the upright axis gives it
  // with an arbitrary sign; among these are cases of either.)
  const auto half = [](const Eigen::Vector3d& axis) { return Eigen::Isometry3d(Eigen::AngleAxisd(std::numbers::pi, axis)); };
  const Eigen::Isometry3d same = Eigen::Isometry3d::Identity(), rolled = half(Eigen::Vector3d::UnitZ()),
                          overX = half(Eigen::Vector3d::UnitX()), overY = half(Eigen::Vector3d::UnitY());
  const std::tuple<Eigen::Isometry3d, Eigen::Isometry3d, double> cases[] = {
      {same, same, 1}, {rolled, same, -1}, {same, overX, -1}, {same, overY, -1}, {rolled, overX, 1}, {rolled, overY, 1}};
  for (const auto& [camera, world, upwards] : cases) {
    SCOPED_TRACE(upwards);
    auto turned = std::make_shared<Scene>(*scene);
    for (Frame& frame : turned->frames) frame.camera.camFromWorld = camera * frame.camera.camFromWorld * world;
    const auto shown = std::make_shared<Inspection>(*inspection);
    shown->scene = shown->given = turned;
    shown->surfaces = std::make_shared<SurfaceCache>(*shown->scene);
    SceneView view;
    view.setInspection(shown);
    (void)render(view);
    view.frameAll();
    const ViewPoint seen = view.viewPoint();
    EXPECT_NEAR(seen.up.cross(seen.position - seen.focalPoint).normalized().z(), 0, 1e-6);
    EXPECT_GT(upwards * seen.up.z(), 0.5);
  }
}

TEST_F(SceneViewPicture, EverythingHoldsAnEllipsoidBeyondTheCameras) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  const Ellipsoid wide(Eigen::Isometry3d(Eigen::Translation3d(2.6, -2.1, 1.6)), {0.7, 0.9, 0.5});
  inspection->models.at("canonical").fits[0].fit->family = EllipsoidFit{wide.dual(), wide};
  SceneView view;
  view.setInspection(inspection);
  const std::set<std::string> seen{"surface", "cameras", "ellipsoids"};
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, seen.count(layer.name) > 0);
  (void)render(view);
  for (const AxisView axis : {AxisView::Front, AxisView::Right, AxisView::Top}) {
    view.lookAlong(axis);
    const ViewPoint seen = view.viewPoint();
    const Eigen::Vector3d back = (seen.position - seen.focalPoint).normalized(), right = seen.up.cross(back);
    for (int i = 0; i < 200; ++i) {  // points all over it
      const double t = 2.4 * i, z = -1 + (i + 0.5) / 100, r = std::sqrt(1 - z * z);
      const Eigen::Vector3d p =
          wide.centre() + wide.semiAxes().cwiseProduct(Eigen::Vector3d(r * std::cos(t), r * std::sin(t), z));
      const double depth = -back.dot(p - seen.position), half = std::tan(seen.viewAngleDeg * std::numbers::pi / 360) * depth;
      ASSERT_GT(depth, 0);
      EXPECT_LT(std::abs(seen.up.dot(p - seen.position)), half) << i;
      EXPECT_LT(std::abs(right.dot(p - seen.position)), half * kWidth / kHeight) << i;
    }
  }
}

/// primal's ellipsoid on a ball is within it: whoever asks for ellipsoids is to see it. One before the surface needs no such
/// help.
TEST_F(SceneViewPicture, AnEllipsoidInsideTheSurfaceIsSeenThroughIt) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  const Ellipsoid middle(Eigen::Isometry3d::Identity(), {0.15, 0.15, 0.15});  // in a ball of 0.4
  inspection->models.at("canonical").fits[0].fit->family = EllipsoidFit{middle.dual(), middle};
  SceneView view;
  view.setInspection(inspection);
  const auto greenWith = [&](const std::set<std::string>& seen) {
    for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, seen.count(layer.name) > 0);
    const Image image = render(view);
    int n = 0;  // px of the ellipsoid's colour, more green than red, off the axes in the corner; the surface is grey
    for (int y = 0; y < kHeight; ++y)
      for (int x = kWidth / 4; x < kWidth * 3 / 4; ++x) n += image.at(x, y, 1) - image.at(x, y, 0) > 0.15;
    return n;
  };
  constexpr int kLines = 300;  // px of its three outlines; behind an opaque ball they leave none
  EXPECT_EQ(greenWith({"surface"}), 0);
  EXPECT_GT(greenWith({"surface", "ellipsoids"}), kLines);
  EXPECT_GT(greenWith({"surface", "ellipsoids", "virtual-cameras"}), kLines);
  // Outside, the ball stays opaque.
  LayerCache cache;
  LayerInput input;
  input.inspection = inspection.get();
  input.models = {"canonical"};
  input.surfaceKey = inspection->surfaces->keyOf(0);
  input.surface = *inspection->surfaces->surfaceOf(0, {});
  input.scale = sceneScale(*inspection, input.surface.get(), {0, 1, 2}, 1);
  input.cache = &cache;
  const Eigen::Vector3d eye = inspection->scene->frames[0].camera.centreInWorld();
  for (const bool inside : {false, true}) {
    const Ellipsoid small(Eigen::Isometry3d(Eigen::Translation3d(inside ? Eigen::Vector3d::Zero().eval() : 0.5 * eye)),
                          {0.05, 0.05, 0.05});
    inspection->models.at("canonical").fits[0].fit->family = EllipsoidFit{small.dual(), small};
    EXPECT_EQ(ellipsoidsLayer(input).behindSurface, inside);
  }
}

TEST_F(SceneViewPicture, TheColourBarStaysInsideThePicture) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  for (const int width : {kWidth, 240}) {
    resize(width, kHeight);
    SceneView view;
    view.setInspection(inspection);
    for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "cameras");
    CameraColours colours;
    colours.by = CameraColours::By::Influence;
    colours.model = "canonical";
    colours.influence = {{0, 1.2e-5}, {1, -1.1e-5}};
    view.setCameraColours(colours);
    const Image image = render(view);
    int marked = 0;
    for (int y = kHeight - 90; y < kHeight - 20; ++y)
      for (int x = width - 3; x < width; ++x) marked += !isNear(image, x, y, kDarkBackground, 0.06);
    EXPECT_EQ(marked, 0) << width;
  }
}

/// What a view is fitted to stands above the colour bar, not under it.
TEST_F(SceneViewPicture, TheColourBarLeavesFreeWhatTheViewIsFittedTo) {
  const std::shared_ptr<Inspection> inspection = smallInspection(folder_.path());
  constexpr double kBarPx = 80;  // of 480: the bar with its title and its ticks
  for (const bool coloured : {false, true}) {
    SceneView view;
    view.setInspection(inspection);
    for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "cameras");
    CameraColours colours;
    colours.by = coloured ? CameraColours::By::Influence : CameraColours::By::Role;
    colours.model = "canonical";
    colours.influence = {{0, 1.2e-5}, {1, -1.1e-5}};
    view.setCameraColours(colours);
    (void)render(view);      // which shows all, at first
    double least = kHeight;  // px from the lower edge, of the cameras and the ball's box
    const ViewPoint seen = view.viewPoint();
    const Eigen::Vector3d back = (seen.position - seen.focalPoint).normalized();
    std::vector<Eigen::Vector3d> points;
    for (const Frame& f : inspection->scene->frames) points.push_back(f.camera.centreInWorld());
    for (int i = 0; i < 8; ++i) points.emplace_back(i & 1 ? 0.4 : -0.4, i & 2 ? 0.4 : -0.4, i & 4 ? 0.4 : -0.4);
    for (const Eigen::Vector3d& p : points) {
      const double half = std::tan(seen.viewAngleDeg * std::numbers::pi / 360) * -back.dot(p - seen.position);
      least = std::min(least, 0.5 * kHeight * (1 + seen.up.dot(p - seen.position) / half));
    }
    EXPECT_EQ(least > kBarPx, coloured) << least;
  }
}

TEST(BetweenViews, StartsAndEndsExactlyAndTurnsAboutWhatIsLookedAt) {
  const ViewPoint from{{4, 0, 0}, {0, 0, 0}, {0, 0, 1}, 30}, to{{0, 1, 0}, {0, 0, 0}, {0, 0, 1}, 20, true};
  EXPECT_EQ(between(from, to, 0).position, from.position);
  EXPECT_EQ(between(from, to, 1).position, to.position);
  EXPECT_TRUE(between(from, to, 1).parallel);
  const ViewPoint half = between(from, to, 0.5);
  // A quarter turn about z, halved; distances 4 and 1 by equal ratios.
  EXPECT_NEAR((half.position - Eigen::Vector3d(std::sqrt(2), std::sqrt(2), 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((half.up - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR(half.viewAngleDeg, 25, 1e-12);
  // What is looked at moves straight, upwards turns with the eye.
  const ViewPoint elsewhere = between(from, {{2, 6, 0}, {2, 2, 0}, {1, 0, 0}, 30}, 0.5);
  EXPECT_NEAR((elsewhere.focalPoint - Eigen::Vector3d(1, 1, 0)).norm(), 0, 1e-12);
  // From right, up, back = y, z, x to z, x, y: a turn of 120 degrees about (1, 1, 1), halved.
  const Eigen::AngleAxisd half60(std::numbers::pi / 3, Eigen::Vector3d(1, 1, 1).normalized());
  EXPECT_NEAR((elsewhere.up - half60 * Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR((elsewhere.position - elsewhere.focalPoint - 4 * (half60 * Eigen::Vector3d::UnitX())).norm(), 0, 1e-12);
  // A view that looks along its own upwards has no way; it is gone to at once.
  const ViewPoint none{{0, 0, 3}, {0, 0, 0}, {0, 0, 1}, 30};
  EXPECT_EQ(between(from, none, 0.5).position, none.position);
  EXPECT_EQ(between(none, from, 0.5).position, from.position);
  // The other side, where the turn has no shortest way, still gives a view.
  const ViewPoint opposite = between(from, {{-4, 0, 0}, {0, 0, 0}, {0, 0, 1}, 30}, 0.5);
  EXPECT_TRUE(opposite.position.allFinite());
  EXPECT_NEAR(opposite.position.norm(), 4, 1e-9);
}

/// A bridged gap is not drawn as if it had been predicted: half of the contour a gap leaves clearly less ink.
TEST_F(SceneViewPicture, GapsOfAPredictionAreDotted) {
  const auto inkOf = [&](const std::vector<std::pair<int, int>>& gaps) {
    const auto inspection = smallInspection(folder_.path());
    for (FrameComparison& c : inspection->models.at("canonical").frames)
      for (PredictedHighlight& h : c.prediction.editable()) h.gaps = gaps;
    SceneView view;
    view.setInspection(inspection);
    view.setSelection({5, "", -1});
    for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "predicted-contours");
    standAt(view, 5);
    return countNear(render(view), modelColour("canonical"), 0.2);
  };
  const int whole = inkOf({}), half = inkOf({{0, 36}});
  EXPECT_GT(half, 0.4 * whole);
  EXPECT_LT(half, 0.8 * whole);
}

TEST_F(SceneViewPicture, AnEmptyViewIsAllowed) {
  SceneView view;
  EXPECT_GT(countNear(render(view), kDarkBackground, 0.02), 0.98 * kWidth * kHeight);
  view.setInspection(nullptr);
  EXPECT_FALSE(view.pick(10, 10));
  EXPECT_THROW(view.setLayerVisible("no-such-layer", true), std::invalid_argument);
}

TEST_F(SceneViewPicture, ThePhotographIsTheRightWayUpAsItsCameraSeesIt) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "photographs");
  standAt(view, 4);
  const Image image = render(view);
  // 4:3 as the camera: the drawn photograph fills the window. The legend stands in the top left corner, labels nowhere else.
  EXPECT_TRUE(isNear(image, 200, 180, {1, 0, 0}, 0.05));
  EXPECT_TRUE(isNear(image, 440, 180, {0, 1, 0}, 0.05));
  EXPECT_TRUE(isNear(image, 200, 300, {0, 0, 1}, 0.05));
  EXPECT_TRUE(isNear(image, 440, 300, {1, 1, 1}, 0.05));
  // Its middle lies where the camera's axis goes: the colours meet in the middle of the window.
  EXPECT_TRUE(isNear(image, kWidth / 2 - 3, kHeight / 2 - 3, {1, 0, 0}, 0.25));
  EXPECT_TRUE(isNear(image, kWidth / 2 + 3, kHeight / 2 + 3, {1, 1, 1}, 0.25));
}

TEST_F(SceneViewPicture, LookingThroughACameraProjectsAsTheCameraDoes) {
  const auto inspection = smallInspection(folder_.path());
  SceneView view;
  view.setInspection(inspection);
  view.setSelection({5, "", -1});
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "predicted-contours");
  standAt(view, 5);
  const Image image = render(view);
  // The contour is a circle of 15 px in a 320 x 240 image: twice that here, about the mirror point's pixel.
  const Pixel centre = 2 * (inspection->evidence[5].highlights[0].peak + Pixel(0.5, 0.5));
  double sum = 0, sumX = 0, sumY = 0, sumRadius = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if ((Pixel(x, y) - centre).norm() > 45 || !isNear(image, x, y, modelColour("canonical"), 0.12)) continue;  // not the legend
      sum += 1;
      sumX += x + 0.5;
      sumY += y + 0.5;
      sumRadius += (Pixel(x + 0.5, y + 0.5) - centre).norm();
    }
  }
  ASSERT_GT(sum, 50);
  EXPECT_NEAR(sumX / sum, centre.x(), 1.5);
  EXPECT_NEAR(sumY / sum, centre.y(), 1.5);
  EXPECT_NEAR(sumRadius / sum, 30, 1.5);
}

TEST_F(SceneViewPicture, ModelsAreDrawnInTheirColourAndOnlyWhenAskedFor) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "ellipsoids");
  const Image with = render(view);
  view.setModels({"dual"});
  const Image without = render(view);
  EXPECT_GT(countDifferent(with, without), 500);
  EXPECT_LT(countNear(without, modelColour("canonical")), 10);
}

TEST_F(SceneViewPicture, TheSameSceneLooksTheSameAtEveryScale) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  view.setLayerVisible("photographs", false);
  const Image metres = render(view);
  for (const double scale : {1e-3, 1e3}) {
    SCOPED_TRACE(scale);
    SceneView other;
    other.setInspection(smallInspection(folder_.path(), scale));
    other.setLayerVisible("photographs", false);
    const Image picture = render(other);
    // The scale bar's text differs, and edges may; a glyph with a fixed size would change thousands of pixels.
    EXPECT_LT(countDifferent(metres, picture), 0.01 * kWidth * kHeight);
  }
}

TEST_F(SceneViewPicture, ASelectionRebuildsNeitherTheSurfaceNorTheEllipsoids) {
  SceneView view;
  const auto inspection = smallInspection(folder_.path());
  view.setInspection(inspection);
  render(view);
  EXPECT_EQ(view.buildCount("surface"), 1);
  EXPECT_EQ(view.buildCount("directions"), 0);  // hidden layers cost nothing
  const Image before = render(view);
  view.setSelection({5, "", -1});
  EXPECT_GT(countDifferent(before, render(view)), 50);
  EXPECT_EQ(view.buildCount("surface"), 1);
  EXPECT_EQ(view.buildCount("ellipsoids"), 1);
  EXPECT_EQ(view.buildCount("true-light"), 1);
  EXPECT_EQ(view.buildCount("cameras"), 2);
  EXPECT_EQ(view.buildCount("predicted-contours"), 2);
  // A recomputation on the same scene keeps the surface as well.
  view.setInspection(std::make_shared<Inspection>(*inspection));
  render(view);
  EXPECT_EQ(view.buildCount("surface"), 1);
  EXPECT_EQ(view.buildCount("predicted-contours"), 3);
  // Switching a layer off and on builds nothing.
  view.setLayerVisible("surface", false);
  render(view);
  view.setLayerVisible("surface", true);
  render(view);
  EXPECT_EQ(view.buildCount("surface"), 1);
}

TEST_F(SceneViewPicture, PickingTellsTheNumbersOfWhatLiesThere) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "surface");
  standAt(view, 0);
  render(view);
  // The window is attached while rendering only; picking needs it.
  vtkNew<vtkRenderWindow> window;
  prepareWindow(window);
  window->SetShowWindow(false);
  window->SetOffScreenRendering(1);
  window->SetSize(kWidth, kHeight);
  window->AddRenderer(view.renderer());
  window->Render();
  const std::optional<Picked> middle = view.pick(kWidth / 2, kHeight / 2);
  ASSERT_TRUE(middle);
  EXPECT_EQ(middle->layer, "surface");
  EXPECT_NEAR(middle->position.norm(), 0.4, 1e-6);
  // The camera looks at the sphere's centre: the middle of its image is the nearest point.
  const Eigen::Vector3d eye = smallInspection(folder_.path())->scene->frames[0].camera.centreInWorld();
  EXPECT_LT((middle->position - 0.4 * eye.normalized()).norm(), 0.005);
  for (const char* name : {"P = ", "N = ", "alpha (lamp) = ", "pixel x = "})
    EXPECT_NE(middle->text.find(name), std::string::npos) << middle->text;
  EXPECT_FALSE(view.pick(kWidth - 5, 5));
  view.setLayerVisible("peaks", true);
  window->Render();
  const Pixel peak = 2 * (smallInspection(folder_.path())->evidence[0].highlights[0].peak + Pixel(0.5, 0.5));
  const std::optional<Picked> point = view.pick(static_cast<int>(peak.x()), kHeight - 1 - static_cast<int>(peak.y()));
  ASSERT_TRUE(point);
  EXPECT_EQ(point->layer, "peaks");
  EXPECT_NE(point->text.find("alpha"), std::string::npos);
  window->RemoveRenderer(view.renderer());
}

TEST_F(SceneViewPicture, AMovedCameraStaysWhereItWasPut) {
  SceneView view;
  view.setInspection(smallInspection(folder_.path()));
  const ViewPoint wanted{{1, 2, 3}, {0, 0, 0.1}, {0, 0, 1}, 40};
  view.setViewPoint(wanted);
  render(view);
  view.setSelection({2, "", -1});
  render(view);
  EXPECT_LT((view.viewPoint().position - wanted.position).norm(), 1e-9);
  EXPECT_LT((view.viewPoint().focalPoint - wanted.focalPoint).norm(), 1e-9);
  EXPECT_NEAR(view.viewPoint().viewAngleDeg, 40, 1e-12);
}

/// The same numbers mean other places where lights stand still in the cameras: the old view would look past the scene.
TEST_F(SceneViewPicture, OtherCoordinatesAreShownAsAWhole) {
  SceneView view, fresh;
  const auto world = smallInspection(folder_.path());
  const auto carried = std::make_shared<Inspection>(*world);
  carried->lightFrame.frame = LightFrame::Camera;
  carried->scene = std::make_shared<const Scene>(inCameras(*world->scene));
  carried->surfaces = std::make_shared<const SurfaceCache>(*carried->scene);
  fresh.setInspection(carried);
  render(fresh);
  view.setInspection(world);
  view.setViewPoint({{1, 2, 3}, {0, 0, 0.1}, {0, 0, 1}, 40});
  render(view);
  view.setInspection(carried);
  render(view);
  EXPECT_LT((view.viewPoint().position - fresh.viewPoint().position).norm(), 1e-9);
  EXPECT_LT((view.viewPoint().focalPoint - fresh.viewPoint().focalPoint).norm(), 1e-9);
}

/// Quadrics that a fit may leave behind where the data do not make an ellipsoid: flagged with their name, never a crash.
TEST_F(SceneViewPicture, ADegenerateQuadricIsDrawnDashedInRedWithItsName) {
  const auto inspection = smallInspection(folder_.path());
  const double nan = std::nan("");
  const std::vector<std::pair<Eigen::Vector4d, std::string>> cases{{{-0.05, 0.02, 0.02, 1}, "hyperboloid of two sheets"},
                                                                   {{-0.05, -0.02, 0.02, 1}, "hyperboloid of one sheet"},
                                                                   {{0.05, 0.02, 0.02, 1}, "imaginary ellipsoid"},
                                                                   {{0, 0, 0, 1}, "point"},
                                                                   {{1, 1, 0, 0}, "quadric at infinity"},
                                                                   {{nan, 1, 1, 1}, "not finite"},
                                                                   {{0, 0, 0, 0}, "empty quadric"}};
  for (const auto& [diagonal, name] : cases) {
    SCOPED_TRACE(name);
    ModelFit& fit = *inspection->models.at("dual").fits[0].fit;
    fit.family = EllipsoidFit{{diagonal.asDiagonal()}};
    LayerInput input;
    input.inspection = inspection.get();
    input.models = {"dual"};
    input.surfaceKey = inspection->surfaces->keyOf(0);
    input.scale = sceneScale(*inspection, nullptr, {0, 1, 2}, 1);
    const LayerContent content = ellipsoidsLayer(input);
    ASSERT_EQ(content.notes.size(), 1u);
    EXPECT_NE(content.notes[0].find(name), std::string::npos) << content.notes[0];
    SceneView view;
    view.setInspection(std::make_shared<Inspection>(*inspection));
    view.setLegendVisible(false);
    view.setModels({"dual"});
    for (const Layer& layer : sceneLayers()) view.setLayerVisible(layer.name, layer.name == "ellipsoids");
    const auto reds = [&] {  // of lines, and of labels, which have a contrast of their own
      const Image picture = render(view);
      return countNear(picture, kFailed, 0.15) + countNear(picture, readableOn(kDarkBackground, kFailed), 0.15);
    };
    const int withLayer = reds();
    view.setLayerVisible("ellipsoids", false);
    const int red = withLayer - reds();  // the axes have some, too
    if (content.drawn.empty()) {
      EXPECT_EQ(red, 0);
    } else {
      ASSERT_EQ(content.labels.size(), 1u);
      EXPECT_NE(content.labels[0].text.find(name), std::string::npos);
      EXPECT_GT(red, 20);
    }
    EXPECT_EQ(content.drawn.empty(), !diagonal.allFinite() || diagonal(3) == 0);
  }
}

}  // namespace
}  // namespace glint::viz
