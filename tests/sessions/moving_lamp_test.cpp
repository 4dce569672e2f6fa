// SPDX-License-Identifier: BSD-3-Clause
// What the lesson of the lamp that moves with the camera claims, against an ellipsoid in closed form, its orbit as the
// specification has it, and Fermat's principle.
#include <algorithm>
#include <numbers>

#include "core/model/model.h"
#include "core/pipeline/summary.h"
#include "tests/sessions/taught.h"

namespace glint::moving_lamp {

using namespace taught;
using Vec = Eigen::Vector3d;

constexpr int kTraining[] = {0, 2, 4, 6, 8};

double degreesBetween(const Vec& a, const Vec& b) { return 180 / std::numbers::pi * std::atan2(a.cross(b).norm(), a.dot(b)); }

struct Mirrored {
  Vec at, normal, out;  ///< in the object's coordinates, which are the world's
};

/// Where the ray through a peak meets the ellipsoid, by its quadratic equation, and where it goes from there.
Mirrored mirroredAt(int frame, const Pixel& peak) {
  const Eigen::Isometry3d pose = movingLampCamera(frame).inverse();
  const Vec ray = (pose.linear() * Vec((peak.x() - 159.5) / 420, (peak.y() - 119.5) / 420, 1)).normalized();
  const Vec d = ray.cwiseQuotient(kMovingLampBody), e = pose.translation().cwiseQuotient(kMovingLampBody);
  const double a = d.squaredNorm(), b = e.dot(d), c = e.squaredNorm() - 1;
  const Vec at = pose.translation() + (-b - std::sqrt(b * b - a * c)) / a * ray;
  const Vec normal = at.cwiseQuotient(kMovingLampBody.cwiseProduct(kMovingLampBody)).normalized();
  return {at, normal, ray - 2 * normal.dot(ray) * normal};
}

Mirrored mirroredIn(const Inspection& in, int frame) {
  return mirroredAt(frame, in.evidence[std::size_t(frame)].highlights.at(0).peak);
}

double missed(const Mirrored& ray, const Vec& place) { return (place - ray.at).cross(ray.out).norm(); }

/// The place with the least sum of squared distances from the rays.
Vec nearestTo(const std::vector<Mirrored>& rays) {
  Eigen::Matrix3d all = Eigen::Matrix3d::Zero();
  Vec right = Vec::Zero();
  for (const Mirrored& ray : rays) {
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray.out * ray.out.transpose();
    all += across;
    right += across * ray.at;
  }
  return all.ldlt().solve(right);
}

double meanError(const Inspection& in, const std::string& model) {
  double sum = 0;
  const std::map<int, double> all = errorsByFrame(in, model);
  for (const auto& [frame, error] : all) sum += error / double(all.size());
  return sum;
}

TEST(MovingLamp, RaysMeetOnTheCameraAndSpreadInTheWorld) {
  const Inspection& in = lesson("moving-lamp").inspection;
  std::vector<Mirrored> still, carried;
  for (const int frame : kTraining) {
    const Mirrored ray = mirroredIn(in, frame);
    const Eigen::Isometry3d pose = movingLampCamera(frame);
    still.push_back(ray);
    carried.push_back({pose * ray.at, pose.linear() * ray.normal, pose.linear() * ray.out});
    EXPECT_TRUE(in.isTraining(frame));
  }
  EXPECT_LT((nearestTo(carried) - kMovingLamp).norm(), 1e-4) << "m";
  double widest = 0;
  for (const Mirrored& a : carried)
    for (const Mirrored& b : carried) widest = std::max(widest, degreesBetween(a.out, b.out));
  EXPECT_NEAR(widest, 7.8, 0.05) << "less than 8 degrees";
  const Vec best = nearestTo(still);
  EXPECT_LT(best.cwiseQuotient(kMovingLampBody).norm(), 1) << "inside the object";
  double worst = 0;
  for (const Mirrored& ray : still) worst = std::max(worst, missed(ray, best));
  EXPECT_NEAR(worst, 0.09, 0.005) << "m";
  const LightEstimate* const light = in.lightFor(0, "lamp");
  ASSERT_TRUE(light);
  EXPECT_LT((light->light.position() - kMovingLamp).norm(), 1e-4) << "m";
}

TEST(MovingLamp, InTheWorldEveryModelWithALampRefuses) {
  const Inspection world =
      changed("moving-lamp", [](InspectionRequest& r) { r.settings.set("light.frame", std::string("world")); });
  for (const char* model : {"dual", "canonical", "limit-angle"}) {
    EXPECT_TRUE(world.models.at(model).fits.at(0).failure()) << model;
    EXPECT_TRUE(errorsByFrame(world, model).empty()) << model;
  }
  EXPECT_EQ(errorsByFrame(world, "primal").size(), 4u);
  EXPECT_NEAR(meanError(world, "primal"), 20, 1) << "%";
}

TEST(MovingLamp, NormalHalvesTheAngleBetweenLensAndLamp) {
  const Inspection& in = lesson("moving-lamp").inspection;
  EXPECT_NEAR(kMovingLamp.norm(), 0.1, 1e-12);
  for (int frame = 0; frame < 9; ++frame) {
    const Mirrored ray = mirroredIn(in, frame);
    const Eigen::Isometry3d pose = movingLampCamera(frame).inverse();
    const Vec eye = pose.translation(), lamp = pose * kMovingLamp;
    const double leant = degreesBetween(ray.normal, eye - ray.at);
    EXPECT_TRUE(leant > 4.75 && leant < 5.35) << leant << ", frame " << frame;
    EXPECT_NEAR(leant, degreesBetween(eye - ray.at, lamp - ray.at) / 2, 1e-3);
    if (frame != 2) continue;
    EXPECT_NEAR((eye - ray.at).norm(), 0.59, 0.005);
    EXPECT_NEAR(degreesBetween(eye - ray.at, lamp - ray.at), 9.7, 0.05);
    EXPECT_NEAR(leant, 4.8, 0.05);
    EXPECT_NEAR(leant / 10, 0.5, 0.02) << "a flash 1 cm beside the lens";
    const Explanation e = explain(in, frame, 0, "canonical");
    EXPECT_NEAR(number(stepOf(e, "peak"), "distance from the camera"), (eye - ray.at).norm(), 1e-5);
    EXPECT_NEAR(number(stepOf(e, "tangent-plane"), "angle between N and the view ray"), leant, 1e-3);
  }
}

/// Where the way from lens to lamp over the turned ellipsoid is shortest, in the camera's coordinates: a search that shrinks.
Vec shortestOver(const Eigen::Isometry3d& cameraFromBody) {
  const Vec towards = cameraFromBody.inverse().translation().cwiseQuotient(kMovingLampBody).normalized();
  const auto place = [&](const Vec& unit) { return Vec(cameraFromBody * unit.normalized().cwiseProduct(kMovingLampBody)); };
  const auto length = [&](const Vec& unit) { return place(unit).norm() + (place(unit) - kMovingLamp).norm(); };
  Vec best = towards;
  for (double step = 0.3; step > 1e-9; step *= 0.7)
    for (int i = 0; i < 12; ++i) {
      const Vec u = best.unitOrthogonal(), v = best.cross(u);
      const double a = i * std::numbers::pi / 6;
      const Vec next = (best + step * (std::cos(a) * u + std::sin(a) * v)).normalized();
      if (length(next) < length(best)) best = next;
    }
  return place(best);
}

TEST(MovingLamp, ATurntableBeforeAStillCameraShowsTheSameHighlights) {
  const Inspection& in = lesson("moving-lamp").inspection;
  const OpenedSession opened = openLesson("moving-lamp");
  auto turned = std::make_shared<Scene>(*opened.scene);
  for (std::size_t i = 0; i < turned->frames.size(); ++i) {
    Frame& frame = turned->frames[i];
    frame.worldFromObject = movingLampCamera(int(i));
    frame.camera.camFromWorld.setIdentity();
    const Vec seen = shortestOver(frame.worldFromObject);
    const Pixel pixel(159.5 + 420 * seen.x() / seen.z(), 119.5 + 420 * seen.y() / seen.z());
    EXPECT_LT((pixel - in.evidence[i].highlights.at(0).peak).norm(), 5e-3) << "px, frame " << i;
  }
  turned->lights.at(0).frame = LightFrame::World;
  const Inspection table = inspect(std::shared_ptr<const Scene>(turned), opened.session.request);
  EXPECT_EQ(table.lightFrame.frame, LightFrame::World) << "the lamp of a camera that never moves stands still";
  for (const char* model : {"dual", "canonical", "limit-angle"}) {
    const std::map<int, double> there = errorsByFrame(table, model), here = errorsByFrame(in, model);
    ASSERT_EQ(there.size(), 4u) << model;
    for (const auto& [frame, error] : there) EXPECT_NEAR(error, here.at(frame), 1e-3) << model << ", %, frame " << frame;
  }
}

bool hits(const Vec& centre, const Vec& axes, const Vec& direction) {
  const Vec d = direction.cwiseQuotient(axes), e = -centre.cwiseQuotient(axes);
  return e.dot(d) * e.dot(d) > d.squaredNorm() * (e.squaredNorm() - 1);
}

TEST(MovingLamp, PrimalHasOneCameraAndTheOthersHaveFive) {
  const Inspection& in = lesson("moving-lamp").inspection;
  const Failure* const failure = in.models.at("primal").fits.at(0).failure();
  ASSERT_TRUE(failure);
  EXPECT_EQ(failure->reason, Reason::RankDeficient);
  int seen = 0;
  for (int i = 0; i < 1000; ++i) {  // the same outline, twice as far away and twice as large
    const Vec centre(0.1, -0.05, 0.9), axes(0.2, 0.1, 0.15), direction(0.4 * std::sin(2.4 * i), 0.4 * std::cos(0.7 * i), 1);
    EXPECT_EQ(hits(centre, axes, direction), hits(2 * centre, 2 * axes, direction));
    seen += hits(centre, axes, direction);
  }
  EXPECT_TRUE(seen > 50 && seen < 950) << seen;
  std::vector<Vec> virtualCameras;
  for (int frame = 0; frame < 9; ++frame) {
    const Mirrored ray = mirroredIn(in, frame);
    const Eigen::Isometry3d pose = movingLampCamera(frame);
    const Vec at = pose * ray.at, normal = pose.linear() * ray.normal, eye = 2 * normal.dot(at) * normal;
    for (const Vec& other : virtualCameras) EXPECT_GT((eye - other).norm(), 0.02) << "m: another one in each frame";
    virtualCameras.push_back(eye);
    const Explanation e = explain(in, frame, 0, "canonical");
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(number(stepOf(e, "virtual-camera"), "centre of the virtual camera", k), eye[Eigen::Index(k)], 1e-4) << "m";
  }
}

TEST(MovingLamp, WhatTheBendCosts) {
  const Inspection& in = lesson("moving-lamp").inspection;
  EXPECT_NEAR(meanError(in, "dual"), 4, 0.5) << "%";
  EXPECT_NEAR(meanError(in, "canonical"), 1.6, 0.05);
  for (const auto& [frame, error] : errorsByFrame(in, "limit-angle")) EXPECT_LT(error, 0.01) << "frame " << frame;
  double least = 1e9, most = 0;
  for (const int frame : kTraining) {
    // Closed form: Gaussian curvature and mean curvature of an ellipsoid.
    const Vec at = mirroredIn(in, frame).at, squares = kMovingLampBody.cwiseProduct(kMovingLampBody);
    const double product = kMovingLampBody.prod(), sum = at.cwiseQuotient(squares).squaredNorm();
    const double gauss = 1 / (product * product * sum * sum),
                 mean = (squares.sum() - at.squaredNorm()) / (2 * product * product * std::pow(sum, 1.5));
    least = std::min(least, mean - std::sqrt(mean * mean - gauss));
    most = std::max(most, mean - std::sqrt(mean * mean - gauss));
  }
  EXPECT_NEAR(least, 1.9, 0.05) << "per metre";
  EXPECT_NEAR(most, 3.3, 0.05);
}

}  // namespace glint::moving_lamp
