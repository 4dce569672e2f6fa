// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/iso_contour.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr double kBorderPx = 1e-3;  // far below what a contour is known to, far above the single precision of its points

/// Marching squares over the image with a frame of one pixel around it that is far below the level: a contour that the border
/// cuts then closes itself through the centres of the border pixels, to 1e-7 px. Row by row, without a second copy of the image.
class MarchingSquares {
 public:
  MarchingSquares(const Image& image, double level) : image_(image), level_(level) {
    float lowest = image.data.front(), highest = lowest;
    for (const float v : image.data) {
      require(std::isfinite(v), "isoContours: values must be finite");
      lowest = std::min(lowest, v);
      highest = std::max(highest, v);
    }
    // 1e7 times the range: the crossing then lies 1e-7 px from the border pixel's centre; + 1e-300 for an image of one value.
    outside_ = level - 1e7 * (std::max<double>(highest, level) - std::min<double>(lowest, level) + 1e-300);
    Row low, high;
    read(-1, low);
    for (int y = -1; y < image.height; ++y) {
      read(y + 1, high);
      joinCells(low, high);
      std::swap(low, high);
    }
  }

  /// The contours as chains of points, with what is above the level on the same side all along.
  std::vector<std::vector<Pixel>> chains() const {
    std::vector<std::vector<Pixel>> result;
    std::vector<char> seen(points_.size(), 0);
    for (std::size_t start = 0; start < points_.size(); ++start) {
      if (seen[start]) continue;
      std::vector<Pixel> chain;
      for (std::size_t at = start; !seen[at]; at = static_cast<std::size_t>(next_[at])) {
        seen[at] = 1;
        chain.push_back(points_[at]);
      }
      result.push_back(std::move(chain));
    }
    return result;
  }

 private:
  /// A row of the image with its frame, x = -1 to the image's width.
  struct Row {
    int y = 0;
    std::vector<double> values;
    std::vector<char> in;        ///< at or above the level
    std::vector<int> along, up;  ///< the crossings to the right and to the next row, where there are any
  };

  void read(int y, Row& row) {
    const std::size_t n = static_cast<std::size_t>(image_.width) + 2;
    row.y = y;
    row.values.assign(n, outside_);
    if (y >= 0 && y < image_.height)
      std::copy_n(image_.data.begin() + static_cast<std::ptrdiff_t>(y) * image_.width, image_.width, row.values.begin() + 1);
    row.in.resize(n);
    for (std::size_t i = 0; i < n; ++i) row.in[i] = row.values[i] >= level_;
    row.along.resize(n);
    row.up.resize(n);
  }

  /// The point between two neighbours at which the level is crossed.
  int crossing(double a, double b, const Pixel& at, const Pixel& step) {
    // In single precision, from the corner of the frame: as VTK's flying edges gave them, to the last bit.
    const Pixel fromCorner = at + Pixel(1, 1) + (level_ - a) / (b - a) * step;
    points_.push_back((fromCorner.cast<float>() - Eigen::Vector2f(1, 1)).cast<double>());
    next_.push_back(-1);
    return static_cast<int>(points_.size()) - 1;
  }

  void joinCells(Row& low, Row& high) {
    const std::size_t n = low.values.size();
    for (std::size_t i = 0; i < n; ++i)
      if (low.in[i] != high.in[i]) low.up[i] = crossing(low.values[i], high.values[i], Pixel(double(i) - 1, low.y), Pixel(0, 1));
    for (std::size_t i = 0; i + 1 < n; ++i)
      if (high.in[i] != high.in[i + 1])
        high.along[i] = crossing(high.values[i], high.values[i + 1], Pixel(double(i) - 1, high.y), Pixel(1, 0));
    for (std::size_t i = 0; i + 1 < n; ++i) {
      // The corners in the order of a walk around the cell, and the crossings between each and the next.
      const std::array<char, 4> in{low.in[i], low.in[i + 1], high.in[i + 1], high.in[i]};
      if (in[0] == in[1] && in[0] == in[2] && in[0] == in[3]) continue;
      const std::array<int, 4> edge{low.along[i], low.up[i + 1], high.along[i], low.up[i]};
      // From where the walk leaves what is inside to where it entered it. At a saddle this parts the two corners that are inside.
      for (std::size_t leave = 0; leave < 4; ++leave) {
        if (!in[leave] || in[(leave + 1) % 4]) continue;
        std::size_t enter = (leave + 3) % 4;
        while (in[enter]) enter = (enter + 3) % 4;
        next_[static_cast<std::size_t>(edge[leave])] = edge[enter];
      }
    }
  }

  const Image& image_;
  double level_, outside_ = 0;
  std::vector<Pixel> points_;
  std::vector<int> next_;  ///< of each point: it starts a line in one of its two cells, and ends one in the other
};

}  // namespace

std::vector<IsoContour> isoContours(const Image& image, double level) {
  require(image.channels == 1 && !image.empty(), "isoContours: one channel, not empty");
  require(std::isfinite(level), "isoContours: level must be finite");
  std::vector<IsoContour> contours;
  for (const std::vector<Pixel>& chain : MarchingSquares(image, level).chains()) {
    IsoContour contour;
    contour.line.points.reserve(chain.size());
    for (const Pixel& raw : chain) {
      const Pixel inside(std::clamp(raw.x(), 0.0, image.width - 1.0), std::clamp(raw.y(), 0.0, image.height - 1.0));
      contour.touchesBorder = contour.touchesBorder || inside.x() < kBorderPx || inside.y() < kBorderPx ||
                              inside.x() > image.width - 1 - kBorderPx || inside.y() > image.height - 1 - kBorderPx;
      contour.line.points.push_back(inside);
    }
    contour.line = withoutRepeats(contour.line);
    if (contour.line.points.size() < 3) continue;
    contours.push_back(std::move(contour));
  }
  std::stable_sort(contours.begin(), contours.end(), [](const IsoContour& a, const IsoContour& b) {
    return std::abs(signedArea(a.line)) > std::abs(signedArea(b.line));
  });
  return contours;
}

}  // namespace glint
