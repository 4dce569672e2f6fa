// SPDX-License-Identifier: BSD-3-Clause
// `evaluate --json` against the keys and types of docs/formats.md, "evaluate --json".
#include <gmock/gmock.h>

#include "tests/cli/small_scene.h"

namespace glint {
namespace {
using namespace testing_support;

/// A type as a letter: n number, i whole number, s text, o object, a list; after it "?" where null means "has none".
bool hasType(const Json& value, const std::string& type) {
  if (value.is_null()) return type.size() == 2;
  switch (type[0]) {
    case 'n': return value.is_number();
    case 'i': return value.is_number_integer();
    case 's': return value.is_string();
    case 'o': return value.is_object();
    case 'a': return value.is_array();
    default: return false;
  }
}

void expectKeys(const Json& object, const std::map<std::string, std::string>& keys, const std::string& where) {
  for (const auto& [key, type] : keys) {
    ASSERT_TRUE(object.contains(key)) << where << "." << key;
    EXPECT_TRUE(hasType(object[key], type)) << where << "." << key << " is " << object[key].dump();
  }
}

class EvaluationContract : public SmallScene {
 protected:
  static void expectContract(const ProgramRun& run) {
    ASSERT_TRUE(Json::accept(run.out)) << run.err;  // strict: neither NaN nor Infinity is JSON
    const Json j = Json::parse(run.out);
    expectKeys(j,
               {{"glint_evaluation", "i"},
                {"input", "s"},
                {"train", "a"},
                {"level", "n"},
                {"settings", "o"},
                {"chosen_model", "s?"},
                {"scored_against", "s"},
                {"warnings", "a"},
                {"models", "o"}},
               "");
    EXPECT_EQ(j["glint_evaluation"], 1);
    for (const auto& [name, model] : j["models"].items()) {
      expectKeys(model, {{"status", "s"}, {"reason", "s"}, {"fits", "a"}, {"summary", "o"}, {"frames", "a"}}, name);
      EXPECT_EQ(model["status"] == "ok", model["reason"] == "") << name;
      for (const Json& fit : model["fits"]) {
        const bool ok = fit["status"] == "ok";
        expectKeys(fit,
                   {{"light", "s"},
                    {"surface", "s?"},
                    {"ellipsoid", "o?"},
                    {"q_dual", "a"},
                    {"light_position", "a?"},
                    {"limit_angle_deg", "n?"},
                    {"roughness", "n?"},
                    {"gap_ratio", "n?"},
                    {"condition", "n?"},
                    {"residual_px", "a"},
                    {"warnings", "a"},
                    {"time_us", ok ? "n" : "n?"}},
                   name + ".fits");
        if (ok) {
          if (name == "limit-angle" || name == "reflectance") {
            EXPECT_TRUE(fit["condition"].is_number()) << name;
          }
          EXPECT_EQ(fit["residual_px"].size(), fit["training_frames"].size()) << name;
        }
        if (!fit["light_position"].is_null()) {
          EXPECT_EQ(fit["light_position"].size(), 4u) << name;
        }
        if (!fit["ellipsoid"].is_null())
          expectKeys(fit["ellipsoid"], {{"centre", "a"}, {"semi_axes", "a"}, {"world_from_ellipsoid", "a"}}, name + ".ellipsoid");
      }
      const Json& summary = model["summary"];
      expectKeys(summary,
                 {{"frames", "i"},
                  {"predicted", "i"},
                  {"contour_error_pct", "o"},
                  {"contour_error_px", "o"},
                  {"iou", "o"},
                  {"matched", "i"},
                  {"missed", "i"},
                  {"spurious", "i"},
                  {"peak_offset_px", "o"},
                  {"coverage", "o"},
                  {"time_us", "o"}},
                 name + ".summary");
      const std::string value = summary["predicted"] > 0 ? "n" : "n?";
      for (const char* key : {"mean", "median", "p95", "max"})
        expectKeys(summary["contour_error_pct"], {{key, value}}, name + ".contour_error_pct");
      for (const char* metric : {"contour_error_px", "iou", "peak_offset_px", "coverage"})
        expectKeys(summary[metric], {{"mean", metric == std::string("iou") ? "n?" : value}}, name + "." + metric);
      expectKeys(summary["time_us"], {{"median", value}, {"p99", value}}, name + ".time_us");
      for (const Json& row : model["frames"]) {
        const std::string metric = row["status"] == "ok" ? "n" : "n?";
        expectKeys(row,
                   {{"index", "i"},
                    {"id", "s"},
                    {"light", "s"},
                    {"highlight", "i"},
                    {"status", "s"},
                    {"reason", "s"},
                    {"contour_error_pct", metric},
                    {"contour_error_px", metric},
                    {"hausdorff_px", metric},
                    {"iou", metric},
                    {"centre_offset_px", metric},
                    {"axis_ratio_error", metric},
                    {"angle_error_deg", metric},
                    {"peak_offset_px", metric},
                    {"coverage", metric},
                    {"time_us", "n"}},
                   name + ".frames");
      }
    }
  }
};

TEST_F(EvaluationContract, AnsweredModels) {
  const ProgramRun run = on("evaluate", "--json -");
  EXPECT_EQ(run.code, 0);
  expectContract(run);
  const Json j = Json::parse(run.out);
  EXPECT_EQ(j["train"], Json::parse("[0,1,2,3,4,5]"));
  EXPECT_EQ(j["scored_against"], "own detection");
  EXPECT_TRUE(j["models"]["reflectance"]["fits"][0]["lobe"].is_string());
  EXPECT_TRUE(j["models"]["reflectance"]["fits"][0]["light_radius"].is_number());
  EXPECT_EQ(j["level"], 0.5);
  EXPECT_EQ(j["models"].size(), 5u);
  std::string best;
  for (const auto& [name, model] : j["models"].items()) {
    const auto error = [&](const std::string& m) { return j["models"][m]["summary"]["contour_error_pct"]["mean"].get<double>(); };
    if (model["status"] == "ok" && (best.empty() || error(name) < error(best))) best = name;
  }
  EXPECT_EQ(j["chosen_model"], best);
  // Held-out frames only.
  for (const auto& [name, model] : j["models"].items())
    for (const Json& row : model["frames"]) EXPECT_GE(row["index"].get<int>(), 6) << name;
}

TEST_F(EvaluationContract, SaysWhatItWasScoredAgainst) {
  for (int i = 0; i < kFrames; ++i) {
    const Json& h = exact_["frames"][i]["highlights"][0];
    folder_.write("truth/000" + std::to_string(i) + ".json",
                  Json{{"levels", {{"0.50", Json::array({{{"points", h["contour"]}}})}}}, {"peak_subpixel", h["peak"]}}.dump());
  }
  const auto scoredAgainst = [&](const std::string& more) {
    return Json::parse(on("evaluate", "--models limit-angle --json - " + more).out)["scored_against"];
  };
  EXPECT_EQ(scoredAgainst(""), "own detection");
  EXPECT_EQ(scoredAgainst("--truth " + out("truth")), "truth");
  withHighlights();
  writeScene();
  EXPECT_EQ(scoredAgainst(""), "given contours");
}

TEST_F(EvaluationContract, AnExtendedLightHasItsExtent) {
  withHighlights();
  writeScene();
  const Json fit = Json::parse(
      on("evaluate", "--models limit-angle --json - --set light.limit_orders=1").out)["models"]["limit-angle"]["fits"][0];
  ASSERT_EQ(fit["light_extent"].size(), 3u) << fit.dump();
  for (const Json& row : fit["light_extent"]) EXPECT_EQ(row.size(), 3u);
  EXPECT_FALSE(Json::parse(on("evaluate", "--models limit-angle --json -").out)["models"]["limit-angle"]["fits"][0].contains(
      "light_extent"));
}

TEST_F(EvaluationContract, ClippedHighlightsAreNamedWithTheirFrames) {
  for (const int frame : {2, 6}) {
    cv::Mat m = cv::imread(radiance(frame).string(), cv::IMREAD_UNCHANGED);
    double top = 0;
    cv::minMaxLoc(m.reshape(1), nullptr, &top);
    writeRadiance(frame, m * (1e4 / top));  // its peak at 10,000, all others far below
  }
  const ProgramRun run = on("evaluate", "--models limit-angle --set detect.clip=6000 --json - --html " + out("e.html"));
  const std::string expected = "clipped (saturated) highlights in training frame 0002 and other frame 0006";
  EXPECT_THAT(run.err, testing::HasSubstr("warning: " + expected));
  EXPECT_THAT(Json::parse(run.out)["warnings"][0].get<std::string>(), testing::HasSubstr(expected));
  EXPECT_THAT(contentOf(folder_ / "e.html"), testing::HasSubstr(expected));
}

TEST_F(EvaluationContract, RefusedModelsHaveTheSameKeys) { expectContract(on("evaluate", "--train 0,1 --json -")); }

TEST_F(EvaluationContract, PerSurfaceNamesTheSurfaceAndScoresEveryFrame) {
  const ProgramRun run = on("evaluate", "--train per-surface --models limit-angle --json -");
  expectContract(run);
  const Json model = Json::parse(run.out)["models"]["limit-angle"];
  EXPECT_EQ(model["summary"]["frames"], kFrames);
  EXPECT_TRUE(model["fits"][0]["surface"].is_string());
}

TEST_F(EvaluationContract, BadFramesHaveTheSameKeys) {
  std::filesystem::remove(radiance(6));
  writeRadiance(7, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(0.1)));
  const ProgramRun run = on("evaluate", "--json -");
  expectContract(run);
  const Json rows = Json::parse(run.out)["models"]["limit-angle"]["frames"];
  EXPECT_EQ(rows[0]["status"], "failed");
  EXPECT_EQ(rows[1]["status"], "spurious");
  for (const Json& row : rows) EXPECT_NE(row["reason"], "");
}

}  // namespace
}  // namespace glint
