// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/vignetting_check.h"

#include <Eigen/Core>
#include <cmath>

#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr double kLeastLoss = 0.15;  // moves contours by less than 0.1 % below
constexpr double kSure = 8;          // standard deviations; neighbouring points are not independent
// Shares of the loss: how far it may differ along the axes, and what slope there may be. Long tails of highlights, which look
// like a loss of 10 to 80 %, have slopes of half of it or losses along the axes of twice as much.
constexpr double kAlikeAcross = 1.6, kSlope = 0.25;

using Terms = std::vector<double> (*)(const Eigen::Vector2d& place);
std::vector<double> radial(const Eigen::Vector2d& p) { return {p.squaredNorm()}; }
std::vector<double> anySmooth(const Eigen::Vector2d& p) { return {p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y()}; }

}  // namespace

std::optional<Vignetting> vignettingOf(const TexturePanel& panel, const std::vector<PointSamples>& points) {
  if (points.empty()) return std::nullopt;
  std::vector<Eigen::Vector2d> middles;
  for (const TextureView& view : panel.views()) middles.emplace_back((view.value.width - 1) / 2.0, (view.value.height - 1) / 2.0);
  const auto fallOf = [&](Terms terms) {
    return fittedSightings(points, middles.size(), [&](const TexturePanel::Sample& s, double) {
      return terms((s.at - middles[s.view]) / middles[s.view].norm());
    });
  };
  const SightingFit fall = fallOf(radial);
  const Vignetting found{-fall.terms(0), fall.sigma(0)};
  const double k = found.cornerLoss;
  if (!(k > kLeastLoss && k > kSure * found.sigma)) return std::nullopt;
  const SightingFit any = fallOf(anySmooth);
  const auto isAlike = [&](double along) { return -along > k / kAlikeAcross && -along < k * kAlikeAcross; };
  const bool round = std::abs(any.terms(0)) < kSlope * k && std::abs(any.terms(1)) < kSlope * k && isAlike(any.terms(2)) &&
                     isAlike(any.terms(4));
  return round ? std::optional(found) : std::nullopt;
}

std::string vignettingRemark(const std::optional<Vignetting>& found, std::size_t views, const CameraResponse& response) {
  if (!found) return "";
  // To a hundredth: the light does not fall with a square to more digits.
  const std::string fix = response.withVignetting(std::round(100 * found->cornerLoss) / 100).text();
  return formatted(
      "the images get darker towards their corners: about %.0f %% less light there, as the same surface points show in %zu "
      "frames (vignetting; state it: \"response\": \"%s\" in the camera, or --response \"%s\" for a capture)",
      100 * found->cornerLoss, views, fix.c_str(), fix.c_str());
}

}  // namespace glint
