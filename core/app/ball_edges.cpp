// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/ball_edges.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/image.h"
#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr double kStepsPerBlur =
    3;  // samples along a line for each standard deviation of the blur: a parabola then finds the peak to 0.01 of it
constexpr double kLeastSlope = 0.15;   // grey levels per px: half a level, which a JPEG rounds away, over the width of the blur
constexpr double kOverNoise = 4;       // standard deviations; one sample of 16,000 of pure noise
constexpr double kNoisier = 0.75;      // of all places three quarters are quieter: a black ball hides the noise of what is lit
constexpr int kSectorNeighbours = 2;   // sectors to each side in which an edge goes on
constexpr int kLeastNeighbours = 3;    // of four: one may be hidden by a speck
constexpr double kOwnScatterPx = 0.5;  // of one sector's edge about its neighbours' line
constexpr double kLeastEdgeSigmaPx = 0.05;  // no edge of a photograph is known better
constexpr double kOutlineStep = 1e-4;       // px, of numerical derivatives

/// A peak of the slope along one line.
struct LineEdge {
  double along = 0, step = 0;
};

struct RadialLine {
  Eigen::Vector2d from, direction;
};

double codePerLinear(double linear) { return linear <= 0.0031308 ? 12.92 : 1.055 / 2.4 * std::pow(linear, 1 / 2.4 - 1); }

double lightAt(const Image& image, const Eigen::Vector2d& p) {
  if (!(p.x() >= 0 && p.y() >= 0 && p.x() < image.width - 1 && p.y() < image.height - 1))
    return std::numeric_limits<double>::quiet_NaN();  // stays inside: no peak is found where a sample is missing
  const int x = static_cast<int>(p.x()), y = static_cast<int>(p.y());
  const double u = p.x() - x, v = p.y() - y;
  return (1 - v) * ((1 - u) * image.at(x, y) + u * image.at(x + 1, y)) +
         v * ((1 - u) * image.at(x, y + 1) + u * image.at(x + 1, y + 1));
}

/// Over the lines of one sector: mean, and standard deviation of the mean.
struct SectorProfile {
  std::vector<double> mean, sigma;
};

SectorProfile sectorProfile(const Image& image, const std::vector<RadialLine>& lines, int samples, double spacing) {
  const double n = static_cast<double>(lines.size());
  SectorProfile profile{std::vector<double>(samples, 0.0), std::vector<double>(samples, 0.0)};
  std::vector<double> values(lines.size());
  for (int i = 0; i < samples; ++i) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      values[k] = lightAt(image, lines[k].from + i * spacing * lines[k].direction);
      profile.mean[i] += values[k] / n;
    }
    for (const double v : values) profile.sigma[i] += (v - profile.mean[i]) * (v - profile.mean[i]) / (n * (n - 1));
    profile.sigma[i] = std::sqrt(profile.sigma[i]);
  }
  return profile;
}

/// The profile smoothed (first) and its derivative for each px (second), Gaussian of 3 samples; NaN at the ends.
std::array<std::vector<double>, 2> smoothedProfile(const std::vector<double>& profile, double spacing) {
  constexpr int kHalf = 9;  // three standard deviations
  static const auto kernel = [] {
    std::array<double, 2 * kHalf + 1> k{};
    double sum = 0;
    for (int i = -kHalf; i <= kHalf; ++i) sum += k[i + kHalf] = std::exp(-0.5 * i * i / (kStepsPerBlur * kStepsPerBlur));
    for (double& v : k) v /= sum;
    return k;
  }();
  const int n = static_cast<int>(profile.size());
  std::array<std::vector<double>, 2> result;
  for (auto& r : result) r.assign(n, std::numeric_limits<double>::quiet_NaN());
  for (int i = kHalf; i + kHalf < n; ++i) {
    double value = 0, slope = 0;
    for (int j = -kHalf; j <= kHalf; ++j) {
      value += kernel[j + kHalf] * profile[i + j];
      slope += kernel[j + kHalf] * profile[i + j] * j;
    }
    result[0][i] = value;
    result[1][i] = slope / (kStepsPerBlur * kStepsPerBlur * spacing);
  }
  return result;
}

/// Local peaks of the slope's size, above a threshold in grey levels per px.
std::vector<LineEdge> slopePeaks(const std::vector<double>& slope, const std::vector<double>& codes, double threshold,
                                 double spacing) {
  std::vector<LineEdge> found;
  for (std::size_t i = 1; i + 1 < slope.size(); ++i) {
    const double before = std::abs(slope[i - 1]), here = std::abs(slope[i]), after = std::abs(slope[i + 1]);
    if (!(here > before && here >= after && codes[i] > threshold)) continue;
    const double bend = before - 2 * here + after;
    found.push_back({(static_cast<double>(i) + 0.5 * (before - after) / bend) * spacing, std::copysign(codes[i], slope[i])});
  }
  return found;
}

using SectorEdges = std::array<std::vector<LineEdge>, kOutlineSectors>;

/// The neighbours of an edge in its own photograph, as (sectors away, place along the line); without itself.
std::vector<Eigen::Vector2d> companions(const SectorEdges& edges, int sector, const LineEdge& edge, double slant) {
  std::vector<Eigen::Vector2d> result;
  for (int d = -kSectorNeighbours; d <= kSectorNeighbours; ++d) {
    if (d == 0) continue;
    double least = kOwnScatterPx + slant * std::abs(d);
    std::optional<Eigen::Vector2d> nearest;
    for (const LineEdge& other : edges[(sector + d + kOutlineSectors) % kOutlineSectors])
      if (other.step * edge.step > 0 && std::abs(other.along - edge.along) < least) {
        least = std::abs(other.along - edge.along);
        nearest = Eigen::Vector2d(d, other.along);
      }
    if (nearest) result.push_back(*nearest);
  }
  return result;
}

/// Standard deviation of an edge about the straight line through it and its companions.
double edgeScatter(const std::vector<Eigen::Vector2d>& companions, double own) {
  double n = 1, x = 0, y = own;
  for (const Eigen::Vector2d& c : companions) n += 1, x += c.x(), y += c.y();
  x /= n, y /= n;
  double xx = x * x, xy = -x * (own - y), yy = (own - y) * (own - y);
  for (const Eigen::Vector2d& c : companions) {
    xx += (c.x() - x) * (c.x() - x);
    xy += (c.x() - x) * (c.y() - y);
    yy += (c.y() - y) * (c.y() - y);
  }
  return std::sqrt(std::max(0.0, yy - xy * xy / xx) / (n - 2));
}

}  // namespace

double OutlineModel::distance(const Eigen::Vector2d& place) const {
  if (!camera) return (place - x.head<2>()).norm() - x[2];
  const auto ray = [&](const Eigen::Vector2d& p) -> Eigen::Vector3d {
    const Eigen::Vector2d d = (p - camera->principal) / camera->focalPx;
    return Eigen::Vector3d(d.x(), d.y(), 1);
  };
  const Eigen::Vector3d axis = ray(x.head<2>());
  const double cosTheta = 1 / axis.norm(), alpha = std::atan(x[2] * cosTheta / camera->focalPx);
  const auto angle = [&](const Eigen::Vector2d& p) {
    const Eigen::Vector3d r = ray(p);
    return std::atan2(axis.cross(r).norm(), axis.dot(r));
  };
  const Eigen::Vector2d outwards = (place - x.head<2>()).normalized(), across(-outwards.y(), outwards.x());
  const double along = (angle(place + kOutlineStep * outwards) - angle(place - kOutlineStep * outwards)) / (2 * kOutlineStep),
               aside = (angle(place + kOutlineStep * across) - angle(place - kOutlineStep * across)) / (2 * kOutlineStep);
  return (angle(place) - alpha) / std::hypot(along, aside);
}

Eigen::Vector3d OutlineModel::derivatives(const Eigen::Vector2d& place) const {
  if (!camera) {
    const Eigen::Vector2d outwards = (place - x.head<2>()).normalized();
    return {-outwards.x(), -outwards.y(), -1};
  }
  Eigen::Vector3d result;
  for (int i = 0; i < 3; ++i) {
    OutlineModel more = *this, less = *this;
    more.x[i] += kOutlineStep, less.x[i] -= kOutlineStep;
    result[i] = (more.distance(place) - less.distance(place)) / (2 * kOutlineStep);
  }
  return result;
}

double OutlineModel::radiusAt(double angle) const {
  double radius = x[2];
  const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
  constexpr int kRounds = 6;  // Newton's, from the circle: exact to rounding but for extreme lenses
  for (int i = 0; camera && i < kRounds; ++i) radius -= distance(x.head<2>() + radius * outwards);
  return radius;
}

std::vector<Image> linearLight(std::span<const Image> photographs) {
  std::array<float, 257> table{};
  for (int i = 0; i <= 256; ++i) table[i] = static_cast<float>(linearFromSrgb(std::min(i, 255) / 255.0));
  std::vector<Image> result;
  for (const Image& p : photographs) {
    Image linear(p.width, p.height, 1);
    for (std::size_t i = 0; i < linear.data.size(); ++i) {
      float sum = 0;
      for (int c = 0; c < p.channels; ++c) {
        const float code = std::clamp(p.data[i * p.channels + c], 0.f, 255.f);
        const int k = static_cast<int>(code);
        sum += table[k] + (code - static_cast<float>(k)) * (table[k + 1] - table[k]);
      }
      linear.data[i] = sum / static_cast<float>(p.channels);
    }
    result.push_back(std::move(linear));
  }
  return result;
}

namespace {

/// The lines of a sector: parallel to its middle one, one per pixel of the arc, from `reach` inside of the outline outwards.
std::vector<RadialLine> sectorLines(const OutlineModel& outline, int sector, double reach) {
  constexpr double kSector = 2 * std::numbers::pi / kOutlineSectors;
  constexpr int kMostLines = 15;
  const int count =
      std::clamp(static_cast<int>(kSector * outline.x[2] / 1.5), 3, kMostLines);  // 1.5 px apart: nearly independent
  std::vector<RadialLine> lines;
  for (int i = 0; i < count; ++i) {
    const double angle = kSector * (sector + (i + 0.5) / count - 0.5);
    const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
    lines.push_back({outline.x.head<2>() + (outline.radiusAt(angle) - reach) * outwards, outwards});
  }
  return lines;
}

/// Every edge of one photograph, before neighbours are asked. Noise is the difference of a sector's lines: an edge along the
/// outline is no noise. White noise sigma has the slope sigma (4 sqrt(pi) blur^3)^-1/2 behind a Gaussian's derivative.
SectorEdges edgesOf(const Image& linear, const std::vector<std::vector<RadialLine>>& lines, int samples, double spacing) {
  std::vector<std::vector<double>> slopes(kOutlineSectors), codes(kOutlineSectors);
  std::vector<double> noise;
  for (int s = 0; s < kOutlineSectors; ++s) {
    const SectorProfile profile = sectorProfile(linear, lines[s], samples, spacing);
    auto [value, slope] = smoothedProfile(profile.mean, spacing);
    codes[s].resize(slope.size());
    for (std::size_t i = 0; i < slope.size(); ++i) {
      const double scale = 255 * codePerLinear(std::max(0.0, value[i]));
      codes[s][i] = std::abs(slope[i]) * scale;
      if (std::isfinite(value[i])) noise.push_back(profile.sigma[i] * scale);
    }
    slopes[s] = std::move(slope);
  }
  SectorEdges result;
  if (noise.empty()) return result;
  const double usual = ranked(noise, static_cast<std::size_t>(kNoisier * static_cast<double>(noise.size() - 1)));
  const double slopeOfNoise = std::sqrt(1 / (4 * std::sqrt(std::numbers::pi) * std::pow(kStepsPerBlur * spacing, 3))) * usual;
  const double threshold = std::max(kLeastSlope, kOverNoise * slopeOfNoise);
  for (int s = 0; s < kOutlineSectors; ++s) result[s] = slopePeaks(slopes[s], codes[s], threshold, spacing);
  return result;
}

}  // namespace

std::vector<BallEdge> ballEdges(std::span<const Image> linear, const OutlineModel& outline, double reach, double blurPx,
                                double slant) {
  const double spacing = blurPx / kStepsPerBlur, margin = 3 * blurPx + spacing;
  const int samples = static_cast<int>(2 * (reach + margin) / spacing) + 1;
  std::vector<std::vector<RadialLine>> lines;
  for (int s = 0; s < kOutlineSectors; ++s) lines.push_back(sectorLines(outline, s, reach + margin));
  std::vector<BallEdge> result;
  for (std::size_t k = 0; k < linear.size(); ++k) {
    const SectorEdges edges = edgesOf(linear[k], lines, samples, spacing);
    for (int s = 0; s < kOutlineSectors; ++s) {
      const double angle = 2 * std::numbers::pi * s / kOutlineSectors;
      const Eigen::Vector2d outwards(std::cos(angle), std::sin(angle));
      for (const LineEdge& e : edges[s]) {
        const std::vector<Eigen::Vector2d> friends = companions(edges, s, e, slant);
        if (friends.size() < kLeastNeighbours) continue;
        const double radius = outline.radiusAt(angle) - reach - margin + e.along;
        result.push_back({static_cast<int>(k), s, outline.x.head<2>() + radius * outwards, e.step,
                          std::max(kLeastEdgeSigmaPx, edgeScatter(friends, e.along))});
      }
    }
  }
  return result;
}

}  // namespace glint
