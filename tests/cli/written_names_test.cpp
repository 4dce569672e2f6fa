// SPDX-License-Identifier: BSD-3-Clause
// `glint synth` writes inside the folder that was named, whatever the specification calls its frames and meshes, and nothing at
// all when the specification is wrong.
#include <gmock/gmock.h>

#include <sstream>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class WrittenNames : public testing::Test {
 protected:
  /// A sphere, seen once for each entry of `frames`.
  static Json sphere(const Json& frames) {
    Json spec =
        Json::parse(R"({"glint_scene": 1, "camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5},
      "surfaces": {"body": {"analytic": {"type": "sphere", "radius": 0.4}}},
      "lights": [{"id": "lamp", "position": [0.3, 0.2, -2]}],
      "render": {"reflectance": "ggx", "roughness": 0.2, "bits": 8, "samples": 1}})");
    spec["frames"] = frames;
    for (Json& frame : spec["frames"]) frame["camera_from_world"] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 1.4}, {0, 0, 0, 1}};
    return spec;
  }
  ProgramRun synth(const Json& spec) const {
    folder_.write("spec/spec.json", spec.dump());
    return runGlint("synth " + inQuotes(folder_ / "spec/spec.json") + " -o " + inQuotes(folder_ / "a/b/out"));
  }
  void refuses(const Json& spec, const std::string& place) const {
    const ProgramRun run = synth(spec);
    EXPECT_EQ(run.code, 2) << place;
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("spec.json: " + place));
    EXPECT_FALSE(fs::exists(folder_ / "a")) << "written before " << run.err;
  }
  void writeTetrahedron(const std::string& name, double size) const {
    const std::string s = (std::ostringstream() << size).str();  // std::to_string writes by the locale
    folder_.write(
        name,
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 4\n"
        "property list uchar int vertex_indices\nend_header\n" +
            s + " 0 0\n-" + s + " 0 0\n0 " + s + " 0\n0 0 " + s + "\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  }
  TemporaryFolder folder_;
};

TEST_F(WrittenNames, IdsThatArePathsStayInsideTheFolder) {
  const std::string absolute = (folder_ / "ABSOLUTE").string();
  const ProgramRun run = synth(sphere({{{"id", "../../ESCAPED"}}, {{"id", absolute}}, {{"id", ".."}}, {{"id", ".hidden"}}}));
  ASSERT_EQ(run.code, 0) << run.err;
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
    if (!entry.is_regular_file() || entry.path().parent_path() == folder_ / "spec") continue;
    EXPECT_THAT(entry.path().string(), HasSubstr("/a/b/out/"));
    EXPECT_NE(entry.path().filename().string()[0], '.');
  }
  // The scene keeps the ids, names the files, and is read without --allow-outside.
  const ProgramRun info = runGlint("info " + inQuotes(folder_ / "a/b/out"));
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_THAT(contentOf(folder_ / "a/b/out/scene.json"), HasSubstr("\"../../ESCAPED\""));
}

TEST_F(WrittenNames, TruthIsLookedForUnderTheNameThatIsWritten) {
  ASSERT_EQ(synth(sphere({{{"id", "a/b"}}})).code, 0);
  const fs::path scene = folder_ / "a/b/out";
  // `--truth` maps the id for contours as `synth` does for its photographs.
  ASSERT_TRUE(fs::exists(scene / "frames/a%2Fb.png"));
  folder_.write("truth/a%2Fb.json", R"({"levels": 5})");
  const ProgramRun run = runGlint("evaluate " + inQuotes(scene) + " --train 0 --truth " + inQuotes(folder_ / "truth"));
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("truth/a%2Fb.json: levels: must be an object, is a number"));
}

TEST_F(WrittenNames, WrongSpecificationsAreRefusedBeforeAnythingIsWritten) {
  refuses(sphere({{{"id", "0"}}, {{"id", "0"}}}), "frames[1].id: duplicate id '0'");
  refuses(sphere({{{"id", "a\nb"}}}), "frames[0].id: must not contain control characters");
  Json twoLamps = sphere(Json::array({Json::object()}));
  twoLamps["lights"].push_back(twoLamps["lights"][0]);
  refuses(twoLamps, "lights[1].id: duplicate id 'lamp'");
  Json noMesh = sphere(Json::array({Json::object()}));
  noMesh["surfaces"] = {{"body", {{"mesh", "nope.ply"}}}};
  refuses(noMesh, "surfaces.body.mesh: file 'nope.ply' does not exist");
  Json torus = sphere(Json::array({Json::object()}));
  torus["surfaces"] = {{"body", {{"analytic", {{"type", "torus"}, {"major_radius", 0.4}, {"minor_radius", 0.1}}}}}};
  torus["surface_steps"] = {{"surface", "body"}, {"parameter", "minor_radius"}, {"values", {0.1, 0.5}}};
  refuses(torus, "surface_steps: minor_radius");
}

TEST_F(WrittenNames, MeshesOfOneNameAreNumbered) {
  writeTetrahedron("spec/one/b.ply", 0.3);
  writeTetrahedron("spec/two/b.ply", 0.5);
  Json spec = sphere({{{"id", "0"}, {"surface", "one"}}, {{"id", "1"}, {"surface", "two"}}});
  spec["surfaces"] = {{"one", {{"mesh", "one/b.ply"}}}, {"two", {{"mesh", "two/b.ply"}}}};
  const ProgramRun run = synth(spec);
  ASSERT_TRUE(run.code == 0 || run.code == 3) << run.err;  // flat faces need not show a highlight
  const Json scene = Json::parse(contentOf(folder_ / "a/b/out/scene.json"));
  for (const char* name : {"one", "two"})
    EXPECT_EQ(contentOf(folder_ / "a/b/out" / scene["surfaces"][name]["mesh"].get<std::string>()),
              contentOf(folder_ / "spec" / name / "b.ply"));
}

TEST_F(WrittenNames, ANumberedNameDoesNotReplaceTheFileOfAnother) {
  writeTetrahedron("spec/one/b.ply", 0.3);
  writeTetrahedron("spec/two/b.ply", 0.5);
  folder_.write("a/b/out/mesh/b-2.ply", "a person's mesh");
  Json spec = sphere({{{"id", "0"}, {"surface", "one"}}, {{"id", "1"}, {"surface", "two"}}});
  spec["surfaces"] = {{"one", {{"mesh", "one/b.ply"}}}, {"two", {{"mesh", "two/b.ply"}}}};
  const ProgramRun run = synth(spec);
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(run.errorLines(), 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("mesh/b-2.ply: already exists, and no scene.json there says that synth wrote it"));
  EXPECT_EQ(contentOf(folder_ / "a/b/out/mesh/b-2.ply"), "a person's mesh");
  EXPECT_FALSE(fs::exists(folder_ / "a/b/out/scene.json"));
}

TEST_F(WrittenNames, ExtensionsOfMeshesHoldNoControls) {
  writeTetrahedron("spec/b.p\n\x1b[31mly", 0.3);
  writeTetrahedron("spec/c.p\xE2\x80\xAEly", 0.3);  // right to left
  Json spec = sphere({{{"id", "0"}, {"surface", "one"}}, {{"id", "1"}, {"surface", "two"}}});
  spec["surfaces"] = {{"one", {{"mesh", "b.p\n\x1b[31mly"}}}, {"two", {{"mesh", "c.p\xE2\x80\xAEly"}}}};
  const ProgramRun run = synth(spec);
  ASSERT_TRUE(run.code == 0 || run.code == 3) << run.err;  // flat faces need not show a highlight
  EXPECT_TRUE(fs::exists(folder_ / "a/b/out/mesh/b.p%0A%1B[31mly"));
  EXPECT_TRUE(fs::exists(folder_ / "a/b/out/mesh/c.p%E2%80%AEly"));
  const ProgramRun info = runGlint("info " + inQuotes(folder_ / "a/b/out"));
  EXPECT_EQ(info.code, 0) << info.err;
}

TEST_F(WrittenNames, ASceneThatLooksLikeOneOfSynthIsNotReplaced) {
  const Json spec = sphere({{{"id", "0000"}}});
  ASSERT_EQ(synth(spec).code, 0);
  const fs::path made = folder_ / "a/b/out";
  // A scene file of highlights alone, and one with every file that synth names: neither says that synth wrote it.
  Json all = Json::parse(contentOf(made / "scene.json")), highlights = all;
  ASSERT_EQ(all.erase("made_by"), 1u);
  highlights.erase("made_by");
  for (const char* key : {"image", "radiance", "depth", "normals", "mask"}) highlights["frames"][0].erase(key);
  folder_.write("a/b/out/frames/0000.png", "a photograph");
  for (const Json& scene : {highlights, all}) {
    folder_.write("a/b/out/scene.json", scene.dump());
    const ProgramRun run = synth(spec);
    EXPECT_EQ(run.code, 2);
    EXPECT_EQ(run.errorLines(), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("scene.json: already exists, and no scene.json there says that synth wrote it"));
    EXPECT_EQ(contentOf(made / "scene.json"), scene.dump());
    EXPECT_EQ(contentOf(made / "frames/0000.png"), "a photograph");
  }
}

TEST_F(WrittenNames, AnEarlierSceneOfSynthIsReplaced) {
  Json spec = sphere({{{"id", "0000"}}});
  spec["name"] = "first";
  ASSERT_EQ(synth(spec).code, 0);
  spec["name"] = "second";
  const ProgramRun run = synth(spec);
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(contentOf(folder_ / "a/b/out/scene.json"), HasSubstr("\"second\""));
  // A copy by another command does not pass for one of synth.
  const ProgramRun copy = runGlint("convert " + inQuotes(folder_ / "a/b/out") + " -o " + inQuotes(folder_ / "a/b/out/copy.json"));
  EXPECT_EQ(copy.code, 0);
  EXPECT_EQ(copy.err, "");
  EXPECT_THAT(contentOf(folder_ / "a/b/out/copy.json"), Not(HasSubstr("made_by")));
}

TEST_F(WrittenNames, TheSpecificationIsNotReplaced) {
  const std::string spec = sphere(Json::array({Json::object()})).dump();
  folder_.write("scene.json", spec);
  const ProgramRun run = runGlint("synth " + inQuotes(folder_ / "scene.json") + " -o " + inQuotes(folder_.path()));
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("would overwrite the specification"));
  EXPECT_EQ(contentOf(folder_ / "scene.json"), spec);
}

}  // namespace
}  // namespace glint
