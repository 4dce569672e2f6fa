// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"
#include "core/model/walk.h"


namespace glint {
namespace {

constexpr int kSubdivisions = 8;  // chords of 36 directions cost 0.13 % of the diameter on a circle; 288 cost 0.002 %
constexpr int kStencil = 6;       // points of the interpolating polynomial: its error is below the walk's other errors

/// Polynomial through the pixels of the directions first .. first + count - 1 (cyclic), at direction number `at`.
Pixel interpolate(const std::vector<Pixel>& pixelOf, int first, int count, double at) {
  const int n = static_cast<int>(pixelOf.size());
  Pixel sum(0, 0);
  for (int a = 0; a < count; ++a) {
    double weight = 1;
    for (int b = 0; b < count; ++b)
      if (b != a) weight *= (at - (first + b)) / double(a - b);
    sum += weight * pixelOf[((first + a) % n + n) % n];
  }
  return sum;
}

/// Closed contour through the directions that succeeded; runs of failed ones are gaps. Between neighbouring directions the
/// curve is interpolated in the azimuth: straight chords would flatten it.
void outlineOf(const CanonicalContour& c, PredictedHighlight& h) {
  const int n = static_cast<int>(c.directions.size());
  std::vector<Pixel> pixelOf(n, Pixel(0, 0));
  std::vector<char> ok(n, 0);
  for (int i = 0, k = 0; i < n; ++i)
    if (!c.directions[i].failure) ok[i] = 1, pixelOf[i] = c.pixels[k++];
  const auto isOk = [&](int i) { return ok[(i % n + n) % n] != 0; };
  h.coverage = n ? double(c.pixels.size()) / n : 0;
  h.contour = Polyline{{}, true};
  for (int i = 0; i < n; ++i) {
    if (!ok[i]) continue;
    h.contour.points.push_back(pixelOf[i]);
    if (!isOk(i + 1)) {
      h.gaps.emplace_back(static_cast<int>(h.contour.points.size()) - 1, static_cast<int>(h.contour.points.size()));
      continue;
    }
    int first = i, last = i + 1;  // grow the stencil evenly within the run
    while (last - first + 1 < std::min(kStencil, n)) {
      const bool left = isOk(first - 1), right = isOk(last + 1);
      if (!left && !right) break;
      if (left && (!right || i - first <= last - i - 1)) --first;
      else ++last;
    }
    for (int k = 1; k < kSubdivisions; ++k)
      h.contour.points.push_back(interpolate(pixelOf, first, last - first + 1, i + double(k) / kSubdivisions));
  }
  // The last gap closes on the first vertex.
  const int count = static_cast<int>(h.contour.points.size());
  for (auto& [from, to] : h.gaps) to %= std::max(1, count);
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
    const Outcome<Reconstruction> r = fitEllipsoid(conics, anchorAtLight(input), settings);
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
    const auto brightest = brightestPointsFor(*surface, camera, light, settings);
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
    dropEnclosed(p.highlights);
    if (!p.highlights.empty()) p.failure.reset();
    return p;
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeCanonical() { return std::make_unique<Canonical>(); }

}  // namespace glint
