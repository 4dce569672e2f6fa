// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "core/app/ball_photographs.h"
#include "core/app/lamp_answer.h"
#include "core/base/numeric.h"
#include "core/geometry/polyline.h"
#include "core/pipeline/inspection.h"

namespace glint {
namespace {

constexpr double kWideShare =
    0.05;  // of the ball's radius: the middle of a disc of 3 degrees lies 0.1 degrees off its mirror point
constexpr double kFarRadii = 1e4;      // a camera there sees the ball under rays that are parallel to 0.006 degrees
constexpr double kAgreeingDeg = 0.5;   // the bias that is to be removed, of a lobe of 15 degrees
constexpr double kAgreeingSigmas = 3;  // beside it

/// The photographs as frames that see a sphere, in the lengths of the ball's projection.
std::shared_ptr<const Scene> sceneOf(const BallShots& shots, int width, int height, const std::optional<Camera>& camera,
                                     const FittedBall& ball) {
  auto scene = std::make_shared<Scene>();
  scene->name = "ball";
  BallProjection view;
  view.camera = camera;
  if (!camera) {
    view.camera.emplace();
    const double focal = ball.parameters.z() * kFarRadii;
    view.camera->pixelFromRay << focal, 0, ball.parameters.x(), 0, focal, ball.parameters.y(), 0, 0, 1;
  }
  AnalyticSpec sphere;
  sphere.type = "sphere";
  sphere.radius = 1;
  sphere.worldFromSurface.translation() = ballOf(view, ball.parameters).centre;
  scene->surfaces["ball"] = sphere;
  for (const Shot& shot : shots.shots) {
    Frame frame;
    frame.id = shot.id;
    frame.image = shot.files.front();
    frame.camera = *view.camera;
    frame.camera.pixelFromRay.topRightCorner<2, 1>() -= shots.balls.front().corner;
    frame.camera.width = width;
    frame.camera.height = height;
    frame.surface = "ball";
    frame.lightsOn = {"lamp-" + shot.id};
    scene->frames.push_back(std::move(frame));
  }
  return scene;
}

}  // namespace

bool showsLobes(const std::vector<LampObservation>& seen, const BallOutline& ball) {
  std::vector<double> radii;
  for (const LampObservation& o : seen)
    if (o.contour.size() > 2) radii.push_back(std::sqrt(std::abs(signedArea(Polyline{o.contour, true})) / std::numbers::pi));
  return !radii.empty() && upperMedian(radii) > kWideShare * ball.radius;
}

void refineByLobe(const BallShots& shots, int width, int height, const std::optional<Camera>& camera, BallLamps& lamps,
                  const ProgressFn& progress) {
  require(shots.balls.size() == 1 && lamps.lamps.size() == shots.shots.size(), "refineByLobe: one ball, one lamp a shot");
  InspectionRequest request;
  request.models.clear();
  request.source = FrameSource::Image;
  request.train = "first:" + std::to_string(shots.shots.size());
  const std::vector<LampAnswer> again =
      lampsOfScene(inspect(sceneOf(shots, width, height, camera, lamps.balls.front()), request, progress), progress);
  // What the outline leaves open turns both answers alike.
  const FittedBall& ball = lamps.balls.front();
  const double ofOutline = 2 * ball.sigmaPx.head<2>().norm() / ball.parameters.z();
  for (LampAnswer& lamp : lamps.lamps) {
    const auto found = std::find_if(again.begin(), again.end(), [&](const LampAnswer& a) { return a.id == lamp.id; });
    if (lamp.failure || found == again.end() || found->failure || !found->remarks.empty()) continue;
    if (found->solver != "pixels" && found->solver != "contours") continue;
    const double apart = std::atan2(found->direction.cross(lamp.direction).norm(), found->direction.dot(lamp.direction));
    const double sigma = std::hypot(lamp.directionSigma, found->directionSigma);
    if (!(apart < radians(kAgreeingDeg) + kAgreeingSigmas * sigma)) continue;
    lamp.direction = found->direction;
    lamp.directionSigma = std::hypot(found->directionSigma, ofOutline);
    lamp.residualPx = found->residualPx;
    lamp.degreesOfFreedom = found->degreesOfFreedom;
    lamp.solver = found->solver;
  }
}

}  // namespace glint
