// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/base/quiet_libraries.h"

namespace glint::testing_support {

/// The grey value of picture i of a written video, 0 .. 250.
inline int greyOf(int i) { return i * 37 % 251; }

/// Writes a video of uniform grey pictures (greyOf). False if the encoder is missing.
inline bool writeVideo(const std::filesystem::path& file, const char (&codec)[5], int pictures, double perSecond, int width = 64,
                       int height = 48) {
  const QuietLibraries quiet;
  cv::VideoWriter writer(file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]),
                         perSecond, cv::Size(width, height));
  if (!writer.isOpened()) return false;
  for (int i = 0; i < pictures; ++i) writer.write(cv::Mat(height, width, CV_8UC3, cv::Scalar::all(greyOf(i))));
  return true;
}

}  // namespace glint::testing_support
