// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "core/scene/capture.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::testing_support {

/// A black image of this size (PGM), so that readers that need the size find it.
inline std::filesystem::path writeBlackImage(const TemporaryFolder& folder, const std::string& name, int width, int height) {
  return folder.write(name, "P5\n" + std::to_string(width) + " " + std::to_string(height) + "\n255\n" +
                                std::string(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), '\0'));
}

/// The view of this name; a test failure if it is missing.
inline const CaptureView& viewNamed(const Capture& capture, const std::string& name) {
  const auto found =
      std::find_if(capture.views.begin(), capture.views.end(), [&](const CaptureView& v) { return v.name == name; });
  if (found != capture.views.end()) return *found;
  ADD_FAILURE() << "no view " << name;
  static const CaptureView none;
  return none;
}

// A small COLMAP model of three images with exact projections, made for these tests. Its cameras (SIMPLE_RADIAL without
// distortion, the principal point at half of the size) and poses were turned into NVM and Bundler by `colmap model_converter` of
// COLMAP 3.8; the pixels are those of COLMAP's own definition, f x / z + w / 2, less the half pixel between its origin and ours.
struct SfmPixel {
  const char* image;
  int point;
  double x, y;
};
inline constexpr std::array<SfmPixel, 9> kSfmPixels{{{"b/second.pgm", 0, 40.312146472164336, 26.07219410538851},
                                                     {"b/second.pgm", 1, 23.581060015588463, 25.62003117692907},
                                                     {"b/second.pgm", 2, 39.285547785547784, 10.632867132867133},
                                                     {"a/first.pgm", 0, 17.90737704918033, 33.87371194379391},
                                                     {"a/first.pgm", 1, 8.521345029239763, 34.249415204678364},
                                                     {"a/first.pgm", 2, 23.355543933054392, 28.03702928870293},
                                                     {"c.pgm", 0, 42.84423443542677, 30.523040470613868},
                                                     {"c.pgm", 1, 27.292988622699102, 48.57908611599297},
                                                     {"c.pgm", 2, 31.844861258035642, 21.82370412564082}}};
inline const std::array<Eigen::Vector3d, 3> kSfmPoints{Eigen::Vector3d(0.5, 0.25, 0.125), Eigen::Vector3d(-0.75, 0.5, -0.25),
                                                       Eigen::Vector3d(0.25, -0.5, 0.5)};

inline void writeSfmImages(const TemporaryFolder& folder) {
  writeBlackImage(folder, "b/second.pgm", 64, 48);
  writeBlackImage(folder, "a/first.pgm", 41, 60);
  writeBlackImage(folder, "c.pgm", 64, 48);
}

/// Projections within 1e-6 px of COLMAP's own.
inline void expectSfmProjections(const Capture& capture) {
  ASSERT_EQ(capture.views.size(), 3u);
  for (const SfmPixel& expected : kSfmPixels) {
    const std::optional<Pixel> pixel = viewNamed(capture, expected.image).camera.project(kSfmPoints[std::size_t(expected.point)]);
    ASSERT_TRUE(pixel) << expected.image << " " << expected.point;
    EXPECT_NEAR(pixel->x(), expected.x, 1e-6) << expected.image << " " << expected.point;
    EXPECT_NEAR(pixel->y(), expected.y, 1e-6) << expected.image << " " << expected.point;
  }
}

/// Every point with every measurement; COLMAP writes these with 6 digits.
inline void expectSfmMeasurements(const Capture& capture, const std::vector<CaptureTrack>& tracks) {
  ASSERT_EQ(tracks.size(), kSfmPoints.size());
  std::size_t compared = 0;
  for (const CaptureTrack& track : tracks) {
    const auto point = std::find(kSfmPoints.begin(), kSfmPoints.end(), track.point);
    ASSERT_NE(point, kSfmPoints.end());
    EXPECT_EQ(track.seen.size(), 3u);
    for (const CaptureTrack::Observation& seen : track.seen)
      for (const SfmPixel& expected : kSfmPixels)
        if (capture.views.at(std::size_t(seen.view)).name == expected.image && point - kSfmPoints.begin() == expected.point) {
          EXPECT_NEAR(seen.measured.x(), expected.x, 1e-4) << expected.image << " " << expected.point;
          EXPECT_NEAR(seen.measured.y(), expected.y, 1e-4) << expected.image << " " << expected.point;
          ++compared;
        }
  }
  EXPECT_EQ(compared, kSfmPixels.size());
}

}  // namespace glint::testing_support
