// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/level_set_prediction.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/camera.h"
#include "core/model/models.h"
#include "core/surface/level_set.h"

namespace glint {
namespace {

constexpr double kSameValue = 1e-7;  // rad, or log I: far above the round-off of a polished peak, far below any level

/// Share of the outline, by length, that lies on the level set or on the surface's own edge rather than at the image margin.
double coverageOf(const LevelSetComponent& c, const Eigen::AlignedBox2d& window, double margin) {
  const auto& p = c.outline.points;
  double total = 0, cut = 0;
  const auto atMargin = [&](const Pixel& q) {
    constexpr double kNear = 1;  // px from where the field ends
    return q.x() < window.min().x() + kNear - margin || q.y() < window.min().y() + kNear - margin ||
           q.x() > window.max().x() - kNear + margin || q.y() > window.max().y() - kNear + margin;
  };
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t j = (i + 1) % p.size();
    const double l = (p[j] - p[i]).norm();
    total += l;
    if (c.onBorder[i] && c.onBorder[j] && atMargin(p[i]) && atMargin(p[j])) cut += l;
  }
  return total > 0 ? 1 - cut / total : 0;
}

/// Whether the window cuts a component, or shows no component although a peak lies beyond: that one may be smaller than a cell of
/// the scan.
bool mayLeave(const std::vector<LevelSetComponent>& components, const SurfaceField& field, const Eigen::AlignedBox2d& window) {
  if (components.empty())
    return std::any_of(field.peaks.begin(), field.peaks.end(),
                       [&](const FieldPeak& p) { return !window.contains(p.point.pixel); });
  return std::any_of(components.begin(), components.end(),
                     [&](const LevelSetComponent& c) { return coverageOf(c, window, 0) < 1; });
}

/// The highlight's peak: the known one inside the outline with the smallest value. A merged highlight holds several whose values
/// are equal up to round-off: the one nearest to the middle is taken, so that round-off decides nothing.
const FieldPeak* peakInside(const SurfaceField& field, const Polyline& outline) {
  const Pixel middle = centroid(outline);
  const FieldPeak* best = nullptr;
  for (const FieldPeak& p : field.peaks) {
    if (!contains(outline, p.point.pixel)) continue;
    const bool darker = best && p.value > best->value + kSameValue;
    const bool asBright = best && std::abs(p.value - best->value) <= kSameValue;
    if (darker || (asBright && (p.point.pixel - middle).norm() >= (best->point.pixel - middle).norm())) continue;
    best = &p;
  }
  return best;
}

/// Every peak lies outside the photograph.
bool allOutside(const SurfaceField& field, const Camera& camera) {
  constexpr double kHalf = 0.5;  // px: the image ends at the outer edges of its pixels
  return !field.peaks.empty() && std::all_of(field.peaks.begin(), field.peaks.end(),
                                             [&](const FieldPeak& p) { return !isInPhotograph(camera, p.point.pixel, kHalf); });
}

}  // namespace

Prediction predictLevelSet(const SurfaceField& field, const Camera& camera, const Surface& surface, const Settings& settings) {
  const Eigen::Vector3d eye = camera.centreInWorld();
  // Seeds: a highlight smaller than the scan's cells has a peak inside.
  LevelSetOptions options;
  options.gridStepPx = settings.number("predict.level_set_step");
  for (const FieldPeak& p : field.peaks) options.seeds.push_back(p.point.pixel);
  const PixelField exact = [&](const Pixel& q) -> std::optional<double> {
    const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(q));
    return hit ? field.value(facing(*hit, eye)) : std::nullopt;
  };
  const PixelFieldBatch batch = [&](const std::vector<Pixel>& pixels) {
    std::vector<Ray> rays;
    rays.reserve(pixels.size());
    for (const Pixel& q : pixels) rays.push_back(camera.ray(q));
    const std::vector<std::optional<SurfacePoint>> hits = surface.approximateHits(rays);
    std::vector<std::optional<double>> values(pixels.size());
    for (std::size_t i = 0; i < hits.size(); ++i)
      if (hits[i]) values[i] = field.value(facing(*hits[i], eye));
    return values;
  };
  const Eigen::AlignedBox2d window = seenWindow(camera);
  std::vector<LevelSetComponent> components = traceLevelSets(exact, batch, field.level, window, options);
  const bool none = components.empty();
  if (mayLeave(components, field, window)) {
    // The image cuts the highlight: it is followed beyond the border, so that all of it is known.
    options.marginPx = kMarginFraction * window.sizes().maxCoeff();
    components = traceLevelSets(exact, batch, field.level, window, options);
    if (none) std::erase_if(components, [&](const LevelSetComponent& c) { return clippedTo(window, c.outline).points.empty(); });
  }
  std::vector<PredictedHighlight> found;
  for (const LevelSetComponent& c : components) {
    PredictedHighlight h;
    h.contour = c.outline;
    h.coverage = coverageOf(c, window, options.marginPx);
    if (const Outcome<Ellipse> e = fitEllipse(c.outline.points)) h.ellipse = *e;
    if (const FieldPeak* peak = peakInside(field, c.outline)) {
      h.brightest = peak->point;
    } else {
      // The smallest value may come from the reduced precision of the scan, just off the surface; the outline is exact.
      Outcome<BrightestPoint> at = observedBrightestPoint(surface, camera, c.minimumAt);
      for (std::size_t i = 0; !at && i < c.outline.points.size(); ++i)
        at = observedBrightestPoint(surface, camera, c.outline.points[i]);
      if (!at) continue;
      h.brightest = *at;
      h.brightest.pixel = c.minimumAt;
      h.brightest.alpha = c.minimum;
    }
    h.tangentPlane = Plane::through(h.brightest.point.position, h.brightest.point.normal);
    found.push_back(std::move(h));
  }
  if (!found.empty()) return found;
  return allOutside(field, camera) ? Failure{Reason::OutsideImage, "the whole highlight lies outside the image"}
                                   : Failure{Reason::NotReached, "no level set in the image"};
}

}  // namespace glint
