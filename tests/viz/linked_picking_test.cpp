// SPDX-License-Identifier: BSD-3-Clause
// What a click in the 3D picture selects, and how a selection made elsewhere is seen in it.
#include <gtest/gtest.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tests/viz/image_checks.h"
#include "tests/viz/small_inspection.h"
#include "viz/camera_colours.h"
#include "viz/convert.h"
#include "viz/layers.h"
#include "viz/scene_view.h"

namespace glint::viz {
namespace {

using test::countDifferent;
using test::countNear;
using test::smallInspection;
using test::TemporaryFolder;

class LinkedPicking : public test::PictureTest {
 protected:
  void SetUp() override {
    PictureTest::SetUp();
    if (IsSkipped()) return;
    inspection_ = smallInspection(folder_.path());
    view_.setInspection(inspection_);
    view_.setLegendVisible(false);
  }
  void showOnly(const std::string& layer) {
    for (const Layer& l : sceneLayers()) view_.setLayerVisible(l.name, l.name == layer);
  }
  /// Picks in a window that stays attached.
  std::optional<Picked> pickAt(const Eigen::Vector3d& worldPoint) {
    return pick([&] {
      vtkRenderer* renderer = view_.renderer();
      renderer->SetWorldPoint(worldPoint.x(), worldPoint.y(), worldPoint.z(), 1);
      renderer->WorldToDisplay();
      return Eigen::Vector2d(renderer->GetDisplayPoint()[0], renderer->GetDisplayPoint()[1]);
    });
  }
  std::optional<Picked> pickAtPixel(const Pixel& ideal) {
    return pick([&] { return *view_.displayOf(ideal.x(), ideal.y()); });
  }
  std::optional<Picked> pick(const std::function<Eigen::Vector2d()>& where) {
    window_->SetShowWindow(false);
    window_->SetOffScreenRendering(1);
    prepareWindow(window_);
    window_->SetSize(kWidth, kHeight);
    window_->AddRenderer(view_.renderer());
    window_->Render();
    const Eigen::Vector2d display = where();
    const std::optional<Picked> picked = view_.pick(static_cast<int>(display.x()), static_cast<int>(display.y()));
    window_->RemoveRenderer(view_.renderer());
    return picked;
  }
  TemporaryFolder folder_;
  std::shared_ptr<Inspection> inspection_;
  SceneView view_;
  vtkNew<vtkRenderWindow> window_;
};

TEST_F(LinkedPicking, AContourPointIsADirectionOfItsHighlight) {
  view_.setEye(Eye::Camera);
  for (const char* layer : {"observed-contours", "predicted-contours"}) {
    showOnly(layer);
    render(view_);
    const double radius = std::string(layer) == "observed-contours" ? 14 : 15;
    for (const double direction : {0.3, 1.9, -2.4}) {
      const Pixel at = inspection_->evidence[0].highlights[0].peak + radius * Pixel(std::cos(direction), std::sin(direction));
      const std::optional<Picked> picked = pickAtPixel(at);
      ASSERT_TRUE(picked);
      EXPECT_EQ(picked->layer, layer);
      EXPECT_EQ(picked->frame, 0);
      EXPECT_EQ(picked->highlight, 0);
      EXPECT_EQ(picked->light, "lamp");
      ASSERT_TRUE(picked->direction);
      EXPECT_NEAR(*picked->direction, direction, 0.08);  // one window px on a contour of 28 px radius is 0.04 rad
    }
  }
}

/// Two models that predict the same: a click there leaves the selected one selected, whichever is drawn on top.
TEST_F(LinkedPicking, TheSelectedModelStaysWhereContoursOverlap) {
  inspection_->models.at("dual").frames = inspection_->models.at("canonical").frames;
  view_.setInspection(inspection_);
  view_.setEye(Eye::Camera);
  showOnly("predicted-contours");
  const Pixel at = inspection_->evidence[0].highlights[0].peak + 15 * Pixel(std::cos(0.3), std::sin(0.3));
  for (const char* model : {"canonical", "dual"}) {
    view_.setSelection({0, model, -1, "", {}});
    render(view_);
    const std::optional<Picked> picked = pickAtPixel(at);
    ASSERT_TRUE(picked) << model;
    EXPECT_EQ(picked->model, model);
    ASSERT_TRUE(picked->direction);
  }
}

TEST_F(LinkedPicking, CameraEllipsoidLightAndVirtualCameraTellWhatTheyAre) {
  view_.setParallel(true);  // picking has no eye point then
  showOnly("cameras");
  render(view_);
  const Camera& camera = inspection_->scene->frames[2].camera;
  const std::optional<Picked> frustum = pickAt((camera.centreInWorld()));
  ASSERT_TRUE(frustum);
  EXPECT_EQ(frustum->layer, "cameras");
  EXPECT_EQ(frustum->frame, 2);
  EXPECT_NE(frustum->text.find("role = training"), std::string::npos);

  showOnly("ellipsoids");
  view_.setModels({"canonical"});
  render(view_);
  const std::optional<Picked> ellipsoid = pickAt((inspection_->models.at("canonical").fits[0].fit->ellipsoid()->centre()));
  ASSERT_TRUE(ellipsoid);
  EXPECT_EQ(ellipsoid->model, "canonical");
  EXPECT_EQ(ellipsoid->light, "lamp");

  showOnly("light");
  render(view_);
  const std::optional<Picked> light = pickAt(inspection_->lightFor(0, "lamp")->light.position());
  ASSERT_TRUE(light);
  EXPECT_EQ(light->layer, "light");
  EXPECT_EQ(light->light, "lamp");

  showOnly("virtual-cameras");
  view_.setParallel(false);
  view_.setSelection({3, "", -1, "", {}});
  view_.setSolo(true);  // the joining lines of the others cross it
  view_.frameAll();
  render(view_);
  const std::optional<Picked> mirrored =
      pickAt((inspection_->views[3].seen->tangentPlane.reflected(inspection_->views[3].camera.centreInWorld())));
  ASSERT_TRUE(mirrored);
  EXPECT_EQ(mirrored->layer, "virtual-cameras");
  EXPECT_EQ(mirrored->frame, 3);
  EXPECT_EQ(mirrored->highlight, 0);
  EXPECT_EQ(mirrored->light, "lamp");
}

/// A selection that comes from another view changes the picture where that thing is drawn, and only there.
TEST_F(LinkedPicking, ASelectionFromElsewhereIsSeen) {
  const Selection none{0, "", -1, "", {}};
  const auto change = [&](const std::string& layer, const Selection& selection) {
    showOnly(layer);
    view_.setSelection(none);
    const Image before = render(view_);
    view_.setSelection(selection);
    return countDifferent(before, render(view_));
  };
  EXPECT_GT(change("cameras", {3, "", -1, "", {}}), 60);
  EXPECT_GT(change("ellipsoids", {0, "canonical", -1, "", {}}), 100);
  EXPECT_GT(change("light", {0, "", -1, "lamp", {}}), 20);
  EXPECT_EQ(change("light", {0, "", -1, "another", {}}), 0);
  EXPECT_GT(change("observed-contours", {0, "", -1, "", 1.0}), 8);
  EXPECT_GT(change("predicted-contours", {0, "", -1, "", 1.0}), 8);
}

TEST_F(LinkedPicking, TheMarkLiesInItsDirection) {
  view_.setEye(Eye::Camera);
  showOnly("observed-contours");
  const Image before = render(view_);
  constexpr double kDirection = 2.0;
  view_.setSelection({0, "", 0, "lamp", kDirection});
  const Image after = render(view_);
  const Pixel at = inspection_->evidence[0].highlights[0].peak + 14 * Pixel(std::cos(kDirection), std::sin(kDirection));
  const Eigen::Vector2d expected = *view_.displayOf(at.x(), at.y());
  double sum = 0;
  Eigen::Vector2d middle(0, 0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (std::abs(after.at(x, y, 0) - before.at(x, y, 0)) < 0.05) continue;
      middle += Eigen::Vector2d(x + 0.5, kHeight - y - 0.5);
      sum += 1;
    }
  }
  ASSERT_GT(sum, 8);
  EXPECT_LT((middle / sum - expected).norm(), 4);  // contour vertices are 5 degrees apart: 2.4 px
}

TEST_F(LinkedPicking, DirectionsAreMeasuredInThePhotograph) {
  Camera camera = inspection_->scene->frames[0].camera;
  camera.lens.parameters = {-0.3, 0, 0, 0, 0};
  Highlight highlight = inspection_->evidence[0].highlights[0];
  for (Pixel& p : highlight.contour.points) p += Pixel(60, 70);  // off the middle, where the lens bends
  const Pixel ideal = highlight.contour.points[9];
  Pixel middle(0, 0);
  for (const Pixel& p : highlight.contour.points) middle += camera.distorted(p) / 72.0;
  const Pixel by = camera.distorted(ideal) - middle;
  EXPECT_NEAR(directionOf(camera, highlight, ideal), std::atan2(by.y(), by.x()), 0.01);
  const std::optional<Pixel> vertex = vertexInDirection(camera, highlight, highlight.contour, std::atan2(by.y(), by.x()));
  ASSERT_TRUE(vertex);
  EXPECT_LT((*vertex - ideal).norm(), 1e-9);
  EXPECT_FALSE(vertexInDirection(camera, highlight, Polyline{}, 0));
}

// --- colours, solo ------------------------------------------------------------------------------------------------------

TEST_F(LinkedPicking, CamerasAreColouredByRoleModelOrError) {
  ModelResult& canonical = inspection_->models.at("canonical");
  for (FrameComparison& c : canonical.frames) c.rows[0].metrics->contourErrorPct = c.frame == 4 ? 100 : 0.01;
  inspection_->request.excluded = {5};
  view_.setInspection(std::make_shared<Inspection>(*inspection_));
  showOnly("cameras");
  const Image byRole = render(view_);
  EXPECT_GT(countNear(byRole, kTraining), 50);
  EXPECT_GT(countNear(byRole, kHeldOut), 20);
  view_.setCameraColours({CameraColours::By::Error, "canonical", {}});
  const Image byError = render(view_);
  EXPECT_LT(countNear(byError, kTraining), 5);
  EXPECT_GT(countNear(byError, errorColour(0.01)), 50);
  EXPECT_GT(countNear(byError, errorColour(100)), 20);
  EXPECT_GT(countNear(byError, errorColour(1), 0.1), 8);  // only the colour bar has the middle of the scale
  view_.setCameraColours({CameraColours::By::Model, "", {}});
  EXPECT_GT(countNear(render(view_), modelColour("canonical")), 50);
}

TEST_F(LinkedPicking, SoloLeavesTheSelectedFrameOnly) {
  showOnly("cameras");
  view_.setSelection({2, "", -1, "", {}});
  const int all = countNear(render(view_), kTraining);
  const ViewPoint before = view_.viewPoint();
  view_.setSolo(true);
  EXPECT_GT(all, 50);
  EXPECT_LT(countNear(render(view_), kTraining), 5);
  EXPECT_LT((view_.viewPoint().position - before.position).norm(), 1e-12);
  view_.setSolo(false);
  EXPECT_NEAR(countNear(render(view_), kTraining), all, 5);
}

TEST(ErrorColour, IsOneAbsoluteScale) {
  EXPECT_EQ(errorColour(1e-9), errorColour(kLeastErrorPct));
  EXPECT_EQ(errorColour(1e9), errorColour(kMostErrorPct));
  EXPECT_EQ(errorColour(std::nan("")), kHeldOut);
  const Colour middle = errorColour(1);  // sqrt(0.01 * 100)
  EXPECT_NEAR(middle[0], 0.85, 1e-9);
  EXPECT_NEAR(middle[2], 0.30, 1e-9);
}

TEST(InfluenceColour, TellsHelpFromHarmAboutThePaleMiddle) {
  const Colour helps = influenceColour(2, 2), harms = influenceColour(-2, 2), neither = influenceColour(0, 2);
  EXPECT_GT(helps[2], helps[0] + 0.5);  // blue
  EXPECT_GT(harms[0], harms[2] + 0.5);  // vermilion
  EXPECT_EQ(influenceColour(9, 2), helps);
  EXPECT_EQ(influenceColour(-9, 2), harms);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(influenceColour(1, 2)[c], 0.5 * (helps[c] + neither[c]), 1e-12);
    EXPECT_NEAR(influenceColour(-1, 2)[c], 0.5 * (harms[c] + neither[c]), 1e-12);
  }
  EXPECT_EQ(influenceColour(1, 0), neither);
  CameraColours colours;
  EXPECT_EQ(mostInfluence(colours), 0);
  colours.influence = {{0, 1.5}, {3, -2.5}};
  EXPECT_EQ(mostInfluence(colours), 2.5);
}

TEST(Coarsened, KeepsTheShapeWithFewerTriangles) {
  TriangleMesh mesh;  // a bumpy sheet
  constexpr int kSide = 400;
  for (int j = 0; j <= kSide; ++j)
    for (int i = 0; i <= kSide; ++i)
      mesh.vertices.emplace_back(0.01 * i, 0.01 * j, 0.1 * std::sin(0.02 * i) * std::cos(0.03 * j));
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const int a = j * (kSide + 1) + i;
      mesh.triangles.emplace_back(a, a + 1, a + kSide + 1);
      mesh.triangles.emplace_back(a + 1, a + kSide + 2, a + kSide + 1);
    }
  }
  const auto fine = withNormals(toPolyData(mesh));
  const auto coarse = coarsened(fine, 60);
  EXPECT_LT(coarse->GetNumberOfPolys(), 12000);
  EXPECT_GT(coarse->GetNumberOfPolys(), 3000);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(coarse->GetBounds()[i], fine->GetBounds()[i], 4.0 / 60);
}

}  // namespace
}  // namespace glint::viz
