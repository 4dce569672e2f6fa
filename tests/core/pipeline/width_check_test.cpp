// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/width_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <random>

#include "core/base/numeric.h"
#include "core/pipeline/inspection.h"
#include "core/scene/scene.h"
#include "core/surface/analytic.h"
#include "tests/shared_data.h"

/// Contours of an ellipsoid at known angles from the half vector, traced pixel by pixel; then frames of another program.
namespace glint::width_check_tests {
namespace {

constexpr double kNarrow = 0.05, kWide = 0.08;  // rad

struct Around {
  Eigen::Vector3d mirror;  ///< where the highlight is
  double azimuth = 0, sineSquared = 0;
};
/// The limit angle of a contour in one direction, rad.
using WidthAt = std::function<double(int view, const Around&)>;

struct Widths {
  std::shared_ptr<const Surface> surface;
  Light light = Light::at({0, 0, 1});
  std::vector<BundleView> views;
  std::vector<Eigen::Vector3d> mirrors;

  Widths(const WidthAt& width, double scale = 1, double noisePx = 0, int count = 6) {
    AnalyticSpec spec;
    spec.type = "ellipsoid";
    spec.semiAxes = scale * Eigen::Vector3d(0.3, 0.2, 0.15);
    surface = makeAnalytic(spec);
    light = Light::at(scale * Eigen::Vector3d(0.8, -1.1, 1.5));
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0, noisePx > 0 ? noisePx : 1);
    for (int i = 0; i < count; ++i) {
      const double a = -2.4 + 2.2 * i / (count - 1);
      const Eigen::Vector3d eye = scale * 1.8 * Eigen::Vector3d(0.8 * std::cos(a), 0.8 * std::sin(a), 0.6),
                            forward = -eye.normalized(), right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
      Camera camera;
      camera.width = 640, camera.height = 480;
      camera.pixelFromRay << 1400, 0, 319.5, 0, 1400, 239.5, 0, 0, 1;
      camera.camFromWorld.linear() << right.transpose(), forward.cross(right).transpose(), forward.transpose();
      camera.camFromWorld.translation() = -camera.camFromWorld.linear() * eye;
      const Outcome<std::vector<BrightestPoint>> found = predictedBrightestPoints(*surface, camera, light);
      if (!found) throw std::logic_error("no mirror point");
      const BrightestPoint& b = found->front();
      mirrors.push_back(b.point.position);
      const double cosine = b.point.normal.dot(light.directionFrom(b.point.position));
      BundleView view{camera, surface.get(), {}, b};
      for (int k = 0; k < 72; ++k) {
        const double azimuth = 2 * M_PI * k / 72;
        const double limit = width(i, {b.point.position, azimuth, 1 - cosine * cosine});
        const Pixel along(std::cos(azimuth), std::sin(azimuth));
        double inside = 0, outside = 1;
        while (angleAt(camera, b.pixel + outside * along) < limit) outside *= 1.5;
        for (int step = 0; step < 60; ++step) {
          const double r = 0.5 * (inside + outside);
          (angleAt(camera, b.pixel + r * along) < limit ? inside : outside) = r;
        }
        view.contour.push_back(b.pixel + inside * along + (noisePx > 0 ? Pixel(noise(random), noise(random)) : Pixel(0, 0)));
      }
      views.push_back(std::move(view));
    }
  }

  double angleAt(const Camera& camera, const Pixel& p) const {
    const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(p));
    if (!hit) return M_PI;
    const Eigen::Vector3d& at = hit->position;
    return incidentAngle(hit->normal, light.directionFrom(at), (camera.centreInWorld() - at).normalized());
  }
};

double twoParts(int, const Around& at) { return at.mirror.x() < 0 ? kNarrow : kWide; }

void expectTwoParts(const Widths& scene, double scale, double tolerance) {
  const std::optional<OwnWidths> own = ownWidths(scene.views, std::nullopt);
  ASSERT_TRUE(own);
  EXPECT_NEAR((own->light.position() - scene.light.position()).norm() / scale, 0, 40 * tolerance);
  const std::optional<WidthGroups> groups = groupedByPlace(*own);
  ASSERT_TRUE(groups);
  EXPECT_NEAR(groups->narrow.limitAngle / kNarrow, 1, tolerance);
  EXPECT_NEAR(groups->wide.limitAngle / kWide, 1, tolerance);
  std::vector<std::size_t> narrow, wide;
  for (std::size_t i = 0; i < scene.mirrors.size(); ++i) (scene.mirrors[i].x() < 0 ? narrow : wide).push_back(i);
  ASSERT_FALSE(narrow.empty() || wide.empty());
  EXPECT_EQ(groups->narrow.views, narrow);
  EXPECT_EQ(groups->wide.views, wide);
  EXPECT_LT(groups->narrow.place.x(), 0);
  EXPECT_GT(groups->wide.place.x(), 0);
}

TEST(WidthsByPlace, TwoPartsOfASurfaceAreFoundWithTheirLight) { expectTwoParts(Widths(twoParts), 1, 1e-4); }

TEST(WidthsByPlace, UnitsDoNotMatter) {
  for (const double scale : {1e-3, 1e3}) expectTwoParts(Widths(twoParts, scale), scale, 1e-4);
}

TEST(WidthsByPlace, NoisyContoursAreGroupedAlike) { expectTwoParts(Widths(twoParts, 1, 0.3), 1, 0.01); }

TEST(WidthsByPlace, OtherCausesAreNotThePlace) {
  const auto grouped = [](const WidthAt& width, int count = 6) {
    const Widths scene(width, 1, 0.1, count);
    const std::optional<OwnWidths> own = ownWidths(scene.views, std::nullopt);
    return own && groupedByPlace(*own);
  };
  EXPECT_TRUE(grouped(twoParts));
  EXPECT_FALSE(grouped(twoParts, 3));                                                   // each view may have its own light
  EXPECT_FALSE(grouped([](int, const Around&) { return kNarrow; }));                    // nothing differs
  EXPECT_FALSE(grouped([](int i, const Around&) { return i % 2 ? kNarrow : kWide; }));  // exposures, say
  EXPECT_FALSE(grouped([](int, const Around& at) { return kNarrow * std::exp(0.8 * at.sineSquared); }));  // a long lamp
  // A brushed surface: the width depends on the direction.
  EXPECT_FALSE(grouped([](int, const Around& at) { return kNarrow * (1.5 + std::cos(2 * at.azimuth)); }));
}

TEST(WidthsByPlace, NothingIsAskedWhereOneWidthIsEnough) {
  const Widths scene([](int, const Around&) { return kNarrow; });
  EXPECT_FALSE(ownWidths(scene.views, scene.light));
  EXPECT_FALSE(ownWidths({}, std::nullopt));
}

/// What the first model says of a folder of shared data.
std::string saidOf(const char* folder, const char* model) {
  const auto scene =
      std::make_shared<const Scene>(readScene(std::filesystem::path(GLINT_SHARED_DIR) / "data" / folder / "scene.json"));
  InspectionRequest request;
  request.models = {model};
  request.train = "spread:6";
  request.source = FrameSource::Image;
  request.settings.setFromText("detect.background", "smooth");  // pixels say nothing here, and take long
  request.settings.setFromText("fit.evidence", "contours");
  const Outcome<ModelFit> fit = inspect(scene, request).models.at(model).fits.at(0).fit;
  if (!fit) return fit.failure().message();
  std::string text;
  for (const std::string& remark : fit->remarks) text += remark + "\n";
  return text;
}

TEST(WidthsByPlace, TwoPatchesOfAnotherProgramAreNamedInEveryModelAndNothingElseIs) {
  GLINT_NEEDS_SHARED_DATA();
  // In its highlights of one part, the radiance has fallen to a half at 2.87 and 6.83 degrees from the mirror direction's normal.
  for (const char* model : {"limit-angle", "reflectance"}) {
    const std::string said = saidOf("exact/rough2", model);
    EXPECT_NE(said.find("depends on the place on the surface: roughness about 0.06"), std::string::npos) << said;
    EXPECT_NE(said.find("frames 0000, 0002, 0004; 0.14"), std::string::npos) << said;
    EXPECT_NE(said.find("frames 0007, 0009, 0011 (leave"), std::string::npos) << said;
  }
  for (const char* folder : {"exact/coat", "exact/aniso_ax", "ladder/panel"})
    EXPECT_EQ(saidOf(folder, "limit-angle").find("depends on the place"), std::string::npos) << folder;
}

}  // namespace
}  // namespace glint::width_check_tests
