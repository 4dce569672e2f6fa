// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/exact_highlight.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/camera.h"
#include "core/geometry/light.h"
#include "core/surface/brightest_point.h"
#include "core/surface/level_set.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

/// Maximum of a smooth field near a start: Newton's method on fourth-order differences, with halved steps while the field does
/// not rise. Nothing when the field ends within the stencil or the Hessian is not negative definite there.
std::optional<Pixel> polishedMaximum(const std::function<std::optional<double>(const Pixel&)>& field, Pixel at) {
  constexpr double kStep = 0.05;  // px: truncation h^4 f''''' / 30 and round-off 1e-15 / h are both below 1e-8 px here
  for (int round = 0; round < 60; ++round) {
    double f[5][5];
    for (int i = -2; i <= 2; ++i)
      for (int j = -2; j <= 2; ++j) {
        if (i != 0 && j != 0 && (std::abs(i) != 1 || std::abs(j) != 1)) continue;
        const std::optional<double> v = field(at + kStep * Pixel(i, j));
        if (!v) return std::nullopt;
        f[i + 2][j + 2] = *v;
      }
    const auto slope = [](double a, double b, double c, double d) { return (a - 8 * b + 8 * c - d) / (12 * kStep); };
    const Eigen::Vector2d gradient(slope(f[0][2], f[1][2], f[3][2], f[4][2]), slope(f[2][0], f[2][1], f[2][3], f[2][4]));
    Eigen::Matrix2d hessian;
    hessian(0, 0) = (f[1][2] - 2 * f[2][2] + f[3][2]) / (kStep * kStep);
    hessian(1, 1) = (f[2][1] - 2 * f[2][2] + f[2][3]) / (kStep * kStep);
    hessian(0, 1) = hessian(1, 0) = (f[3][3] - f[3][1] - f[1][3] + f[1][1]) / (4 * kStep * kStep);
    Eigen::Vector2d step;
    if (hessian(0, 0) < 0 && hessian.determinant() > 0) {
      step = -hessian.ldlt().solve(gradient);
    } else {
      step = gradient.norm() > 0 ? Eigen::Vector2d(gradient.normalized()) : Eigen::Vector2d(0, 0);  // uphill, one pixel
    }
    if (step.norm() > 20) step *= 20 / step.norm();
    double share = 1;
    for (; share > 1e-3; share *= 0.5) {  // ten halvings: a step that still falls then is no ascent
      const std::optional<double> next = field(at + share * step);
      if (next && *next >= f[2][2] - 1e-12 * std::abs(f[2][2])) break;  // round-off of the field
    }
    at += share * step;
    if (share * step.norm() < 1e-9) return at;  // px: below the error of the differences
  }
  return at;
}

struct Candidate {
  Pixel pixel;
  double value;
};

bool dimmer(const Candidate& a, const Candidate& b) { return a.value < b.value; }

/// One light in one view: how bright it shows, and where it is brightest.
class LightView {
 public:
  LightView(const Surface& surface, const Camera& camera, const TrueLight& light, const Material& material,
            const ExactOptions& options)
      : surface_(surface), camera_(camera), light_(light), material_(material), options_(options) {}

  bool limit() const { return options_.kind == ContourKind::LimitAngle; }
  const Eigen::AlignedBox2d& window() const { return window_; }

  /// The larger, the brighter: log I, or -alpha.
  std::optional<double> brightness(const Pixel& pixel) const {
    if (!limit()) return logSpecular(surface_, camera_, pixel, light_, material_);
    const Ray ray = camera_.ray(pixel);
    const Outcome<SurfacePoint> hit = surface_.firstHit(ray);
    if (!hit) return std::nullopt;
    const SurfacePoint p = facing(*hit, ray.origin);
    const Eigen::Vector3d toLight = centre_.directionFrom(p.position);
    if (!(p.normal.dot(toLight) > 0)) return std::nullopt;
    if (surface_.occluded(p, occlusionTarget(surface_, p.position, centre_, (ray.origin - p.position).norm())))
      return std::nullopt;
    return -incidentAngle(p.normal, toLight, -ray.direction);
  }

  /// The brightest first.
  std::vector<Candidate> peaks() const {
    std::vector<Candidate> peaks;
    BrightestPointOptions search;
    search.marginFraction = std::max(search.marginFraction, options_.marginPx / window_.sizes().minCoeff());
    if (const Outcome<std::vector<BrightestPoint>> points = predictedBrightestPoints(surface_, camera_, centre_, search))
      for (const BrightestPoint& point : *points) {
        const Pixel at = limit() ? point.pixel : maximumNear(point.pixel).value_or(point.pixel);
        if (const std::optional<double> value = brightness(at)) peaks.push_back({at, *value});
      }
    // A light that is wide, or whose mirror point is hidden, may have its maximum elsewhere: the coarse grid of the image
    // decides.
    if (!limit() || peaks.empty())
      if (std::optional<Candidate> best = brightestOfGrid();
          best && (peaks.empty() || best->value > std::max_element(peaks.begin(), peaks.end(), dimmer)->value)) {
        if (!limit())
          if (const std::optional<Pixel> at = maximumNear(best->pixel)) best = Candidate{*at, *brightness(*at)};
        peaks.push_back(*best);
      }
    std::sort(peaks.begin(), peaks.end(), [](const Candidate& a, const Candidate& b) { return dimmer(b, a); });
    return peaks;
  }

  /// Empty for a region that is too small or outside of the photograph.
  std::optional<Highlight> highlightOf(const LevelSetComponent& component, const std::vector<Candidate>& peaks) const {
    Highlight h;
    h.light = light_.id;
    h.level = options_.level;
    h.contour = component.outline;
    h.areaPx2 = std::abs(signedArea(h.contour));
    if (h.contour.points.size() < 5 || !(h.areaPx2 > 0)) return std::nullopt;
    // The window of a wide lens has corners that the photograph does not show.
    const auto shown = [&](const Pixel& p) { return isInPhotograph(camera_, p, options_.marginPx + 0.5); };
    if (camera_.hasDistortion() && std::none_of(h.contour.points.begin(), h.contour.points.end(), shown) &&
        !shown(component.minimumAt))
      return std::nullopt;
    const Candidate peak = peakIn(h.contour, component, peaks);
    h.peak = peak.pixel;
    h.peakValue = limit() ? 0 : std::exp(peak.value);
    const double outer = options_.marginPx - 1e-6;  // px: vertices on the border lie on it to the root finder's tolerance
    for (const Pixel& p : h.contour.points) h.touchesBorder = h.touchesBorder || !isInPhotograph(camera_, p, outer);
    if (const Outcome<Ellipse> ellipse = fitEllipse(h.contour.points)) h.ellipse = *ellipse;
    return h;
  }

 private:
  std::optional<Pixel> maximumNear(const Pixel& start) const {
    return polishedMaximum([&](const Pixel& p) { return brightness(p); }, start);
  }
  std::optional<Candidate> brightestOfGrid() const {
    constexpr double kGridPx = 16;
    std::optional<Candidate> best;
    for (double y = window_.min().y() + 0.5; y < window_.max().y(); y += kGridPx)
      for (double x = window_.min().x() + 0.5; x < window_.max().x(); x += kGridPx)
        if (const std::optional<double> value = brightness(Pixel(x, y)); value && (!best || *value > best->value))
          best = Candidate{Pixel(x, y), *value};
    return best;
  }
  Candidate peakIn(const Polyline& contour, const LevelSetComponent& component, const std::vector<Candidate>& peaks) const {
    const auto inside = std::find_if(peaks.begin(), peaks.end(), [&](const Candidate& p) { return contains(contour, p.pixel); });
    if (inside != peaks.end()) return *inside;
    if (!limit())
      if (const std::optional<Pixel> at = maximumNear(component.minimumAt); at && contains(contour, *at))
        return {*at, *brightness(*at)};
    return {component.minimumAt, -component.minimum};
  }

  const Surface& surface_;
  const Camera& camera_;
  const TrueLight& light_;
  const Material& material_;
  const ExactOptions& options_;
  Light centre_ = lightOf(light_.lamp);  ///< stands for the lamp where one direction is needed (seeds, limit angles)
  Eigen::AlignedBox2d window_ = seenWindow(camera_);
};

}  // namespace

Outcome<std::vector<Highlight>> exactHighlights(const Surface& surface, const Camera& camera, const TrueLight& light,
                                                const Material& material, const ExactOptions& options) {
  const LightView view(surface, camera, light, material, options);
  if (view.limit() && !light.lamp.isPoint()) return Failure{Reason::NotSupported, "a limit angle needs a point light"};
  const std::vector<Candidate> peaks = view.peaks();
  if (peaks.empty()) return Failure{Reason::NoHighlight, "no surface point is visible and lit"};

  const double threshold = view.limit() ? options.limitAngle : -(peaks.front().value + std::log(options.level));
  LevelSetOptions trace;
  trace.sagittaPx = options.sagittaPx;
  trace.marginPx = options.marginPx;
  for (const Candidate& peak : peaks)
    if (-peak.value < threshold) trace.seeds.push_back(peak.pixel);
  const PixelField field = [&](const Pixel& pixel) -> std::optional<double> {
    const std::optional<double> value = view.brightness(pixel);
    if (!value) return std::nullopt;
    return -*value;
  };
  std::vector<Highlight> highlights;
  for (const LevelSetComponent& component : traceLevelSets(field, {}, threshold, view.window(), trace))
    if (std::optional<Highlight> h = view.highlightOf(component, peaks)) highlights.push_back(std::move(*h));
  if (highlights.empty()) return Failure{Reason::NoHighlight, "no region of the image lies above the level"};
  std::stable_sort(highlights.begin(), highlights.end(),
                   [](const Highlight& a, const Highlight& b) { return a.peakValue > b.peakValue; });
  return highlights;
}

}  // namespace glint
