// SPDX-License-Identifier: BSD-3-Clause
// Movies are read back with a decoder: number, size, order and colours of their frames.
#include "viz/movie.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/outcome.h"

namespace glint::viz {
namespace {

namespace fs = std::filesystem;

fs::path emptyFolder(const std::string& name) {
  std::string pattern = (fs::path(testing::TempDir()) / "glint-XXXXXX").string();  // tests run beside each other
  const fs::path folder = fs::path(mkdtemp(pattern.data())) / name;
  fs::create_directories(folder);
  return folder;
}

int files(const fs::path& folder) { return int(std::distance(fs::directory_iterator(folder), fs::directory_iterator())); }

/// Red grows from frame to frame; the right half is green.
Image picture(int i) {
  Image p(64, 48, 3);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      p.at(x, y, 0) = 0.1f * float(i);
      p.at(x, y, 1) = x < 32 ? 0.f : 0.8f;
    }
  return p;
}

class MovieFile : public testing::TestWithParam<const char*> {};

TEST_P(MovieFile, HoldsTheFramesInOrder) {
  const fs::path folder = emptyFolder("movies"), file = folder / (std::string("a movie") + GetParam());
  writeMovie(file.string(), {64, 48, 12.5}, 9, picture);
  EXPECT_EQ(files(folder), 1);
  cv::VideoCapture movie(file.string());
  ASSERT_TRUE(movie.isOpened());
  EXPECT_NEAR(movie.get(cv::CAP_PROP_FPS), 12.5, 0.01);
  cv::Mat frame;
  int n = 0;
  while (movie.read(frame)) {
    ASSERT_EQ(frame.cols, 64);
    ASSERT_EQ(frame.rows, 48);
    const cv::Vec3b left = frame.at<cv::Vec3b>(24, 10), right = frame.at<cv::Vec3b>(24, 54);
    EXPECT_NEAR(left[2], 25.5 * n, 14) << n;  // red last; codecs round
    EXPECT_NEAR(left[1], 0, 14) << n;
    EXPECT_NEAR(right[1], 204, 14) << n;
    ++n;
  }
  EXPECT_EQ(n, 9);
}

INSTANTIATE_TEST_SUITE_P(Endings, MovieFile, testing::Values(".mp4", ".webm", ".avi", ".mkv"));

TEST(WriteMovie, ASeriesOfPictures) {
  const fs::path folder = emptyFolder("series");
  writeMovie((folder / "turn.png").string(), {64, 48, 25}, 3, picture);
  EXPECT_EQ(files(folder), 3);
  for (int i = 0; i < 3; ++i) {
    const cv::Mat one = cv::imread((folder / ("turn_000" + std::to_string(i) + ".png")).string());
    ASSERT_FALSE(one.empty());
    EXPECT_NEAR(one.at<cv::Vec3b>(0, 0)[2], 25.5 * i, 1);
  }
}

TEST(WriteMovie, StoppedLeavesNothing) {
  for (const char* name : {"m.mp4", "m.png"}) {
    const fs::path folder = emptyFolder("stopped");
    int asked = 0;
    EXPECT_THROW(writeMovie((folder / name).string(), {64, 48, 25}, 9, picture, [&](const StageEvent&) { return ++asked < 5; }),
                 Stopped);
    EXPECT_EQ(files(folder), 0) << name;
  }
}

TEST(WriteMovie, RefusesWhatItCannotWrite) {
  const fs::path folder = emptyFolder("refused");
  EXPECT_THROW(writeMovie((folder / "m.gif").string(), {64, 48, 25}, 2, picture), InputError);
  EXPECT_THROW(writeMovie((folder / "m.mp4").string(), {63, 48, 25}, 2, picture), InputError);
  EXPECT_THROW(writeMovie((folder / "none" / "m.mp4").string(), {64, 48, 25}, 2, picture), InputError);
  EXPECT_THROW(writeMovie((folder / "m.mp4").string(), {64, 50, 25}, 2, picture), std::invalid_argument);
  EXPECT_EQ(files(folder), 0);
}

TEST(Turntable, KeepsDistanceAndHeightAndClosesTheCircle) {
  const ViewPoint start{{3, 0, 1}, {1, 0, 0}, {0, 0, 1}, 40, false};
  const std::vector<ViewPoint> views = turntable(start, {0, 0, 2}, 8);
  ASSERT_EQ(views.size(), 8u);
  EXPECT_TRUE(views[0].position.isApprox(start.position));
  EXPECT_TRUE(views[2].position.isApprox(Eigen::Vector3d(1, 2, 1)))
      << views[2].position.transpose();  // a quarter, about (1, 0, .)
  EXPECT_TRUE(views[4].position.isApprox(Eigen::Vector3d(-1, 0, 1)));
  for (const ViewPoint& v : views) {
    EXPECT_NEAR((v.position - v.focalPoint).norm(), std::sqrt(5.0), 1e-12);
    EXPECT_TRUE(v.up.isApprox(Eigen::Vector3d::UnitZ()));
    EXPECT_EQ(v.viewAngleDeg, 40);
  }
  EXPECT_THROW(turntable(start, {0, 0, 0}, 8), std::invalid_argument);
}

/// A view from aslant keeps its horizon: its up turns with it.
TEST(Turntable, UpTurnsWithTheView) {
  const ViewPoint start{{3, 0, 3}, {0, 0, 0}, Eigen::Vector3d(-1, 0, 1).normalized(), 40, false};
  const std::vector<ViewPoint> views = turntable(start, {0, 0, 1}, 4);
  const Eigen::Vector3d outwards[] = {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(views[i].position.isApprox(3 * (outwards[i] + Eigen::Vector3d::UnitZ()))) << i;
    EXPECT_TRUE(views[i].up.isApprox((Eigen::Vector3d::UnitZ() - outwards[i]).normalized())) << i;
  }
}

}  // namespace
}  // namespace glint::viz
