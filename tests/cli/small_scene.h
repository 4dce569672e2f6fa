// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/cli/run_program.h"

namespace glint::testing_support {

using Json = nlohmann::json;

/// For the shell.
inline std::string inQuotes(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

/// Eight frames of 160 x 120 of an ellipsoid under one lamp, made once by `glint synth`; each test gets a copy. The scene file
/// gives no highlights, so that they are detected, unless `withHighlights` puts the exact ones back.
class SmallScene : public testing::Test {
 protected:
  static constexpr int kWidth = 160, kHeight = 120, kFrames = 8;

  static void SetUpTestSuite() {
    made_ = std::make_unique<TemporaryFolder>();
    const std::filesystem::path spec = made_->write("spec.json", R"({"glint_scene": 1, "name": "small", "units": "m",
  "camera": {"width": 160, "height": 120, "fx": 200, "fy": 200, "cx": 79.5, "cy": 59.5},
  "surfaces": {"body": {"analytic": {"type": "ellipsoid", "semi_axes": [0.6, 0.35, 0.3]}}},
  "lights": [{"id": "lamp", "position": [1.5, -1.0, 2.2]}],
  "path": {"orbit": {"centre": [0,0,0], "radius": 1.9, "height": 0.9, "from": -1.9, "to": -0.5, "count": 8}},
  "render": {"reflectance": "ggx", "roughness": 0.2, "diffuse": 0.05, "bits": 32, "samples": 1}})");
    const ProgramRun run = runGlint("synth " + inQuotes(spec) + " -o " + inQuotes(*made_ / "scene"));
    ASSERT_EQ(run.code, 0) << run.err;
  }
  static void TearDownTestSuite() { made_.reset(); }

  void SetUp() override {
    std::filesystem::copy(*made_ / "scene", folder_.path(), std::filesystem::copy_options::recursive);
    exact_ = Json::parse(contentOf(folder_ / "scene.json"));
    scene_ = exact_;
    for (Json& frame : scene_["frames"]) frame.erase("highlights");
    writeScene();
  }
  static std::filesystem::path spec() { return *made_ / "spec.json"; }
  void withHighlights() { scene_ = exact_; }
  void writeScene() const { folder_.write("scene.json", scene_.dump()); }
  void writeRadiance(int frame, const cv::Mat& m) const {
    ASSERT_TRUE(cv::imwrite(radiance(frame).string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
  }
  std::filesystem::path radiance(int frame) const { return folder_ / ("radiance/000" + std::to_string(frame) + ".tiff"); }
  /// A highlight without a surface, where frame 7 of the scene has its own.
  static cv::Mat blob() {
    cv::Mat m(kHeight, kWidth, CV_32FC1);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        m.at<float>(y, x) = static_cast<float>(0.05 + 5 * std::exp(-((x - 95) * (x - 95) + (y - 70) * (y - 70)) / 30.0));
    return m;
  }
  /// `glint COMMAND FOLDER MORE`.
  ProgramRun on(const std::string& command, const std::string& more = "", const std::string& before = "") const {
    return runGlint(command + " " + inQuotes(folder_.path()) + " " + more, before);
  }
  /// `glint COMMAND FOLDER/run.glint MORE`.
  ProgramRun onSession(const std::string& command, const std::string& more = "", const std::string& before = "") const {
    return runGlint(command + " " + inQuotes(folder_ / "run.glint") + " " + more, before);
  }
  void saveSession(const std::string& more = "") const {
    const ProgramRun run = on("reconstruct", more + " -o " + out("run.glint"));
    ASSERT_EQ(run.code, 0) << run.err;
  }
  std::string out(const std::string& name) const { return inQuotes(folder_ / name); }

  TemporaryFolder folder_;
  Json exact_, scene_;

 private:
  inline static std::unique_ptr<TemporaryFolder> made_;
};

}  // namespace glint::testing_support
