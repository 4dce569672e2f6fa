// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/lamps_report.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

namespace glint::lamps_report_tests {
using nlohmann::json;

LampAnswer answered() {
  LampAnswer lamp;
  lamp.id = "lamp-001";
  lamp.frames = {"001"};
  lamp.position = Eigen::Vector3d(1, -2, 3);
  lamp.covariance = Eigen::Matrix3d::Identity() * 0.25;
  lamp.direction = {0.6, -0.48, -0.64};
  lamp.directionSigma = 0.01;
  lamp.from = Eigen::Vector3d(0, 0, 2.7);
  lamp.residualPx = 0.3;
  lamp.highlights = 2;
  lamp.degreesOfFreedom = 1.5;
  lamp.outlineShare = 0.125;
  lamp.dropped.push_back({"001", 1, {4, 5}, "contradicts the other balls"});
  return lamp;
}

LampAnswer failed() {
  LampAnswer lamp;
  lamp.id = "lamp-002";
  lamp.frames = {"002"};
  lamp.failure = Failure{Reason::NoHighlight, "nothing, \"at all\""};
  return lamp;
}

LampsReport report() {
  LampsReport r;
  r.input = "shots";
  r.lengthUnit = "m";
  r.lamps = {answered(), failed()};
  r.lines = {{"shot 001.JPG", {0.6, -0.48, -0.64}}, {"b.png", {-1e-12, 0, -1}}};
  return r;
}

// x right, y up, z towards the camera, one blank between the fields and none in a name; no minus before a zero.
TEST(LampsLp, IsByteForByteWhatRelightReads) {
  EXPECT_EQ(lampsLp(report()),
            "2\n"
            "shot_001.JPG 0.600000000 0.480000000 0.640000000\n"
            "b.png 0.000000000 0.000000000 1.000000000\n");
}

TEST(LampsJson, HasTheKeysOfTheContract) {
  const json j = json::parse(lampsJson(report()));
  EXPECT_EQ(j["glint_lights"], 1);
  EXPECT_EQ(j["length_unit"], "m");
  const json& a = j["lights"][0];
  EXPECT_EQ(a["id"], "lamp-001");
  EXPECT_EQ(a["frames"], json::array({"001"}));
  EXPECT_EQ(a["status"], "ok");
  EXPECT_EQ(a["reason"], "");
  EXPECT_EQ(a["position"], json::array({1.0, -2.0, 3.0}));
  EXPECT_EQ(a["covariance"][1][1], 0.25);
  EXPECT_EQ(a["from"], json::array({0.0, 0.0, 2.7}));
  EXPECT_NEAR(a["direction_sigma_deg"], 0.57295779513, 1e-9);
  EXPECT_EQ(a["residual_px"], 0.3);
  EXPECT_EQ(a["highlights"], 2);
  EXPECT_EQ(a["degrees_of_freedom"], 1.5);
  EXPECT_EQ(a["outline_share"], 0.125);
  EXPECT_EQ(a["dropped"][0]["ball"], 2);
}

TEST(LampsJson, WhatIsNotKnownIsNull) {
  LampsReport r = report();
  r.lengthUnit = "";
  r.lamps[0].position.reset();
  r.lamps[0].covariance.reset();
  r.lamps[0].from.reset();
  r.lamps[0].withoutPosition = "one ball";
  const json j = json::parse(lampsJson(r));
  EXPECT_TRUE(j["length_unit"].is_null());
  for (const char* key : {"position", "covariance", "from"}) EXPECT_TRUE(j["lights"][0][key].is_null()) << key;
  EXPECT_EQ(j["lights"][0]["reason"], "one ball");
  EXPECT_EQ(j["lights"][0]["status"], "ok");
  EXPECT_EQ(j["lights"][1]["status"], "failed");
  EXPECT_EQ(j["lights"][1]["reason"], "no highlight: nothing, \"at all\"");
  for (const char* key : {"position", "direction", "direction_sigma_deg", "residual_px"})
    EXPECT_TRUE(j["lights"][1][key].is_null()) << key;
}

TEST(LampsJson, EachBallHasItsResiduals) {
  LampsReport r = report();
  r.balls.emplace();
  FittedBall& b = r.balls->balls.emplace_back();
  b.edgeResidualPx = 0.5;
  b.edgeDegreesOfFreedom = 117;
  b.highlights = 3;
  b.highlightResidualPx = 0.25;
  b.highlightDegreesOfFreedom = 1.75;
  const json ball = json::parse(lampsJson(r))["balls"][0];
  EXPECT_EQ(ball["edge_residual_px"], 0.5);
  EXPECT_EQ(ball["edge_degrees_of_freedom"], 117);
  EXPECT_EQ(ball["highlights"], 3);
  EXPECT_EQ(ball["residual_px"], 0.25);
  EXPECT_EQ(ball["degrees_of_freedom"], 1.75);
}

TEST(LampsCsv, HasOneRowForEachLamp) {
  EXPECT_EQ(lampsCsv(report()).substr(std::string(kLampsCsvHeader).size()),
            "lamp-001,ok,,001,1,-2,3,0.25,0.25,0.25,0,0,0,0.59999999999999998,-0.47999999999999998,-0.64000000000000001,"
            "0.57295779513082323,0,0,2.7000000000000002,0.29999999999999999,2,1,\n"
            "lamp-002,failed,\"no highlight: nothing, \"\"at all\"\"\",002,,,,,,,,,,,,,,,,,,0,0,\n");
}

TEST(LampsCsv, SaysInWhatALampStandsStill) {
  LampsReport r = report();
  r.lamps[0].frame = LightFrame::Camera;
  r.lamps[1].frame = LightFrame::World;
  const std::string csv = lampsCsv(r);
  EXPECT_THAT(csv, testing::HasSubstr(",dropped,frame\n"));
  EXPECT_THAT(csv, testing::HasSubstr(",2,1,camera\n"));
  EXPECT_THAT(csv, testing::HasSubstr(",0,0,world\n"));
}

// Every photograph in the frame of its own camera: a camera that looks along the world's x sees a lamp at +x in front of it.
TEST(LampLines, AreInTheCamerasFrame) {
  Scene scene;
  Frame f;
  f.id = "001";
  f.image = "/shots/001.png";
  f.camera.camFromWorld.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  scene.frames = {f, f, f};
  scene.frames[1].id = "002";
  scene.frames[2].id = "003";
  LampAnswer a = answered(), b = failed();
  a.direction = {1, 0, 0};
  a.frames = {"001", "003"};
  LampAnswer c = answered();
  c.frames = {"003"};
  std::vector<std::string> warnings;
  const std::vector<LampLine> lines = lampLinesOf(scene, {a, b, c}, warnings);
  ASSERT_EQ(lines.size(), 1U);  // the second has no answer, the third shows two
  EXPECT_EQ(lines[0].file, "001.png");
  EXPECT_EQ(lines[0].direction, Eigen::Vector3d(0, 0, 1));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_THAT(warnings[0], testing::HasSubstr("1 photographs that show several lamps"));
}

// A flash is measured in the camera's coordinates: no pose turns it, whichever coordinates the scene is in.
TEST(LampLines, OfALampThatMovesWithTheCameraAreTheSameForEveryCamera) {
  Scene scene;
  Frame f;
  f.id = "001";
  f.image = "/shots/001.png";
  scene.frames = {f, f};
  scene.frames[1].id = "002";
  scene.frames[1].camera.camFromWorld.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  LampAnswer flash = answered();
  flash.frame = LightFrame::Camera;
  flash.direction = {0.6, 0, -0.8};
  flash.frames = {"001", "002"};
  std::vector<std::string> warnings;
  const std::vector<LampLine> lines = lampLinesOf(scene, {flash}, warnings);
  ASSERT_EQ(lines.size(), 2U);
  for (const LampLine& line : lines) EXPECT_EQ(line.direction, flash.direction);
  EXPECT_TRUE(warnings.empty());
}

}  // namespace glint::lamps_report_tests
