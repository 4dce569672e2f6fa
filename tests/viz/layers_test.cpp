// SPDX-License-Identifier: BSD-3-Clause
// What single layers draw, and what a view of them is to hold: read from their geometry, no picture is drawn.
#include "viz/layers.h"

#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
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

#include "tests/tolerances.h"
#include "tests/viz/small_inspection.h"
#include "viz/glyphs.h"
#include "viz/scene_legend.h"
#include "viz/scene_questions.h"
#include "viz/style.h"
#include "viz/view_camera.h"

namespace glint::viz {
namespace {

using test::heldOutInput;
using test::smallInspection;
using test::TemporaryFolder;

constexpr double kDrawn = 1e-6, kDrawnPx = 1e-3;  // m, px: what is drawn is in single precision

/// An ellipsoid far from the highlights fills a fair part of the picture, and what comes to it is held as far as that allows.
TEST(Framings, AnEllipsoidIsNoDot) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input;
  input.inspection = inspection.get();
  input.models = {"canonical"};
  input.surfaceKey = inspection->surfaces->keyOf(0);
  input.surface = *inspection->surfaces->surfaceOf(0, {});
  input.scale = sceneScale(*inspection, input.surface.get(), {0, 1, 2, 3}, 1);
  const Ellipsoid& ellipsoid = *inspection->models.at("canonical").fits.at(0).fit->ellipsoid();
  const std::optional<Framing> framing = ellipsoidFraming(input, {0, 1, 2, 3}, "canonical");
  ASSERT_TRUE(framing);
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : framing->points) box.extend(p);
  EXPECT_LT(box.diagonal().norm(), 10 * 2 * ellipsoid.semiAxes().norm());
  EXPECT_TRUE(box.contains(ellipsoid.centre()));
}

TEST(Framings, TheMirrorHoldsTheEllipsoidWhereItIsDrawn) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input;
  input.inspection = inspection.get();
  input.models = {"canonical"};
  input.selection.frame = 1;
  input.selection.model = "canonical";
  input.surfaceKey = inspection->surfaces->keyOf(1);
  input.surface = *inspection->surfaces->surfaceOf(1, {});
  input.scale = sceneScale(*inspection, input.surface.get(), {0, 1, 2, 3}, 1);
  const Eigen::Vector3d end =
      inspection->scene->lights[0].lamp.position() + 1.1 * Eigen::Vector3d(0.25, 0, 0);  // of its longest axis
  for (const bool drawn : {false, true}) {
    const std::optional<Framing> framing = highlightFraming(input, 0, HighlightLook::Mirror, {false, drawn});
    ASSERT_TRUE(framing);
    EXPECT_EQ(std::any_of(framing->points.begin(), framing->points.end(),
                          [&](const Eigen::Vector3d& q) { return (end - q).norm() < 1e-9; }),
              drawn);
  }
}

TEST(Layers, CamerasThatShareAPoseAreDrawnOnce) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  auto scene = std::make_shared<Scene>(*inspection->scene);
  for (int i = 0; i < 6; ++i) scene->frames.push_back(scene->frames[static_cast<std::size_t>(i)]);
  inspection->scene = scene;
  inspection->surfaces = std::make_shared<SurfaceCache>(*scene);
  const std::vector<int> frames = framesToDraw(*inspection, inspection->surfaces->keyOf(0), 8);
  EXPECT_EQ(frames.size(), 6u);
  EXPECT_NE(std::find(frames.begin(), frames.end(), 8), frames.end());  // the selected one stands for its pose
}

/// Looking through a camera, one beside it is not drawn across the photograph; one over there is.
TEST(Layers, CamerasBesideTheEyeAreNotDrawn) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  auto scene = std::make_shared<Scene>(*inspection->scene);
  LayerInput input;
  input.scale = sceneScale(*inspection, nullptr, {0, 1, 2, 3}, 1);
  const Camera eye = scene->frames[0].camera;
  const auto moved = [&](double right, double forward) {
    Camera camera = eye;
    camera.camFromWorld.translation() -= input.scale.cameraDepth * Eigen::Vector3d(right, 0, forward);
    return camera;
  };
  scene->frames[1].camera = moved(1, 0);     // beside
  scene->frames[2].camera = moved(0.5, -3);  // behind
  scene->frames[3].camera = moved(0.5, 5);   // before
  inspection->scene = scene;
  LayerCache cache;
  input.cache = &cache;
  input.inspection = inspection.get();
  input.frames = {0, 1, 2, 3};
  const auto lines = [&] {
    vtkIdType n = 0;
    for (const Drawn& d : camerasLayer(input).drawn)
      n += vtkPolyDataMapper::SafeDownCast(vtkActor::SafeDownCast(d.prop)->GetMapper())->GetInput()->GetNumberOfCells();
    return n;
  };
  for (const int frame : {1, 2, 3}) EXPECT_FALSE(besideEye(input, frame));
  const vtkIdType all = lines(), each = all / 4;
  input.eye = Eye::Camera;
  EXPECT_TRUE(besideEye(input, 1));
  EXPECT_TRUE(besideEye(input, 2));
  EXPECT_FALSE(besideEye(input, 3));
  EXPECT_EQ(lines(), each);
}

/// Cones of the small scene whose model has a ball as its ellipsoid; the first one drawn, which is frame 0's.
TriangleMesh firstCone(const Inspection& inspection, const std::string& model) {
  LayerInput input;
  input.inspection = &inspection;
  input.models = {model};
  input.surfaceKey = inspection.surfaces->keyOf(0);
  input.scale = sceneScale(inspection, nullptr, {0, 1, 2}, 1);
  const LayerContent content = conesLayer(input);
  TriangleMesh mesh;
  if (content.drawn.empty()) return mesh;
  vtkPolyData* data =
      vtkPolyDataMapper::SafeDownCast(vtkActor::SafeDownCast(content.drawn.front().prop)->GetMapper())->GetInput();
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) mesh.vertices.emplace_back(data->GetPoint(i));
  return mesh;
}

/// The mirror makes the difference: a virtual camera's cone begins where it sees the highlight, on the tangent plane; a camera's
/// own begins halfway, and so before the ellipsoid, which lies about that plane.
TEST(Layers, AConeReachesFromItsPlaceThroughTheContourToBeyondTheEllipsoid) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const TrainingView& view = inspection->views[0];
  const Eigen::Vector3d eye = view.camera.centreInWorld();
  for (const bool mirrored : {false, true}) {
    SCOPED_TRACE(mirrored);
    const std::string model = mirrored ? "dual" : "primal";
    const Eigen::Vector3d apex = mirrored ? view.seen->tangentPlane.reflected(eye) : eye;
    // A ball on the axis of the contour's cone: at the brightest point, or as far beyond it as the mirrored camera is before it.
    const Eigen::Vector3d centre =
        mirrored ? 2 * view.seen->brightest.point.position - apex : view.seen->brightest.point.position;
    constexpr double kBall = 0.05;
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    place.translation() = centre;
    ModelFit fit;
    fit.model = model;
    fit.light = "lamp";
    const Ellipsoid ball(place, Eigen::Vector3d::Constant(kBall));
    fit.family = EllipsoidFit{ball.dual(), ball};
    inspection->models[model].fits = {{"lamp", {}, fit, {}}};
    const std::vector<Eigen::Vector3d> points = firstCone(*inspection, model).vertices;
    ASSERT_EQ(points.size() % 2, 0u);
    ASSERT_GT(points.size(), 100u);
    const Eigen::Vector3d axis = (centre - apex).normalized();
    const double end = (centre - apex).norm() + 1.15 * kBall;
    for (std::size_t i = 0; i < points.size(); i += 2) {
      const Eigen::Vector3d &near = points[i], &far = points[i + 1];
      EXPECT_NEAR((far - apex).dot(axis), end, kDrawn);
      if (mirrored)
        EXPECT_NEAR(view.seen->tangentPlane.signedDistance(near), 0, kDrawn);
      else
        EXPECT_NEAR((near - apex).dot(axis), 0.5 * end, kDrawn);
      // Both ends are seen on the contour: a camera behind the mirror sees there what the camera itself sees.
      for (const Eigen::Vector3d& p : {near, far}) {
        const std::optional<Pixel> pixel = view.camera.project(mirrored ? view.seen->tangentPlane.reflected(p) : p);
        ASSERT_TRUE(pixel);
        EXPECT_NEAR((*pixel - view.highlight.peak).norm(), view.highlight.ellipse->semiAxes.x(), kDrawnPx);
      }
    }
  }
}

TEST(Layers, ContoursCastOntoTheSurfaceLieOnIt) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const auto surface = inspection->surfaces->surfaceOf(0, NormalPolicy::Interpolated);
  ASSERT_TRUE(surface);
  const SceneScale scale = sceneScale(*inspection, surface->get(), {0, 1, 2, 3, 4, 5}, 1);
  const Highlight& highlight = inspection->evidence[0].highlights[0];
  const Camera& camera = inspection->scene->frames[0].camera;
  const std::vector<Points> chains = castContour(camera, **surface, highlight.contour, scale, 0.01);
  ASSERT_EQ(chains.size(), 1u);
  ASSERT_EQ(chains[0].size(), highlight.contour.points.size() + 1);
  for (std::size_t i = 0; i < highlight.contour.points.size(); ++i) {  // lifted, but still over its own pixel
    const Eigen::Vector3d& p = chains[0][i];
    EXPECT_NEAR(p.norm(), 0.41, 0.001);
    EXPECT_LT((*camera.project(p) - highlight.contour.points[i]).norm(), tolerance::kPixel);
  }
  // A contour that runs over the edge of the sphere is broken, not drawn through the air.
  Polyline wide;
  const Pixel middle = *camera.project(Eigen::Vector3d::Zero());
  for (int i = 0; i < 90; ++i) {
    const double t = i * 0.0698131700797732;
    wide.points.push_back(middle + Pixel(130 * std::cos(t), 60 * std::sin(t)));
  }
  for (const Points& chain : castContour(camera, **surface, wide, scale, 0)) {
    for (const Eigen::Vector3d& p : chain) EXPECT_NEAR(p.norm(), 0.4, 1e-9);
  }
}

Eigen::Vector3d carried(vtkMatrix4x4* by, const Eigen::Vector3d& p) {
  return (Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(by->GetData()) * p.homogeneous()).hnormalized();
}

/// No gap between a contour and its surface from anywhere, and yet it is drawn before it.
TEST(Layers, ContoursLieOnTheSurfaceAndComeNearerAlongTheRaysOfSightAlone) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  input.selection.direction = 0.5;
  constexpr int kHeight = 600;  // px
  for (const LayerContent& content : {observedContoursLayer(input), predictedContoursLayer(input)}) {
    int lines = 0;
    for (const Drawn& d : content.drawn) {
      EXPECT_GT(d.nearerPx, 0);
      auto* actor = vtkActor::SafeDownCast(d.prop);
      vtkPolyData* data = vtkPolyDataMapper::SafeDownCast(actor->GetMapper())->GetInput();
      if (data->GetNumberOfLines() == 0 || data->GetNumberOfPoints() < 60) continue;  // the mark of a direction
      ++lines;
      for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i) EXPECT_NEAR(toEigen(data->GetPoint(i)).norm(), 0.4, kDrawn);
      for (const bool parallel : {false, true}) {
        vtkNew<vtkCamera> camera;
        setViewPoint(camera, {{0.7, -1.1, 0.9}, {0.1, 0, 0}, {0, 0, 1}, 30, parallel});
        content.bringNearer(camera, kHeight);
        const auto onScreen = [&](const Eigen::Vector3d& p) {
          return carried(camera->GetCompositeProjectionTransformMatrix(1.5, 0.1, 10), p);
        };
        const Eigen::Vector3d p = toEigen(data->GetPoint(0)), moved = carried(actor->GetUserMatrix(), p);
        EXPECT_LT((onScreen(moved) - onScreen(p)).head<2>().norm(), kDrawn);
        EXPECT_LT(onScreen(moved).z(), onScreen(p).z());
        // As far as so many px measure there, seen from the front.
        const double depth = parallel ? (Eigen::Vector3d(0.7, -1.1, 0.9) - Eigen::Vector3d(0.1, 0, 0)).norm()
                                      : (p - Eigen::Vector3d(0.7, -1.1, 0.9)).norm();
        EXPECT_NEAR((moved - p).norm(), d.nearerPx * 2 * std::tan(std::numbers::pi / 12) * depth / kHeight, kDrawn);
      }
    }
    EXPECT_GE(lines, 1);
  }
}

Eigen::AlignedBox3d boundsOf(const Drawn& drawn) {
  double b[6];
  std::copy_n(drawn.prop->GetBounds(), 6, b);
  return {Eigen::Vector3d(b[0], b[2], b[4]), Eigen::Vector3d(b[1], b[3], b[5])};
}

TEST(Layers, AFrameThatDoesNotTrainHasItsRayAndItsPlaneFromWhatWasObserved) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  // The mirror point of frame 5 is what the scene's closed form says, as in its prediction.
  const PredictedHighlight& exact = inspection->models["canonical"].frames[5].prediction.highlights()[0];
  const Eigen::Vector3d p = exact.brightest.point.position, eye = inspection->scene->frames[5].camera.centreInWorld();
  Eigen::AlignedBox3d ray;
  for (const Drawn& d : raysLayer(input).drawn)
    if (d.info.frame == 5) {
      EXPECT_EQ(d.info.highlight, 0);
      ray.extend(boundsOf(d));
    }
  ASSERT_FALSE(ray.isEmpty()) << "no ray";
  const auto holds = [](const Eigen::AlignedBox3d& box, const Eigen::Vector3d& q) { return box.exteriorDistance(q) < kDrawn; };
  EXPECT_TRUE(holds(ray, eye));
  EXPECT_TRUE(holds(ray, p));
  EXPECT_TRUE(holds(ray, inspection->scene->lights[0].lamp.position())) << "it goes on to the light";
  // The plane is drawn once, in the colour of the mirror; of the models' own a ring at most.
  int sheets = 0, rings = 0;
  for (const char* model : {"", "canonical"}) {
    input.selection.model = model;
    for (const Drawn& d : tangentPlanesLayer(input).drawn) {
      if (d.info.frame != 5) continue;
      const Eigen::AlignedBox3d box = boundsOf(d);
      EXPECT_LT((box.center() - p).norm(), 2 * input.scale.lift);
      if (d.lineWidthPx == 0) {
        ++sheets;
        EXPECT_EQ(d.info.model, "");
      }
      rings += d.lineWidthPx > 0 && d.info.model == "canonical";
    }
  }
  EXPECT_EQ(sheets, 2) << "one for each selection";
  EXPECT_EQ(rings, 1) << "where the model is selected";
}

TEST(Layers, OnAnotherSurfaceTheRaysAndConesAreThoseOfTheViewsThatTrained) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  input.surfaceKey = "another";  // as if frames 0 to 3 had trained on a ball that is not shown
  input.models = {"canonical"};
  const LayerContent cones = conesLayer(input);
  std::set<int> frames;
  for (const Drawn& d : cones.drawn) frames.insert(d.info.frame);
  EXPECT_EQ(frames, (std::set<int>{0, 1, 2, 3}));
  ASSERT_EQ(cones.remarks.size(), 1u);
  EXPECT_NE(cones.remarks[0].find("another surface"), std::string::npos);
  frames.clear();
  const LayerContent rays = raysLayer(input);
  for (const Drawn& d : rays.drawn) {
    frames.insert(d.info.frame);
    const double opacity = vtkActor::SafeDownCast(d.prop)->GetProperty()->GetOpacity();
    EXPECT_EQ(opacity < 1, d.info.frame != 5) << d.info.frame;
  }
  EXPECT_EQ(frames, (std::set<int>{0, 1, 2, 3, 5}));
  EXPECT_EQ(rays.remarks.size(), 1u);
  inspection->train.perSurface = true;  // then each surface has a light of its own
  for (const Drawn& d : raysLayer(input).drawn) EXPECT_EQ(d.info.frame, 5);
}

TEST(Layers, WhereTheObjectMovesRaysAndConesAreThoseOfItsOtherPlaces) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  auto moving = std::make_shared<Scene>(*inspection->scene);
  moving->frames[5].worldFromObject.translation().x() = 0.1;
  inspection->scene = moving;
  inspection->lightFrame.frame = LightFrame::Camera;
  LayerInput input = heldOutInput(*inspection);
  input.surfaceKey = "another";
  input.models = {"canonical"};
  const LayerContent cones = conesLayer(input), rays = raysLayer(input);
  ASSERT_EQ(cones.remarks.size(), 1u);
  EXPECT_EQ(cones.remarks[0], "cones: from the training frames, wherever the object stood");
  ASSERT_EQ(rays.remarks.size(), 1u);
  EXPECT_EQ(rays.remarks[0], "rays: 4 start where the object stands in other frames (faded)");
  input.frames = {5};
  const LayerContent cameras = camerasLayer(input), none;
  std::vector<ShownLayer> layers(sceneLayers().size(), {false, &none});
  for (std::size_t i = 0; i < layers.size(); ++i)
    if (sceneLayers()[i].name == "cameras") layers[i] = {true, &cameras};
  ASSERT_EQ(legendOf(input, layers).remarks.size(), 1u);
  EXPECT_NE(legendOf(input, layers).remarks[0].find("camera's coordinates"), std::string::npos);
}

/// What primal calls its brightest point is the middle of its ellipsoid, which lies behind the surface.
TEST(Layers, APredictionWithoutATangentPlaneHasNoBrightestPointOnTheSurface) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const LayerInput input = heldOutInput(*inspection);
  const auto ofModel = [&] {
    int n = 0;
    for (const Drawn& d : peaksLayer(input).drawn) n += d.info.model == "canonical";
    return n;
  };
  EXPECT_EQ(ofModel(), 2) << "a ball and its normal";
  inspection->models["canonical"].frames[5].prediction.editable()[0].tangentPlane.reset();
  EXPECT_EQ(ofModel(), 0);
}

/// The step about the normal of the peak would show a bundle of them.
TEST(Layers, TheSelectedFrameAloneHasTheNormalOfWhatWasObservedAndNoOther) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  for (const int frame : {0, 5}) {  // trains, and not
    LayerInput input = heldOutInput(*inspection);
    input.selection.frame = frame;
    input.solo = true;
    const auto count = [&] { return peaksLayer(input).drawn.size(); };
    EXPECT_EQ(count(), 2u) << "a ball and its normal";
    for (const Drawn& d : peaksLayer(input).drawn) EXPECT_EQ(d.info.model, "");
  }
  // Where nothing was observed, what is predicted is all that there is.
  LayerInput input = heldOutInput(*inspection);
  inspection->evidence[5].highlights.clear();
  input.solo = true;
  EXPECT_EQ(peaksLayer(input).drawn.size(), 2u);
}

/// Ellipse, walks and plane of the one contour that was observed; a predicted one beside them would look as if it were theirs.
TEST(Layers, AFrameThatDoesNotTrainHasTheCanonicalEllipseOfWhatWasObservedInIt) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  input.selection.model = "canonical";
  const auto ofModels = [&] {
    int n = 0;
    for (const LayerContent& content : {canonicalEllipsesLayer(input), directionsLayer(input), tangentPlanesLayer(input)})
      for (const Drawn& d : content.drawn) n += !d.info.model.empty();
    return n;
  };
  EXPECT_GT(ofModels(), 0);
  input.solo = true;
  EXPECT_EQ(ofModels(), 0);
  const std::vector<TrainingView> own = input.ownViews(true);
  ASSERT_EQ(own.size(), 1u);
  ASSERT_TRUE(own[0].canonical && own[0].canonical->ellipse);
  ASSERT_EQ(canonicalEllipsesLayer(input).drawn.size(), 1u);
  const Eigen::AlignedBox3d drawn = boundsOf(canonicalEllipsesLayer(input).drawn[0]);
  Eigen::AlignedBox3d expected;
  for (const Points& chain : ellipseOnPlane(own[0].camera, own[0].seen->tangentPlane, *own[0].canonical->ellipse, 0))
    for (const Eigen::Vector3d& p : chain) expected.extend(p);
  EXPECT_LT((drawn.center() - expected.center()).norm(), kDrawn);
  EXPECT_FALSE(directionsLayer(input).drawn.empty());
  inspection->lights.clear();  // then nothing tells where they end
  EXPECT_TRUE(input.ownViews(true).empty());
}

TEST(Framing, HoldsTheWholeWalkWhateverItsDirection) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const LayerInput input = heldOutInput(*inspection);
  const std::vector<TrainingView> own = input.ownViews(true);
  ASSERT_EQ(own.size(), 1u);
  const Eigen::Vector3d at = own[0].seen->brightest.point.position, n = own[0].seen->tangentPlane.normal;
  double reach = 0;
  for (const DirectionResult& d : own[0].canonical->directions)
    if (d.limitAngle && !d.failure) reach = std::max(reach, (d.onTangentPlane - at).norm());
  ASSERT_GT(reach, 0);
  for (const bool drawn : {false, true}) {
    const std::optional<Framing> framing =
        highlightFraming(input, 0, HighlightLook::Section, {false, false, false, false, drawn});
    ASSERT_TRUE(framing);
    double disc = 0, arrows = 0;
    for (const Eigen::Vector3d& q : framing->points) {
      const double up = std::abs((q - at).dot(n)), out = ((q - at) - (q - at).dot(n) * n).norm();
      if (up < input.scale.lift) disc = std::max(disc, out);
      if (out > 0.9 * reach) arrows = std::max(arrows, up);
    }
    EXPECT_EQ(disc > 1.12 * reach, drawn);    // as walkLayer() draws its disc
    EXPECT_EQ(arrows > 0.75 * reach, drawn);  // and the arrows at its end
  }
}

TEST(Layers, TheSelectedFrameAloneNamesItsDirections) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  for (const int frame : {0, 5}) {  // trains, and not
    LayerInput input = heldOutInput(*inspection);
    input.selection.frame = frame;
    EXPECT_TRUE(raysLayer(input).labels.empty() && peaksLayer(input).labels.empty());
    input.solo = true;
    std::map<std::string, Eigen::Vector3d> at;
    for (const LayerContent& content : {raysLayer(input), peaksLayer(input)})
      for (const DrawnLabel& label : content.labels) {
        at[label.text] = label.anchor;
        ASSERT_TRUE(label.tail) << "each stands at the tip of its arrow";
        EXPECT_NEAR((label.anchor - *label.tail).norm(), 1.3 * input.scale.arrow, 1e-6 * input.scale.arrow);
      }
    ASSERT_EQ(at.size(), 3u) << frame;
    const SurfacePoint p = inspection->models["canonical"].frames[std::size_t(frame)].prediction.highlights()[0].brightest.point;
    const Eigen::Vector3d eye = inspection->scene->frames[std::size_t(frame)].camera.centreInWorld();
    EXPECT_LT((at["V"] - p.position).cross(eye - p.position).norm(), kDrawn);
    EXPECT_LT((at["N"] - p.position).cross(p.normal).norm(), kDrawn);
    EXPECT_LT((at["L"] - p.position).cross(inspection->scene->lights[0].lamp.position() - p.position).norm(), kDrawn);
  }
}

/// The word at a light stands beside all of its star, and beside the ring about it when it is selected.
TEST(Layers, ALightsLabelKeepsOffItsStar) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  for (const bool selected : {false, true}) {
    input.selection.light = selected ? inspection->scene->lights[0].id : "";
    const LayerContent content = lightLayer(input);
    ASSERT_FALSE(content.labels.empty());
    ASSERT_FALSE(content.drawn.empty());
    double reach = 0;
    for (const Drawn& drawn : content.drawn) {
      if (!drawn.info.model.empty()) continue;  // a model's own estimate, which has a star of its own
      const double* box = drawn.prop->GetBounds();
      for (int axis = 0; axis < 3; ++axis)
        for (const int side : {0, 1}) reach = std::max(reach, std::abs(box[2 * axis + side] - content.labels[0].anchor(axis)));
    }
    EXPECT_GE(content.labels[0].clear, (1 - 1e-6) * reach);
    EXPECT_LE(content.labels[0].clear, 1.05 * reach);
    ASSERT_EQ(content.glyphs.size(), content.labels.size());
  }
}

/// From a camera itself the lines to virtual cameras would run across its photograph.
TEST(VirtualCameras, AreNotJoinedWithTheirCamerasWhereOneLooksThroughOne) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  const std::size_t outside = virtualCamerasLayer(input).drawn.size();
  input.eye = Eye::Camera;
  const std::size_t through = virtualCamerasLayer(input).drawn.size();
  constexpr std::size_t kSight = 3;  // lines of sight of the selected frame
  EXPECT_EQ(outside, 3 * through + kSight) << "the frustum alone, without line, foot and lines of sight";
  EXPECT_GT(through, 0u);
}

/// Looked at alone a plane carries the canonical contour, which is larger than the highlight; among the others it does not hide
/// them.
TEST(TangentPlanes, AloneTheyReachTheCanonicalContour) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  LayerInput input = heldOutInput(*inspection);
  input.selection.frame = 0;
  TrainingView& view = inspection->views.front();
  for (Pixel& p : view.canonical->pixels) p = view.seen->brightest.pixel + 4 * (p - view.seen->brightest.pixel);
  if (view.canonical->pixels.empty())
    view.canonical->pixels = {view.seen->brightest.pixel + Pixel(60, 0), view.seen->brightest.pixel - Pixel(60, 0)};
  double reach = 0;
  for (const Pixel& p : view.canonical->pixels)
    if (const auto q = intersection(view.camera.ray(p), view.seen->tangentPlane))
      reach = std::max(reach, (*q - view.seen->brightest.point.position).norm());
  reach = std::min(reach, 0.35 * input.scale.surfaceSize);  // no plane is drawn larger
  const auto widest = [&] {
    double half = 0;
    for (const Drawn& d : tangentPlanesLayer(input).drawn)
      if (d.info.frame == 0 && d.lineWidthPx == 0) half = std::max(half, 0.5 * boundsOf(d).sizes().maxCoeff());
    return half;
  };
  input.solo = true;
  const double alone = widest();
  EXPECT_GE(alone, 0.99 * reach);
  input.solo = false;
  EXPECT_LT(widest(), 0.8 * alone);
}

TEST(Framing, HoldsTheWholeTangentPlaneThatIsDrawn) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const LayerInput input = heldOutInput(*inspection);
  Eigen::AlignedBox3d disc;
  for (const Drawn& d : tangentPlanesLayer(input).drawn)
    if (d.info.frame == 5) disc.extend(boundsOf(d));
  const BrightestPoint& b = inspection->models["canonical"].frames[5].prediction.highlights()[0].brightest;
  const double radius =
      0.5 * disc.diagonal().norm() / std::sqrt(2.0);  // its box has sides 2 r sin to each axis, and those squares sum up to 2
  for (const bool drawn : {false, true}) {
    const std::optional<Framing> framing = highlightFraming(input, 0, HighlightLook::Section, {false, false, false, drawn});
    ASSERT_TRUE(framing);
    double reach = 0;
    for (const Eigen::Vector3d& q : framing->points) {
      const Eigen::Vector3d by = q - b.point.position;
      if (std::abs(by.dot(b.point.normal)) < input.scale.lift) reach = std::max(reach, by.norm());
    }
    EXPECT_EQ(reach > 0.99 * radius, drawn) << reach << " of " << radius;
  }
}

TEST(Framing, HoldsTheVirtualCamerasThatAreDrawn) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const LayerInput input = heldOutInput(*inspection);
  const auto held = [&](const std::optional<Framing>& framing, int frame) {
    const BrightestPoint& b = inspection->models["canonical"].frames[std::size_t(frame)].prediction.highlights()[0].brightest;
    const Plane plane = Plane::through(b.point.position, b.point.normal);
    std::vector<Eigen::Vector3d> camera;
    addFrustum(input, camera, frame);
    for (const Eigen::Vector3d& corner : camera) {
      double least = 1;
      for (const Eigen::Vector3d& q : framing->points) least = std::min(least, (q - plane.reflected(corner)).norm());
      if (least > kDrawn) return false;
    }
    return true;
  };
  for (const bool drawn : {true, false}) {
    const DrawnParts parts{false, true, drawn};
    const std::optional<Framing> mirror = highlightFraming(input, 0, HighlightLook::Mirror, parts);
    ASSERT_TRUE(mirror);
    EXPECT_TRUE(held(mirror, 5)) << "the pair is what this look is about";
    EXPECT_EQ(held(mirror, 2), drawn);
  }
}

/// A layer that is built again (another frame was selected) draws the same textures: making one ready takes far longer than the
/// layer. A few old ones are let go.
TEST(Photographs, AreBroughtToTheGraphicsCardOnce) {
  LayerCache cache;
  std::vector<vtkSmartPointer<vtkImageData>> pictures;
  for (int i = 0; i < 80; ++i) pictures.push_back(vtkSmartPointer<vtkImageData>::New());
  const vtkSmartPointer<vtkTexture> first = cache.textureOf(pictures[0]);
  EXPECT_EQ(first->GetInput(), pictures[0]);
  EXPECT_TRUE(first->GetMipmap() && first->GetInterpolate());
  const vtkSmartPointer<vtkTexture> second = cache.textureOf(pictures[1]);
  EXPECT_NE(first, second);
  for (int i = 2; i < 80; ++i) {
    cache.textureOf(pictures[std::size_t(i)]);
    EXPECT_EQ(cache.textureOf(pictures[0]), first) << i;  // in use all the time
  }
  EXPECT_NE(cache.textureOf(pictures[1]), second);  // not used for long
}

}  // namespace
}  // namespace glint::viz
