// SPDX-License-Identifier: BSD-3-Clause
// What the reflectance model says about a lamp wider than the lobe, and about a wrong lobe, from 8-bit images. The values
// expected are those of the specification.
#include <gmock/gmock.h>

#include <sstream>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;

constexpr double kRadius = 0.5, kRoughness = 0.12;
constexpr double kSizeTolerance = 0.1, kRoughnessTolerance = 0.1;  // shares; 200 x 150 pixels of 8 bits leave 0.036 and 0.047

class LampSize : public testing::Test {
 protected:
  void SetUp() override { make(R"("radius": 0.5)", 0.12); }
  void make(const std::string& lamp, double roughness) {
    const std::filesystem::path spec =
        folder_.write("spec.json", R"({"glint_scene": 1, "name": "ball",
  "camera": {"width": 200, "height": 150, "fx": 250, "fy": 250, "cx": 99.5, "cy": 74.5},
  "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.45, 0.35]}}},
  "lights": [{"id": "lamp", "position": [0.9, -0.8, 1.6], )" +
                                       lamp + R"(}],
  "path": {"orbit": {"centre": [0, 0, 0], "radius": 1.6, "from": -1.6, "to": 0.4, "height": 0.9, "count": 8}},
  "render": {"reflectance": "torrance-sparrow", "roughness": )" +
                                       (std::ostringstream() << roughness).str() +
                                       R"(, "diffuse": [0.3, 0.4, 0.6], "noise": 0.002, "bits": 8, "seed": 3}})");
    const ProgramRun run = runGlint("synth " + inQuotes(spec) + " -o " + inQuotes(folder_ / "scene"));
    ASSERT_EQ(run.code, 0) << run.err;
    Json scene = Json::parse(contentOf(folder_ / "scene/scene.json"));
    for (Json& frame : scene["frames"]) frame.erase("highlights");  // the program has to find them
    folder_.write("scene/scene.json", scene.dump());
  }
  Json fit(const std::string& more = "") const {
    const ProgramRun run =
        runGlint("evaluate " + inQuotes(folder_ / "scene") + " --models reflectance --train first:6 --json - " + more);
    EXPECT_EQ(run.code, 0) << run.err;
    return Json::parse(run.out)["models"]["reflectance"]["fits"][0];
  }
  TemporaryFolder folder_;
};

TEST_F(LampSize, WiderThanTheLobeIsFound) {
  const Json found = fit();
  EXPECT_NEAR(found["light_radius"].get<double>(), kRadius, kSizeTolerance * kRadius);
  EXPECT_NEAR(found["roughness"].get<double>(), kRoughness, kRoughnessTolerance * kRoughness);
}

TEST_F(LampSize, APointInItsPlaceIsWarnedOf) {
  const Json found = fit("--set fit.light_size=point");
  EXPECT_EQ(found["light_radius"], 0.0);
  EXPECT_THAT(found["warnings"].dump(), testing::HasSubstr("lobe, light or surface may be wrong"));
}

class StatedLobe : public LampSize {
  void SetUp() override { make(R"("radius": 0)", 0.2); }
};

// Far down the lobe a GGX is brighter: a fit to all pixels pays for that at the contour.
TEST_F(StatedLobe, AWrongOneIsWarnedOf) {
  EXPECT_THAT(fit("--set fit.lobe=ggx")["warnings"].dump(), testing::HasSubstr("from those of the fit to the pixels"));
}

TEST_F(StatedLobe, TheRightOneIsNot) { EXPECT_EQ(fit("--set fit.lobe=torrance-sparrow")["warnings"].dump(), "[]"); }

}  // namespace
}  // namespace glint
