// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/fit_ellipsoid.h"
#include "core/model/models.h"
#include "core/model/plausible.h"

namespace glint {
namespace {

class Primal final : public EllipsoidModel {
 public:
  std::string id() const override { return "primal"; }
  std::string title() const override { return "Primal JOLIMAS"; }
  std::string assumption() const override {
    return "The image ellipses are outlines of one fixed ellipsoid in the real cameras. Exact on planes.";
  }
  std::string reference() const override { return "Morgand et al., JOLIMAS (2016); method.md section 7"; }
  bool needsLight() const override { return false; }
  bool needsCanonicalContours() const override { return false; }
  ModelTraits traits() const override { return {{230, 159, 0}, false, true, ModelTraits::Assumes::Plane}; }
  std::optional<ConicView> outlineIn(const TrainingView& v) const override {
    return hasWholeEllipse(v) ? std::optional(conicViewOf(v, v.camera.projection())) : std::nullopt;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface*, const Settings&) const override {
    const Outcome<Ellipsoid> ellipsoid = ellipsoidOf(fit);
    if (!ellipsoid) return ellipsoid.failure();
    const Outcome<Ellipse> e = outlineEllipse(*ellipsoid, camera.projection());
    if (!e) return e.failure();
    BrightestPoint brightest;
    brightest.pixel = e->centre;
    brightest.point.position = ellipsoid->centre();
    brightest.point.normal = (camera.centreInWorld() - brightest.point.position).normalized();
    return std::vector{highlightFromEllipse(*e, brightest)};
  }

 private:
  std::optional<CentreAnchor> anchor(const FitInput& input) const override { return anchorFromCentres(input.views); }
  std::optional<Failure> unused(const TrainingView& v) const override {
    if (hasWholeEllipse(v)) return std::nullopt;
    if (std::optional<Failure> small = tooSmall(v.highlight.contour)) return small;
    if (std::optional<Failure> cut = notWhole(v)) return v.failure().value_or(*cut);
    return v.failure();
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makePrimal() { return std::make_unique<Primal>(); }

}  // namespace glint
