// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/camera_response.h"

#include <gmock/gmock.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/base/number_text.h"
#include "core/scene/scene.h"
#include "core/scene/scene_dom.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_json.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::camera_response_tests {
namespace {
using namespace testing_support;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = CameraResponse::Kind;
namespace fs = std::filesystem;

constexpr double kExact = 1e-12;  // of values in 0..1: a few roundings
constexpr float kFloat = 1e-6f;   // a few ulp of float32 at 1

CameraResponse known(const std::string& text) { return CameraResponse::named(text, "scene.json", "camera.response").value(); }

/// Half of the codes give a fifth of the light; every colour its own curve.
const std::string kColours = "code,red,green,blue\n0,0,0,0\n64,1,2,3\n128,20,21,22\n255,100,105,110\n";

std::string refusedText(const std::string& text) {
  return inputErrorOf([&] { CameraResponse::ofText(text, "curve.csv"); });
}

/// One grey picture of one code.
Frame frameOf(const TemporaryFolder& folder, int depth, double code, const CameraResponse& response) {
  Frame frame;
  frame.id = "a";
  frame.camera.width = frame.camera.height = 2;
  frame.response = response;
  frame.image = folder / "grey.png";
  EXPECT_TRUE(cv::imwrite(frame.image.string(), cv::Mat(2, 2, CV_MAKETYPE(depth, 3), cv::Scalar::all(code))));
  return frame;
}

float lightIn(const Frame& frame, std::string* how = nullptr) {
  const Outcome<Image> image = readLinear(frame, FrameSource::Image, how);
  EXPECT_TRUE(image);
  return image ? image->at(1, 1, 0) : -1;
}

// --- nominal: closed forms and a curve worked out by hand ---

TEST(CameraResponse, NamedOnesAreTheirClosedForms) {
  EXPECT_NEAR(known("srgb").lightOf(128 / 255.0, 0), 0.2158605, 1e-7);  // IEC 61966-2-1, worked value
  EXPECT_NEAR(known("linear").lightOf(0.3, 1), 0.3, kExact);
  EXPECT_NEAR(known("gamma:2").lightOf(0.3, 2), 0.09, kExact);
  EXPECT_NEAR(known("gamma:0.5").lightOf(0.09, 2), 0.3, kExact);
  EXPECT_NEAR(known("s-curve:0.5").codeOf(0.2158605, 0), 128 / 255.0 + 0.5 * 0.0019607, 1e-6);  // sin(2 pi (c - 1/2)) is small
  EXPECT_NEAR(known("s-curve:0.5").codeOf(0.0508761, 0), 0.25 - 0.5 / (2 * 3.14159265), 1e-6);  // c = 1/4: sin = 1
  EXPECT_NEAR(known("s-curve:0.5").lightOf(0.25 - 0.5 / (2 * 3.14159265), 1), 0.0508761, 1e-6);
  EXPECT_NEAR(known("s-curve:0").lightOf(128 / 255.0, 2), 0.2158605, 1e-7);
  EXPECT_NEAR(CameraResponse().lightOf(128 / 255.0, 0), 0.2158605, 1e-7);
  EXPECT_NEAR(CameraResponse().lightOf(0.3, 0, true), 0.3, kExact);
  EXPECT_EQ(CameraResponse::named("curve.csv", "f", "p"), std::nullopt);
}

TEST(CameraResponse, AFileIsInterpolatedColourByColour) {
  const CameraResponse r = CameraResponse::ofText(kColours, "curve.csv");
  EXPECT_NEAR(r.lightOf(0, 0), 0, kExact);
  EXPECT_NEAR(r.lightOf(128 / 255.0, 0), 0.20, kExact);
  EXPECT_NEAR(r.lightOf(128 / 255.0, 1), 0.20, kExact);  // 21 / 105
  EXPECT_NEAR(r.lightOf(96 / 255.0, 2), 12.5 / 110, kExact);
  EXPECT_EQ(r.lightOf(1, 2), 1);
  EXPECT_NEAR(r.codeOf(0.105, 0), 96 / 255.0, kExact);  // half way from 1 to 20 of 100
}

TEST(CameraResponse, TheFormsOfAFileAreOneCurve) {
  std::string line, column, pairs;
  for (int i = 0; i <= 255; ++i) {
    const std::string light = formatted("%.17g", std::pow(i / 255.0, 2.1));
    line += light + " ";
    column += light + "\n";
    pairs += formatted("%d;", i) + light + "\r\n";
  }
  for (const std::string& text : {line, column, "# measured\n" + column, pairs, "code;light\n" + pairs}) {
    const CameraResponse r = CameraResponse::ofText(text, "curve.csv");
    for (const int i : {0, 1, 77, 254, 255})
      for (const int c : {0, 1, 2}) EXPECT_NEAR(r.lightOf(i / 255.0, c), std::pow(i / 255.0, 2.1), kExact);
  }
}

TEST(CameraResponse, PixelsGoThroughIt) {
  const TemporaryFolder folder;
  std::string how;
  EXPECT_NEAR(lightIn(frameOf(folder, CV_8U, 51, known("linear")), &how), 0.2f, kFloat);
  EXPECT_EQ(how, "8-bit codes taken as linear (stated)");
  EXPECT_NEAR(lightIn(frameOf(folder, CV_8U, 51, known("gamma:2"))), 0.04f, kFloat);
  EXPECT_NEAR(lightIn(frameOf(folder, CV_16U, 13107, known("gamma:2")), &how), 0.04f, kFloat);
  EXPECT_EQ(how, "16-bit codes to the power of 2 (stated)");
  EXPECT_NEAR(lightIn(frameOf(folder, CV_8U, 128, {}), &how), 0.2158605f, kFloat);
  EXPECT_EQ(how, "8-bit codes through the sRGB curve (default: no response is stated)");
  const Frame colours = frameOf(folder, CV_8U, 64, CameraResponse::ofText(kColours, "curve.csv"));
  const Outcome<Image> image = readLinear(colours, FrameSource::Image, &how);
  ASSERT_TRUE(image);
  EXPECT_NEAR(image->at(0, 0, 0), 1 / 100.f, kFloat);
  EXPECT_NEAR(image->at(0, 0, 1), 2 / 105.f, kFloat);
  EXPECT_NEAR(image->at(0, 0, 2), 3 / 110.f, kFloat);
  EXPECT_EQ(how, "8-bit codes through the curve of curve.csv (stated)");
}

// What is shown is sRGB: a linear 0.2158605 looks like code 128 of an sRGB picture.
TEST(CameraResponse, ThePhotographIsShownInSrgb) {
  const TemporaryFolder folder;
  const Outcome<Image> shown = readPhotograph(frameOf(folder, CV_16U, std::round(0.2158605 * 65535), known("linear")));
  ASSERT_TRUE(shown);
  EXPECT_NEAR(shown->at(0, 0, 1), 128 / 255.f, 1e-4f);  // half a code of 16 bits, at the slope there
  const Outcome<Image> asIs = readPhotograph(frameOf(folder, CV_8U, 77, known("srgb")));
  ASSERT_TRUE(asIs);
  EXPECT_EQ(asIs->at(0, 0, 1), 77 / 255.f);
}

// --- scale: neither the unit of light nor that of the codes counts ---

TEST(CameraResponse, UnitsDoNotCount) {
  const CameraResponse one = CameraResponse::ofText("0 0\n0.5 0.2\n1 1\n", "curve.csv");
  for (const double unit : {1e-300, 1e-6, 1e9, 1e300})
    for (const double codes : {1.0, 255.0, 4095.0, 65535.0}) {
      const CameraResponse r =
          CameraResponse::ofText(formatted("0 0\n%.17g %.17g\n%.17g %.17g\n", codes / 2, 0.2 * unit, codes, unit), "curve.csv");
      for (const double code : {0.0, 0.1, 0.5, 0.77, 1.0}) EXPECT_NEAR(r.lightOf(code, 0), one.lightOf(code, 0), kExact);
    }
}

// --- noise: a measured curve is not smooth; it may stand still, and codes of lights come back ---

TEST(CameraResponse, CodesOfLightsAreTheInverse) {
  const CameraResponse measured = CameraResponse::ofText("0 0.5\n10 0.5\n60 2\n61 2\n200 30\n250 60\n255 60\n", "curve.csv");
  for (const CameraResponse& r : {known("srgb"), known("linear"), known("gamma:2.2"), measured})
    for (double light = 0; light <= 1; light += 1 / 64.0)
      if (light >= r.lightOf(0, 1)) {
        EXPECT_NEAR(r.lightOf(r.codeOf(light, 1), 1), light, kExact);
      }
  EXPECT_EQ(measured.codeOf(0, 0), 0);  // darker than the darkest code
  EXPECT_NEAR(measured.codeOf(2 / 60.0, 0), 60 / 255.0, kExact);
  EXPECT_EQ(measured.codeOf(std::nan(""), 0), 0);
}

// --- degenerate: refused with file, place and reason ---

TEST(CameraResponse, WhatIsNoCurveIsRefusedByName) {
  EXPECT_THAT(refusedText(""), HasSubstr("curve.csv: is no camera response: it needs the light of two codes"));
  EXPECT_THAT(refusedText("0 0\n1 nan\n"), HasSubstr("line 2: 'nan' is not a number"));
  EXPECT_THAT(refusedText("0 0\n1 x\n"), HasSubstr("line 2: 'x' is not a number"));
  EXPECT_THAT(refusedText("code light\nand more\n0 0\n1 1\n"), HasSubstr("line 2: 'and' is not a number"));
  EXPECT_THAT(refusedText("0 0\n128 1 2 3\n"), HasSubstr("line 2: has 4 numbers, the lines before have 2"));
  EXPECT_THAT(refusedText("0 0\n200 1\n"), HasSubstr("line 2: the last code must be the largest one"));
  EXPECT_THAT(refusedText("3 0\n255 1\n"), HasSubstr("line 1: the first code must be 0"));
  EXPECT_THAT(refusedText("0 0\n128 0.2\n100 0.3\n255 1\n"), HasSubstr("line 3: the codes must rise"));
  EXPECT_THAT(refusedText("0 0\n128 0.2\n255 0.1\n"), HasSubstr("line 3: light must not fall"));
  EXPECT_THAT(refusedText("0 -4.2\n255 0\n"), HasSubstr("line 1: light must not be negative (logarithms are not read)"));
  EXPECT_THAT(refusedText("0 1\n255 1\n"), HasSubstr("all codes have the same light"));
  EXPECT_THAT(refusedText("1 2 3 4 5\n1 2 3 4 5\n"), HasSubstr("line 1: has 5 numbers"));
  EXPECT_THAT(refusedText("1 2 3 4 5\n"), HasSubstr("needs the light of two codes"));
  std::string many;
  for (int i = 0; i <= 65536; ++i) many += "1 ";
  EXPECT_THAT(refusedText(many), HasSubstr("more than 65536 codes"));
  for (char& c : many)
    if (c == ' ') c = '\n';
  EXPECT_THAT(refusedText(many), HasSubstr("line 65537: there are more than 65536 codes"));
}

TEST(CameraResponse, AGammaThatIsNoneIsRefused) {
  for (const char* text : {"gamma:", "gamma:x", "gamma:0", "gamma:-2", "gamma:1e9", "gamma:nan", "gamma:2,2"})
    EXPECT_THAT(inputErrorOf([&] { known(text); }), HasSubstr("scene.json: camera.response: expected gamma:G")) << text;
}

TEST(CameraResponse, TheOtherWayRoundIsDoubted) {
  EXPECT_THAT(known("gamma:0.4545").doubt(), HasSubstr("was gamma:2.2 meant?"));
  EXPECT_THAT(CameraResponse::ofText("0 0\n0.5 0.73\n1 1\n", "curve.csv").doubt(), HasSubstr("73 % of the light"));
  for (const CameraResponse& r : {known("gamma:2.2"), known("srgb"), known("linear"), CameraResponse(), known("gamma:1"),
                                  CameraResponse::ofText(kColours, "curve.csv")})
    EXPECT_EQ(r.doubt(), "");
}

// --- in a scene file ---

std::string sceneWith(const std::string& response) {
  return with(minimalScene(), "\"cy\": 23.5", "\"cy\": 23.5, \"response\": \"" + response + "\"");
}

TEST(CameraResponse, ASceneKeepsItAndItsFile) {
  const TemporaryFolder folder;
  folder.write("curves/camera.csv", kColours);
  for (const char* text :
       {"srgb", "linear", "gamma:2.2", "s-curve:0.5", "vignetting:0.25", "srgb, vignetting:0.3", "curves/camera.csv"}) {
    const Scene scene = readScene(folder.write("scene.json", sceneWith(text)));
    EXPECT_THAT(scene.warnings, IsEmpty());
    writeScene(scene, folder / "again.json");
    EXPECT_THAT(contentOf(folder / "again.json"), HasSubstr("\"response\": \"" + std::string(text) + "\""));
    EXPECT_EQ(readScene(folder / "again.json").frames[0].response, scene.frames[0].response);
  }
  const Scene scene = readScene(folder / "scene.json");
  EXPECT_EQ(scene.frames[0].response.kind(), Kind::Table);
  EXPECT_THAT(filesOf(scene), Contains(folder / "curves/camera.csv"));  // so a session hashes and copies it
}

TEST(CameraResponse, ASceneIsRefusedWithPlaceAndReason) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& response) {
    return inputErrorOf([&] { readScene(folder.write("scene.json", sceneWith(response))); });
  };
  EXPECT_THAT(
      refused("sRGB"),
      HasSubstr("scene.json: camera.response: 'sRGB' is neither srgb, linear, gamma:G, s-curve:S, vignetting:K, nor a file"));
  EXPECT_THAT(refused("gamma:x"), HasSubstr("scene.json: camera.response: expected gamma:G"));
  EXPECT_THAT(refused("s-curve:1"), HasSubstr("scene.json: camera.response: expected s-curve:S with a number S from -0.95 to"));
  EXPECT_THAT(refused("vignetting:1"),
              HasSubstr("scene.json: camera.response: expected vignetting:K with a number K above 0, up to"));
  EXPECT_THAT(refused("sepia, vignetting:0.3"), HasSubstr("vignetting:K follows srgb, linear, gamma:G or s-curve:S"));
  EXPECT_THAT(refused("../curve.csv"), HasSubstr("camera.response"));
  folder.write("curve.csv", "0 1\n255 0\n");
  EXPECT_THAT(refused("curve.csv"), HasSubstr("curve.csv: line 2: light must not fall"));
}

TEST(CameraResponse, VignettingIsUndoneUpToAFactorOfAllPixels) {
  const CameraResponse response = *CameraResponse::named("gamma:2, vignetting:0.4", "f", "p");
  EXPECT_EQ(response.kind(), Kind::Gamma);
  // The same light, 0.5, in the middle and in a corner, which shows 0.6 of it; halfway out it shows 1 - 0.4 / 4.
  EXPECT_DOUBLE_EQ(response.withoutVignetting(0.5, 100, 50, 201, 101), 0.3);
  EXPECT_DOUBLE_EQ(response.withoutVignetting(0.3, 0, 100, 201, 101), 0.3);
  EXPECT_DOUBLE_EQ(response.withoutVignetting(0.45, 150, 25, 201, 101), 0.3);
  EXPECT_EQ(response.withoutVignetting(1, 100, 50, 201, 101), 1);  // clipped stays clipped
  EXPECT_LT(response.withoutVignetting(0.999, 0, 0, 201, 101), 1);
}

TEST(CameraResponse, FramesWithACameraOfTheirOwnHaveTheirOwnResponse) {
  const TemporaryFolder folder;
  const std::string own = R"("camera": {"width": 64, "height": 48, "fx": 80, "fy": 80, "cx": 31.5, "cy": 23.5})";
  const std::string text = with(sceneWith("gamma:0.4"), "{\"id\": \"a\",", "{\"id\": \"a\", " + own + ",");
  const Scene scene = readScene(folder.write("scene.json", text));
  EXPECT_FALSE(scene.frames[0].response.isStated());
  EXPECT_THAT(scene.warnings,
              ElementsAre(HasSubstr("camera.response: the camera response gives"),
                          "camera.response does not hold for 1 frames with a camera of their own that states none"));
}

// --- of a capture: said by an option, kept by the session ---

TEST(CameraResponse, ASessionKeepsTheOption) {
  const TemporaryFolder folder;
  const fs::path curve = folder.write("curve.csv", kColours);
  const auto given = [](const std::string& text) {
    InputChoices c;
    for (const ChoiceOption& option : choiceOptions())
      if (std::string(option.flag) == "--response") option.set(c, text);
    return c;
  };
  for (const std::string& text : {std::string("srgb"), std::string("gamma:2.2"), std::string("s-curve:0.5"),
                                  std::string("linear, vignetting:0.3"), curve.string()}) {
    const InputChoices c = given(text);
    const std::string json = toJson(c, [&](const fs::path& p) { return p.lexically_relative(folder.path()).string(); }).dump();
    const InputChoices again = readInputChoices(JsonNode::parse(json, "s.glint"), folder.path());
    EXPECT_EQ(again, c) << json;
    EXPECT_EQ(responseOf(again).text(), text);
  }
  EXPECT_THAT(inputErrorOf([&] { given("sRGB"); }),
              HasSubstr("--response sRGB: is neither srgb, linear, gamma:G, s-curve:S, vignetting:K, nor a file"));
  EXPECT_THAT(inputErrorOf([&] { readInputChoices(JsonNode::parse(R"({"response": "curve.csv"})", "s.glint"), folder.path()); }),
              HasSubstr("s.glint: response: must be srgb, linear, gamma:G, s-curve:S or vignetting:K"));
}

}  // namespace
}  // namespace glint::camera_response_tests
