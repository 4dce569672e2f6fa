// SPDX-License-Identifier: BSD-3-Clause
// Where the walk is drawn, in space and over the photograph, on surfaces where every place of it is known in closed form.
#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <optional>

#include "core/advise/explain.h"
#include "core/base/number_text.h"
#include "tests/core/pipeline/exact_scene.h"
#include "viz/layers.h"
#include "viz/walk_picture.h"
#include "viz/walk_story.h"

namespace glint::viz {
namespace {

using namespace testing_support;

constexpr double kPlace = 1e-6;  // m: what is drawn is stored as given, peaks of exact contours are found to 1e-7 px
constexpr double kRadius = 0.5;
const Eigen::Vector3d kCentre(0, 0, -kRadius), kLamp(0.1, 0.2, 1.4);  // of the exact scene

struct Told {
  std::shared_ptr<Inspection> inspection;
  std::shared_ptr<WalkStory> story;
  Eigen::Vector3d eye;
};

Told told(const AnalyticSpec& surface) {
  InspectionRequest q;
  q.models = {"canonical"};
  q.train = "first:4";
  Told t{std::make_shared<Inspection>(inspect(exactScene(surface, 6), q)), std::make_shared<WalkStory>(), {}};
  const Outcome<WalkStory> story = walkStory(*t.inspection, explain(*t.inspection, 5, 0, "canonical"), false, 0.4);
  if (story)
    *t.story = *story;
  else
    ADD_FAILURE() << story.failure().message();
  t.eye = t.inspection->scene->frames[5].camera.centreInWorld();
  return t;
}

LayerInput inputOf(const Told& t, int step) {
  LayerInput in;
  in.inspection = t.inspection.get();
  in.selection.frame = 5;
  in.scale.lift = 1e-3;
  in.walk = t.story;
  in.walkStep = step;
  return in;
}

struct Shape {
  std::vector<Eigen::Vector3d> points;
  double width = 0;
  Colour colour;
};
std::vector<Shape> shapesOf(const LayerContent& content) {
  std::vector<Shape> shapes;
  for (const Drawn& d : content.drawn) {
    auto* actor = vtkActor::SafeDownCast(d.prop);
    auto* data = vtkPolyDataMapper::SafeDownCast(actor->GetMapper())->GetInput();
    Shape s;
    s.width = d.lineWidthPx;
    for (int i = 0; i < 3; ++i) s.colour[static_cast<std::size_t>(i)] = actor->GetProperty()->GetDiffuseColor()[i];
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
      s.points.emplace_back(Eigen::Map<const Eigen::Vector3d>(data->GetPoint(i)));
    shapes.push_back(s);
  }
  return shapes;
}
/// The nth shape of one width and colour.
const Shape* shapeOf(const std::vector<Shape>& shapes, double width, const Colour& colour, int nth = 0) {
  for (const Shape& s : shapes)
    if (s.width == width && s.colour == colour && nth-- == 0) return &s;
  return nullptr;
}
double offAxis(const Eigen::Vector3d& p, const Eigen::Vector3d& from, const Eigen::Vector3d& unit) {
  return (p - from).cross(unit).norm();
}
Eigen::Vector3d halfAt(const Eigen::Vector3d& p, const Eigen::Vector3d& eye) {
  return ((eye - p).normalized() + (kLamp - p).normalized()).normalized();
}

/// The walk's trail and what stands at its end, whichever surface it is on.
struct Expected {
  bool onSurface;
  Eigen::Vector3d lift, start;
  std::function<double(const Eigen::Vector3d&)> off;  ///< distance from the surface
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> normal;
};

void expectNow(const Told& t, const std::vector<Shape>& shapes, const LayerContent& content, int step, const Expected& e) {
  const WalkStory& s = *t.story;
  const double size = std::max(s.trace.reachOnSurface, s.trace.reachOnPlane);
  const Colour own = e.onSurface ? kTextOnDark : modelColour("canonical");
  const Shape* trail = shapeOf(shapes, e.onSurface ? 5.0 : 2.5, own);
  ASSERT_TRUE(trail);
  const int places = static_cast<int>(s.trace.onSurface.size()), passed = step % places + 1;
  ASSERT_EQ(static_cast<int>(trail->points.size()), passed);
  EXPECT_LT((trail->points.front() - e.start - e.lift).norm(), kPlace) << "it begins at P_B";
  for (const Eigen::Vector3d& p : trail->points) {
    EXPECT_NEAR(e.off(p - e.lift), 0, kPlace);
    EXPECT_NEAR((p - e.start).dot(s.normal.cross(s.along)), 0, kPlace) << "straight ahead";
  }
  const Eigen::Vector3d here = trail->points.back(), at = here - e.lift, n = e.normal(at), h = halfAt(at, t.eye);
  // Normals of every fourth place, square to the surface.
  const Shape* normals = shapeOf(shapes, 1.2, own);
  ASSERT_TRUE(normals);
  ASSERT_EQ(static_cast<int>(normals->points.size()), 2 * ((passed + 3) / 4));
  for (std::size_t i = 0; i < normals->points.size(); i += 2) {
    EXPECT_LT((normals->points[i] - trail->points[2 * i]).norm(), kPlace);
    const Eigen::Vector3d drawn = normals->points[i + 1] - normals->points[i];
    EXPECT_LT((drawn.normalized() - e.normal(normals->points[i] - e.lift)).norm(), 1e-5);
    EXPECT_NEAR(drawn.norm(), 0.45 * size, kPlace);
  }
  // From the current place to the camera and to the light.
  const Shape *toEye = shapeOf(shapes, 1.2, kVirtualCamera), *toLight = shapeOf(shapes, 1.2, kLightColour);
  ASSERT_TRUE(toEye && toLight);
  for (const Eigen::Vector3d& p : toEye->points) EXPECT_LT(offAxis(p, here, (t.eye - at).normalized()), kPlace);
  for (const Eigen::Vector3d& p : toLight->points) EXPECT_LT(offAxis(p, here, (kLamp - at).normalized()), 1e-5);  // estimated
  EXPECT_NEAR((toEye->points.back() - here).norm(), 1.3 * size, 0.1 * size);
  // The last five: ball, sector, the arrows N and H.
  ASSERT_GE(shapes.size(), 4u);
  const Shape &ball = shapes[shapes.size() - 4], &sector = shapes[shapes.size() - 3], &arrowN = shapes[shapes.size() - 2],
              &arrowH = shapes.back();
  for (const Eigen::Vector3d& p : ball.points) EXPECT_NEAR((p - here).norm(), 0.045 * size, 1e-6 + 1e-3 * size);
  EXPECT_EQ(ball.colour, own);
  EXPECT_EQ(arrowN.colour, own);
  const double arrow = 0.75 * size;
  for (const auto& [shape, unit] : {std::pair(&arrowN, n), std::pair(&arrowH, h)}) {
    double tip = 0, foot = 1;
    for (const Eigen::Vector3d& p : shape->points) {
      tip = std::max(tip, (p - here).dot(unit));
      foot = std::min(foot, (p - here).dot(unit));
      EXPECT_LT(offAxis(p, here, unit), 0.012 * size * 2.6 + 1e-4 * size);  // no point farther than the head's radius
    }
    EXPECT_NEAR(tip, arrow, 1e-4 * arrow);
    EXPECT_NEAR(foot, 0, 1e-4 * arrow);
  }
  // The sector lies between N and H and opens as far as alpha.
  EXPECT_LT((sector.points.front() - here).norm(), kPlace);
  const Eigen::Vector3d first = (sector.points[1] - here).normalized(), last = (sector.points.back() - here).normalized();
  EXPECT_LT((first - n).norm(), 1e-5);
  EXPECT_LT((last - h).norm(), 1e-4);
  const double alpha = std::atan2(h.cross(n).norm(), h.dot(n));
  EXPECT_NEAR(std::atan2(first.cross(last).norm(), first.dot(last)), alpha, 1e-4);
  for (std::size_t i = 1; i < sector.points.size(); ++i) EXPECT_NEAR((sector.points[i] - here).norm(), 0.9 * arrow, 1e-6);
  ASSERT_EQ(content.labels.size(), 1u);
  EXPECT_EQ(content.labels[0].text, formatted("on %s: α %.2f° of %.2f°", e.onSurface ? "S" : "T", alpha * 180 / std::numbers::pi,
                                              kLimitAngle * 180 / std::numbers::pi));
  EXPECT_LT((content.labels[0].anchor - here - 1.05 * arrow * n).norm(), 1e-4 * arrow);
}

class WalkLayer : public testing::TestWithParam<bool> {};  // on a ball, else on a plane

TEST_P(WalkLayer, TrailNormalsAndAnglesLieWhereTheSurfaceAndThePlaneHaveThem) {
  const bool ball = GetParam();
  const Told t = told(ball ? sphere(kRadius) : sheet(0));
  const WalkStory& s = *t.story;
  const int places = static_cast<int>(s.trace.onSurface.size());
  ASSERT_GT(places, 12);
  const Eigen::Vector3d start = s.trace.onSurface.front().position;
  const double size = std::max(s.trace.reachOnSurface, s.trace.reachOnPlane);
  // T touches S where the mirror law holds: its normal halves the angle between camera and light.
  const Eigen::Vector3d normal = ball ? Eigen::Vector3d((start - kCentre) / kRadius) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  ASSERT_LT((normal - halfAt(start, t.eye)).norm(), 1e-5);
  const Eigen::Vector3d lift = std::min(1e-3, 0.01 * size) * normal;
  const Expected onS{true, lift, start, [&](const Eigen::Vector3d& p) { return ball ? (p - kCentre).norm() - kRadius : p.z(); },
                     [&](const Eigen::Vector3d& p) { return ball ? Eigen::Vector3d((p - kCentre) / kRadius) : normal; }};
  const Expected onT{false, lift, start, [&](const Eigen::Vector3d& p) { return (p - start).dot(normal); },
                     [&](const Eigen::Vector3d&) { return normal; }};
  for (const int step : {6, places - 1, places + 5, 2 * places - 1}) {
    SCOPED_TRACE(step);
    const LayerContent content = walkLayer(inputOf(t, step));
    const std::vector<Shape> shapes = shapesOf(content);
    const bool onSurface = step < places;
    expectNow(t, shapes, content, step, onSurface ? onS : onT);
    // The disc is T.
    for (const std::size_t i : {0u, 1u})
      for (const Eigen::Vector3d& p : shapes[i].points) {
        EXPECT_NEAR((p - start - lift).dot(normal), 0, kPlace);
        EXPECT_NEAR((p - start - lift).norm(), 1.12 * size, kPlace);
      }
    const Shape* before = shapeOf(shapes, 5.0, kTextOnDark);
    ASSERT_TRUE(before);
    if (!onSurface) {
      EXPECT_EQ(static_cast<int>(before->points.size()), places) << "the walk on S stays";
    } else {
      EXPECT_FALSE(shapeOf(shapes, 2.5, modelColour("canonical"))) << "not on T yet";
      // The gap that the walk on S crosses: from T to S, where the camera sees both at once.
      const Shape* gap = shapeOf(shapes, 1.2, modelColour("canonical"));
      ASSERT_TRUE(gap);
      ASSERT_EQ(gap->points.size(), 2u);
      EXPECT_NEAR((gap->points[0] - lift - start).dot(normal), 0, kPlace);
      EXPECT_NEAR(onS.off(gap->points[1] - lift), 0, kPlace);
      EXPECT_LT((gap->points[1] - before->points.back()).norm(), kPlace);
    }
    for (const Drawn& d : content.drawn) {
      EXPECT_EQ(d.info.layer, "walk");
      EXPECT_EQ(d.info.frame, 5);
      EXPECT_EQ(d.info.direction, s.direction);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(On, WalkLayer, testing::Bool(), [](const auto& info) { return info.param ? "ABall" : "APlane"; });

TEST(WalkLayer, IsOfItsFrameOnly) {
  const Told t = told(sphere(kRadius));
  LayerInput in = inputOf(t, 3);
  in.selection.frame = 4;
  EXPECT_TRUE(walkLayer(in).drawn.empty());
  in.walk = nullptr;
  EXPECT_TRUE(walkLayer(in).drawn.empty());
}

// --- over the photograph ------------------------------------------------------------------------------------------------

/// Where the ray through an ideal pixel first meets the ball or the plane z = 0.
Eigen::Vector3d hit(const Camera& camera, const Pixel& p, bool ball) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  const Eigen::Vector3d d =
      (camera.camFromWorld.linear().transpose() * camera.pixelFromRay.inverse() * p.homogeneous()).normalized();
  if (!ball) return eye - eye.z() / d.z() * d;
  const double b = d.dot(eye - kCentre), c = (eye - kCentre).squaredNorm() - kRadius * kRadius;
  return eye + (-b - std::sqrt(b * b - c)) * d;
}

TEST(AddWalk, ItsPixelsAreThoseWhereTheCameraSeesTheWalkAlsoThroughALens) {
  for (const bool ball : {true, false}) {
    for (const double k1 : {0.0, 0.08}) {
      SCOPED_TRACE(testing::Message() << (ball ? "ball" : "plane") << ", k1 " << k1);
      Told t = told(ball ? sphere(kRadius) : sheet(0));
      WalkStory& s = *t.story;
      s.camera.lens.parameters[0] = k1;
      const int places = static_cast<int>(s.trace.onSurface.size());
      const auto lineOf = [](const FrameOverlay& overlay, const std::string& label) {
        for (const OverlayLine& l : overlay.lines)
          if (l.label == label) return std::optional(l);
        return std::optional<OverlayLine>();
      };
      for (const int step : {6, places + 5}) {
        SCOPED_TRACE(step);
        FrameOverlay overlay;
        addWalk(s, step, overlay);
        const auto onS = lineOf(overlay, "walk on S"), onT = lineOf(overlay, "walk on T");
        ASSERT_TRUE(onS);
        ASSERT_EQ(static_cast<int>(onS->points.size()), std::min(step + 1, places));
        for (std::size_t i = 0; i < onS->points.size(); ++i) {
          const Pixel ideal = s.camera.undistorted(onS->points[i]);
          EXPECT_LT((hit(s.camera, ideal, ball) - s.trace.onSurface[i].position).norm(), kPlace);
        }
        EXPECT_EQ(onT.has_value(), step >= places);
        if (onT) {
          ASSERT_EQ(static_cast<int>(onT->points.size()), step - places + 1);
          for (std::size_t i = 0; i < onT->points.size(); ++i) {
            const Eigen::Vector3d p = s.trace.onPlane[i].position, toPixel = (p - t.eye).normalized();
            const Pixel ideal = s.camera.undistorted(onT->points[i]);
            const Eigen::Vector3d ray =
                s.camera.camFromWorld.linear().transpose() * s.camera.pixelFromRay.inverse() * ideal.homogeneous();
            EXPECT_LT((ray.normalized() - toPixel).norm(), kPlace);
            EXPECT_NEAR((p - s.trace.onPlane[0].position).dot(s.normal), 0, 1e-9);
          }
        }
        ASSERT_EQ(overlay.marks.size(), 1u);
        const OverlayMark& mark = overlay.marks[0];
        const OverlayLine& current = onT ? *onT : *onS;
        EXPECT_LT((mark.at - current.points.back()).norm(), 1e-9);
        EXPECT_EQ(mark.colour, current.colour);
        EXPECT_EQ(mark.label, walkText(s, step));
        // The shorter one lies on top where both are there.
        if (onT) {
          const bool planeLonger = s.trace.reachOnPlane > s.trace.reachOnSurface;
          EXPECT_EQ(overlay.lines.front().label, planeLonger ? "walk on T" : "walk on S");
        }
      }
    }
  }
}

}  // namespace
}  // namespace glint::viz
