// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/model/models.h"
#include "core/surface/level_set.h"

namespace glint {
namespace {

constexpr double kSameAlpha = 1e-7;  // rad; far above the round-off of a polished point, far below any limit angle

/// alpha of the surface point seen at a pixel; empty off the surface, on its dark side, and where it turns away.
std::optional<double> alphaAt(const SurfacePoint& hit, const Eigen::Vector3d& eye, const Light& light) {
  const SurfacePoint p = facing(hit, eye);
  const Eigen::Vector3d l = light.directionFrom(p.position), v = (eye - p.position).normalized();
  if (!(p.normal.dot(l) > 0)) return std::nullopt;
  const double alpha = incidentAngle(p.normal, l, v);
  return std::isfinite(alpha) ? std::optional<double>(alpha) : std::nullopt;
}

/// Share of the outline, by length, that lies on the level set or on the surface's own edge rather than at the image margin.
double coverageOf(const LevelSetComponent& c, const Camera& camera, double margin) {
  const auto& p = c.outline.points;
  double total = 0, cut = 0;
  const auto atMargin = [&](const Pixel& q) {
    return q.x() < 0.5 - margin || q.y() < 0.5 - margin || q.x() > camera.width - 1.5 + margin || q.y() > camera.height - 1.5 + margin;
  };
  for (std::size_t i = 0; i < p.size(); ++i) {
    const std::size_t j = (i + 1) % p.size();
    const double l = (p[j] - p[i]).norm();
    total += l;
    if (c.onBorder[i] && c.onBorder[j] && atMargin(p[i]) && atMargin(p[j])) cut += l;
  }
  return total > 0 ? 1 - cut / total : 0;
}

class LimitAngle final : public HighlightModel {
 public:
  std::string id() const override { return "limit-angle"; }
  std::string title() const override { return "Limit angle"; }
  std::string assumption() const override {
    return "The contour is the level set alpha = alpha_lim on the surface; no ellipsoid: any smooth surface, point-like light.";
  }
  std::string reference() const override { return "method.md section 7"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings&) const override {
    if (!input.light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    ModelFit fit;
    for (const TrainingView& v : input.views)
      if (!v.failure) fit.frames.push_back(v.frame);
    if (!(input.light->limitAngle > 0)) return Failure{Reason::TooFewPoints, "no contour point on the surface"};
    fit.lightEstimate = input.light->light;
    fit.lightCovariance = input.light->covariance;
    fit.limitAngle = input.light->limitAngle;
    fit.solver = input.light->solver;
    fit.condition = input.light->condition;
    return fit;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    Prediction p;
    if (!surface || !fit.lightEstimate || !fit.limitAngle) {
      p.failure = Failure{surface ? Reason::NoLight : Reason::NoSurface, ""};
      return p;
    }
    const Light& light = *fit.lightEstimate;
    const Eigen::Vector3d eye = camera.centreInWorld();
    // Seeds: a highlight smaller than the scan's cells has a brightest point inside.
    LevelSetOptions options;
    options.gridStepPx = settings.number("predict.level_set_step");
    const auto brightest = brightestPointsFor(*surface, camera, light, settings);
    if (brightest)
      for (const BrightestPoint& b : *brightest) options.seeds.push_back(b.pixel);
    const PixelField field = [&](const Pixel& q) -> std::optional<double> {
      const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(q));
      return hit ? alphaAt(*hit, eye, light) : std::nullopt;
    };
    const PixelFieldBatch batch = [&](const std::vector<Pixel>& pixels) {
      std::vector<Ray> rays;
      rays.reserve(pixels.size());
      for (const Pixel& q : pixels) rays.push_back(camera.ray(q));
      const std::vector<std::optional<SurfacePoint>> hits = surface->approximateHits(rays);
      std::vector<std::optional<double>> values(pixels.size());
      for (std::size_t i = 0; i < hits.size(); ++i)
        if (hits[i]) values[i] = alphaAt(*hits[i], eye, light);
      return values;
    };
    std::vector<LevelSetComponent> components = traceLevelSets(field, batch, *fit.limitAngle, camera.width, camera.height, options);
    if (std::any_of(components.begin(), components.end(), [&](const LevelSetComponent& c) { return coverageOf(c, camera, 0) < 1; })) {
      // The image cuts it: follow it beyond the border, so that the whole highlight is known.
      options.marginPx = kMarginFraction * std::max(camera.width, camera.height);
      components = traceLevelSets(field, batch, *fit.limitAngle, camera.width, camera.height, options);
    }
    for (const LevelSetComponent& c : components) {
      PredictedHighlight h;
      h.contour = c.outline;
      h.coverage = coverageOf(c, camera, options.marginPx);
      if (const Outcome<Ellipse> e = fitEllipse(c.outline.points)) h.ellipse = *e;
      // Its peak: the brightest point inside. A merged highlight holds several whose alpha is zero up to round-off: the one
      // nearest to the middle is taken, so that round-off decides nothing.
      bool found = false;
      const Pixel middle = centroid(c.outline);
      if (brightest)
        for (const BrightestPoint& b : *brightest) {
          if (!contains(c.outline, b.pixel)) continue;
          const bool darker = found && b.alpha > h.brightest.alpha + kSameAlpha;
          const bool asBright = found && std::abs(b.alpha - h.brightest.alpha) <= kSameAlpha;
          if (darker || (asBright && (b.pixel - middle).norm() >= (h.brightest.pixel - middle).norm())) continue;
          h.brightest = b;
          found = true;
        }
      if (!found) {
        // The smallest value may come from the reduced precision of the scan, just off the surface; the outline is exact.
        Outcome<BrightestPoint> at = observedBrightestPoint(*surface, camera, c.minimumAt);
        for (std::size_t i = 0; !at && i < c.outline.points.size(); ++i)
          at = observedBrightestPoint(*surface, camera, c.outline.points[i]);
        if (!at) continue;
        h.brightest = *at;
        h.brightest.pixel = c.minimumAt;
        h.brightest.alpha = c.minimum;
      }
      h.tangentPlane = Plane::through(h.brightest.point.position, h.brightest.point.normal);
      p.highlights.push_back(std::move(h));
    }
    if (p.highlights.empty()) p.failure = brightest ? Failure{Reason::NotReached, "no level set in the image"} : brightest.failure();
    return p;
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeLimitAngle() { return std::make_unique<LimitAngle>(); }

}  // namespace glint
