// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "tests/core/pipeline/coloured_scene.h"

/// Frames of a lobe on coloured paint under a soft shadow, seen through a lens: the truth is the lobe's contour in ideal pixels.
namespace glint::separated_evidence_tests {
namespace {

using test::Coloured;

TEST(PartEvidence, TheContourIsTheLobesInIdealPixels) {
  for (const bool distorted : {false, true}) {
    const Coloured c(false, distorted);
    FrameEvidence evidence = c.detected();
    ASSERT_EQ(evidence.highlights.size(), 1u);
    const double before = test::meanDistance(evidence.highlights[0].contour, c.blob.levelSet(0.5));
    const SpecularSeparation separation = separateEvidence(c.scene, 0, FrameSource::Radiance, Settings{}, evidence);
    ASSERT_TRUE(separation.separated) << separation.reason;
    const double after = test::meanDistance(evidence.highlights[0].contour, c.blob.levelSet(0.5));
    EXPECT_LT(after, 0.1) << distorted;
    EXPECT_GT(before, 3 * after) << distorted;
    EXPECT_LT((evidence.highlights[0].peak - c.blob.centre).norm(), 0.1) << distorted;
    EXPECT_EQ(evidence.highlights[0].light, "light");
    ASSERT_TRUE(evidence.highlights[0].ellipse);
  }
}

TEST(PartEvidence, DegenerateFramesKeepTheirHighlightsAndSayWhy) {
  const Coloured grey(true, false);
  FrameEvidence evidence = grey.detected();
  ASSERT_EQ(evidence.highlights.size(), 1u);
  const std::vector<Pixel> before = evidence.highlights[0].contour.points;
  EXPECT_EQ(separateEvidence(grey.scene, 0, FrameSource::Radiance, Settings{}, evidence).reason, "the image is grey");
  EXPECT_EQ(evidence.highlights[0].contour.points, before);
  FrameEvidence none;
  EXPECT_EQ(separateEvidence(grey.scene, 0, FrameSource::Radiance, Settings{}, none).reason, "there is no highlight");
  evidence.highlights[0].fromScene = true;
  EXPECT_EQ(separateEvidence(grey.scene, 0, FrameSource::Radiance, Settings{}, evidence).reason,
            "the scene gives the highlights");
}

}  // namespace
}  // namespace glint::separated_evidence_tests
