// SPDX-License-Identifier: BSD-3-Clause
#include "viz/pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <thread>
#include <vector>

#include "core/draw/contrast.h"
#include "core/draw/frame_overlay.h"
#include "core/scene/scene.h"
#include "tests/viz/image_checks.h"
#include "tests/viz/small_inspection.h"
#include "viz/annotations.h"

namespace glint::viz {
namespace {

using test::isNear;
using test::smallInspection;
using test::TemporaryFolder;

/// Colour of texts about what failed, on the panel of dark pictures.
const Colour kFailedText = draw::readableOn({0.15, 0.16, 0.18}, kFailed);

int countOfColour(const Image& image, const Colour& colour, double tolerance = 0.08) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) count += isNear(image, x, y, colour, tolerance);
  }
  return count;
}

// `glint predict --out` draws its overlays in parallel; VTK's text tools have no lock of their own and crashed now and then.
TEST(Pictures, AreDrawnByManyThreadsAtOnce) {
  const test::TemporaryFolder folder;
  const auto inspection = test::smallInspection(folder.path());
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 12; ++i) framePicture(*inspection, i % 3, Failure{Reason::FrameUnreadable, "none"}, 320, 240);
    });
  for (std::thread& t : threads) t.join();
}

TEST(Canvas, ImagePixelsAndOverlayPointsShareOneGrid) {
  // A single white pixel at (5, 3), stretched 20 times: its square is [100, 120) x [60, 80), and pixel (5, 3) is its middle.
  Image image(12, 8, 3);
  for (int c = 0; c < 3; ++c) image.at(5, 3, c) = 1;
  Canvas canvas(240, 160, {0, 0, 0});
  const Crop whole{-0.5, -0.5, 12, 8};
  const Box box{0, 0, 240, 160};
  canvas.picture(image, whole, box);
  const Image before = canvas.image();
  double sx = 0, sy = 0, sum = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) {
      sum += before.at(x, y, 0);
      sx += (x + 0.5) * before.at(x, y, 0);
      sy += (y + 0.5) * before.at(x, y, 0);
    }
  }
  EXPECT_NEAR(sx / sum, 110, 0.1);
  EXPECT_NEAR(sy / sum, 70, 0.1);
  FrameOverlay overlay;
  OverlayMark mark;
  mark.at = {5, 3};
  mark.colour = {1, 0, 0};
  mark.halo = false;
  overlay.marks.push_back(mark);
  Canvas marked(240, 160, {0, 0, 0});
  paintOverlay(marked, overlay, whole, box, 1);
  const Image cross = marked.image();
  sum = sx = sy = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 240; ++x) {
      sum += cross.at(x, y, 0);
      sx += (x + 0.5) * cross.at(x, y, 0);
      sy += (y + 0.5) * cross.at(x, y, 0);
    }
  }
  EXPECT_NEAR(sx / sum, 110, 0.15);
  EXPECT_NEAR(sy / sum, 70, 0.15);
}

TEST(Canvas, TextStandsOnItsBaselineAndIsAligned) {
  const auto extent = [](Align align, bool vertical) {
    Canvas canvas(300, 300, {0, 0, 0});
    canvas.text({150, 150}, "EHE", 30, {1, 1, 1}, align, vertical);
    const Image image = canvas.image();
    Eigen::AlignedBox2i box;
    for (int y = 0; y < 300; ++y) {
      for (int x = 0; x < 300; ++x) {
        if (image.at(x, y, 0) > 0.5f) box.extend(Eigen::Vector2i(x, y));
      }
    }
    return box;
  };
  const Eigen::AlignedBox2i left = extent(Align::Left, false), centre = extent(Align::Centre, false),
                            right = extent(Align::Right, false);
  EXPECT_NEAR(left.max().y(), 149, 2);  // capitals end on the baseline
  EXPECT_NEAR(left.min().x(), 150, 6);
  EXPECT_NEAR(0.5 * (centre.min().x() + centre.max().x()), 150, 3);
  EXPECT_NEAR(right.max().x(), 150, 6);
  const Eigen::AlignedBox2i up = extent(Align::Centre, true);
  EXPECT_GT(up.sizes().y(), up.sizes().x());
  EXPECT_NEAR(0.5 * (up.min().y() + up.max().y()), 150, 4);
}

TEST(Canvas, LongTextIsShortenedByWholeCharacters) {
  const Canvas canvas(100, 100, {0, 0, 0});
  const std::string text = "\u03b1\u03b2\u03b3\u03b4\u03b5\u03b6\u03b7\u03b8";
  const std::string shorter = canvas.fitted(text, 20, 0.6 * canvas.textWidth(text, 20));
  ASSERT_GE(shorter.size(), 3u) << canvas.textWidth(text, 20) << " " << canvas.textWidth("\u03b1\u2026", 20);
  EXPECT_LT(shorter.size(), text.size());
  EXPECT_LE(canvas.textWidth(shorter, 20), 0.6 * canvas.textWidth(text, 20));
  EXPECT_EQ(shorter.substr(shorter.size() - 3), "\u2026");
  EXPECT_EQ((shorter.size() - 3) % 2, 0u);  // Greek letters have two bytes each
  EXPECT_EQ(canvas.fitted("ab", 20, 1000), "ab");
}

TEST(Canvas, WrapsAtBlanksAndLosesNothing) {
  const Canvas canvas(64, 64, {0, 0, 0});
  const std::string text = "not an ellipsoid: the quadric is a hyperboloid of two sheets";
  const std::vector<std::string> lines = canvas.wrapped(text, 12, 120);
  ASSERT_GT(lines.size(), 2u);
  std::string again;
  for (const std::string& line : lines) {
    EXPECT_LE(canvas.textWidth(line, 12), 120) << line;
    again += (again.empty() ? "" : " ") + line;
  }
  EXPECT_EQ(again, text);
  EXPECT_EQ(canvas.wrapped(text, 12, 1e4), std::vector<std::string>{text});
  EXPECT_EQ(canvas.wrapped("abc d", 12, 1).size(), 2u);  // a word is never broken
  EXPECT_TRUE(canvas.wrapped("", 12, 100).empty());
}

TEST(FramePicture, DrawsThePhotographAndTheModelsInTheirColours) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[0]);
  ASSERT_TRUE(photograph);
  const Image picture = framePicture(*inspection, 0, photograph, 900, 600);
  EXPECT_EQ(picture.width, 900);
  EXPECT_EQ(picture.height, 600);
  EXPECT_GT(countOfColour(picture, {1, 0, 0}), 5000);
  EXPECT_GT(countOfColour(picture, {0, 1, 0}), 5000);
  EXPECT_GT(countOfColour(picture, modelColour("canonical"), 0.1), 100);
  PictureOptions bare;
  bare.hidden = {OverlayRole::PredictedContour, OverlayRole::PredictedEllipse, OverlayRole::PredictedPeak,
                 OverlayRole::CanonicalEllipse};
  EXPECT_LT(countOfColour(framePicture(*inspection, 0, photograph, 900, 600, bare), modelColour("canonical"), 0.1),
            0.7 * countOfColour(picture, modelColour("canonical"), 0.1));
}

/// The contour that everything is compared with is in the legend: on a light page as a white swatch with an edge.
TEST(FramePicture, TheLegendNamesWhatWasObserved) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[0]);
  auto nothingSeen = std::make_shared<Inspection>(*inspection);
  nothingSeen->evidence[0].highlights.clear();
  const auto swatch = [&](const Inspection& of) {  // rows of the lower left corner that begin with a white swatch on dark
    const Image picture = framePicture(of, 0, photograph, 900, 600);
    int white = 0;
    for (int y = 450; y < 600; ++y) white += isNear(picture, 16, y, kObserved, 0.02);
    return white;
  };
  EXPECT_GT(swatch(*inspection), 3);
  EXPECT_EQ(swatch(*nothingSeen), 0);
}

TEST(FramePicture, AMissingPhotographIsSaidInItsPlace) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const Image picture = framePicture(*inspection, 0, Failure{Reason::FrameUnreadable, "x.png"}, 600, 400);
  EXPECT_GT(countOfColour(picture, kFailedText, 0.2), 30);
}

TEST(Pictures, EverySizeWorks) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[0]);
  for (const auto& [w, h] : {std::pair{16, 16}, std::pair{160, 900}, std::pair{1600, 100}, std::pair{640, 480}}) {
    EXPECT_EQ(framePicture(*inspection, 0, photograph, w, h).width, w);
    EXPECT_EQ(ladderPicture(*inspection, 0, photograph, w, h).height, h);
    EXPECT_EQ(plotsPicture(*inspection, w, h).width, w);
  }
  EXPECT_THROW(framePicture(*inspection, 0, photograph, 8, 100), std::invalid_argument);
  EXPECT_THROW(framePicture(*inspection, 9, photograph, 100, 100), std::invalid_argument);
}

TEST(LadderPicture, ShowsEachModelsPredictionOnlyInItsTile) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[0]);
  const Image both = ladderPicture(*inspection, 0, photograph, 900, 500);
  int left = 0, right = 0;  // dual refuses (left tile), canonical answers (right tile)
  for (int y = 60; y < 400; ++y) {
    for (int x = 0; x < 900; ++x) (x < 450 ? left : right) += isNear(both, x, y, modelColour("canonical"), 0.08);
  }
  EXPECT_EQ(left, 0);
  EXPECT_GT(right, 200);
}

/// Lines of text below the tile of a model that refuses: bands of rows that hold the colour of failures.
TEST(LadderPicture, AReasonIsWholeInSeveralLines) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[0]);
  const auto lines = [&](const std::string& detail) {
    for (FrameComparison& c : inspection->models.at("dual").frames) {
      c.prediction = Failure{Reason::NotAnEllipsoid, detail};
      c.rows[0].failure = *c.prediction.failure();
    }
    const Image picture = ladderPicture(*inspection, 0, photograph, 400, 400);
    int bands = 0, before = 0;
    for (int y = 0; y < picture.height; ++y) {
      int red = 0;
      for (int x = 0; x < picture.width; ++x) red += isNear(picture, x, y, kFailedText, 0.12);
      bands += red > 0 && before == 0;
      before = red;
    }
    return bands;
  };
  const int few = lines("short");
  EXPECT_GE(lines("a hyperboloid of two sheets whose axes are far larger than the scene that it was fitted to"), few + 2);
}

TEST(PlotsPicture, ALargerErrorIsDrawnHigher) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  for (int i = 0; i < 6; ++i)
    inspection->models["canonical"].frames[static_cast<std::size_t>(i)].rows[0].metrics->contourErrorPct = 1.0 + i;
  const Image picture = plotsPicture(*inspection, 900, 600);
  // Mean height of the line's pixels about the first and the last frame.
  const auto height = [&](int from, int to) {
    double sum = 0, rows = 0;
    for (int x = from; x < to; ++x) {
      for (int y = 60; y < 540; ++y) {
        if (isNear(picture, x, y, modelColour("canonical"), 0.06)) {
          sum += 600 - y;
          rows += 1;
        }
      }
    }
    return rows > 0 ? sum / rows : -1.0;
  };
  ASSERT_GT(height(60, 200), 0);
  EXPECT_GT(height(760, 890), height(60, 200) + 100);
}

TEST(PlotsPicture, SaysSoWhenThereIsNothingToPlot) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());
  inspection->models.erase("canonical");
  const auto words = [&] { return countOfColour(plotsPicture(*inspection, 600, 400), {0.64, 0.66, 0.68}, 0.1); };
  const int without = words();
  EXPECT_GT(without, 60) << "a sentence in the middle";
}

TEST(WritePng, IsReadBackAndRefusesAFolderThatIsNotThere) {
  const TemporaryFolder folder;
  const auto inspection = smallInspection(folder.path());  // writes its photograph through writePng
  const Outcome<Image> photograph = readPhotograph(inspection->scene->frames[0]);
  ASSERT_TRUE(photograph);
  EXPECT_TRUE(isNear(*photograph, 10, 10, {1, 0, 0}, 1e-3));
  EXPECT_TRUE(isNear(*photograph, 300, 10, {0, 1, 0}, 1e-3));
  EXPECT_TRUE(isNear(*photograph, 10, 230, {0, 0, 1}, 1e-3));
  EXPECT_TRUE(isNear(*photograph, 300, 230, {1, 1, 1}, 1e-3));
  EXPECT_THROW(writePng(*photograph, (folder.path() / "none" / "a.png").string()), InputError);
}

TEST(Annotations, LengthsAreRoundAndReadable) {
  EXPECT_DOUBLE_EQ(roundLength(0.7), 0.5);
  EXPECT_DOUBLE_EQ(roundLength(0.2), 0.2);
  EXPECT_DOUBLE_EQ(roundLength(999), 500);
  EXPECT_EQ(lengthText(0.5), "50 cm");
  EXPECT_EQ(lengthText(2), "2 m");
  EXPECT_EQ(lengthText(5000), "5 km");
  EXPECT_EQ(lengthText(0.002), "2 mm");
}

}  // namespace
}  // namespace glint::viz
