// SPDX-License-Identifier: BSD-3-Clause
#include "tests/viz/small_inspection.h"

#include <stdlib.h>

#include <cmath>
#include <numbers>

#include "viz/canvas.h"

namespace glint::test {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr double kFocal = 400, kContourPx = 14;

Camera lookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - eye).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.pixelFromRay << kFocal, 0, (kWidth - 1) / 2.0, 0, kFocal, (kHeight - 1) / 2.0, 0, 0, 1;
  Eigen::Matrix3d axes;
  axes.row(0) = right.transpose();
  axes.row(1) = forward.cross(right).transpose();
  axes.row(2) = forward.transpose();
  camera.camFromWorld.linear() = axes;
  camera.camFromWorld.translation() = -axes * eye;
  return camera;
}

Polyline circleAbout(const Pixel& centre, double radius) {
  Polyline line;
  for (int i = 0; i < 72; ++i) {
    const double t = 2 * std::numbers::pi * i / 72;
    line.points.push_back(centre + radius * Pixel(std::cos(t), std::sin(t)));
  }
  return line;
}

/// Mirror point on a sphere about the origin: the normal halves the angle between the directions to eye and light.
Eigen::Vector3d mirrorPoint(double radius, const Eigen::Vector3d& eye, const Eigen::Vector3d& light) {
  Eigen::Vector3d n = (eye.normalized() + light.normalized()).normalized();
  for (int i = 0; i < 200; ++i) n = ((eye - radius * n).normalized() + (light - radius * n).normalized()).normalized();
  return radius * n;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "glint-viz-XXXXXX").string();
  require(mkdtemp(pattern.data()) != nullptr, "TemporaryFolder: cannot create one");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

viz::WalkStory shortWalk(const Inspection& inspection) {
  viz::WalkStory story;
  story.frame = 0;
  story.camera = inspection.scene->frames[0].camera;
  story.lamp = Light::at({0, 0, 3});
  for (int i = 0; i < 3; ++i) {
    WalkPlace p;
    p.distance = 0.1 * i;
    p.onTangentPlane = p.position = Eigen::Vector3d(0.1 * i, 0, 0.5);
    p.normal = {0, 0, 1};
    p.alpha = 0.02 * i;
    story.trace.onSurface.push_back(p);
    story.trace.onPlane.push_back(p);
  }
  story.trace.limitAngle = 0.04;
  story.trace.reachOnSurface = story.trace.reachOnPlane = 0.2;
  return story;
}

std::shared_ptr<Inspection> smallInspection(const std::filesystem::path& folder, double scale) {
  Image photograph(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool left = x < kWidth / 2, top = y < kHeight / 2;
      photograph.at(x, y, 0) = left == top ? 1.f : 0.f;
      photograph.at(x, y, 1) = !left ? 1.f : 0.f;
      photograph.at(x, y, 2) = !top ? 1.f : 0.f;
    }
  }
  const std::filesystem::path file = folder / "photograph.png";
  viz::writePng(photograph, file.string());

  const double radius = 0.4 * scale;
  const Eigen::Vector3d light = scale * Eigen::Vector3d(0.9, -0.8, 1.2);
  auto scene = std::make_shared<Scene>();
  scene->name = "small";
  scene->folder = folder;
  AnalyticSpec sphere;
  sphere.type = "sphere";
  sphere.radius = radius;
  scene->surfaces["ball"] = sphere;
  TrueLight truth;
  truth.id = "lamp";
  truth.lamp = lampAt(light);
  truth.lamp = withRadius(truth.lamp, 0.01 * scale);
  scene->lights.push_back(truth);
  for (int i = 0; i < 6; ++i) {
    const double azimuth = -1.3 + 0.42 * i;
    Frame frame;
    frame.id = "000" + std::to_string(i);
    frame.image = file;
    frame.camera =
        lookAt(scale * Eigen::Vector3d(1.6 * std::cos(azimuth), 1.6 * std::sin(azimuth), 0.7), Eigen::Vector3d::Zero());
    frame.surface = "ball";
    scene->frames.push_back(frame);
  }

  auto inspection = std::make_shared<Inspection>();
  inspection->scene = inspection->given = scene;
  inspection->surfaces = std::make_shared<SurfaceCache>(*scene);
  inspection->request.models = {"dual", "canonical"};
  inspection->train.text = "0-3";
  inspection->train.frames = {0, 1, 2, 3};
  LightEstimate estimate;
  estimate.light = Light::at(light + scale * Eigen::Vector3d(0.05, 0.02, -0.03));
  estimate.solver = "bundle";
  inspection->lights.insert_or_assign({"lamp"}, estimate);

  ModelResult canonical, dual;
  canonical.model = "canonical";
  dual.model = "dual";
  ModelFit fit;
  fit.model = "canonical";
  fit.light = "lamp";
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
  place.translation() = light;
  const Ellipsoid ellipsoid(place, scale * Eigen::Vector3d(0.25, 0.2, 0.12));
  fit.family = EllipsoidFit{ellipsoid.dual(), ellipsoid};
  fit.lightEstimate = Light::at(light);
  canonical.fits.push_back({"lamp", {}, fit, {}});
  // A two-sheet hyperboloid: the dual model's quadric, which must not be drawn as an ellipsoid.
  ModelFit hyperboloid;
  hyperboloid.model = "dual";
  hyperboloid.light = "lamp";
  const double area = scale * scale;
  hyperboloid.family = EllipsoidFit{{Eigen::Vector4d(-0.01 * area, 0.02 * area, 0.02 * area, 1).asDiagonal()}};
  dual.fits.push_back({"lamp", {}, hyperboloid, {}});

  for (int i = 0; i < 6; ++i) {
    const Camera& camera = scene->frames[static_cast<std::size_t>(i)].camera;
    const Eigen::Vector3d p = mirrorPoint(radius, camera.centreInWorld(), light);
    const Pixel pixel = *camera.project(p);
    const Plane plane = Plane::through(p, p.normalized());
    BrightestPoint brightest;
    brightest.point.position = p;
    brightest.point.normal = p.normalized();
    brightest.pixel = pixel;

    Highlight highlight;
    highlight.light = "lamp";
    highlight.contour = circleAbout(pixel, kContourPx);
    highlight.peak = pixel;
    highlight.ellipse = Ellipse{pixel, {kContourPx, kContourPx}, 0};
    highlight.areaPx2 = std::numbers::pi * kContourPx * kContourPx;
    FrameEvidence evidence;
    evidence.frame = i;
    evidence.highlights.push_back(highlight);
    inspection->evidence.push_back(evidence);

    CanonicalContour walk;
    const Eigen::Matrix<double, 3, 2> basis = tangentBasis(plane.normal);
    for (int k = 0; k < 12; ++k) {
      DirectionResult direction;
      direction.azimuth = 2 * std::numbers::pi * k / 12;
      const Eigen::Vector3d along = std::cos(direction.azimuth) * basis.col(0) + std::sin(direction.azimuth) * basis.col(1);
      if (k == 0) {
        direction.failure = Failure{Reason::SurfaceEnded, ""};
      } else {
        direction.limitAngle = 0.07;
        direction.onTangentPlane = p + 0.05 * scale * along;
        direction.onSurface = radius * direction.onTangentPlane.normalized();
      }
      walk.directions.push_back(direction);
    }
    walk.ellipse = Ellipse{pixel, {kContourPx + 2, kContourPx - 1}, 0.3};
    if (i < 4) {
      TrainingView view;
      view.frame = i;
      view.camera = camera;
      view.highlight = highlight;
      view.seen = SeenOnSurface{brightest, plane, virtualCamera(camera, plane)};
      view.canonical = walk;
      inspection->views.push_back(view);
    }
    PredictedHighlight predicted;
    predicted.contour = circleAbout(pixel, kContourPx + 1);
    predicted.ellipse = Ellipse{pixel, {kContourPx + 1, kContourPx + 1}, 0};
    predicted.brightest = brightest;
    predicted.tangentPlane = plane;
    predicted.canonical = walk;
    FrameComparison comparison;
    comparison.frame = i;
    comparison.light = "lamp";
    comparison.fit = 0;
    comparison.prediction = std::vector{predicted};
    ContourMetrics metrics;
    metrics.contourErrorPx = 1;
    metrics.contourErrorPct = 100.0 / (2 * kContourPx);
    comparison.rows.push_back({0, 0, metrics, {}, {}});
    comparison.iou = (kContourPx * kContourPx) / ((kContourPx + 1) * (kContourPx + 1));
    canonical.frames.push_back(comparison);
    FrameComparison refused;
    refused.frame = i;
    refused.light = "lamp";
    refused.prediction = Failure{Reason::NotAnEllipsoid, "a hyperboloid"};
    refused.rows.push_back({0, -1, {}, *refused.prediction.failure(), {}});
    dual.frames.push_back(refused);
  }
  inspection->models["canonical"] = canonical;
  inspection->models["dual"] = dual;
  return inspection;
}

viz::LayerInput heldOutInput(const Inspection& inspection) {
  viz::LayerInput input;
  input.inspection = &inspection;
  input.selection.frame = 5;
  input.models = {"dual", "canonical"};
  input.surface = *inspection.surfaces->surfaceOf(5, NormalPolicy::Interpolated);
  input.surfaceKey = inspection.surfaces->keyOf(5);
  input.scale = viz::sceneScale(inspection, input.surface.get(), {0, 1, 2, 3, 4, 5}, 1);
  return input;
}

}  // namespace glint::test
