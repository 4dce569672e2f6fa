// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/surface/brightest_point.h"
#include "core/surface/level_set.h"
#include "tests/core/surface/surfaces.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

using Json = nlohmann::json;

Json reference(const char* name) {
  std::ifstream in(std::string(GLINT_SHARED_DIR) + "/reference/" + name);
  return in ? Json::parse(in) : Json();
}

Camera cameraOf(const Json& file, const Json& frame) {
  Camera camera;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      camera.pixelFromRay(i, j) = file["K"][i][j];
      camera.camFromWorld.linear()(i, j) = frame["camera_from_world"][i][j];
    }
  for (int i = 0; i < 3; ++i) camera.camFromWorld.translation()[i] = frame["camera_from_world"][i][3];
  camera.width = file["width"];
  camera.height = file["height"];
  return camera;
}

/// Peaks and contours of one frame against the surface's own.
void expectFrame(const Surface& surface, const Json& file, const Json& frame, const std::string& where) {
  const Camera camera = cameraOf(file, frame);
  const Light light =
      Light::at(Eigen::Vector3d(file["light"][0].get<double>(), file["light"][1].get<double>(), file["light"][2].get<double>()));
  BrightestPointOptions wide;
  wide.marginFraction = 1;  // some reference peaks are outside the image
  const auto found = predictedBrightestPoints(surface, camera, light, wide);
  ASSERT_TRUE(found) << where << found.failure().message();
  ASSERT_EQ(found->size(), 1u) << where;
  EXPECT_NEAR(((*found)[0].pixel - Pixel(frame["peak"][0].get<double>(), frame["peak"][1].get<double>())).norm(), 0,
              tolerance::kReferencePeakPx)
      << where;

  const double limit = file["alpha_lim_deg"].get<double>() * M_PI / 180;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const PixelField alpha = [&](const Pixel& p) -> std::optional<double> {
    const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(p));
    if (!hit) return std::nullopt;
    const SurfacePoint q = facing(*hit, eye);
    const Eigen::Vector3d l = light.directionFrom(q.position);
    if (q.normal.dot(l) <= 0) return std::nullopt;
    return incidentAngle(q.normal, l, (eye - q.position).normalized());
  };
  LevelSetOptions options;
  options.sagittaPx = 2e-7;  // so that the polyline is as good as the reference points
  options.marginPx = 640;    // some reference contours leave the image
  options.seeds = {(*found)[0].pixel};
  const auto components = traceLevelSets(alpha, {}, limit, camera.width, camera.height, options);
  ASSERT_EQ(components.size(), 1u) << where;
  for (const Json& p : frame["contour"])
    EXPECT_LT(distance(components[0].outline, Pixel(p[0].get<double>(), p[1].get<double>())), tolerance::kReferenceContourPx)
        << where;
}

TEST(Reference, EllipsoidPeaksAndContours) {
  GLINT_NEEDS_SHARED_DATA();
  const Json file = reference("ellipsoid.json");
  const auto surface = makeAnalytic(test::ellipsoid(0.6, 0.35, 0.25));
  for (const Json& frame : file["frames"]) expectFrame(*surface, file, frame, "frame " + frame["index"].dump());
}

TEST(Reference, PlaneToCylinderPeaksAndContours) {
  GLINT_NEEDS_SHARED_DATA();
  const Json file = reference("plane_to_cylinder.json");
  for (const Json& step : file["steps"]) {
    const auto surface = makeAnalytic(test::sheet(step["curvature"]));
    for (const Json& frame : step["frames"]) expectFrame(*surface, file, frame, "curvature " + step["curvature"].dump());
  }
}

}  // namespace
}  // namespace glint
