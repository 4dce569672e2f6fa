// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/level_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/core/highlight/highlight_images.h"
#include "tests/core/scene/scene_fixture.h"

/// Sequences whose best level is known by construction: which contours are stable follows from where the image has a plateau.
namespace glint::level_choice_tests {
namespace {

using namespace testing_support;

constexpr int kWidth = 200, kHeight = 160;

/// Frames with this radiance; the blobs move from frame to frame.
Scene sequence(const TemporaryFolder& folder, int frames, const std::function<double(const Pixel&)>& value, double noise = 0) {
  Scene scene;
  scene.folder = folder.path();
  for (int f = 0; f < frames; ++f) {
    Image image = test::drawn(kWidth, kHeight, [&](const Pixel& p) { return value(p - Pixel(2.0 * f, f)); });
    if (noise > 0) test::addNoise(image, noise, 11U + static_cast<unsigned>(f));
    cv::Mat m(kHeight, kWidth, CV_32F, image.data.data());
    Frame frame;
    frame.id = std::to_string(f);
    frame.radiance = folder.path() / (frame.id + ".tiff");
    frame.camera.width = kWidth;
    frame.camera.height = kHeight;
    EXPECT_TRUE(cv::imwrite(frame.radiance.string(), m, {cv::IMWRITE_TIFF_COMPRESSION, 1}));
    scene.frames.push_back(frame);
  }
  return scene;
}

std::vector<int> all(const Scene& scene) {
  std::vector<int> frames;
  for (int f = 0; f < static_cast<int>(scene.frames.size()); ++f) frames.push_back(f);
  return frames;
}

Outcome<LevelChoice> chosen(const Scene& scene) {
  Settings settings;
  return chooseLevel(scene, all(scene), FrameSource::Radiance, settings);
}

double lobe(const Pixel& p) { return 2 * std::exp(-((p - Pixel(90, 75)) / 25).squaredNorm()); }

/// A lobe on a wide plateau of half its height: at 0.5 the contour jumps from the lobe to the plateau's edge, at 0.4 it does not.
double lobeOnPlateau(const Pixel& p) {
  const double r = (p - Pixel(90, 75)).norm();
  return std::max(2 * std::exp(-r * r / (12 * 12)), 1 / (1 + std::exp((r - 45) / 0.8)));
}

TEST(ChooseLevel, NominalALobeIsStableAtTheDefault) {
  const TemporaryFolder folder;
  const Outcome<LevelChoice> choice = chosen(sequence(folder, 9, lobe));
  ASSERT_TRUE(choice) << choice.failure().message();
  EXPECT_EQ(choice->level, 0.5);
  EXPECT_EQ(choice->looked, 6);
  EXPECT_EQ(choice->stable, 6);
  EXPECT_NE(choice->reason.find("stable in 6 of 6 frames"), std::string::npos) << choice->reason;
}

/// The long tail of GGX changes more with the level than a Gaussian lobe does.
TEST(ChooseLevel, NominalALongTailIsStableToo) {
  const TemporaryFolder folder;
  const Outcome<LevelChoice> choice = chosen(sequence(folder, 2, [](const Pixel& p) {
    const double r2 = ((p - Pixel(90, 75)) / 14).squaredNorm();
    return std::pow(1 + (std::sqrt(2.0) - 1) * r2, -2);
  }));
  ASSERT_TRUE(choice) << choice.failure().message();
  EXPECT_EQ(choice->level, 0.5);
  EXPECT_EQ(choice->stable, 2) << choice->reason;
}

TEST(ChooseLevel, NominalAPlateauAtTheDefaultIsAvoided) {
  const TemporaryFolder folder;
  const Outcome<LevelChoice> choice = chosen(sequence(folder, 3, lobeOnPlateau));
  ASSERT_TRUE(choice) << choice.failure().message();
  EXPECT_EQ(choice->level, 0.4) << choice->reason;
}

TEST(ChooseLevel, ScaleOfTheRadianceChangesNothing) {
  for (const double scale : {1e-5, 1e4}) {
    const TemporaryFolder folder;
    const Outcome<LevelChoice> choice = chosen(sequence(folder, 2, [&](const Pixel& p) { return scale * lobeOnPlateau(p); }));
    ASSERT_TRUE(choice) << choice.failure().message();
    EXPECT_EQ(choice->level, 0.4) << scale;
  }
}

TEST(ChooseLevel, NoiseThatNoLevelStandsOutOfIsSaid) {
  const TemporaryFolder folder;
  const Outcome<LevelChoice> choice = chosen(sequence(folder, 2, lobe, 0.25));
  ASSERT_TRUE(choice) << choice.failure().message();
  EXPECT_LT(choice->stable, choice->looked);
  EXPECT_NE(choice->reason.find("at no level tried"), std::string::npos) << choice->reason;
}

TEST(ChooseLevel, DegenerateWithoutHighlightsOrWithGivenOnes) {
  const TemporaryFolder folder;
  Scene flat = sequence(folder, 2, [](const Pixel&) { return 0.5; });
  const Outcome<LevelChoice> none = chosen(flat);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.failure().reason, Reason::NoHighlight);
  Highlight given;
  given.level = 0.3;
  flat.frames[1].highlights.push_back(given);
  const Outcome<LevelChoice> choice = chosen(flat);
  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->level, 0.3);
  EXPECT_NE(choice->reason.find("the scene gives"), std::string::npos);
}

}  // namespace
}  // namespace glint::level_choice_tests
