// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/frame_blur.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "core/base/numeric.h"
#include "core/geometry/camera.h"

namespace glint {

namespace {

constexpr int kDirections = 8;          // of edges, over half a turn
constexpr int kLeastDirections = 4;     // one more than the coefficients
constexpr std::size_t kLeastEdges = 8;  // in a direction: their lower quartile is then a second of them
constexpr double kQuartile = 0.25;      // of the variances of one direction
constexpr double kLeastStep = 20;       // in standard deviations of the noise: the variance is then right to a few tenths
constexpr double kLeastContrast = 0.1;  // of the sum of both sides: less is texture or shading
constexpr double kFlat = 0.06;          // of the step: what both ends of a profile may still change
constexpr double kWithin = 0.75;        // of the step: that the middle half of a profile holds; of a ramp it holds a half
constexpr double kOvershoot = 0.1;      // of the step: more is a line or a sharpened edge
constexpr double kStepPx = 0.5;         // between the samples of a profile
constexpr std::array kReaches{4.0, 7.0, 12.0, 20.0};   // px: the shortest that ends on flat sides counts
constexpr double kEndPx = 1.5;                         // of a profile: its flat ends
constexpr double kSharpVariance = 1.0 / 6 + 1.0 / 12;  // px^2: of linear interpolation and of a pixel's square
constexpr int kGridPx = 3;                             // edges nearer to each other share their pixels
constexpr double kLeastMotionPx = 1.0;                 // less cannot be told from an anisotropic edge of pixels
constexpr double kSure =
    4;  // times what the fit over the directions leaves: content that is soft in one direction looks like motion, but no cosine
constexpr int kMotionDirections = 6;  // with edges enough, before motion is told from content

struct EdgeImage {
  Image grey;
  std::vector<char> bad;  ///< clipped or not finite
  double noise = 0;

  std::optional<double> at(const Pixel& p) const {
    if (!(p.x() >= 0 && p.y() >= 0 && p.x() < grey.width - 1 && p.y() < grey.height - 1)) return std::nullopt;
    const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
    const std::size_t i = static_cast<std::size_t>(y) * grey.width + x, next = i + static_cast<std::size_t>(grey.width);
    if (bad[i] || bad[i + 1] || bad[next] || bad[next + 1]) return std::nullopt;
    const double a = p.x() - x, b = p.y() - y;
    return (1 - b) * ((1 - a) * grey.at(x, y) + a * grey.at(x + 1, y)) +
           b * ((1 - a) * grey.at(x, y + 1) + a * grey.at(x + 1, y + 1));
  }
};

EdgeImage edgeImageOf(const Image& image, double clipValue) {
  EdgeImage e{Image(image.width, image.height, 1), std::vector<char>(static_cast<std::size_t>(image.width) * image.height, 0), 0};
  for (std::size_t i = 0; i < e.bad.size(); ++i) {
    double sum = 0;
    for (int c = 0; c < image.channels; ++c) {
      const float v = image.data[i * static_cast<std::size_t>(image.channels) + static_cast<std::size_t>(c)];
      if (!std::isfinite(v) || (clipValue > 0 && v >= clipValue)) e.bad[i] = 1;
      sum += v;
    }
    if (!e.bad[i]) e.grey.data[i] = static_cast<float>(sum / image.channels);
  }
  std::vector<char> usable(e.bad.size());
  for (std::size_t i = 0; i < usable.size(); ++i) usable[i] = !e.bad[i];
  e.noise = pixelNoise(e.grey, usable);
  return e;
}

Eigen::Vector2d gradientAt(const Image& v, int x, int y) {  // Scharr
  const auto side = [&](int dx, int dy, int ex, int ey) { return double(v.at(x + dx, y + dy)) - v.at(x + ex, y + ey); };
  return Eigen::Vector2d(3 * side(1, -1, -1, -1) + 10 * side(1, 0, -1, 0) + 3 * side(1, 1, -1, 1),
                         3 * side(-1, 1, -1, -1) + 10 * side(0, 1, 0, -1) + 3 * side(1, 1, 1, -1)) /
         32;
}

/// Variance of a profile's derivative, px^2; nothing if it is no step between two flat sides.
std::optional<double> variance(const EdgeImage& e, const Pixel& centre, const Eigen::Vector2d& along, double reach) {
  const int n = static_cast<int>(reach / kStepPx);
  const std::size_t m = 2 * static_cast<std::size_t>(n) + 1, ends = static_cast<std::size_t>(kEndPx / kStepPx) + 1;
  std::array<double, 2 * static_cast<std::size_t>(kReaches.back() / kStepPx) + 1> values;
  const auto fill = [&](std::size_t from, std::size_t to) {
    for (std::size_t k = from; k < to; ++k) {
      const std::optional<double> v = e.at(centre + (static_cast<double>(k) - n) * kStepPx * along);
      if (!v) return false;
      values[k] = *v;
    }
    return true;
  };
  const auto mean = [&](std::size_t from, std::size_t to) {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += values[k] / static_cast<double>(to - from);
    return sum;
  };
  // The ends first: nearly all places fail there, and a frame has hundreds of thousands.
  if (!fill(0, ends) || !fill(m - ends, m)) return std::nullopt;
  const double low = mean(0, ends), high = mean(m - ends, m), step = high - low;
  if (!(step > kLeastStep * e.noise) || !(step > kLeastContrast * (high + low)) || !(step > 0)) return std::nullopt;
  if (!fill(ends, m - ends)) return std::nullopt;
  const double lowInner = mean(ends, 2 * ends), highInner = mean(m - 2 * ends, m - ends);
  if (std::abs(lowInner - low) > kFlat * step || std::abs(highInner - high) > kFlat * step) return std::nullopt;
  if (values[m - 1 - m / 4] - values[m / 4] < kWithin * step) return std::nullopt;
  // With F from 0 to 1: mean and second moment of dF, by parts, so that no noise is differentiated.
  double first = 0, second = 0;
  for (std::size_t k = 0; k < m; ++k) {
    const double f = (values[k] - low) / step, t = (static_cast<double>(k) - n) * kStepPx;
    if (f < -kOvershoot || f > 1 + kOvershoot) return std::nullopt;
    const double jump = f - (t > 0 ? 1.0 : t == 0 ? 0.5 : 0.0);  // against a sharp step at t = 0
    first -= jump * kStepPx;
    second -= 2 * t * jump * kStepPx;
  }
  return std::max(0.0, second - first * first - kSharpVariance);
}

std::optional<double> edgeVariance(const EdgeImage& e, const Pixel& centre, const Eigen::Vector2d& along) {
  for (const double reach : kReaches)
    if (const std::optional<double> v = variance(e, centre, along, reach)) return v;
  return std::nullopt;
}

}  // namespace

double FrameBlur::varianceAlong(double rad) const {
  const double part = motionPx * std::cos(rad - directionRad);
  return sigmaPx * sigmaPx + part * part / 12;
}

Outcome<FrameBlur> measureBlur(const Image& image, double clipValue) {
  require(image.channels == 1 || image.channels == 3, "measureBlur: 1 or 3 channels");
  if (image.width < 8 || image.height < 8) return Failure{Reason::TooFewPoints, "the image is too small for edges"};
  const EdgeImage e = edgeImageOf(image, clipValue);
  std::array<std::vector<double>, kDirections> found;
  FrameBlur blur;
  for (int y = 2; y + 2 < image.height; ++y)
    for (int x = 2; x + 2 < image.width; ++x) {
      const Eigen::Vector2d g = gradientAt(e.grey, x, y);
      const double size = g.norm();
      if (!(size > e.noise) || !(size > 0)) continue;
      const Eigen::Vector2d along = g / size;
      const int dx = static_cast<int>(std::lround(along.x())), dy = static_cast<int>(std::lround(along.y()));
      // The steepest place across the edge, and of neighbours along it a few.
      if (gradientAt(e.grey, x + dx, y + dy).norm() > size || gradientAt(e.grey, x - dx, y - dy).norm() >= size) continue;
      if ((std::abs(along.x()) > std::abs(along.y()) ? y : x) % kGridPx != 0) continue;
      const std::optional<double> v = edgeVariance(e, Pixel(x, y), along);
      if (!v) continue;
      const double turn = std::atan2(along.y(), along.x()) + M_PI;
      const int bin = static_cast<int>(std::lround(turn / M_PI * kDirections)) % kDirections;
      found[static_cast<std::size_t>(bin)].push_back(*v);
      ++blur.edges;
    }
  Eigen::Matrix<double, kDirections, 3> rows;
  Eigen::Matrix<double, kDirections, 1> right;
  int used = 0;
  for (int k = 0; k < kDirections; ++k) {
    std::vector<double>& v = found[static_cast<std::size_t>(k)];
    if (v.size() < kLeastEdges) continue;
    const double rad = M_PI * k / kDirections;
    rows.row(used) << 1, std::cos(2 * rad), std::sin(2 * rad);
    right[used++] = ranked(v, static_cast<std::size_t>(kQuartile * static_cast<double>(v.size())));
  }
  if (used < kLeastDirections)
    return Failure{Reason::TooFewPoints, "only " + std::to_string(used) + " of 8 directions have sharp edges enough"};
  const auto a = rows.topRows(used);
  const Eigen::Vector3d c = a.colPivHouseholderQr().solve(right.head(used));
  if (!c.allFinite()) return Failure{Reason::NotFinite, "the edges' widths have no fit"};
  const double turned = c.tail<2>().norm();
  const double error = (a * c - right.head(used)).norm() / std::sqrt(std::max(1, used - 3));
  const double motion = std::sqrt(24 * turned);  // L^2 / 12 = 2 A
  if (used >= kMotionDirections && motion >= kLeastMotionPx && turned > kSure * error) {
    blur.motionPx = motion;
    blur.directionRad = std::fmod(0.5 * std::atan2(c[2], c[1]) + M_PI, M_PI);
    blur.sigmaPx = std::sqrt(std::max(0.0, c[0] - turned));
  } else {
    blur.sigmaPx = std::sqrt(right.head(used).minCoeff());  // no direction is sharper than the blur
  }
  return blur;
}

double pixelNoise(const Image& image, const std::vector<char>& usable) {
  const int w = image.width, h = image.height;
  std::vector<float> response;
  const int stride = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(w) * h / 50000)));
  for (int y = 1; y + 1 < h; y += stride)
    for (int x = 1; x + 1 < w; x += stride) {
      if (!usable[static_cast<std::size_t>(y) * w + x]) continue;
      const auto v = [&](int dx, int dy) { return image.at(x + dx, y + dy); };
      response.push_back(
          std::abs(v(-1, -1) + v(1, -1) + v(-1, 1) + v(1, 1) - 2 * (v(0, -1) + v(0, 1) + v(-1, 0) + v(1, 0)) + 4 * v(0, 0)));
    }
  if (response.empty()) return 0;
  return 1.4826 * upperMedian(std::move(response)) / 6.0;  // the mask's own norm is 6
}

}  // namespace glint
