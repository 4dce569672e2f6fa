// SPDX-License-Identifier: BSD-3-Clause
// detect.background = colours in an inspection: contours on the specular part, and a warning where the colours do not tell it.
#include "core/pipeline/hand_edits.h"
#include "core/report/texts.h"
#include "tests/core/pipeline/coloured_scene.h"

namespace glint::separated_inspection_tests {

using test::Coloured;

FrameEvidence evidenceOf(const Coloured& c, const std::string& background) {
  InspectionRequest request;
  request.settings.set("detect.background", background);
  return evidenceFor(c.scene, 0, evidenceInputs(request, false));
}

double errorPx(const Coloured& c, const FrameEvidence& e) {
  return test::meanDistance(e.highlights.at(0).contour, c.blob.levelSet(0.5));
}

Inspection inspectionOf(const Coloured& c, FrameEvidence evidence) {
  Inspection r;
  r.scene = std::make_shared<const Scene>(c.scene);
  r.evidence = {std::move(evidence)};
  r.train.frames = {0};
  return r;
}

TEST(ColoursAsBackground, TheContourIsTheLobesAndNothingIsWarnedOf) {
  for (const bool distorted : {false, true}) {
    const Coloured c(false, distorted);
    const FrameEvidence smooth = evidenceOf(c, "smooth"), separated = evidenceOf(c, "colours");
    EXPECT_LT(errorPx(c, separated), 0.1);
    EXPECT_GT(errorPx(c, smooth), 3 * errorPx(c, separated));
    EXPECT_EQ(separated.notSeparated, "");
    EXPECT_TRUE(warningsOf(inspectionOf(c, separated)).empty());
  }
}

TEST(ColoursAsBackground, GreyFramesKeepTheSmoothOneAndSayWhy) {
  const Coloured c(true, false);
  const FrameEvidence smooth = evidenceOf(c, "smooth"), separated = evidenceOf(c, "colours");
  EXPECT_EQ(separated.highlights.at(0).contour.points, smooth.highlights.at(0).contour.points);
  EXPECT_EQ(separated.notSeparated, "the image is grey");
  EXPECT_EQ(smooth.notSeparated, "") << "nobody asked";
  const std::vector<std::string> warnings = warningsOf(inspectionOf(c, separated));
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0],
            "colours do not tell what is specular, and the smooth background is used, in frame 0 (the image is grey)");
}

TEST(ColoursAsBackground, ReasonsAreListedWithTheirFrames) {
  Inspection r;
  Scene scene;
  for (int f = 0; f < 5; ++f) {
    scene.frames.emplace_back().id = "00" + std::to_string(20 + f);
    r.evidence.emplace_back().frame = f;
    r.evidence.back().notSeparated = f == 1 ? "too much noise" : f == 3 ? "" : "the image is grey";
  }
  r.scene = std::make_shared<const Scene>(std::move(scene));
  r.request.excluded = {4};
  const std::vector<std::string> warnings = warningsOf(r);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(
      warnings[0],
      "colours do not tell what is specular, and the smooth background is used, in frames 0020, 0022 (the image is grey); frame "
      "0021 (too much noise)");
}

}  // namespace glint::separated_inspection_tests
