// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/bytes.h"
#include "core/codecs/codecs.h"
#include "core/pipeline/photograph.h"
#include "core/report/share_parts.h"

namespace glint::share {
namespace {

constexpr std::size_t kAllPhotographs =
    9 << 20;  ///< bytes: 12 MB of a page in base64, which leaves room for everything else below 20 MB
constexpr int kWidest = 1280, kNarrowest = 96;  ///< px
constexpr int kQuality = 88;                    ///< of JPEG: edges of highlights stay clean

cv::Mat toBytes(const Image& image) {
  cv::Mat out(image.height, image.width, CV_8UC3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int k = 0; k < 3; ++k) {
        const double value = image.at(x, y, std::min(k, image.channels - 1));
        out.at<cv::Vec3b>(y, x)[2 - k] = cv::saturate_cast<unsigned char>(std::isfinite(value) ? 255 * value : 0);
      }
  return out;
}

/// At most `most` bytes, unless that were too small to see.
std::vector<unsigned char> jpegOf(const cv::Mat& picture, std::size_t most) {
  double width = std::min(kWidest, picture.cols);
  for (;;) {
    cv::Mat scaled = picture;
    const int columns = std::max(1, static_cast<int>(width));
    const int rows = std::max(1, static_cast<int>(std::lround(static_cast<double>(picture.rows) * columns / picture.cols)));
    if (columns < picture.cols) cv::resize(picture, scaled, {columns, rows}, 0, 0, cv::INTER_AREA);
    std::vector<unsigned char> bytes;
    encodeWithOpenCv(".jpg", scaled, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
    if (bytes.size() <= most || width <= kNarrowest) return bytes;
    width = std::max<double>(kNarrowest,
                             width * std::min(0.9, std::sqrt(static_cast<double>(most) / static_cast<double>(bytes.size()))));
  }
}

}  // namespace

std::vector<std::string> photographsOf(const Inspection& inspection, const std::vector<int>& frames, const ProgressFn& progress) {
  std::vector<std::string> all;
  const std::size_t most = kAllPhotographs / std::max<std::size_t>(1, frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!report(progress, {"photograph", static_cast<int>(i), static_cast<int>(frames.size())})) throw Stopped{};
    all.emplace_back();
    if (!hasPhotograph(inspection, frames[i])) continue;
    if (const Outcome<Image> photograph = photographOf(inspection, frames[i]))
      all.back() = "data:image/jpeg;base64," + base64(jpegOf(toBytes(*photograph), most));
  }
  return all;
}

}  // namespace glint::share
