// SPDX-License-Identifier: BSD-3-Clause
// Lamps that the scene states (lights[].known): a dome in front of a still camera, one lamp on in each photograph.
#include "core/pipeline/known_lamps.h"

#include <gmock/gmock.h>

#include "core/base/numeric.h"
#include "core/model/models.h"
#include "core/pipeline/fits.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/live_prediction.h"
#include "core/pipeline/pipeline.h"
#include "core/pipeline/summary.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint::known_lamps_tests {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

AnalyticSpec bodyOf(double unit) {
  AnalyticSpec spec;
  spec.type = "ellipsoid";
  spec.semiAxes = Vector3d(0.5, 0.4, 0.35) * unit;
  return spec;
}

Camera stillCamera(double unit) { return lookingAt(unit * Vector3d(1.5, -0.4, 0.6), {0, 0, 0}); }

/// Directions on the camera's side, as a dome has them.
Vector3d domeDirection(int i) {
  const double azimuth = 2.4 * i, height = 0.35 + 0.9 * std::fmod(0.618 * i, 1.0);
  return Vector3d(1.2, 0, 0.5) + 0.8 * Vector3d(std::cos(height) * std::sin(azimuth), std::cos(azimuth), std::sin(height));
}

std::string domeName(int i) { return "dome-" + std::to_string(i); }

/// One photograph for each lamp. @param at  places the lamps at that distance, 0 = at infinity, m
/// @param apart  every other lamp has a limit angle that is larger by this share, the rest one that is smaller
std::shared_ptr<Scene> domeScene(int lamps, double at = 0, double unit = 1, double apart = 0) {
  auto scene = std::make_shared<Scene>();
  scene->name = "dome";
  scene->surfaces["body"] = bodyOf(unit);
  for (int i = 0; i < lamps; ++i) {
    const Vector3d d = domeDirection(i).normalized();
    TrueLight light;
    light.id = domeName(i);
    light.lamp = at > 0 ? lampAt(unit * at * d) : lampTowards(d);
    light.known = true;
    scene->lights.push_back(light);
    Frame f;
    f.id = "v" + std::to_string(i);
    f.camera = stillCamera(unit);
    f.surface = "body";
    f.lightsOn = {light.id};
    ExactOptions options;
    options.kind = ContourKind::LimitAngle;
    options.limitAngle = kLimitAngle * (i % 2 == 0 ? 1 - apart : 1 + apart);
    options.sagittaPx = 5e-3;
    const Outcome<std::vector<Highlight>> found =
        exactHighlights(*makeAnalytic(bodyOf(unit)), f.camera, light, Material{}, options);
    EXPECT_TRUE(found) << domeName(i);
    if (found) f.highlights = *found;
    for (Highlight& h : f.highlights) {
      h.light = light.id;
      h.fromScene = true;
    }
    scene->frames.push_back(std::move(f));
  }
  return scene;
}

InspectionRequest domeRequest() {
  InspectionRequest request;
  request.models = {"limit-angle"};
  request.train = "0-11";
  return request;
}

const ModelResult::Fit* fitOfLamp(const Inspection& in, const std::string& model, const std::string& light) {
  for (const ModelResult::Fit& fit : in.models.at(model).fits)
    if (fit.light == light) return &fit;
  return nullptr;
}

double heldOutPct(const Inspection& in, const std::string& model) {
  const ModelSummary s = summarise(in, in.models.at(model));
  return s.matched > 0 && s.missed == 0 ? s.contourErrorPct.mean : std::nan("");
}

TEST(KnownLamps, TwelveLampsPredictTheThirteenth) {
  for (const double at : {0.0, 2.5}) {
    const Inspection in = inspect(domeScene(13, at), domeRequest());
    const ModelResult::Fit* const fit = fitOfLamp(in, "limit-angle", domeName(12));
    ASSERT_TRUE(fit && fit->fit) << (fit ? fit->failure()->message() : "no fit");
    EXPECT_EQ(fit->fit->poor, "");
    // The contours were made with it; their chords lie up to 5e-3 px inside of some 30 px.
    EXPECT_NEAR(*fit->fit->limitAngle(), kLimitAngle, kLimitAngle * 2e-4);
    EXPECT_LT(heldOutPct(in, "limit-angle"), 0.01);
    EXPECT_TRUE(fit->fit->frames.empty());
    EXPECT_EQ(in.lights.at({domeName(0)})->solver, "known");
  }
}

TEST(KnownLamps, AnotherUnitChangesNothing) {
  for (const double at : {0.0, 2.5}) {
    const Inspection metres = inspect(domeScene(13, at), domeRequest()), far = inspect(domeScene(13, at, 1000), domeRequest());
    EXPECT_NEAR(heldOutPct(metres, "limit-angle"), heldOutPct(far, "limit-angle"), 1e-3);
    EXPECT_NEAR(*fitOfLamp(far, "limit-angle", domeName(3))->fit->limitAngle(), kLimitAngle, kLimitAngle * 2e-4);
  }
}

TEST(KnownLamps, NoiseIsSharedByAllLamps) {
  InspectionRequest request = domeRequest();
  request.noisePx = 0.5;
  const Inspection in = inspect(domeScene(13), request);
  // Twelve contours of 72 points each with noise of 0.5 px against radii of some 40 px: 0.5 / 40 / sqrt(864) of the angle.
  EXPECT_NEAR(*fitOfLamp(in, "limit-angle", domeName(12))->fit->limitAngle(), kLimitAngle, 4 * kLimitAngle * 0.5 / 40 / 29);
  EXPECT_LT(heldOutPct(in, "limit-angle"), 0.3);
}

TEST(KnownLamps, WhatOneLimitAngleLeavesIsSaid) {
  const auto saysIt = [](double apart) {
    const Inspection in = inspect(domeScene(13, 0, 1, apart), domeRequest());
    for (const std::string& remark : fitOfLamp(in, "limit-angle", domeName(3))->fit->remarks)
      if (remark.find("one limit angle leaves") != std::string::npos) return true;
    return false;
  };
  EXPECT_FALSE(saysIt(0.005));
  EXPECT_TRUE(saysIt(0.03));  // 3 % of the radius remain
}

TEST(KnownLamps, OneHighlightOfOneLampIsEnough) {
  InspectionRequest request = domeRequest();
  request.train = "4";
  const Inspection in = inspect(domeScene(13), request);
  EXPECT_LT(heldOutPct(in, "limit-angle"), 0.01);
}

TEST(KnownLamps, AWrongLampIsNamed) {
  const std::shared_ptr<Scene> scene = domeScene(13);
  std::swap(scene->lights[2].lamp, scene->lights[7].lamp);
  const Inspection in = inspect(scene, domeRequest());
  const ModelResult::Fit* const wrong = fitOfLamp(in, "limit-angle", domeName(2));
  ASSERT_NE(wrong, nullptr);
  ASSERT_TRUE(wrong->fit);
  EXPECT_THAT(wrong->fit->poor, AllOf(HasSubstr("frame v2"), HasSubstr("known lamp mirrors")));
  // It has no say in what the others share.
  const ModelResult::Fit* const right = fitOfLamp(in, "limit-angle", domeName(3));
  ASSERT_TRUE(right && right->fit);
  EXPECT_EQ(right->fit->poor, "");
  EXPECT_LT(heldOutPct(in, "limit-angle"), 0.01);
}

TEST(KnownLamps, ALampBehindItsHighlightIsRefused) {
  const std::shared_ptr<Scene> scene = domeScene(2);
  for (TrueLight& l : scene->lights) l.lamp = lampTowards(Vector3d(-1, 0.2, -0.5));
  InspectionRequest request = domeRequest();
  request.train = "first:2";
  const Inspection in = inspect(scene, request);
  for (const ModelResult::Fit& fit : in.models.at("limit-angle").fits) EXPECT_FALSE(fit.fit);
}

TEST(KnownLamps, APlaceIsNotPooledWithADirection) {
  const KnownLamp sun{lampTowards({0, 0, 1}), 0}, near{lampAt({0, 0, 1}), 0}, other{lampAt({0, 1, 1}), 0},
      ball{sphereLamp(Light::at({0, 0, 1}), 0.1), 0};
  EXPECT_TRUE(shareMaterial(near, other));
  EXPECT_FALSE(shareMaterial(sun, near));
  EXPECT_FALSE(shareMaterial(ball, near));
}

TEST(KnownLamps, TheStatedUncertaintyIsInTheBand) {
  std::vector<double> widths;
  for (const double sigma : {0.0, 1.0}) {
    const std::shared_ptr<Scene> scene = domeScene(13);
    for (TrueLight& l : scene->lights) l.sigma = sigma;
    InspectionRequest request = domeRequest();
    request.noisePx = 0.3;
    request.settings.set("predict.band", true);
    const Inspection in = inspect(scene, request);
    for (const FrameComparison& c : in.models.at("limit-angle").frames)
      if (c.frame == 12) {
        ASSERT_THAT(c.prediction.highlights(), SizeIs(1));
        double squares = 0;
        const std::vector<double>& s = c.prediction.highlights().front().sigmaPx;
        for (const double px : s) squares += px * px / double(s.size());
        widths.push_back(std::sqrt(squares));
      }
  }
  ASSERT_THAT(widths, SizeIs(2));
  // A direction that turns by one degree moves the mirror point by half a degree of the normal; on this body a limit angle of
  // 3.4 degrees spans the contour's radius. Across the contour, on average over it, 1 / sqrt(2) of that.
  const double turned = 0.5 / degrees(kLimitAngle) / std::sqrt(2.0);
  EXPECT_LT(widths[0], 0.1);
  EXPECT_GT(widths[1], 5 * widths[0]);
  EXPECT_GT(widths[1], 10 * turned);  // px: the contours' radii are some 20 to 60 px
  EXPECT_LT(widths[1], 90 * turned);
}

/// What else explains the material is fitted under one lamp and stands for all: each band is as if fitted under its own.
TEST(KnownLamps, BandsShareWhatElseExplainsTheMaterial) {
  InspectionRequest request = domeRequest();
  request.train = "0-4";
  request.settings.set("predict.band", true);
  for (const double at : {0.0, 2.5}) {
    const Inspection in = inspect(domeScene(6, at, 1, 0.02), request);
    const HighlightModel& model = modelByName("limit-angle");
    const ModelResult& result = in.models.at("limit-angle");
    for (const FrameComparison& c : result.frames) {
      const ModelResult::Fit& fit = result.fits[std::size_t(c.fit)];
      ASSERT_TRUE(fit.fit && c.prediction.highlights().size() == 1u) << c.light;
      const FitInput input = fitInputOf(in, model, fit.key());
      const std::vector<OtherFit> own = otherFits(model, *fit.fit, input, in.request.settings);
      ASSERT_THAT(own, SizeIs(1)) << "reflectance stands beside it";
      const FittedBand band = bandOf(model, *fit.fit, input, in.request.settings, own, false);
      const PredictedHighlight& shown = c.prediction.highlights()[0];
      const Camera camera = in.cameraFor(c.frame, c.light);
      const std::vector<double> alone = band.band->sigmaPx(shown, camera, surfaceOfModel(in, model, c.frame, c.light).get());
      ASSERT_EQ(alone.size(), shown.sigmaPx.size());
      for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_NEAR(shown.sigmaPx[i], alone[i], 1e-3 * alone[i]) << c.light;
    }
  }
}

TEST(KnownLamps, SeveralThatAreOnAreToldApart) {
  // Two of the dome's lamps in each photograph, whose names the highlights do not carry.
  const std::shared_ptr<Scene> single = domeScene(12), both = domeScene(12);
  for (int i = 0; i < 12; ++i) {
    Frame& f = both->frames[std::size_t(i)];
    const int other = (i + 5) % 12;
    f.lightsOn = {domeName(i), domeName(other)};
    const std::vector<Highlight>& more = single->frames[std::size_t(other)].highlights;
    f.highlights.insert(f.highlights.begin(), more.begin(), more.end());
    for (Highlight& h : f.highlights) h.light.clear();
  }
  InspectionRequest request = domeRequest();
  request.train = "0-5";
  const Inspection in = inspect(both, request);
  for (int i = 0; i < 12; ++i)
    for (const Highlight& h : in.evidence[std::size_t(i)].highlights) {
      EXPECT_TRUE(h.light == domeName(i) || h.light == domeName((i + 5) % 12)) << "frame " << i << ": " << h.light;
    }
  EXPECT_LT(heldOutPct(in, "limit-angle"), 0.01);
}

TEST(KnownLamps, ALampOnTheCameraIsPredictedFromNewPoses) {
  auto scene = domeScene(1);
  scene->lights.front().lamp = lampAt({0.05, -0.02, 0.01});
  scene->lights.front().frame = LightFrame::Camera;
  const Frame pattern = scene->frames.front();
  scene->frames.clear();
  for (int i = 0; i < 4; ++i) {
    Frame f = pattern;
    f.id = "v" + std::to_string(i);
    f.camera = lookingAt({1.5 * std::cos(0.5 * i), 1.5 * std::sin(0.5 * i), 0.5}, {0, 0, 0});
    f.highlights =
        exactContours(bodyOf(1), f.camera, {domeName(0), f.camera.camFromWorld.inverse() * Vector3d(0.05, -0.02, 0.01)});
    scene->frames.push_back(f);
  }
  InspectionRequest request = domeRequest();
  request.train = "0-1";
  const Inspection in = inspect(scene, request);
  EXPECT_EQ(in.lightFrame.frame, LightFrame::Camera);
  EXPECT_THAT(in.lightFrame.reason, HasSubstr("the scene states its lamps"));
  EXPECT_LT(heldOutPct(in, "limit-angle"), 0.01);
}

TEST(KnownLamps, LightsNamesWhatIsPredicted) {
  const std::shared_ptr<Scene> scene = domeScene(13);
  scene->frames.pop_back();  // nobody photographed the thirteenth
  InspectionRequest request = domeRequest();
  request.lights = {domeName(12)};
  const LivePredictor predictor(scene, request);
  const Outcome<LiveAnswer> answer = predictor.predict("new", stillCamera(1).camFromWorld, stillCamera(1));
  ASSERT_TRUE(answer);
  ASSERT_THAT(answer->highlights, SizeIs(1));
  EXPECT_EQ(answer->highlights.front().light, domeName(12));
  ASSERT_THAT(answer->highlights.front().prediction.highlights(), SizeIs(1));
  const std::vector<Highlight> truth = domeScene(13)->frames.back().highlights;
  const Polyline& contour = answer->highlights.front().prediction.highlights().front().contour;
  for (const Pixel& p : truth.front().contour.points) EXPECT_LT(distance(contour, p), 0.02);
}

}  // namespace
}  // namespace glint::known_lamps_tests
