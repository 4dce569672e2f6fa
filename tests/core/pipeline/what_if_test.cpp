// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/what_if.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "core/app/session.h"
#include "core/pipeline/fits.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/what_if_dom.h"
#include "core/pipeline/what_if_knobs.h"
#include "tests/core/pipeline/exact_scene.h"

namespace glint {
namespace {

using namespace testing_support;

constexpr double kExactly = 1e-12;   // a few operations on numbers of order one
constexpr double kSameModel = 1e-3;  // of the light's distance: reflectance inverts the radiance that made the contours

/// A surface with a lamp that the scene states, and contours of a limit angle in every frame.
std::shared_ptr<Scene> lamp(const AnalyticSpec& surface = sphere(0.5)) { return litScene(surface, 8); }

InspectionRequest request(const std::vector<std::string>& models = {"limit-angle"}) {
  InspectionRequest q;
  q.models = models;
  q.train = "first:4";
  return q;
}

TEST(WhatIf, NothingChangedIsTheSceneItself) {
  const auto scene = lamp();
  const Inspection result = inspect(scene, request());
  EXPECT_EQ(result.scene, scene);
  EXPECT_EQ(result.given, scene);
  EXPECT_TRUE(result.evidenceBefore.empty());
}

TEST(WhatIf, AMovedCameraHasItsCentreWhereItsAxesSay) {
  const auto scene = lamp();
  WhatIf w;
  w.poses[2].translation = {0.1, -0.2, 0.3};
  w.poses[2].rotation = {0, 0, 0.5};
  const Camera before = scene->frames[2].camera, after = changedScene(*scene, w, 0.5)->frames[2].camera;
  const Eigen::Matrix3d axes = before.camFromWorld.linear().transpose();
  EXPECT_LT((after.centreInWorld() - before.centreInWorld() - axes * Eigen::Vector3d(0.1, -0.2, 0.3)).norm(), kExactly);
  // About the optical axis: it stays, and the image's right turns towards its bottom.
  EXPECT_LT((after.camFromWorld.linear().row(2) - before.camFromWorld.linear().row(2)).norm(), kExactly);
  EXPECT_NEAR(after.camFromWorld.linear().row(0).dot(before.camFromWorld.linear().row(1)), std::sin(0.5), kExactly);
  EXPECT_EQ(changedScene(*scene, w, 0.5)->frames[1].camera.camFromWorld.matrix(), scene->frames[1].camera.camFromWorld.matrix());
}

TEST(WhatIf, AMovedHighlightMovesAndScales) {
  const Highlight h = lamp()->frames[0].highlights.at(0);
  const Highlight c = changed(h, {{3, -4}, 2, {1, 0}});
  EXPECT_LT((centroid(c.contour) - centroid(h.contour) - Pixel(3, -4)).norm(), 1e-9);  // round-off of areas of 10^4 px^2
  EXPECT_NEAR(c.areaPx2 / std::abs(signedArea(h.contour)), 4, 1e-9);
  EXPECT_EQ(c.peak, Pixel(h.peak + Pixel(1, 0)));
  ASSERT_TRUE(c.ellipse);
}

TEST(WhatIf, MovingAHighlightDetectsNothingAgainAndPuttingItBackIsTheStart) {
  const auto scene = lamp();
  const Inspection start = inspect(scene, request());
  InspectionRequest q = request();
  q.whatIf.highlights[{1, 0}].contourBy = {5, 0};
  const Inspection moved = inspect(scene, q, {}, &start);
  EXPECT_EQ(moved.work.framesDetected, 0);
  EXPECT_GT(moved.work.trainingViews, 0);
  EXPECT_NE(digestOf(moved), digestOf(start));
  EXPECT_EQ(digestOf(moved), digestOf(inspect(scene, q))) << "the same from nothing";
  q.whatIf.highlights[{1, 0}].contourBy = {7, 0};
  EXPECT_EQ(digestOf(inspect(scene, q, {}, &moved)), digestOf(inspect(scene, q)))
      << "a second change starts from what was detected";
  const Inspection back = inspect(scene, request(), {}, &moved);
  EXPECT_EQ(back.work.framesDetected, 0);
  EXPECT_EQ(digestOf(back), digestOf(start));
}

TEST(WhatIf, AWrongPoseSpoilsTheFitAndPuttingItBackIsTheStart) {
  const auto scene = lamp();
  const Inspection start = inspect(scene, request());
  InspectionRequest q = request();
  q.whatIf.poses[1].rotation = {0, 0.02, 0};
  const Inspection wrong = inspect(scene, q, {}, &start);
  EXPECT_EQ(wrong.work.framesDetected, 0) << "the photograph is the same";
  EXPECT_GT(wrong.lightFor(0, "lamp")->rmsPx, 5 * std::max(0.01, start.lightFor(0, "lamp")->rmsPx));
  EXPECT_EQ(digestOf(inspect(scene, request(), {}, &wrong)), digestOf(start));
}

TEST(WhatIf, SynthesisedContoursFollowTheLamp) {
  const auto scene = lamp();
  InspectionRequest q = request({"reflectance"});
  q.whatIf.synthesise = true;
  q.whatIf.roughness = 0.08;
  q.whatIf.lightsBy["lamp"] = {-0.3, 0.1, 0.2};
  const Inspection result = inspect(scene, q);
  const Eigen::Vector3d expected(-0.2, 0.3, 1.6);
  const ModelResult::Fit& fit = result.models.at("reflectance").fits.at(0);
  ASSERT_TRUE(fit.fit) << fit.fit.failure().message();
  EXPECT_LT((fit.fit->lightEstimate->position() - expected).norm(), kSameModel * expected.norm());
  EXPECT_NEAR(fit.fit->as<ReflectanceFit>()->roughness, 0.08, 0.08 * 0.01);
  EXPECT_LT((result.scene->lights[0].lamp.position() - expected).norm(), kExactly)
      << "the picture shows the lamp where it was put";
}

TEST(WhatIf, SynthesisedContoursFollowTheCurvature) {
  const auto scene = lamp(sheet(0));
  WhatIf w;
  w.synthesise = true;
  // On a plane the mirror point is where the ray to the mirrored lamp meets it; the radiance's maximum is not far.
  const auto flat = changedScene(*scene, w, 0.5);
  const Camera& camera = scene->frames[0].camera;
  const Eigen::Vector3d eye = camera.centreInWorld(), mirrored(0.1, 0.2, -1.4), d = mirrored - eye;
  const Pixel mirror = *camera.project(eye - eye.z() / d.z() * d);
  ASSERT_FALSE(flat->frames[0].highlights.empty());
  EXPECT_LT((flat->frames[0].highlights[0].peak - mirror).norm(), 5);
  // Bent towards -z, the sheet is convex: the highlight shrinks.
  w.surfaces["body"] = 1.0;
  const auto bent = changedScene(*scene, w, 0.5);
  EXPECT_LT(bent->frames[0].highlights[0].areaPx2, 0.8 * flat->frames[0].highlights[0].areaPx2);
  EXPECT_EQ(bent->surfaces.at("body").analytic()->curvature, 1.0);
}

TEST(WhatIf, ALampThatNothingReflectsIsNamed) {
  InspectionRequest q = request();
  q.whatIf.synthesise = true;
  q.whatIf.lightsBy["lamp"] = {0, 0, -3};  // below the plane
  const Inspection result = inspect(lamp(sheet(0)), q);
  for (const FrameEvidence& e : result.evidence) {
    ASSERT_TRUE(e.failure);
    EXPECT_EQ(e.failure->reason, Reason::NoHighlight);
  }
}

/// A sheet under two lamps, with the contours of both in every frame.
std::shared_ptr<Scene> twoLamps() {
  auto scene = lamp(sheet(0.3));
  TrueLight second = scene->lights[0];
  second.id = "second";
  second.lamp = moved(second.lamp, {-0.5, 0.1, 0.2});
  scene->lights.push_back(second);
  for (Frame& f : scene->frames) f.lightsOn.clear();
  WhatIf w;
  w.synthesise = true;
  auto both = std::make_shared<Scene>(*changedScene(*scene, w, 0.5));
  for (Frame& f : both->frames) f.lightsOn = {"lamp", "second"};
  return both;
}

int highlightsOf(const FrameEvidence& e, const std::string& light) {
  return int(std::count_if(e.highlights.begin(), e.highlights.end(), [&](const Highlight& h) { return h.light == light; }));
}

/// The reference is a scene whose files never had that light there.
TEST(WhatIf, ALightSwitchedOffIsAsIfItHadNeverBeenOnInThatFrame) {
  const auto scene = twoLamps();
  auto without = std::make_shared<Scene>(*scene);
  InspectionRequest q = request({"dual", "limit-angle"});
  for (const int frame : {1, 6}) {  // a training and a held-out one
    q.whatIf = switched(q.whatIf, *scene, frame, "second", false);
    Frame& f = without->frames[std::size_t(frame)];
    ASSERT_EQ(f.highlights.size(), 2u);
    std::erase_if(f.highlights, [](const Highlight& h) { return h.light == "second"; });
    f.lightsOn = {"lamp"};
  }
  const Inspection start = inspect(scene, request({"dual", "limit-angle"}));
  const Inspection off = inspect(scene, q, {}, &start), expected = inspect(without, request({"dual", "limit-angle"}));
  EXPECT_EQ(off.work.framesDetected, 0) << "it comes after detection";
  EXPECT_EQ(off.views.size(), start.views.size() - 1);
  EXPECT_EQ(highlightsOf(off.evidence[6], "second"), 0);
  EXPECT_EQ(highlightsOf(off.evidence[6], "lamp"), 1);
  for (const auto& [name, model] : expected.models) {
    const ModelResult& got = off.models.at(name);
    ASSERT_EQ(got.frames.size(), model.frames.size()) << name;
    for (std::size_t i = 0; i < model.frames.size(); ++i) {
      EXPECT_EQ(got.frames[i].frame, model.frames[i].frame);
      EXPECT_EQ(got.frames[i].light, model.frames[i].light);
      ASSERT_EQ(got.frames[i].rows.size(), model.frames[i].rows.size());
      for (std::size_t k = 0; k < model.frames[i].rows.size(); ++k) {
        ASSERT_EQ(got.frames[i].rows[k].metrics.has_value(), model.frames[i].rows[k].metrics.has_value());
        if (model.frames[i].rows[k].metrics) {
          EXPECT_EQ(got.frames[i].rows[k].metrics->contourErrorPct, model.frames[i].rows[k].metrics->contourErrorPct);
        }
      }
    }
  }
  EXPECT_NE(digestOf(off), digestOf(start));
  EXPECT_EQ(digestOf(off), digestOf(inspect(scene, q))) << "the same from nothing";
  EXPECT_EQ(digestOf(inspect(scene, request({"dual", "limit-angle"}), {}, &off)), digestOf(start)) << "and back";
}

TEST(WhatIf, AMovedHighlightStaysTheOneThatWasMovedWhateverIsSwitchedOff) {
  const auto scene = twoLamps();
  InspectionRequest q = request();
  q.noisePx = 0.5;
  q.whatIf.highlights[{2, 1}].peakBy = {3, 0};
  const Inspection both = inspect(scene, q);
  const std::string moved = both.evidence[2].highlights.at(1).light;
  q.whatIf = switched(q.whatIf, *scene, 2, both.evidence[2].highlights.at(0).light, false);
  const Inspection one = inspect(scene, q, {}, &both);
  ASSERT_EQ(one.evidence[2].highlights.size(), 1u);
  EXPECT_EQ(one.evidence[2].highlights[0].light, moved);
  EXPECT_EQ(one.evidence[2].highlights[0].peak, both.evidence[2].highlights[1].peak);
  EXPECT_EQ(one.evidence[2].asFound(0), 1);
  const auto viewOf = [&](const Inspection& in) {
    return *std::find_if(in.views.begin(), in.views.end(),
                         [&](const TrainingView& v) { return v.frame == 2 && v.highlight.light == moved; });
  };
  EXPECT_EQ(viewOf(one).highlight.contour.points, viewOf(both).highlight.contour.points) << "its noise is the same";
}

TEST(WhatIf, AFrameWithoutAnyLightSaysSoAndALightThatIsNowhereOnIsNotFitted) {
  const auto scene = twoLamps();
  InspectionRequest q = request();
  for (const char* light : {"lamp", "second"}) q.whatIf = switched(q.whatIf, *scene, 5, light, false);
  const Inspection dark = inspect(scene, q);
  ASSERT_TRUE(dark.evidence[5].failure);
  EXPECT_EQ(dark.evidence[5].failure->reason, Reason::NoHighlight);
  EXPECT_EQ(dark.evidence[5].failure->detail, "switched off: lamp, second");
  for (const FrameComparison& c : dark.models.at("limit-angle").frames) EXPECT_NE(c.frame, 5) << "nothing is predicted there";
  q.whatIf = {};
  for (int i = 0; i < 8; ++i) q.whatIf = switched(q.whatIf, *scene, i, "second", false);
  const Inspection one = inspect(scene, q);
  ASSERT_EQ(one.models.at("limit-angle").fits.size(), 1u);
  EXPECT_EQ(one.models.at("limit-angle").fits[0].light, "lamp");
}

TEST(WhatIf, ALightThatWasOffCanBeOnWhereContoursAreSynthesised) {
  const auto scene = twoLamps();
  scene->frames[3].lightsOn = {"lamp"};
  std::erase_if(scene->frames[3].highlights, [](const Highlight& h) { return h.light == "second"; });
  InspectionRequest q = request();
  q.whatIf = switched({}, *scene, 3, "second", true);
  EXPECT_FALSE(isOn(*scene, q.whatIf, 3, "second")) << "its photograph cannot show it";
  EXPECT_EQ(highlightsOf(inspect(scene, q).evidence[3], "second"), 0);
  q.whatIf.synthesise = true;
  const Inspection lit = inspect(scene, q);
  EXPECT_EQ(highlightsOf(lit.evidence[3], "second"), 1);
  InspectionRequest asCaptured = q;
  asCaptured.whatIf.lightsSwitched.clear();
  const Inspection before = inspect(scene, asCaptured);
  EXPECT_EQ(highlightsOf(before.evidence[3], "second"), 0);
  EXPECT_EQ(digestOf(inspect(scene, q, {}, &before)), digestOf(lit)) << "and also after results without it";
  // Switching off synthesises nothing again.
  InspectionRequest off = q;
  off.whatIf = switched(off.whatIf, *scene, 4, "lamp", false);
  const Inspection dark = inspect(scene, off, {}, &lit);
  EXPECT_EQ(dark.scene, lit.scene);
  EXPECT_EQ(highlightsOf(dark.evidence[4], "lamp"), 0);
  EXPECT_EQ(lightsOn(*scene, off.whatIf, 4).size(), 1u);
  EXPECT_EQ(switched(off.whatIf, *scene, 4, "lamp", true), q.whatIf) << "what agrees with the capture is no change";
}

TEST(WhatIf, Refusals) {
  const auto scene = lamp();
  const auto refused = [&](const std::function<void(WhatIf&)>& change) {
    WhatIf w;
    w.synthesise = true;
    change(w);
    EXPECT_THROW(changedScene(*scene, w, 0.5), InputError);
  };
  refused([](WhatIf& w) { w.lightsBy["sun"] = {0, 0, 1}; });
  refused([](WhatIf& w) { w.poses[99]; });
  refused([](WhatIf& w) { w.roughness = 0; });
  refused([](WhatIf& w) { w.surfaces["no such"] = 1; });
  refused([](WhatIf& w) { w.surfaces["body"] = -1; });
  scene->lights.clear();
  ASSERT_TRUE(whyNotSynthesised(*scene));
  refused([](WhatIf&) {});
}

TEST(WhatIf, TheWorkingDistanceIsThatOfWhatTheCamerasLookAt) {
  const auto scene = lamp();  // all look at the origin
  double sum = 0;
  for (const Frame& f : scene->frames) sum += f.camera.centreInWorld().norm();
  EXPECT_NEAR(workingDistance(*scene), sum / 8, 1e-9);  // least squares over eight axes
  scene->frames.resize(1);
  EXPECT_EQ(workingDistance(*scene), 1) << "one axis meets nothing";
}

TEST(WhatIf, EveryKnobChangesSomethingAndItsDefaultPutsItBack) {
  const auto scene = lamp();
  const std::vector<WhatIfKnob> knobs = whatIfKnobs(*scene, 3, 1);
  EXPECT_EQ(knobs.size(), 3u + 1 + 1 + 6 + 5);  // light, radius, roughness, pose, highlight
  std::set<std::string> keys;
  for (const WhatIfKnob& knob : knobs) {
    EXPECT_TRUE(keys.insert(knob.spec.key).second) << knob.spec.key;
    WhatIf w;
    const double neutral = std::get<double>(knob.spec.defaultValue);
    EXPECT_DOUBLE_EQ(knob.get(w), neutral) << knob.spec.key;
    EXPECT_LT(knob.spec.min, neutral);
    EXPECT_GT(knob.spec.max, neutral);
    const double other = 0.5 * (neutral + knob.spec.max);
    knob.set(w, other);
    EXPECT_FALSE(w.none()) << knob.spec.key;
    EXPECT_NEAR(knob.get(w), other, kExactly) << knob.spec.key;
    for (const WhatIfKnob& neighbour : knobs) {
      if (neighbour.spec.key == knob.spec.key) continue;
      EXPECT_DOUBLE_EQ(neighbour.get(w), std::get<double>(neighbour.spec.defaultValue)) << neighbour.spec.key;
    }
    knob.set(w, neutral);
    EXPECT_TRUE(w.none()) << knob.spec.key;
  }
}

/// On a sphere the brightest point of a narrow lobe is where the normal halves the angle between camera and lamp.
TEST(WhatIf, ALampOfTheCameraMovesInTheCoordinatesOfEveryCamera) {
  const auto scene = litScene(sphere(0.5), 5);
  scene->lights[0].frame = LightFrame::Camera;
  scene->lights[0].lamp = lampAt(kFlashInCamera);
  WhatIf w;
  w.synthesise = true;
  w.roughness = 0.02;
  const std::vector<WhatIfKnob> knobs = whatIfKnobs(*scene, 0, 0);
  EXPECT_EQ(knobs[0].group, "Light lamp, moves with the camera");
  EXPECT_NE(knobs[0].spec.help.find("axis of the camera"), std::string::npos) << knobs[0].spec.help;
  EXPECT_NE(knobs[0].spec.help.find("0.05, -0.02, 0.01 m"), std::string::npos) << knobs[0].spec.help;
  knobs[0].set(w, 0.3);
  const auto after = changedScene(*scene, w, 0.5);
  for (const Frame& f : after->frames) {
    ASSERT_EQ(f.highlights.size(), 1U) << f.id;
    const Eigen::Isometry3d worldFromCamera = f.camera.camFromWorld.inverse();
    const Eigen::Vector3d eye = worldFromCamera.translation(), ray = f.camera.ray(f.highlights[0].peak).direction.normalized();
    const Eigen::Vector3d middle(0, 0, -0.5), to = eye - middle;
    const double b = ray.dot(to), t = -b - std::sqrt(b * b - to.squaredNorm() + 0.25);
    const Eigen::Vector3d p = eye + t * ray, n = (p - middle).normalized();
    const Eigen::Vector3d lampIs = worldFromCamera * (kFlashInCamera + Eigen::Vector3d(0.3, 0, 0));
    const Eigen::Vector3d half = ((eye - p).normalized() + (lampIs - p).normalized()).normalized();
    EXPECT_LT(std::atan2(half.cross(n).norm(), half.dot(n)), 1e-3) << f.id;
  }
}

/// Contours of a known lobe tell it again: by the model that inverts the radiance, and roughly by their limit angle alone.
TEST(WhatIf, ASynthesisStartsFromTheLobeThatTheSceneShows) {
  constexpr double kMade = 0.07;         // another width than that of a WhatIf{}
  constexpr double kSameLobe = 0.02;     // relative: masking, which this fit tells from a wider lobe, hardly counts here
  constexpr double kOfLimitAngle = 0.1;  // relative: the limit angle alone knows nothing of masking and falling light
  WhatIf made;
  made.synthesise = true;
  made.roughness = kMade;
  const std::shared_ptr<const Scene> captured = changedScene(*lamp(), made, 0.5);
  for (const char* model : {"reflectance", "limit-angle"}) {
    const Inspection in = inspect(captured, request({model}));
    const Outcome<FittedLobe> lobe = fittedLobe(in, 5);
    ASSERT_TRUE(lobe) << model << ": " << lobe.failure().message();
    const bool exact = model == std::string("reflectance");
    EXPECT_NEAR(lobe->roughness, kMade, (exact ? kSameLobe : kOfLimitAngle) * kMade) << model;
    EXPECT_NE(lobe->origin.find(exact ? "reflectance" : "limit angle"), std::string::npos) << lobe->origin;
    EXPECT_NE(lobe->origin.find("lamp"), std::string::npos) << lobe->origin;
    for (const WhatIfKnob& knob : whatIfKnobs(*captured, 5, 1, lobe->roughness))
      if (knob.spec.key == "roughness") {
        EXPECT_EQ(std::get<double>(knob.spec.defaultValue), lobe->roughness);
      }
  }
  // primal knows no light, hence no lobe; and contours that were synthesised would only give back what made them.
  const Outcome<FittedLobe> none = fittedLobe(inspect(captured, request({"primal"})), 5);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::NotSupported);
  InspectionRequest again = request({"reflectance"});
  again.whatIf = made;
  EXPECT_FALSE(fittedLobe(inspect(captured, again), 5));
}

TEST(WhatIf, KnobsSpeakDegrees) {
  WhatIf w;
  for (const WhatIfKnob& knob : whatIfKnobs(*lamp(), 2, 0))
    if (knob.spec.key == "pose.rotate.y") knob.set(w, 3);
  EXPECT_NEAR(w.poses.at(2).rotation.y(), 0.05235987755982988, kExactly);  // 3 pi / 180
}

TEST(WhatIf, TheSummaryCounts) {
  WhatIf w;
  EXPECT_EQ(summaryOf(w), "");
  w.poses[1].rotation = {1, 0, 0};
  w.highlights[{1, 0}].contourScale = 2;
  w.highlights[{2, 0}].contourScale = 2;
  EXPECT_EQ(summaryOf(w), "1 pose, 2 highlights");
  w.lightsSwitched[{2, "lamp"}] = false;
  w.lightsSwitched[{3, "lamp"}] = true;  // counts only where contours are synthesised
  EXPECT_EQ(summaryOf(w), "1 pose, 2 highlights, 1 light switched");
  EXPECT_EQ(frameNote(w, 2), "highlight moved by hand, light lamp switched off");
  EXPECT_EQ(frameNote(w, 3), "");
}

TEST(WhatIf, JsonRoundTrip) {
  WhatIf w;
  w.poses[3] = {{0.1, 1.0 / 3, -1e-17}, {1, 2, 3}};
  w.highlights[{4, 1}] = {{0.5, -0.25}, 1.5, {2, 3}};
  w.synthesise = true;
  w.lobe = Lobe::Ggx;
  w.roughness = 0.07;
  w.lightsSwitched[{2, "a \"quoted lamp"}] = false;
  w.lightsSwitched[{3, "b"}] = true;
  w.lightsBy["a \"quoted\" lamp"] = {1, 2, 3};
  w.surfaces["body"] = 0.4;
  EXPECT_EQ(readWhatIf(JsonNode::parse(toJson(w).dump(), "x")), w);
  EXPECT_TRUE(readWhatIf(JsonNode::parse("{}", "x")).none());
  EXPECT_THROW(
      (void)readWhatIf(JsonNode::parse(R"({"poses": [{"frame": -1, "rotation": [0,0,0], "translation": [0,0,0]}]})", "x")),
      InputError);
  EXPECT_THROW((void)readWhatIf(JsonNode::parse(R"({"synthesise": {"lobe": "mirror", "roughness": 0.1}})", "x")), InputError);
}

}  // namespace
}  // namespace glint
