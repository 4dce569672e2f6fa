// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"
#include "core/model/walk.h"

namespace glint {
namespace {

/// Closed polyline through the directions that succeeded; runs of failed ones are gaps.
void outlineOf(const CanonicalContour& c, PredictedHighlight& h) {
  const int n = static_cast<int>(c.directions.size());
  std::vector<int> succeeded;
  for (int i = 0; i < n; ++i)
    if (!c.directions[i].failure) succeeded.push_back(i);
  h.contour = Polyline{c.pixels, true};
  h.coverage = n ? double(succeeded.size()) / n : 0;
  for (std::size_t k = 0; k < succeeded.size(); ++k) {
    const std::size_t next = (k + 1) % succeeded.size();
    if ((succeeded[next] - succeeded[k] + n) % n > 1) h.gaps.emplace_back(static_cast<int>(k), static_cast<int>(next));
  }
}

class Canonical final : public HighlightModel {
 public:
  std::string id() const override { return "canonical"; }
  std::string title() const override { return "Canonical JOLIMAS"; }
  std::string assumption() const override {
    return "After carrying each contour to its tangent plane by limit angles, the ellipses are outlines of one fixed ellipsoid in the "
           "virtual cameras: any smooth surface.";
  }
  std::string reference() const override { return "Morgand, Tamaazousti, Bartoli, canonical JOLIMAS (2022); method.md sections 6 to 8"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return true; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const override {
    if (!input.light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    std::vector<ConicView> conics;
    ModelFit fit;
    for (const TrainingView& v : input.views) {
      if (v.failure || !v.virtualCamera || !v.canonical || !v.canonical->ellipse) continue;
      conics.push_back({*v.virtualCamera, *v.canonical->ellipse, v.canonical->pixels});
      fit.frames.push_back(v.frame);
    }
    std::optional<CentreAnchor> anchor;
    if (!input.light->light.atInfinity()) anchor = CentreAnchor{input.light->light.position(), input.light->covariance};
    const Outcome<Reconstruction> r = fitEllipsoid(conics, anchor, settings);
    if (!r) return r.failure();
    store(*r, fit);
    fit.lightEstimate = input.light->light;
    fit.lightCovariance = input.light->covariance;
    fit.limitAngle = input.light->limitAngle;
    return fit;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    Prediction p;
    const auto fail = [&](Failure f) {
      p.failure = std::move(f);
      return p;
    };
    if (!surface) return fail({Reason::NoSurface, ""});
    if (!fit.ellipsoid) return fail({Reason::NotAnEllipsoid, fit.quadric ? describe(*fit.quadric) : ""});
    const Light light = fit.lightEstimate ? *fit.lightEstimate : Light::at(fit.ellipsoid->centre());
    const auto brightest = predictedBrightestPoints(*surface, camera, light, brightestOptions(settings));
    if (!brightest) return fail(brightest.failure());
    WalkOptions walkOptions;
    walkOptions.toleranceRad = settings.number("predict.walk_tolerance");
    for (const BrightestPoint& b : *brightest) {
      const TangentWalk walk(*surface, camera, b, light, walkOptions);
      const Outcome<Ellipse> e = outlineEllipse(*fit.ellipsoid, virtualCamera(camera, walk.tangentPlane()));
      if (!e) {
        p.failure = e.failure();
        continue;
      }
      PredictedHighlight h;
      h.brightest = b;
      h.tangentPlane = walk.tangentPlane();
      h.canonical = predictFromEllipse(walk, *surface, camera, *e, settings.integer("predict.directions"));
      outlineOf(*h.canonical, h);
      h.ellipse = h.canonical->ellipse;
      h.canonical->ellipse = *e;  // on T: what the viewer draws there
      if (h.contour.points.size() < 3) {
        // Too little to close a contour; the first named reason tells why.
        for (const DirectionResult& d : h.canonical->directions)
          if (d.failure) {
            p.failure = d.failure;
            break;
          }
        continue;
      }
      p.highlights.push_back(std::move(h));
    }
    if (!p.highlights.empty()) p.failure.reset();
    return p;
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeCanonical() { return std::make_unique<Canonical>(); }

}  // namespace glint
