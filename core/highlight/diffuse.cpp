// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/diffuse.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/base/numeric.h"
#include "core/highlight/frame_blur.h"

namespace glint {
namespace {

constexpr double kSmoothShare = 1.0 / 60;  // of the object's width: shading of a ball bends by 0.03 % over that
constexpr double kLeastSmoothPx = 2;       // below it noise alone remains
constexpr double kExceededBy = 0.8;        // a fifth of the pixels shows more
constexpr double kTopShare = 0.995;        // one pixel in 200 is brighter: hot pixels do not count
constexpr double kNoiseShare = 1.28;       // of its standard deviation, which a fifth of Gaussian noise exceeds
constexpr double kAboveNoise = 2;          // times what noise explains
constexpr double kWorthShare = 0.01;       // of the top: less moves a contour by less than half a percent of its radius
constexpr std::size_t kLeastToTell = 400;  // that tell structure from chance

}  // namespace

int takeOff(const DiffuseLight& under, Image& value, std::vector<char>& usable) {
  for (int y = 0; y < value.height; ++y)
    for (int x = 0; x < value.width; ++x) {
      const float diffuse = under.at(x, y);
      float& v = value.at(x, y);
      v = std::isfinite(diffuse) ? v - diffuse : 0.f;
      if (!std::isfinite(diffuse)) usable[static_cast<std::size_t>(y) * value.width + x] = 0;
    }
  return static_cast<int>(std::count_if(usable.begin(), usable.end(), [](char u) { return u != 0; }));
}

bool FineStructure::isTexture() const { return top > 0 && amount > kWorthShare * top; }

FineStructure fineStructure(const Image& image, const std::vector<char>& usable) {
  const std::size_t count = static_cast<std::size_t>(std::count_if(usable.begin(), usable.end(), [](char u) { return u != 0; }));
  if (count < kLeastToTell) return {};
  cv::Mat weight(image.height, image.width, CV_32F), value(image.height, image.width, CV_32F), smooth, share;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const bool on = usable[static_cast<std::size_t>(y) * image.width + x] != 0;
      weight.at<float>(y, x) = on ? 1.f : 0.f;
      value.at<float>(y, x) = on ? image.at(x, y) : 0.f;
    }
  const double sigma = std::max(kLeastSmoothPx, kSmoothShare * std::sqrt(static_cast<double>(count)));
  cv::GaussianBlur(value, smooth, {}, sigma);
  cv::GaussianBlur(weight, share, {}, sigma);
  std::vector<float> off, bright;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (weight.at<float>(y, x) == 0.f) continue;
      bright.push_back(value.at<float>(y, x));
      off.push_back(std::abs(value.at<float>(y, x) - smooth.at<float>(y, x) / share.at<float>(y, x)));
    }
  const auto rank = [](std::vector<float>& of, double at) {
    return static_cast<double>(ranked(of, static_cast<std::size_t>(at * static_cast<double>(of.size()))));
  };
  FineStructure found;
  found.top = rank(bright, kTopShare);
  const double seen = rank(off, kExceededBy), noise = kNoiseShare * pixelNoise(image, usable);
  found.amount = seen > kAboveNoise * noise ? std::sqrt(seen * seen - noise * noise) : 0;
  return found;
}

}  // namespace glint
