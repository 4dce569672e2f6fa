// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/exact_highlight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/surface/analytic.h"
#include "core/synth/synth.h"
#include "tests/core/highlight/highlight_images.h"
#include "tests/shared_data.h"
#include "tests/tolerances.h"

namespace glint {
namespace {

nlohmann::json reference(const char* name) {
  std::ifstream in(std::string(GLINT_SHARED_DIR) + "/reference/" + name);
  return nlohmann::json::parse(in);
}

Camera cameraOf(const nlohmann::json& frame) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.pixelFromRay << 800, 0, 320, 0, 800, 240, 0, 0, 1;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      camera.camFromWorld.matrix()(i, j) =
          frame.at("camera_from_world")[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return camera;
}

TrueLight lightOf(const nlohmann::json& file) {
  TrueLight light;
  light.id = "lamp";
  light.lamp = lampAt(Eigen::Vector3d(file.at("light")[0], file.at("light")[1], file.at("light")[2]));
  return light;
}

/// Peak and 36 contour points of an independent program; sagitta of our chords 1e-7 px, so that the points lie on them.
void expectReference(const Surface& surface, const nlohmann::json& frame, const TrueLight& light, double limitDeg) {
  ExactOptions options;
  options.kind = ContourKind::LimitAngle;
  options.limitAngle = limitDeg * M_PI / 180;
  options.sagittaPx = 1e-7;
  options.marginPx = 400;  // some of the reference's contours leave the image
  const Outcome<std::vector<Highlight>> found = exactHighlights(surface, cameraOf(frame), light, {}, options);
  ASSERT_TRUE(found) << found.failure().message();
  const Pixel peak(frame.at("peak")[0], frame.at("peak")[1]);
  ASSERT_EQ(found->size(), 1u);
  EXPECT_LT((found->front().peak - peak).norm(), tolerance::kReferencePeakPx);
  EXPECT_FALSE(found->front().touchesBorder);
  for (const auto& p : frame.at("contour"))
    EXPECT_LT(distance(found->front().contour, Pixel(p[0], p[1])), tolerance::kReferenceContourPx + options.sagittaPx);
}

TEST(ExactHighlights, LimitAngleContoursOfThePlaneBentIntoACylinder) {
  GLINT_NEEDS_SHARED_DATA();
  const nlohmann::json file = reference("plane_to_cylinder.json");
  for (const auto& step : file.at("steps")) {
    AnalyticSpec spec;
    spec.type = "sheet";
    spec.curvature = step.at("curvature");
    const std::shared_ptr<const Surface> surface = makeAnalytic(spec);
    for (const auto& frame : step.at("frames")) expectReference(*surface, frame, lightOf(file), file.at("alpha_lim_deg"));
  }
}

TEST(ExactHighlights, LimitAngleContoursOfTheEllipsoid) {
  GLINT_NEEDS_SHARED_DATA();
  const nlohmann::json file = reference("ellipsoid.json");
  AnalyticSpec spec;
  spec.type = "ellipsoid";
  spec.semiAxes = {0.6, 0.35, 0.25};
  const std::shared_ptr<const Surface> surface = makeAnalytic(spec);
  for (const auto& frame : file.at("frames")) expectReference(*surface, frame, lightOf(file), file.at("alpha_lim_deg"));
}

struct SphereScene {
  std::shared_ptr<const Surface> surface;
  Camera camera;
  TrueLight light;
  SphereScene() {
    AnalyticSpec spec;
    spec.type = "sphere";
    spec.radius = 0.4;
    surface = makeAnalytic(spec);
    camera.width = 320;
    camera.height = 240;
    camera.pixelFromRay << 400, 0, 159.5, 0, 400, 119.5, 0, 0, 1;
    camera.camFromWorld.translation() = Eigen::Vector3d(0, 0, 1.7);  // at (0, 0, -1.7), looking along +z
    light.id = "lamp";
    light.lamp = lampAt(Eigen::Vector3d(1.1, -0.7, -1.5));
  }
};

TEST(ExactHighlights, EveryVertexLiesOnTheLevelAndThePeakIsTheMaximum) {
  const SphereScene scene;
  for (const Lobe lobe : {Lobe::Phong, Lobe::BlinnPhong, Lobe::TorranceSparrow, Lobe::Ggx}) {
    const Material material{lobe, 0.12, 1, {0, 0, 0}};
    const Outcome<std::vector<Highlight>> found = exactHighlights(*scene.surface, scene.camera, scene.light, material, {});
    ASSERT_TRUE(found) << nameOf(lobe) << found.failure().message();
    const Highlight& h = found->front();
    const auto field = [&](const Pixel& p) {
      return logSpecular(*scene.surface, scene.camera, p, scene.light, material).value();
    };
    const double top = field(h.peak);
    EXPECT_NEAR(h.peakValue, std::exp(top), 1e-12 * h.peakValue);
    for (const Pixel& p : h.contour.points) EXPECT_NEAR(field(p), top + std::log(0.5), 1e-8) << nameOf(lobe);
    // Curvature of log I is about 2 / (30 px)^2; a step of 0.01 px lowers it by 1e-7, far above round-off.
    for (const Pixel& step : {Pixel(0.01, 0), Pixel(-0.01, 0), Pixel(0, 0.01), Pixel(0, -0.01)})
      EXPECT_LT(field(h.peak + step), top) << nameOf(lobe);
  }
}

TEST(ExactHighlights, DetectionOnARenderedFrameAgrees) {
  const SphereScene scene;
  const Material material{Lobe::TorranceSparrow, 0.12, 1, {0, 0, 0}};
  const Outcome<std::vector<Highlight>> exact = exactHighlights(*scene.surface, scene.camera, scene.light, material, {});
  ASSERT_TRUE(exact);
  const RenderedFrame frame = renderFrame(*scene.surface, scene.camera, {scene.light}, material);
  DetectOptions options;
  options.removeBackground = false;
  const Outcome<std::vector<Highlight>> found = detectHighlights(frame.specular, &frame.mask, options);
  ASSERT_TRUE(found);
  // Chords of marching squares: 0.25 / radius of curvature, with a highlight of about 25 px.
  EXPECT_LT(test::meanDistance(found->front().contour, exact->front().contour), 0.01);
  EXPECT_LT((found->front().peak - exact->front().peak).norm(),
            0.1);  // a quadratic is not the lobe: its window is 0.9 of the peak
}

TEST(ExactHighlights, SmallSphereLightTendsToThePointLight) {
  SphereScene scene;
  const Material material{Lobe::TorranceSparrow, 0.12, 1, {0, 0, 0}};
  const Outcome<std::vector<Highlight>> point = exactHighlights(*scene.surface, scene.camera, scene.light, material, {});
  scene.light.lamp = withRadius(scene.light.lamp, 1e-4);
  const Outcome<std::vector<Highlight>> small = exactHighlights(*scene.surface, scene.camera, scene.light, material, {});
  scene.light.lamp = withRadius(scene.light.lamp, 0.1);
  const Outcome<std::vector<Highlight>> large = exactHighlights(*scene.surface, scene.camera, scene.light, material, {});
  ASSERT_TRUE(point && small && large);
  EXPECT_LT(test::meanDistance(point->front().contour, small->front().contour), 2e-3);  // two sagittas of 2e-3 at most
  EXPECT_GT(large->front().areaPx2, 1.005 * point->front().areaPx2);                    // a wide light widens the highlight
}

TEST(ExactHighlights, DegenerateIsRefusedByName) {
  SphereScene scene;
  ExactOptions limit;
  limit.kind = ContourKind::LimitAngle;
  scene.light.lamp = withRadius(scene.light.lamp, 0.1);
  EXPECT_EQ(exactHighlights(*scene.surface, scene.camera, scene.light, {}, limit).failure().reason, Reason::NotSupported);
  scene.light.lamp = withRadius(scene.light.lamp, 0);
  scene.light.lamp = lampAt(Eigen::Vector3d(0, 0, 5));  // behind the sphere
  EXPECT_EQ(exactHighlights(*scene.surface, scene.camera, scene.light, {}, {}).failure().reason, Reason::NoHighlight);
}

// The inner wall of a ring is in the shadow of the wall across, whatever the ring's size: nothing is tested at a distance in
// metres.
TEST(LightSource, ScaleOfAShadowUnderALightAtInfinity) {
  TrueLight light;
  light.lamp = lampTowards(Eigen::Vector3d(-1, 0, 0.05).normalized());
  for (const double scale : {1e-6, 1.0, 1e6}) {
    AnalyticSpec spec;
    spec.type = "torus";
    spec.majorRadius = scale;
    spec.minorRadius = 0.2 * scale;
    const std::shared_ptr<const Surface> ring = makeAnalytic(spec);
    const Eigen::Vector3d eye(0.3 * scale, 0, 0.1 * scale);
    const Shading across = shade(*ring, {{0.8 * scale, 0, 0}, {-1, 0, 0}}, eye, light, {});
    EXPECT_EQ(across.specular, 0) << scale;
    const Shading top = shade(*ring, {{scale, 0, 0.2 * scale}, {0, 0, 1}}, {0, 0, 2 * scale}, light, {});
    EXPECT_GT(top.diffuse, 0) << scale;
  }
}

}  // namespace
}  // namespace glint
