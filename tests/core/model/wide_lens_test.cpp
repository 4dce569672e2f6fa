// SPDX-License-Identifier: BSD-3-Clause
// Highlights far from the axis of a fisheye lens, against those that an ordinary camera at the same place sees when it is turned
// towards them: the same rays, far inside of its image.
#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/camera.h"
#include "core/pipeline/inspection.h"
#include "core/surface/analytic.h"
#include "core/surface/brightest_point.h"
#include "core/synth/exact_highlight.h"

namespace glint::wide_lens_tests {
namespace {

constexpr double kFocal = 160;                    // px per rad: 640 px span 229 degrees
constexpr double kOffAxis = 62 * EIGEN_PI / 180;  // tan = 1.9: 300 px outside of a picture without lens
constexpr double kRadius = 2.2;                   // m, of the cameras' circle

Eigen::Isometry3d lookingAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - eye).normalized(), x = Eigen::Vector3d(0, 0, -1).cross(z).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().row(0) = x;
  pose.linear().row(1) = z.cross(x);
  pose.linear().row(2) = z;
  pose.translation() = -(pose.linear() * eye);
  return pose;
}

Camera turnedTowards(const Eigen::Vector3d& eye) {
  Camera c;
  c.width = 640;
  c.height = 480;
  c.pixelFromRay << 800, 0, 319.5, 0, 800, 239.5, 0, 0, 1;
  c.camFromWorld = lookingAt(eye, Eigen::Vector3d::Zero());
  return c;
}

/// Sees the origin `kOffAxis` from its axis.
Camera fisheye(const Eigen::Vector3d& eye, double side) {
  Camera c = turnedTowards(eye);
  c.pixelFromRay << kFocal, 0, 319.5, 0, kFocal, 239.5, 0, 0, 1;
  c.lens.model = LensModel::OpenCvFisheye;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  c.camFromWorld = Eigen::Isometry3d(Eigen::AngleAxisd(side * kOffAxis, up)) * c.camFromWorld;
  return c;
}

/// The ideal pixel in which `to` has what `from`, at the same place, has at p.
Pixel moved(const Pixel& p, const Camera& from, const Camera& to) {
  const Eigen::Vector3d ray = to.camFromWorld.linear() * from.ray(p).direction;
  return (to.pixelFromRay * ray).hnormalized();
}

Eigen::Vector3d eyeOf(int i) {
  const double turn = 0.16 * i, height = i % 2 ? 0.55 : 0.25;
  return kRadius * Eigen::Vector3d(std::cos(turn), std::sin(turn), height).normalized();
}

std::shared_ptr<Scene> sceneThrough(bool wide, std::vector<Highlight>* expected = nullptr) {
  const auto scene = std::make_shared<Scene>();
  AnalyticSpec body;
  body.type = "ellipsoid";
  body.semiAxes = {0.45, 0.35, 0.3};
  scene->surfaces["body"] = body;
  const std::shared_ptr<const Surface> surface = makeAnalytic(body);
  TrueLight light;
  light.id = "lamp";
  light.lamp = lampAt(Eigen::Vector3d(1.6, 1.2, 2.4));
  for (int i = 0; i < 10; ++i) {
    const Camera pinhole = turnedTowards(eyeOf(i)), lens = fisheye(eyeOf(i), i % 3 ? 1 : -1);
    ExactOptions options;
    options.kind = ContourKind::LimitAngle;
    options.limitAngle = 0.08;
    Frame frame;
    frame.id = std::to_string(i);
    frame.surface = "body";
    frame.camera = wide ? lens : pinhole;
    const auto found = exactHighlights(*surface, pinhole, light, {}, options);
    if (!found) {
      ADD_FAILURE() << found.failure().message();
      continue;
    }
    Highlight h = found->front();
    h.light = "lamp";
    h.fromScene = true;
    if (wide) {
      h.peak = moved(h.peak, pinhole, lens);
      for (Pixel& p : h.contour.points) p = moved(p, pinhole, lens);
      if (signedArea(h.contour) < 0) std::reverse(h.contour.points.begin(), h.contour.points.end());
      h.areaPx2 = std::abs(signedArea(h.contour));
      h.ellipse = *fitEllipse(h.contour.points);
    }
    if (expected) expected->push_back(h);
    frame.highlights.push_back(h);
    scene->frames.push_back(frame);
  }
  scene->lights.push_back(light);
  return scene;
}

TEST(SeenWindow, WithoutLensIsTheImage) {
  const Eigen::AlignedBox2d window = seenWindow(turnedTowards({2, 0, 0}));
  EXPECT_EQ(window.min(), Pixel(-0.5, -0.5));
  EXPECT_EQ(window.max(), Pixel(639.5, 479.5));
}

/// r = f theta.
TEST(SeenWindow, OfAFisheyeByItsFormula) {
  Camera c = fisheye({2, 0, 0}, 1);
  c.width = c.height = 200;
  c.pixelFromRay(0, 2) = c.pixelFromRay(1, 2) = 99.5;
  const double reach = kFocal * std::tan(100 / kFocal);
  Eigen::AlignedBox2d window = seenWindow(c);
  // The corners see farther than the sides' middles: 141 px are 50.6 degrees.
  const double corner = kFocal * std::tan(std::hypot(100, 100) / kFocal) / std::sqrt(2.0);
  EXPECT_GT(corner, reach);
  EXPECT_LT((window.max() - Pixel(99.5 + corner, 99.5 + corner)).norm(), 1e-9);
  EXPECT_LT((window.min() - Pixel(99.5 - corner, 99.5 - corner)).norm(), 1e-9);
  // Beyond 85 degrees it ends, even if the lens sees more than 90.
  c.width = c.height = 640;
  c.pixelFromRay(0, 2) = c.pixelFromRay(1, 2) = 319.5;
  window = seenWindow(c);
  EXPECT_NEAR(window.max().x(), 319.5 + kFocal * std::tan(85 * EIGEN_PI / 180), 1e-9);
  // 240 px above the centre are 1.5 rad: what is at 1.4 is in the photograph, and at 1.55 is not.
  c.height = 480;
  c.pixelFromRay(1, 2) = 239.5;
  EXPECT_TRUE(isInPhotograph(c, Pixel(319.5, 239.5 - kFocal * std::tan(1.4))));
  EXPECT_FALSE(isInPhotograph(c, Pixel(319.5, 239.5 - kFocal * std::tan(1.55))));
}

TEST(WideLens, BrightestPointFarFromTheAxis) {
  const auto scene = sceneThrough(true);
  const std::shared_ptr<const Surface> surface = makeAnalytic(*scene->surfaces.at("body").analytic());
  const Light light = lightOf(scene->lights.front().lamp);
  for (const Frame& f : scene->frames) {
    const auto found = predictedBrightestPoints(*surface, f.camera, light, {});
    ASSERT_TRUE(found) << f.id << ": " << found.failure().message();
    EXPECT_LT((found->front().pixel - f.highlights[0].peak).norm(), 1e-6) << f.id;
  }
}

TEST(WideLens, ContourFarFromTheAxis) {
  const auto scene = sceneThrough(true);
  const std::shared_ptr<const Surface> surface = makeAnalytic(*scene->surfaces.at("body").analytic());
  ExactOptions options;
  options.kind = ContourKind::LimitAngle;
  options.limitAngle = 0.08;
  for (const Frame& f : scene->frames) {
    const auto found = exactHighlights(*surface, f.camera, scene->lights.front(), {}, options);
    ASSERT_TRUE(found) << f.id << ": " << found.failure().message();
    ASSERT_EQ(found->size(), 1u);
    EXPECT_FALSE(found->front().touchesBorder);
    for (const Pixel& p : f.highlights[0].contour.points)
      EXPECT_LT(distance(found->front().contour, p), 3 * options.sagittaPx) << f.id;  // chords of both
  }
}

/// Learned from six frames through the lens and predicted in the other four: as well as by the ordinary camera.
TEST(WideLens, PredictionsAreThoseOfAnOrdinaryCamera) {
  InspectionRequest request;
  request.models = {"canonical", "limit-angle"};
  const Inspection wide = inspect(sceneThrough(true), request, {}), plain = inspect(sceneThrough(false), request, {});
  for (const std::string& model : request.models)
    for (const Inspection* inspection : {&wide, &plain}) {
      int scored = 0;
      for (const FrameComparison& c : inspection->models.at(model).frames) {
        if (inspection->isTraining(c.frame)) continue;
        ASSERT_EQ(c.rows.size(), 1u) << model;
        ASSERT_TRUE(c.rows[0].metrics) << model << " frame " << c.frame;
        // The canonical model takes the contour as an ellipse on one plane; the limit angle is exact here.
        EXPECT_LT(c.rows[0].metrics->contourErrorPct, model == "canonical" ? 3 : 0.05) << model << " frame " << c.frame;
        ++scored;
      }
      EXPECT_EQ(scored, 4);
    }
}

}  // namespace
}  // namespace glint::wide_lens_tests
