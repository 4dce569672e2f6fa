// SPDX-License-Identifier: BSD-3-Clause
// Sessions as programs of every version wrote them (fixtures/version-N.glint, of sessions/plane): they open and mean what they
// meant. Newer and damaged ones are refused with file, place and reason.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "core/app/session.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

const fs::path kScene = fs::path(GLINT_SOURCE_DIR) / "sessions/plane/scene.json";
fs::path fixture(int version) {
  return fs::path(GLINT_SOURCE_DIR) / ("tests/core/app/fixtures/version-" + std::to_string(version) + ".glint");
}

/// Largest relative difference between stored and recomputed numbers of the light and the fits.
double largestChange(const OpenedSession& opened) {
  const KeyResults now = keyResultsOf(inspect(opened.scene, opened.session.request));
  double largest = 0;
  for (const auto& [name, value] : opened.session.keyResults) {
    if (name.find("light.") != 0 && name.find(".fit.") == std::string::npos) continue;
    const auto it = std::find_if(now.begin(), now.end(), [&name = name](const auto& r) { return r.first == name; });
    EXPECT_NE(it, now.end()) << name;
    if (it != now.end()) largest = std::max(largest, std::abs(it->second - value) / std::abs(value));
  }
  return largest;
}

void expectPlane(const Session& s) {
  EXPECT_THAT(s.warnings, ElementsAre());
  EXPECT_THAT(s.request.models, ElementsAre("primal", "dual", "canonical", "limit-angle"));
  EXPECT_EQ(s.request.train, "0-3");
  EXPECT_EQ(s.request.source, FrameSource::Image);
  EXPECT_EQ(s.request.settings.number("detect.level"), 0.5);
  EXPECT_EQ(s.request.settings.text("fit.solver"), "refined");
  // Its program had one background and one kind of evidence; today's defaults look at pixels.
  EXPECT_EQ(s.request.settings.text("detect.background"), "smooth");
  EXPECT_EQ(s.request.settings.text("detect.motion"), "off");
  EXPECT_EQ(s.request.settings.text("detect.texture"), "off");
  EXPECT_EQ(s.request.settings.text("fit.evidence"), "contours");
  EXPECT_EQ(s.request.settings.number("fit.most_residual"), 10);  // no fit was refused
  EXPECT_THAT(s.training, ElementsAre("0000", "0001", "0002", "0003"));
  EXPECT_THAT(s.heldOut, ElementsAre("0004", "0005"));
  EXPECT_EQ(s.keyResults.size(), 116u);
  EXPECT_EQ(s.digest.size(), 64u);
  ASSERT_EQ(s.files.size(), 7u);
  EXPECT_EQ(s.files[0].path, fixture(1).parent_path() / "scene.json");
}

TEST(Migration, OfVersion1) {
  const Session s = readSession(fixture(1));
  expectPlane(s);
  // Its program knew one limit angle for each light; today's default chooses.
  EXPECT_EQ(s.request.settings.integer("light.limit_orders"), 0);
  EXPECT_TRUE(s.request.whatIf.none());
  EXPECT_FALSE(s.tradeoff);
  EXPECT_TRUE(s.view.options.empty());
  EXPECT_EQ(s.view.layers, (std::map<std::string, bool>{{"rays", true}, {"frame/peak", false}}));
  ASSERT_EQ(s.view.cameras.count("scene"), 1u);
  EXPECT_EQ(s.view.cameras.at("scene").position, Eigen::Vector3d(1.5, -2, 3));
  EXPECT_FALSE(s.view.cameras.at("scene").parallel);
  EXPECT_EQ(s.view.frame + s.view.model + s.view.light, "0004canonicalA");
  EXPECT_EQ(s.view.highlight, 0);
  EXPECT_EQ(s.notes, "of version 1");

  const OpenedSession opened = openSession(fixture(1), {kScene});
  EXPECT_EQ(opened.warning, "");  // the hash of the scene is that of the shipped one
  // Solvers were improved since: 7e-4. With today's default the limit angle would differ by 1.1e-2.
  EXPECT_LT(largestChange(opened), 1e-3);
}

TEST(Migration, OfVersion2) {
  const Session s = readSession(fixture(2));
  expectPlane(s);
  EXPECT_EQ(s.request.settings.integer("light.limit_orders"), -1);
  ASSERT_TRUE(s.tradeoff);
  EXPECT_EQ(s.tradeoff->points.size(), 2u);
  EXPECT_EQ(s.tradeoff->chosen, 1);
  // The prior of an extent was changed since: 3.0e-2 of the limit angle, with which an extent trades. It still has one.
  const OpenedSession opened = openSession(fixture(2), {kScene});
  EXPECT_LT(largestChange(opened), 4e-2);
  EXPECT_TRUE(inspect(opened.scene, opened.session.request).lights.begin()->second->extent);
}

TEST(Migration, OfASessionWithEverythingThatVersion2Grew) {
  const Session s = readSession(fixture(2).parent_path() / "version-2-what-if.glint");
  EXPECT_EQ(s.view.options, (std::map<std::string, std::string>{{"frame/gamma", "1.8"}, {"scene/solo", "1"}}));
  EXPECT_TRUE(s.view.cameras.at("Top").parallel);
  EXPECT_TRUE(s.request.whatIf.synthesise);
  EXPECT_EQ(s.request.whatIf.poses.at(2).translation, Eigen::Vector3d(0.01, 0, 0));
  EXPECT_EQ(s.request.whatIf.highlights.at({0, 0}).contourScale, 1.2);
  EXPECT_EQ(s.request.whatIf.lightsBy.at("A"), Eigen::Vector3d(0, 0.1, 0));
  EXPECT_EQ(s.request.whatIf.surfaces.at("g00"), 0.5);
  EXPECT_EQ(s.request.whatIf.roughness, 0.2);
}

TEST(Migration, OfASessionWithEverythingThatVersion3Grew) {
  const Session s = readSession(fixture(3));
  EXPECT_THAT(s.warnings, ElementsAre());
  ASSERT_EQ(s.folders.size(), 1u);
  EXPECT_EQ(s.folders[0].folder.lexically_normal(), (fixture(3).parent_path() / "../elsewhere/photos").lexically_normal());
  EXPECT_EQ(s.view.cameras.at("scene").position, Eigen::Vector3d(1.5, -2, 3));
  ASSERT_EQ(s.view.moreCameras.size(), 2u);
  EXPECT_EQ(s.view.moreCameras[1].position, Eigen::Vector3d(4, 0, 1));
  EXPECT_EQ(s.view.options.at("scene/hidden"), "camera 0001\n");
  EXPECT_TRUE(isSwitchedOff(s.request.whatIf, 5, "A"));
  EXPECT_EQ(s.notes, "of version 3");
}

/// The fit took the prediction's directions and walk tolerance before it had its own; the points of a trade-off were measured so,
/// too.
TEST(Migration, TheFitKeepsTheDirectionsOfThePrediction) {
  std::string text = contentOf(fixture(2));
  const auto replace = [&](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("\"predict.directions\": 36", "\"predict.directions\": 24");
  replace("\"predict.walk_tolerance\": 1e-10", "\"predict.walk_tolerance\": 1e-6");
  replace("\"set\": {}", "\"set\": {\"predict.directions\": 12}");
  const Session old = parseSession(text, fixture(2));
  EXPECT_EQ(old.request.settings.integer("fit.directions"), 24);
  EXPECT_EQ(old.request.settings.number("fit.walk_tolerance"), 1e-6);
  EXPECT_EQ(old.tradeoff->points[0].settings.integer("fit.directions"), 12);
  EXPECT_EQ(old.tradeoff->points[1].settings.integer("fit.directions"), 36);

  replace("\"predict.directions\": 24", "\"fit.directions\": 48,\n      \"predict.directions\": 24");
  const Session now = parseSession(text, fixture(2));
  EXPECT_EQ(now.request.settings.integer("fit.directions"), 48);
  EXPECT_EQ(now.request.settings.integer("predict.directions"), 24);
  EXPECT_EQ(now.tradeoff->points[0].settings.integer("fit.directions"), 36);
}

TEST(Migration, WrittenAgainItIsOfThisVersionAndMeansTheSame) {
  const TemporaryFolder folder;
  for (const char* name : {"version-1.glint", "version-2.glint", "version-2-what-if.glint", "version-3.glint"}) {
    const Session s = readSession(fixture(1).parent_path() / name);
    writeSession(s, folder / "again.glint");
    EXPECT_THAT(contentOf(folder / "again.glint"), HasSubstr("\"glint_session\": 3"));
    const Session again = readSession(folder / "again.glint");
    EXPECT_EQ(again.request, s.request) << name;
    EXPECT_EQ(again.view.layers, s.view.layers);
    EXPECT_EQ(again.view.options, s.view.options);
    EXPECT_EQ(again.view.cameras.size(), s.view.cameras.size());
    EXPECT_EQ(again.view.frame, s.view.frame);
    EXPECT_EQ(again.notes, s.notes);
    EXPECT_EQ(again.keyResults, s.keyResults);
    EXPECT_EQ(again.digest, s.digest);
    EXPECT_EQ(again.files.size(), s.files.size());
    EXPECT_EQ(again.tradeoff.has_value(), s.tradeoff.has_value());
  }
}

/// Written by hand from docs/formats.md: what version 4 adds.
TEST(Migration, Version4SaysHowACaptureIsRead) {
  const InputChoices c = readSession(fixture(4)).choices;
  EXPECT_EQ(c.as, "colmap");
  EXPECT_EQ(c.surface, InputChoices::Surface::File);
  EXPECT_EQ(c.surfaceFile, (fixture(4).parent_path() / "meshes/object.ply").lexically_normal());
  EXPECT_EQ(c.camera, (std::vector<double>{525, 526, 319.5, 239.5, 0.1, -0.2, 0.001, 0.002}));
  EXPECT_EQ(c.object, "5");
  EXPECT_EQ(c.metresPerUnit, 0.01);
  EXPECT_EQ(c.surfaceMetresPerUnit, 0.001);
  EXPECT_EQ(c.depthScale, 0.0002);
  EXPECT_EQ(c.world, "original");
  // Without it, a session is read as it always was.
  EXPECT_TRUE(readSession(fixture(3)).choices.none());
}

TEST(Migration, ANewerOneIsRefusedAsNewerWhateverElseIsInIt) {
  const TemporaryFolder folder;
  for (const char* rest : {"", ", \"input\": 7, \"request\": {\"brand\": \"new\"}"}) {
    const fs::path file = folder.write("x.glint", std::string("{\"glint_session\": 5") + rest + "}");
    const std::string message = inputErrorOf([&] { readSession(file); });
    EXPECT_THAT(message, HasSubstr(file.string() + ": glint_session: "));
    EXPECT_THAT(message, HasSubstr("version 5 is newer than this program supports (4)"));
  }
}

TEST(Migration, DamagedOnesAreRefusedWithTheirName) {
  const TemporaryFolder folder;
  for (const int version : {1, 2, 3}) {
    const std::string whole = contentOf(fixture(version));
    for (int part = 0; part < 40; ++part) {  // cut anywhere: a disk that was full
      const fs::path file = folder.write("cut.glint", whole.substr(0, whole.size() * std::size_t(part) / 40));
      EXPECT_THAT(inputErrorOf([&] { readSession(file); }), HasSubstr(file.string())) << part;
    }
    std::string zeros = whole;
    std::fill(zeros.begin() + 500, zeros.begin() + 1000, '\0');  // a block that was never written
    EXPECT_THAT(inputErrorOf([&] { readSession(folder.write("zeros.glint", zeros)); }), HasSubstr("zeros.glint"));
    for (const char* key : {"glint_session", "input", "request", "training", "key_results"}) {
      const std::string quoted = std::string("\"") + key + "\":";
      std::string without = whole;
      without.replace(without.find(quoted), quoted.size(), "\"lost\":");
      EXPECT_THAT(inputErrorOf([&] { readSession(folder.write("lost.glint", without)); }), HasSubstr(key));
    }
  }
  EXPECT_THAT(inputErrorOf([&] { readSession(folder.write("list.glint", "[1, 2]")); }), HasSubstr("list.glint"));
}

}  // namespace
}  // namespace glint
