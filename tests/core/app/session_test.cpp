// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/session.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "core/base/sha256.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/shared_data.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

// FIPS 180-4's own examples.
TEST(Sha256, StandardExamples) {
  Sha256 abc;
  abc.add("a");
  abc.add("bc");  // in pieces, as files are read
  EXPECT_EQ(abc.hex(), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256().hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

Session example(const TemporaryFolder& folder) {
  Session s;
  s.input = folder.write("data/scene.json", minimalScene());
  s.files = hashInputs(readScene(s.input), {});
  s.request.models = {"canonical", "limit-angle"};
  s.request.train = "0,2-3";
  s.request.excluded = {4, 7};
  s.request.source = FrameSource::Image;
  s.request.settings.setFromText("predict.directions", "72");
  s.request.settings.setFromText("surface.normals", "curved");
  s.request.settings.setFromText("detect.level", "0.1");
  s.request.noisePx = 0.25;
  s.request.seed = 4000000000u;
  s.request.truthFolder = (folder / "truth").string();
  s.training = {"a"};
  s.heldOut = {"b", "c"};
  s.view.layout = "wide";
  s.view.layers = {{"surface", false}, {"light", true}};
  s.view.options = {{"frame/gamma", "1.8"}, {"scene/colour-by", "error"}};
  s.view.cameras["scene"] = {{1, 2, 3}, {0.1, 0.2, 0.3}, {0, 0, 1}, 35};
  s.view.moreCameras = {{{4, 5, 6}, {0, 0, 1}, {0, 1, 0}, 20, true}, {{7, 8, 9}, {0, 0, 0}, {1, 0, 0}, 40}};
  s.view.frame = "b";
  s.view.model = "canonical";
  s.view.highlight = 1;
  s.notes = "two lines\n\"quoted\"";
  s.keyResults = {{"z.first", 0.1}, {"a.second", 1e-300}, {"undefined", std::numeric_limits<double>::quiet_NaN()}};
  s.digest = std::string(64, 'a');
  return s;
}

TEST(Session, RoundTripKeepsEverything) {
  const TemporaryFolder folder;
  const Session s = example(folder);
  fs::create_directory(folder / "sessions");
  writeSession(s, folder / "sessions/x.glint");
  const Session r = readSession(folder / "sessions/x.glint");
  EXPECT_EQ(r.input, s.input);
  ASSERT_EQ(r.files.size(), 1u);
  EXPECT_EQ(r.files[0].path, s.files[0].path);
  EXPECT_EQ(r.files[0].sha256, s.files[0].sha256);
  EXPECT_EQ(r.request.models, s.request.models);
  EXPECT_EQ(r.request.train, s.request.train);
  EXPECT_EQ(r.request.excluded, s.request.excluded);
  EXPECT_EQ(r.request.source, FrameSource::Image);
  EXPECT_EQ(r.request.settings, s.request.settings);
  EXPECT_EQ(r.request.noisePx, 0.25);
  EXPECT_EQ(r.request.seed, 4000000000u);
  EXPECT_EQ(r.request.truthFolder, s.request.truthFolder);
  EXPECT_EQ(r.training, s.training);
  EXPECT_EQ(r.heldOut, s.heldOut);
  EXPECT_EQ(r.view.layout, "wide");
  EXPECT_EQ(r.view.layers, s.view.layers);
  EXPECT_EQ(r.view.options, s.view.options);
  EXPECT_EQ(r.view.cameras.at("scene").focalPoint, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(r.view.cameras.at("scene").viewAngleDeg, 35);
  ASSERT_EQ(r.view.moreCameras.size(), 2u);
  EXPECT_EQ(r.view.moreCameras[0].position, Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(r.view.moreCameras[0].parallel);
  EXPECT_EQ(r.view.moreCameras[1].up, Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(r.view.frame, "b");
  EXPECT_EQ(r.view.highlight, 1);
  EXPECT_EQ(r.notes, s.notes);
  ASSERT_EQ(r.keyResults.size(), 3u);
  EXPECT_EQ(r.keyResults[0], s.keyResults[0]);  // in order, to the last bit
  EXPECT_EQ(r.keyResults[1], s.keyResults[1]);
  EXPECT_TRUE(std::isnan(r.keyResults[2].second));
  EXPECT_EQ(r.digest, s.digest);
  const std::string text = contentOf(folder / "sessions/x.glint");
  EXPECT_THAT(text, testing::Not(HasSubstr(folder.path().string())));  // relative paths only
  EXPECT_THAT(text, HasSubstr("\"path\": \"../data/scene.json\""));
  EXPECT_EQ(text.find("NaN"), std::string::npos);
}

TEST(Session, SurvivesBeingMovedWithItsData) {
  const TemporaryFolder folder;
  writeSession(example(folder), folder / "x.glint");
  const TemporaryFolder other;
  fs::copy(folder.path(), other.path(), fs::copy_options::recursive);
  const OpenedSession opened = openSession(other / "x.glint");
  EXPECT_EQ(opened.session.input, other / "data/scene.json");
  EXPECT_EQ(opened.scene->frames.size(), 1u);
  EXPECT_THAT(changedFiles(opened.session), ElementsAre());
}

TEST(Session, IsAnInputLikeAScene) {
  const TemporaryFolder folder;
  writeSession(example(folder), folder / "x.glint");
  EXPECT_EQ(readScene(folder / "x.glint").frames.size(), 1u);
}

TEST(Session, ChangedAndMissingInputsAreNamed) {
  const TemporaryFolder folder;
  const Session s = example(folder);
  folder.write("data/scene.json", minimalScene() + " ");
  EXPECT_THAT(changedFiles(s), ElementsAre(s.input.string() + ": changed"));
  fs::remove(s.input);
  EXPECT_THAT(changedFiles(s), ElementsAre(s.input.string() + ": missing"));
  Session noted = s;
  noted.files[0].sha256.clear();  // it was missing when the session was saved
  EXPECT_THAT(changedFiles(noted), ElementsAre());
  writeSession(s, folder / "x.glint");
  EXPECT_THAT(inputErrorOf([&] { replay(readSession(folder / "x.glint")); }),
              HasSubstr("x.glint: input: " + s.input.string() + ": missing"));
}

TEST(Session, HashesEveryFileOfTheScene) {
  GLINT_NEEDS_SHARED_DATA();
  const Scene scene = readScene(fs::path(GLINT_SHARED_DIR) / "data/cycles/sphere");
  const auto files = hashInputs(scene, {});
  EXPECT_EQ(files.size(), 1u + 1u + 3u * 24u);  // scene, mesh, and image, radiance, depth of 24 frames
  for (const SessionFile& f : files) EXPECT_EQ(f.sha256.size(), 64u) << f.path;
}

TEST(Session, UnknownKeysAreWarnedOfAndKept) {
  const TemporaryFolder folder;
  writeSession(example(folder), folder / "x.glint");
  folder.write("x.glint", with(contentOf(folder / "x.glint"), "\"notes\"", "\"future\": [1, null], \"notes\""));
  const Session s = readSession(folder / "x.glint");
  EXPECT_THAT(s.warnings, ElementsAre("future: unknown key, kept"));
  writeSession(s, folder / "y.glint");
  EXPECT_THAT(contentOf(folder / "y.glint"), HasSubstr("\"future\""));
}

// docs/commands.md, "replay": 1e-9 relative, to at least 1 px or 1 % for errors of contours and 0.001 for the rest.
TEST(Session, DifferencesOfKeyResultsAreRelativeToALeastSize) {
  for (const char* distance : {"dual.contour_error_px.mean", "dual.contour_error_pct.max", "dual.peak_offset_px.median"}) {
    EXPECT_NEAR(keyResultDifference(distance, 0.005, 0.005 + 1e-9), 1e-9 / 1.005, 1e-16) << distance;
    EXPECT_NEAR(keyResultDifference(distance, 999, 999 * (1 + 1e-9)), 0.999e-9, 1e-15) << distance;
  }
  EXPECT_NEAR(keyResultDifference("dual.iou.mean", 0.009, 0.009 + 1e-9), 1e-7, 1e-12);
  EXPECT_NEAR(keyResultDifference("light.lamp.x", 0, 1e-12), 1e-9, 1e-15);
  EXPECT_EQ(keyResultDifference("dual.iou.mean", NAN, NAN), 0);
  EXPECT_TRUE(std::isinf(keyResultDifference("dual.iou.mean", NAN, 1)));
}

/// A path-traced sphere with its analytic surface and the cheapest model: the whole way from images to numbers and back.
TEST(Session, ReplayAgreesAndSaysWhereItDoesNot) {
  GLINT_NEEDS_SHARED_DATA();
  const auto scene =
      std::make_shared<const Scene>(readScene(fs::path(GLINT_SHARED_DIR) / "data/cycles/sphere/scene-analytic.json"));
  InspectionRequest request;
  request.models = {"primal", "dual"};
  request.settings.set("fit.most_residual", 0.3);  // neither is made for a sphere
  const Inspection inspection = inspect(scene, request);
  const TemporaryFolder folder;
  writeSession(sessionOf(inspection), folder / "x.glint");
  Session session = readSession(folder / "x.glint");
  EXPECT_EQ(session.training.size(), 6u);
  EXPECT_EQ(session.heldOut.size(), 18u);
  const Replay same = replay(session);
  EXPECT_THAT(same.differences, ElementsAre());
  EXPECT_TRUE(same.digestAgrees);
  EXPECT_GT(same.compared, 20);
  EXPECT_EQ(same.compared, static_cast<int>(session.keyResults.size()));

  const auto error = std::find_if(session.keyResults.begin(), session.keyResults.end(),
                                  [](const auto& r) { return r.first == "dual.contour_error_pct.mean"; });
  ASSERT_NE(error, session.keyResults.end());
  error->second *= 1 + 1e-8;
  session.keyResults.emplace_back("gone", 1.0);
  const Replay changed = replay(session);
  ASSERT_EQ(changed.differences.size(), 2u);
  EXPECT_THAT(changed.differences[0], HasSubstr("dual.contour_error_pct.mean: was "));
  EXPECT_THAT(changed.differences[1], HasSubstr("gone: was 1, is no longer computed"));
  EXPECT_EQ(changed.firstChanged, "prediction");
  EXPECT_EQ(same.firstChanged, "");

  // Another level changes what is detected, and with it all the rest: the first stage is named. A session of an older program
  // does not hold its detection, so that the same change shows first in the light.
  Session level = readSession(folder / "x.glint");
  level.request.settings.setFromText("detect.level", "0.4");
  EXPECT_EQ(replay(level).firstChanged, "detection");
  std::erase_if(level.keyResults, [](const auto& r) { return r.first.rfind("detect.", 0) == 0; });
  EXPECT_THAT(replay(level).firstChanged, HasSubstr("the session is older"));
  // The solver of the ellipsoids leaves what was detected and the light as they were.
  Session solver = readSession(folder / "x.glint");
  solver.request.settings.setFromText("fit.solver", "linear");
  EXPECT_EQ(replay(solver).firstChanged, "fit");

  // Another setting: the digest tells, whatever the summaries say.
  Session other = session;
  other.request.settings.setFromText("detect.level", "0.49");
  EXPECT_FALSE(replay(other).digestAgrees);
}

struct BadSession {
  const char *from, *to, *place, *reason;
};
class BadSessions : public testing::TestWithParam<BadSession> {};

TEST_P(BadSessions, AreOneLineWithFilePlaceAndReason) {
  const TemporaryFolder folder;
  writeSession(example(folder), folder / "x.glint");
  const fs::path file = folder.write("x.glint", with(contentOf(folder / "x.glint"), GetParam().from, GetParam().to));
  const std::string message = inputErrorOf([&] { readSession(file); });
  EXPECT_THAT(message, HasSubstr(file.string() + ": " + GetParam().place));
  EXPECT_THAT(message, HasSubstr(GetParam().reason));
}

INSTANTIATE_TEST_SUITE_P(
    Session, BadSessions,
    testing::Values(
        BadSession{"\"glint_session\": 3", "\"glint_session\": 5", "glint_session: ", "newer"},
        BadSession{"\"glint_session\": 3", "\"glint_session\": 0", "glint_session: ", "does not exist"},
        BadSession{"\"train\"", "\"trian\"", "request.train: ", "missing"},
        BadSession{"\"source\": \"image\"", "\"source\": \"video\"", "request.source: ", "'video'"},
        BadSession{"\"predict.directions\": 72", "\"predict.directions\": 72.5",
                   "request.settings.predict.directions: ", "whole number"},
        BadSession{"\"predict.directions\": 72", "\"predict.directions\": 1",
                   "request.settings.predict.directions: ", "outside 6 .. 720"},
        BadSession{"\"predict.directions\"", "\"predict.turns\"", "request.settings.predict.turns: ", "unknown setting"},
        BadSession{"\"seed\": 4000000000", "\"seed\": -1", "request.seed: ", "whole number"},
        BadSession{"\"digest\": \"aaaa", "\"digest\": \"xaaa", "results.digest: ", "hexadecimal"},
        BadSession{"\"view_angle_deg\": 35", "\"view_angle_deg\": 0", "view.cameras.scene.view_angle_deg: ", "between 0 and 180"},
        BadSession{"\"frame/gamma\": \"1.8\"", "\"frame/gamma\": 1.8", "view.options.frame/gamma: ", "text"},
        BadSession{"\"surface\": false", "\"surface\": 0", "view.layers.surface: ", "true or false"}),
    [](const auto& info) {
      std::string name = std::to_string(info.index) + "_" + info.param.place;
      for (char& c : name)
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
      return name;
    });

}  // namespace
}  // namespace glint
