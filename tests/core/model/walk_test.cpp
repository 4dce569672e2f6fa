// SPDX-License-Identifier: BSD-3-Clause
// The walks against independent values: shared/reference holds, for each contour point on S, its canonical point on T.
#include "core/model/walk.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/surface/analytic.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using nlohmann::json;

json reference(const std::string& name) {
  std::ifstream stream(std::string(GLINT_SHARED_DIR) + "/reference/" + name);
  return json::parse(stream);
}

Eigen::Vector3d vector3(const json& j) { return {j[0].get<double>(), j[1].get<double>(), j[2].get<double>()}; }

Camera cameraOf(const json& file, const json& frame) {
  Camera c;
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 3; ++k) c.pixelFromRay(r, k) = file["K"][r][k].get<double>();
  Eigen::Matrix4d m;
  for (int r = 0; r < 4; ++r)
    for (int k = 0; k < 4; ++k) m(r, k) = frame["camera_from_world"][r][k].get<double>();
  c.camFromWorld.matrix() = m;
  c.width = file["width"];
  c.height = file["height"];
  return c;
}

struct Worst {
  double canonicalPx = 0, limitRad = 0, surfacePx = 0, projection = 0;
  int points = 0;
};

void compare(const json& file, const json& frame, const AnalyticSpec& spec, Worst& worst) {
  const std::shared_ptr<const Surface> surface = makeAnalytic(spec);
  const Camera camera = cameraOf(file, frame);
  const Light light = Light::at(vector3(file["light"]));
  BrightestPoint b;
  b.point = facing({vector3(frame["brightest_point"]), vector3(frame["normal"])}, camera.centreInWorld());
  b.pixel = Pixel(frame["peak"][0].get<double>(), frame["peak"][1].get<double>());
  const TangentWalk walk(*surface, camera, b, light, {1e-13, 60});

  const Projection virtualP = virtualCamera(camera, walk.tangentPlane());
  Eigen::Matrix<double, 3, 4> expected;
  for (int r = 0; r < 3; ++r)
    for (int k = 0; k < 4; ++k) expected(r, k) = frame["virtual_projection"][r][k].get<double>();
  worst.projection = std::max(worst.projection, (virtualP.matrix - expected).norm() / expected.norm());

  for (std::size_t i = 0; i < frame["contour"].size(); ++i) {
    const Pixel contour(frame["contour"][i][0].get<double>(), frame["contour"][i][1].get<double>());
    const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(contour));
    ASSERT_TRUE(hit) << i;
    const double limit = frame["limit_angles_deg"][i].get<double>() * std::numbers::pi / 180;
    const Outcome<double> alpha = walk.alphaOnSurface(facing(*hit, camera.centreInWorld()));
    ASSERT_TRUE(alpha);
    worst.limitRad = std::max(worst.limitRad, std::abs(*alpha - limit));
    // Forward: the same azimuth on T until alpha equals the limit.
    const Eigen::Vector3d direction = walk.direction(walk.azimuthOf(hit->position));
    const double guess = 0.3 * (hit->position - b.point.position).norm();
    const Outcome<double> onPlane = walk.reachOnPlane(direction, *alpha, guess);
    ASSERT_TRUE(onPlane) << i << " " << onPlane.failure().message();
    const Pixel canonical(frame["canonical_contour"][i][0].get<double>(), frame["canonical_contour"][i][1].get<double>());
    const std::optional<Pixel> pixel = camera.project(b.point.position + *onPlane * direction);
    ASSERT_TRUE(pixel);
    worst.canonicalPx = std::max(worst.canonicalPx, (*pixel - canonical).norm());
    // Inverse: the walk on S with that angle ends at the contour point again.
    const Outcome<TangentWalk::Reach> onSurface = walk.reachOnSurface(direction, *alpha, guess);
    ASSERT_TRUE(onSurface) << i << " " << onSurface.failure().message();
    const std::optional<Pixel> back = camera.project(onSurface->point.position);
    ASSERT_TRUE(back);
    worst.surfacePx = std::max(worst.surfacePx, (*back - contour).norm());
    ++worst.points;
  }
}

void expectAgreement(const Worst& worst) {
  EXPECT_LT(worst.projection, tolerance::kExact);
  EXPECT_LT(worst.canonicalPx, tolerance::kReferenceContourPx);
  EXPECT_LT(worst.surfacePx, tolerance::kReferenceContourPx);
  EXPECT_LT(worst.limitRad, tolerance::kSolve);
}

TEST(TangentWalk, ReferencePlaneToCylinder) {
  GLINT_NEEDS_SHARED_DATA();
  const json file = reference("plane_to_cylinder.json");
  Worst worst;
  for (const json& step : file["steps"]) {
    AnalyticSpec spec;
    spec.type = "sheet";
    spec.curvature = step["curvature"];
    for (const json& frame : step["frames"]) compare(file, frame, spec, worst);
  }
  EXPECT_EQ(worst.points, 5 * 6 * 36);
  expectAgreement(worst);
}

TEST(TangentWalk, ReferenceEllipsoid) {
  GLINT_NEEDS_SHARED_DATA();
  const json file = reference("ellipsoid.json");
  AnalyticSpec spec;
  spec.type = "ellipsoid";
  spec.semiAxes = {0.6, 0.35, 0.25};
  Worst worst;
  for (const json& frame : file["frames"]) compare(file, frame, spec, worst);
  EXPECT_EQ(worst.points, 10 * 36);
  expectAgreement(worst);
}

/// Camera above a plane, looking down.
Camera overhead(double height) {
  Camera c;
  c.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  c.width = 640;
  c.height = 480;
  c.camFromWorld.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  c.camFromWorld.translation() = Eigen::Vector3d(0, 0, height);
  return c;
}

/// Camera and light at the same point above a plane: H = V = L, so alpha(s) = atan(s / h).
TEST(TangentWalk, EqPlaneReachIsHeightTimesTangent) {
  AnalyticSpec spec;
  spec.type = "plane";
  const auto plane = makeAnalytic(spec);
  for (const double h : {1e-3, 1.0, 1e4}) {
    const Camera camera = overhead(h);
    BrightestPoint b;
    b.point = {{0, 0, 0}, {0, 0, 1}};
    b.pixel = {320, 240};
    const TangentWalk walk(*plane, camera, b, Light::at({0, 0, h}), {1e-14, 60});
    const double limit = 0.1;
    const Outcome<double> t = walk.reachOnPlane(walk.direction(0.7), limit, 0.01 * h);
    ASSERT_TRUE(t);
    EXPECT_NEAR(*t / h, std::tan(limit), tolerance::kExact);
    const Outcome<TangentWalk::Reach> s = walk.reachOnSurface(walk.direction(0.7), limit, 0.01 * h);
    ASSERT_TRUE(s);
    EXPECT_NEAR(s->distance / h, std::tan(limit), tolerance::kExact);
  }
}

TEST(TangentWalk, AnEdgeBeforeTheLimitIsNamed) {
  AnalyticSpec spec;
  spec.type = "sheet";
  spec.length = 0.1;
  spec.width = 10;
  const auto sheet = makeAnalytic(spec);
  const Camera camera = overhead(1);
  BrightestPoint b;
  b.point = {{0, 0, 0}, {0, 0, 1}};
  b.pixel = {320, 240};
  const TangentWalk walk(*sheet, camera, b, Light::at({0, 0, 1}));
  const Outcome<TangentWalk::Reach> out = walk.reachOnSurface({1, 0, 0}, 0.1, 0.01);  // needs 0.1003, the edge is at 0.05
  ASSERT_FALSE(out);
  EXPECT_EQ(out.failure().reason, Reason::SurfaceEnded);
  // Just inside the edge the limit is reached although the marching steps jump over the edge.
  const Outcome<TangentWalk::Reach> in = walk.reachOnSurface({1, 0, 0}, std::atan(0.0499), 0.03);
  ASSERT_TRUE(in) << in.failure().message();
  EXPECT_NEAR(in->distance, 0.0499, tolerance::kSolve);
}

TEST(TangentWalk, ALimitBeyondReachIsNamed) {
  AnalyticSpec spec;
  spec.type = "plane";
  const auto plane = makeAnalytic(spec);
  const Camera camera = overhead(1);
  BrightestPoint b;
  b.point = {{0, 0, 0}, {0, 0, 1}};
  b.pixel = {320, 240};
  const TangentWalk walk(*plane, camera, b, Light::towards({0, 0, 1}));
  // Light at infinity overhead: V turns to the horizon, L stays: alpha < 45 degrees.
  const Outcome<double> t = walk.reachOnPlane({1, 0, 0}, 50 * std::numbers::pi / 180, 0.1);
  ASSERT_FALSE(t);
  EXPECT_EQ(t.failure().reason, Reason::NotReached);
}

/// On a plane the canonical contour is the contour itself.
TEST(CanonicalContour, OnAPlaneNothingMoves) {
  AnalyticSpec spec;
  spec.type = "plane";
  const auto plane = makeAnalytic(spec);
  const Camera camera = overhead(1);
  BrightestPoint b;
  b.point = {{0, 0, 0}, {0, 0, 1}};
  b.pixel = {320, 240};
  const TangentWalk walk(*plane, camera, b, Light::at({0, 0, 1.5}), {1e-14, 60});
  const Ellipse drawn{{325, 236}, {60, 35}, 0.4};
  const CanonicalContour c = canonicalContour(walk, camera, {drawn.sample(720), true}, 36);
  ASSERT_EQ(c.pixels.size(), 36u);
  ASSERT_TRUE(c.ellipse);
  // The polygon of 720 chords lies inside the ellipse by up to a (pi/720)^2 / 2 = 6e-4 px.
  for (const Pixel& p : c.pixels) EXPECT_LT(distance({drawn.sample(7200), true}, p), 7e-4);
  // And the inverse walk returns to the ellipse.
  const CanonicalContour back = predictFromEllipse(walk, *plane, camera, drawn, 36);
  ASSERT_EQ(back.pixels.size(), 36u);
  for (const Pixel& p : back.pixels) {
    const Eigen::Vector3d x = p.homogeneous();
    EXPECT_NEAR(x.dot(drawn.conic().matrix * x), 0, tolerance::kSolve);
  }
}

TEST(CanonicalContour, AContourThatDoesNotEncloseThePeakFailsByName) {
  AnalyticSpec spec;
  spec.type = "plane";
  const auto plane = makeAnalytic(spec);
  const Camera camera = overhead(1);
  BrightestPoint b;
  b.point = {{0, 0, 0}, {0, 0, 1}};
  b.pixel = {320, 240};
  const TangentWalk walk(*plane, camera, b, Light::at({0, 0, 1}));
  const CanonicalContour c = canonicalContour(walk, camera, {Ellipse{{420, 240}, {20, 20}, 0}.sample(72), true}, 12);
  EXPECT_TRUE(c.pixels.empty());
  EXPECT_FALSE(c.ellipse);
  for (const DirectionResult& d : c.directions) {
    ASSERT_TRUE(d.failure);
    EXPECT_EQ(d.failure->reason, Reason::NotReached);
  }
}

}  // namespace
}  // namespace glint
