// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"

namespace glint {
namespace {

class Dual final : public EllipsoidModel {
 public:
  std::string id() const override { return "dual"; }
  std::string title() const override { return "Dual JOLIMAS"; }
  std::string assumption() const override {
    return "The image ellipses are outlines of one fixed ellipsoid in the virtual (mirrored) cameras. Approximate where the "
           "curvature is constant.";
  }
  std::string reference() const override { return "Morgand et al., dual JOLIMAS (2017); method.md section 7"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }
  ModelTraits traits() const override { return {{86, 180, 233}, true, true, ModelTraits::Assumes::ConstantCurvature}; }
  std::optional<ConicView> outlineIn(const TrainingView& v) const override {
    if (!v.seen || !hasWholeEllipse(v)) return std::nullopt;
    return conicViewOf(v, v.seen->virtualCamera);
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    if (!surface) return Failure{Reason::NoSurface, ""};
    const Outcome<Ellipsoid> ellipsoid = ellipsoidOf(fit);
    if (!ellipsoid) return ellipsoid.failure();
    // The model stores no light: its brightest point is that of a light at the ellipsoid's centre.
    const auto brightest = brightestPointsFor(*surface, camera, Light::at(ellipsoid->centre()), settings, fit.hints);
    if (!brightest) return brightest.failure();
    std::vector<PredictedHighlight> found;
    std::optional<Failure> why;
    for (const BrightestPoint& b : *brightest) {
      const Plane plane = Plane::through(b.point.position, b.point.normal);
      const Outcome<Ellipse> e = outlineEllipse(*ellipsoid, virtualCamera(camera, plane));
      if (!e) {
        why = e.failure();
        continue;
      }
      PredictedHighlight h = highlightFromEllipse(*e, b);
      h.tangentPlane = plane;
      found.push_back(std::move(h));
    }
    dropEnclosed(found);
    return {std::move(found), std::move(why)};
  }

 private:
  std::optional<Failure> unused(const TrainingView& v) const override {
    if (!v.seen) return v.seen.failure();
    return notWhole(v);
  }
  void complete(const FitInput& input, ModelFit& fit) const override { fit.hints = hintsOf(input); }
};

}  // namespace

std::unique_ptr<HighlightModel> makeDual() { return std::make_unique<Dual>(); }

}  // namespace glint
