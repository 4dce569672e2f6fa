// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/app/session.h"
#include "core/pipeline/inspection.h"
#include "core/scene/decoded_images.h"
#include "tests/core/pipeline/painted_scene.h"
#include "tests/core/pipeline/questions.h"
#include "tests/core/scene/scene_fixture.h"

/// Whole inspections of photographs with painted spots: none of them trains.
namespace glint::painted_inspection_tests {
namespace {

using namespace testing_support;

Painted painted() {
  Painted p;
  p.surface = sphere(0.5);
  p.cameras = arc(12, 120);
  p.lamp.id = "lamp";
  p.lamp.lamp = lampAt(Eigen::Vector3d(0.3, 0.4, 2.0));
  for (const auto& [x, y] : {std::pair(-0.15, 0.1), std::pair(0.2, 0.12)})
    p.paint.push_back({{x, y, std::sqrt(0.25 - x * x - y * y) - 0.5}, 0.03, 1.0});
  return p;
}

std::shared_ptr<Scene> photographed(const Painted& p, const TemporaryFolder& folder, const std::vector<std::string>& lightsOn) {
  auto scene = std::make_shared<Scene>();
  scene->surfaces["body"] = p.surface;
  for (std::size_t f = 0; f < p.cameras.size(); ++f) {
    Frame frame;
    frame.id = std::to_string(f);
    frame.camera = p.cameras[f];
    frame.surface = "body";
    frame.lightsOn = lightsOn;
    frame.radiance = folder / (frame.id + ".tiff");
    Image image = picture(p, f);
    cv::imwrite(frame.radiance.string(), cv::Mat(image.height, image.width, CV_32F, image.data.data()),
                {cv::IMWRITE_TIFF_COMPRESSION, 1});
    scene->frames.push_back(std::move(frame));
  }
  return scene;
}

InspectionRequest request(const std::string& train, const std::string& motion = "reject") {
  InspectionRequest q;
  q.models = {"limit-angle"};
  q.train = train;
  for (const auto& [key, value] : {std::pair("detect.motion", motion.c_str()), std::pair("detect.background", "smooth"),
                                   std::pair("fit.evidence", "contours"), std::pair("light.limit_orders", "0")})
    q.settings.setFromText(key, value);
  q.settings.set("fit.most_residual", 10.0);
  return q;
}

double lampOffBy(const Inspection& r) {
  const LightEstimate* light = r.lightOf({"lamp", std::nullopt});
  return light ? (light->light.position() - Eigen::Vector3d(0.3, 0.4, 2.0)).norm() : std::numeric_limits<double>::infinity();
}

std::size_t textures(const Inspection& r) {
  std::size_t n = 0;
  for (const FrameEvidence& e : r.evidence) n += e.textures.size();
  return n;
}

/// The same evidence and the same light.
void expectSame(const Inspection& a, const Inspection& b) {
  ASSERT_EQ(a.evidence.size(), b.evidence.size());
  for (std::size_t f = 0; f < a.evidence.size(); ++f) {
    ASSERT_EQ(a.evidence[f].highlights.size(), b.evidence[f].highlights.size()) << f;
    for (std::size_t i = 0; i < a.evidence[f].highlights.size(); ++i)
      EXPECT_EQ(a.evidence[f].highlights[i].peak, b.evidence[f].highlights[i].peak) << f;
    EXPECT_EQ(a.evidence[f].textures.size(), b.evidence[f].textures.size()) << f;
    EXPECT_EQ(a.evidence[f].rejected.size(), b.evidence[f].rejected.size()) << f;
  }
  EXPECT_EQ(lampOffBy(a), lampOffBy(b));
}

TEST(PaintedInspection, TextureTrainsNoModelAndTheFitSaysSo) {
  const TemporaryFolder folder;
  const auto scene = photographed(painted(), folder, {"lamp"});
  for (const char* train : {"spread:6", "first:6"}) {
    const Inspection off = inspect(scene, request(train, "off")), all = inspect(scene, request(train));
    EXPECT_GT(off.views.size(), 6u) << train;
    EXPECT_EQ(all.views.size(), 6u) << train;
    EXPECT_LT(lampOffBy(all), 0.2) << train;  // contours of a level of radiance follow no limit angle
    EXPECT_GT(lampOffBy(off), 2 * lampOffBy(all)) << train;
    EXPECT_GE(textures(all), 16u);
    const ModelResult::Fit& fit = all.models.at("limit-angle").fits.at(0);
    ASSERT_TRUE(fit.fit);
    EXPECT_TRUE(std::any_of(fit.fit->remarks.begin(), fit.fit->remarks.end(),
                            [](const std::string& r) { return r.find("are no evidence (texture") != std::string::npos; }));
    EXPECT_EQ(textures(inspect(scene, request(train, "flag"))), 0u);
  }
}

TEST(PaintedInspection, OneFrameFirstAndTheRestLaterIsTheSame) {
  const TemporaryFolder folder;
  const auto scene = photographed(painted(), folder, {"lamp"});
  for (const char* train : {"spread:6", "0-3"}) {
    const Inspection all = inspect(scene, request(train)), one = inspectOneFrame(scene, request(train), 5);
    EXPECT_EQ(one.evidence[5].highlights.size(), all.evidence[5].highlights.size());
    EXPECT_EQ(lampOffBy(one), lampOffBy(all));
    expectSame(inspect(scene, request(train), {}, &one), all);
    // Other training frames, and another surface.
    expectSame(inspect(scene, request("6-11"), {}, &one), inspect(scene, request("6-11")));
    InspectionRequest moved = request(train);
    moved.whatIf.poses[2].translation = {0.05, 0, 0};
    expectSame(inspect(scene, moved, {}, &all), inspect(scene, moved));
    InspectionRequest off = request(train, "off");
    expectSame(inspect(scene, off, {}, &all), inspect(scene, off));
  }
}

/// Models that take no pixels come before the lobe is fitted to them, and change nothing of what comes later.
TEST(FirstLook, ShowsModelsWithoutPixelsAndLeavesTheRest) {
  const TemporaryFolder folder;
  const auto scene = photographed(painted(), folder, {"lamp"});
  InspectionRequest q = request("spread:6");
  q.models = {"limit-angle", "reflectance"};
  q.settings.set("fit.evidence", std::string("auto"));
  const std::optional<Inspection> look = firstLook(scene, q, 5);
  ASSERT_TRUE(look);
  EXPECT_EQ(look->work.pixelFits, 0);
  ASSERT_EQ(look->models.size(), 1u);
  const Inspection all = inspect(scene, q), one = inspectOneFrame(scene, q, 5, {}, &*look), rest = inspect(scene, q, {}, &one);
  ASSERT_EQ(all.work.pixelFits, 1);
  EXPECT_EQ(digestOf(rest), digestOf(all));
  EXPECT_EQ(one.work.framesDetected + one.work.trainingViews + one.work.lights, 0);
  EXPECT_EQ(one.work.pixelFits, 1);
  EXPECT_EQ(one.work.fits, 1);  // of the model that was left
  EXPECT_EQ(look->models.at("limit-angle").frames.at(0).iou, all.models.at("limit-angle").frames.at(5).iou);
  // Not worth a step of its own.
  EXPECT_FALSE(firstLook(scene, q, 5, {}, &one));
  const auto with = [&](std::vector<std::string> models, const char* key = "fit.evidence", const char* value = "auto") {
    InspectionRequest other = q;
    other.models = std::move(models);
    other.settings.setFromText(key, value);
    return firstLook(scene, other, 5).has_value();
  };
  EXPECT_TRUE(with({"limit-angle"}));
  InspectionRequest quick = q;
  quick.models = {"limit-angle"};
  EXPECT_FALSE(firstLook(scene, quick, 5, {}, &all));  // the lobe is there
  quick.settings.setFromText("detect.min_contrast", "5");
  EXPECT_TRUE(firstLook(scene, quick, 5, {}, &all));  // it is one of other contours
  EXPECT_FALSE(with({"reflectance"}));
  EXPECT_FALSE(with(q.models, "fit.evidence", "contours"));
  EXPECT_TRUE(with(q.models));
}

/// Contours of the smooth background first, those of the lobe afterwards.
TEST(FirstLook, LeavesContoursToBeFoundAgainWithTheLobe) {
  const TemporaryFolder folder;
  const auto scene = photographed(painted(), folder, {"lamp"});
  InspectionRequest q = request("spread:6"), smooth = q;
  q.settings.setFromText("detect.background", "lobe");
  const Inspection all = inspect(scene, q);
  const std::optional<Inspection> look = firstLook(scene, q, 5);
  ASSERT_TRUE(look);
  expectSame(*look, inspectOneFrame(scene, smooth, 5));
  const Inspection one = inspectOneFrame(scene, q, 5, {}, &*look);
  EXPECT_EQ(one.work.framesDetected, 0);
  EXPECT_GT(one.work.framesContouredAgain, 0);
  EXPECT_EQ(digestOf(inspect(scene, q, {}, &one)), digestOf(all));
  EXPECT_EQ(digestOf(inspect(scene, q, {}, &*look)), digestOf(all));
  EXPECT_FALSE(firstLook(scene, q, 5, {}, &one));
}

/// A person who stops does not wait for the lobe's fit.
TEST(FirstLook, StopEndsTheFitOfTheLobe) {
  const TemporaryFolder folder;
  const auto scene = photographed(painted(), folder, {"lamp"});
  InspectionRequest q = request("spread:6");
  q.models = {"reflectance"};
  q.settings.set("fit.evidence", std::string("auto"));
  int asked = 0, askedAfter = 0;
  bool stopped = false;
  const ProgressFn progress = [&](const StageEvent& e) {
    askedAfter += stopped;
    asked += e.stage == "lobe";
    stopped = stopped || asked > 3;
    return !stopped;
  };
  EXPECT_THROW(inspect(scene, q, progress), Stopped);
  EXPECT_EQ(asked, 4);
  EXPECT_EQ(askedAfter, 0);
}

TEST(PaintedInspection, LightsThatNobodyNamesAreToldApartWithoutTexture) {
  const TemporaryFolder folder;
  const Inspection all = inspect(photographed(painted(), folder, {}), request("spread:6"));
  EXPECT_GE(textures(all), 16u);
  for (const FrameEvidence& e : all.evidence) EXPECT_EQ(e.highlights.size(), 1u) << e.frame;
}

/// Six of twelve frames train. The others are looked at again where their contours are found a second time.
TEST(PaintedInspection, APhotographThatTrainsIsDecodedOnce) {
  const TemporaryFolder folder;
  const auto scene = photographed(painted(), folder, {"lamp"});
  const auto decoded = [&](const char* background, const char* evidence, const char* level = "0.5") {
    InspectionRequest q = request("spread:6");
    q.models = {"limit-angle", "reflectance"};
    for (const auto& [key, value] :
         {std::pair("detect.background", background), std::pair("fit.evidence", evidence), std::pair("detect.level", level)})
      q.settings.setFromText(key, value);
    const int before = timesDecoded();
    (void)inspect(scene, q);
    return timesDecoded() - before;
  };
  EXPECT_EQ(decoded("smooth", "contours"), 12);
  EXPECT_EQ(decoded("smooth", "auto"), 12);
  EXPECT_EQ(decoded("smooth", "levels"), 12);
  EXPECT_EQ(decoded("smooth", "pixels", "0.4"), 12) << "the lobe's contours are at half the peak";
  EXPECT_EQ(decoded("lobe", "auto"), 12 + 6);
}

TEST(PaintedInspection, WhatAHandHasLabelledStays) {
  const TemporaryFolder folder;
  const Painted p = painted();
  const auto scene = photographed(p, folder, {"lamp"});
  const Inspection before = inspect(scene, request("spread:6"));
  ASSERT_FALSE(before.evidence[4].textures.empty());
  Highlight label = before.evidence[4].textures.front().highlight;
  label.fromScene = true;
  label.light = "lamp";
  scene->frames[4].highlights = {label};
  const Inspection after = inspect(scene, request("spread:6"));
  ASSERT_EQ(after.evidence[4].highlights.size(), 1u);
  EXPECT_EQ(after.evidence[4].highlights[0].peak, label.peak);
  EXPECT_GE(textures(after), textures(before) - 3);
}

}  // namespace
}  // namespace glint::painted_inspection_tests
