// SPDX-License-Identifier: BSD-3-Clause
#include "tests/viz/perceptual.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace glint::test {
namespace {

cv::Mat toLab(const Image& image) {
  const cv::Mat rgb(image.height, image.width, CV_32FC3, const_cast<float*>(image.data.data()));
  cv::Mat blurred, lab;
  cv::GaussianBlur(rgb, blurred, {}, kBlurPx);
  cv::cvtColor(blurred, lab, cv::COLOR_RGB2Lab);
  return lab;
}

/// Whether the colour is found at the pixel or beside it.
bool hasNear(const cv::Mat& lab, const cv::Vec3f& colour, int x, int y) {
  constexpr float kSquared = float(kSeenDeltaE * kSeenDeltaE);
  for (int v = std::max(0, y - 1); v <= std::min(lab.rows - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(lab.cols - 1, x + 1); ++u) {
      const cv::Vec3f d = lab.at<cv::Vec3f>(v, u) - colour;
      if (d.dot(d) <= kSquared) return true;
    }
  return false;
}

std::string fileOf(const std::string& name) { return GLINT_SOURCE_DIR "/tests/viz/pictures/" + name + ".png"; }

}  // namespace

double seenShare(const Image& a, const Image& b, const std::vector<draw::Box>& masked) {
  if (a.width != b.width || a.height != b.height || a.channels != 3 || b.channels != 3) return 1;
  cv::Mat compared(a.height, a.width, CV_8U, cv::Scalar(1));
  for (const draw::Box& box : masked) {
    const cv::Rect rect(int(box.x), int(box.y), int(std::ceil(box.width)), int(std::ceil(box.height)));
    compared(rect & cv::Rect(0, 0, a.width, a.height)).setTo(0);
  }
  const cv::Mat labA = toLab(a), labB = toLab(b);
  int seen = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      seen += compared.at<unsigned char>(y, x) &&
              (!hasNear(labB, labA.at<cv::Vec3f>(y, x), x, y) || !hasNear(labA, labB.at<cv::Vec3f>(y, x), x, y));
  return double(seen) / cv::countNonZero(compared);
}

Image storedPicture(const std::string& name) {
  const std::string file = fileOf(name);
  const cv::Mat bgr = cv::imread(file, cv::IMREAD_COLOR);
  EXPECT_FALSE(bgr.empty()) << file;
  Image image(bgr.cols, bgr.rows, 3);
  for (int y = 0; y < bgr.rows; ++y)
    for (int x = 0; x < bgr.cols; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = float(bgr.at<cv::Vec3b>(y, x)[2 - c]) / 255.f;
  return image;
}

void storePicture(const std::string& name, const Image& now) {
  if (std::getenv("GLINT_STORE_PICTURES")) viz::writePng(now, fileOf(name));
}

}  // namespace glint::test
