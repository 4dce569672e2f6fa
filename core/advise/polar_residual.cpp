// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/polar_residual.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/camera.h"

namespace glint {
namespace {

constexpr double kBorderPx = 1.0;  // detection's contours end within a pixel of the border

double directionOf(int index, int count) { return -std::numbers::pi + 2 * std::numbers::pi * (index + 1) / count; }

bool onBorder(const Pixel& p, const Camera& camera) { return !isInPhotograph(camera, p, -kBorderPx); }

double cross(const Pixel& a, const Pixel& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The model's comparisons of one frame; all lights.
std::vector<const FrameComparison*> comparisonsOf(const Inspection& inspection, int frame, const std::string& model) {
  std::vector<const FrameComparison*> found;
  const auto it = inspection.models.find(model);
  if (it == inspection.models.end()) return found;
  for (const FrameComparison& c : it->second.frames)
    if (c.frame == frame) found.push_back(&c);
  return found;
}

const FrameEvidence* evidenceOf(const Inspection& inspection, int frame) {
  return frame >= 0 && frame < int(inspection.evidence.size()) ? &inspection.evidence[std::size_t(frame)] : nullptr;
}

std::optional<double> alphaAt(const Pixel& pixel, const Camera& camera, const Surface& surface, const Light& light) {
  const Outcome<SurfacePoint> hit = surface.firstHit(camera.ray(pixel));
  if (!hit) return std::nullopt;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint p = facing(*hit, eye);
  const Eigen::Vector3d toLight = light.directionFrom(p.position);
  if (!(p.normal.dot(toLight) > 0)) return std::nullopt;
  const double alpha = incidentAngle(p.normal, toLight, (eye - p.position).normalized());
  if (!std::isfinite(alpha)) return std::nullopt;
  return alpha;
}

}  // namespace

std::optional<Pixel> contourPointAt(const Polyline& contour, const Pixel& centre, double direction) {
  const Pixel d(std::cos(direction), std::sin(direction));
  const std::size_t n = contour.points.size();
  const std::size_t segments = n < 2 ? 0 : contour.closed ? n : n - 1;
  double furthest = -1;
  for (std::size_t i = 0; i < segments; ++i) {
    const Pixel a = contour.points[i] - centre, b = contour.points[(i + 1) % n] - centre;
    // Side of the ray's line; a vertex on it counts to one side, so that it is met once.
    const double sa = cross(d, a), sb = cross(d, b);
    if ((sa >= 0) == (sb >= 0)) continue;
    const double along = (a + sa / (sa - sb) * (b - a)).dot(d);
    if (along >= 0) furthest = std::max(furthest, along);
  }
  if (furthest < 0) return std::nullopt;
  return centre + furthest * d;
}

std::optional<double> depthInside(const Polyline& contour, const std::vector<std::pair<int, int>>& gaps, const Pixel& point) {
  const int n = static_cast<int>(contour.points.size());
  const int segments = n < 2 ? 0 : contour.closed ? n : n - 1;
  double best = std::numeric_limits<double>::infinity();
  bool inGap = false;
  for (int i = 0; i < segments; ++i) {
    const int j = (i + 1) % n;
    const Pixel &a = contour.points[std::size_t(i)], ab = contour.points[std::size_t(j)] - a;
    const double squared = ab.squaredNorm();
    const double t = squared > 0 ? std::clamp((point - a).dot(ab) / squared, 0.0, 1.0) : 0.0;
    const double distance = (a + t * ab - point).norm();
    if (distance >= best) continue;
    best = distance;
    inGap = std::find(gaps.begin(), gaps.end(), std::pair<int, int>(i, j)) != gaps.end();
  }
  if (!std::isfinite(best) || inGap) return std::nullopt;
  return contains(contour, point) ? best : -best;
}

std::vector<PolarResidual> polarResiduals(const Inspection& inspection, int frame, const std::string& model, int directions) {
  require(directions >= 3, "polarResiduals: needs three directions");
  std::vector<PolarResidual> all;
  const FrameEvidence* evidence = evidenceOf(inspection, frame);
  if (!evidence) return all;
  const Camera& camera = inspection.scene->frames[std::size_t(frame)].camera;
  for (const FrameComparison* c : comparisonsOf(inspection, frame, model))
    for (const FrameComparison::Row& row : c->rows) {
      if (row.observed < 0 || row.predicted < 0 || row.observed >= int(evidence->scored().size()) ||
          row.predicted >= int(c->prediction.highlights().size()))
        continue;
      const Highlight& observed = evidence->scored()[std::size_t(row.observed)];
      const PredictedHighlight& predicted = c->prediction.highlights()[std::size_t(row.predicted)];
      PolarResidual r;
      r.model = model;
      r.light = c->light;
      r.observed = row.observed;
      r.predicted = row.predicted;
      r.centre = centroid(observed.contour);
      double sum = 0, largest = 0;
      int count = 0;
      for (int k = 0; k < directions; ++k) {
        DirectionSample s;
        s.direction = directionOf(k, directions);
        if (const std::optional<Pixel> at = contourPointAt(observed.contour, r.centre, s.direction)) {
          s.at = *at;
          if (!(observed.touchesBorder && onBorder(*at, camera))) s.value = depthInside(predicted.contour, predicted.gaps, *at);
        }
        if (s.value) sum += std::abs(*s.value), largest = std::max(largest, std::abs(*s.value)), ++count;
        r.samples.push_back(s);
      }
      r.meanAbsPx = count ? sum / count : std::nan("");
      r.largestAbsPx = count ? largest : std::nan("");
      all.push_back(std::move(r));
    }
  return all;
}

Outcome<Light> lightOfModel(const Inspection& inspection, int frame, const std::string& model, const std::string& light) {
  const auto result = inspection.models.find(model);
  const FitKey key = inspection.keyFor(frame, light);
  const ModelFit* fit = nullptr;
  if (result != inspection.models.end())
    for (const ModelResult::Fit& f : result->second.fits)
      if (f.key() == key && f.fit) fit = &*f.fit;
  if (fit && fit->lightEstimate) return *fit->lightEstimate;
  if (const LightEstimate* const estimate = inspection.lightOf(key)) return estimate->light;
  if (fit && fit->ellipsoid() && modelByName(model).traits().mirrored) return Light::at(fit->ellipsoid()->centre());
  if (const Failure* const why = inspection.lightFailureFor(frame, light)) return *why;
  return Failure{Reason::NoLight, "the light '" + light + "' was not estimated"};
}

Outcome<std::shared_ptr<const Surface>> surfaceOfFrame(const Inspection& inspection, int frame, const std::string& light) {
  require(frame >= 0 && frame < int(inspection.scene->frames.size()), "surfaceOfFrame: no such frame");
  for (const TrainingView& v : inspection.views)
    if (v.frame == frame && v.seen && v.surface && v.highlight.light == light) return v.surface;
  return surfaceFor(inspection, frame, light);
}

std::vector<AngleByDirection> limitAngles(const Inspection& inspection, int frame, const std::string& model,
                                          const Surface& surface, int directions) {
  require(directions >= 3, "limitAngles: needs three directions");
  std::vector<AngleByDirection> all;
  const FrameEvidence* evidence = evidenceOf(inspection, frame);
  if (!evidence) return all;
  const Camera& camera = inspection.scene->frames[std::size_t(frame)].camera;
  const std::vector<const FrameComparison*> comparisons = comparisonsOf(inspection, frame, model);
  for (int o = 0; o < int(evidence->scored().size()); ++o) {
    const Highlight& h = evidence->scored()[std::size_t(o)];
    const Outcome<Light> light = lightOfModel(inspection, frame, model, h.light);
    if (!light) continue;
    AngleByDirection a;
    a.model = model;
    a.light = h.light;
    a.observed = o;
    a.centre = centroid(h.contour);
    const PredictedHighlight* predicted = nullptr;
    for (const FrameComparison* c : comparisons) {
      for (const FrameComparison::Row& row : c->rows)
        if (row.observed == o && row.predicted >= 0 && row.predicted < int(c->prediction.highlights().size()))
          predicted = &c->prediction.highlights()[std::size_t(row.predicted)];
      const auto& fits = inspection.models.at(model).fits;
      if (c->light == h.light && c->fit >= 0 && c->fit < int(fits.size()) && fits[std::size_t(c->fit)].fit) {
        const ModelFit& fit = *fits[std::size_t(c->fit)].fit;
        a.limitAngle = fit.limitAngle();
        a.extended = fit.as<LimitAngleFit>() && fit.as<LimitAngleFit>()->extent;
      }
    }
    for (int k = 0; k < directions; ++k) {
      DirectionSample s;
      s.direction = directionOf(k, directions);
      if (const std::optional<Pixel> at = contourPointAt(h.contour, a.centre, s.direction)) {
        s.at = *at;
        if (!(h.touchesBorder && onBorder(*at, camera))) s.value = alphaAt(*at, camera, surface, *light);
      }
      a.measured.push_back(s);
      if (!predicted) continue;
      DirectionSample p;
      p.direction = s.direction;
      if (const std::optional<Pixel> at = contourPointAt(predicted->contour, a.centre, p.direction)) {
        p.at = *at;
        if (depthInside(predicted->contour, predicted->gaps, *at)) p.value = alphaAt(*at, camera, surface, *light);
      }
      a.predicted.push_back(p);
    }
    all.push_back(std::move(a));
  }
  return all;
}

}  // namespace glint
