// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/refined_normals.h"

#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/light/contour_evidence.h"
#include "core/model/plausible.h"
#include "core/model/reflectance_settings.h"
#include "core/pipeline/carried.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/training.h"
#include "core/reflectance/pixel_patch.h"
#include "core/reflectance/radiance_field.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr int kRounds = 2;  // what a lobe adds to the limit angle hardly depends on the bumps
constexpr double kScanStepPx = 16;

double rms(const std::vector<double>& perView) {
  double sum = 0;
  for (const double r : perView) sum += r * r;
  return perView.empty() ? std::nan("") : std::sqrt(sum / double(perView.size()));
}

std::vector<BundleView> bundleViewsOf(const std::vector<TrainingView>& views, const Settings& settings) {
  std::vector<BundleView> result;
  for (const TrainingView& v : views)
    if (v.seen) result.push_back(bundleView(v, settings.integer("light.bundle_points")));
  return result;
}

/// The reflectance model of some views' contours; none if it fails.
std::optional<ModelFit> reflectanceOf(const std::vector<TrainingView>& views, const LightEstimate& light,
                                      const Settings& settings) {
  Settings contours = settings;
  contours.set("fit.evidence", std::string("contours"));
  contours.set("fit.most_residual", 1.0);  // what the bumps leave is what is looked for
  const Outcome<ModelFit> fit =
      accepted(fitModel(radianceModel(), views, Outcome<LightEstimate>(light), contours), PoorFits::Refuse);
  return fit && fit->lightEstimate && fit->as<ReflectanceFit>() ? std::optional<ModelFit>(*fit) : std::nullopt;
}

/// The angle of a reflectance fit's predicted contour near a pixel: the pixel's angle less its distance from that contour.
class LobeAngles {
 public:
  LobeAngles(const ModelFit& fit, const std::vector<TrainingView>& views) : light_(*fit.lightEstimate) {
    const ReflectanceFit& lobe = *fit.as<ReflectanceFit>();
    for (const TrainingView& v : views) {
      if (!v.seen) continue;
      auto view = std::make_shared<View>(v, lobe.lobe, lobe.roughness, *fit.lamp());
      const std::vector<RadiancePeak> peaks = view->field.peaks({v.highlight.peak}, kScanStepPx);
      if (!peaks.empty()) view->top = peaks.front().logRadiance;
      view->level = std::sqrt(-std::log(v.highlight.level));
      views_.push_back(std::move(view));
    }
  }
  std::optional<double> at(std::size_t v, const Pixel& p) const {
    const View& view = *views_[v];
    if (!view.top) return std::nullopt;
    const auto angle = [&](const Pixel& q) { return angleAt(view, q); };
    const auto root = [&](const Pixel& q) {
      const std::optional<double> log = view.field.at(q);
      return log ? std::sqrt(std::max(0.0, *view.top - *log)) : std::nan("");
    };
    const Pixel x(ContourEvidence::kStepPx, 0), y(0, ContourEvidence::kStepPx);
    const auto slope = [&](const auto& f) {
      return std::hypot(f(p + x) - f(p - x), f(p + y) - f(p - y)) / (2 * ContourEvidence::kStepPx);
    };
    const double distance = (root(p) - view.level) / slope(root);
    const double result = angle(p) - distance * slope(angle);
    return std::isfinite(result) ? std::optional<double>(result) : std::nullopt;
  }

 private:
  struct View {
    View(const TrainingView& v, Lobe lobe, const Roughness& roughness, const Lamp& lamp)
        : surface(v.surface), camera(v.camera), field(*surface, camera, lobe, roughness, lamp) {}
    std::shared_ptr<const Surface> surface;
    Camera camera;
    RadianceField field;
    std::optional<double> top;
    double level = 0;
  };
  double angleAt(const View& view, const Pixel& p) const {
    const Outcome<SurfacePoint> hit = view.surface->firstHit(view.camera.ray(p));
    if (!hit) return std::nan("");
    const Eigen::Vector3d eye = view.camera.centreInWorld();
    const SurfacePoint s = facing(*hit, eye);
    return incidentAngle(s.normal, light_.directionFrom(s.position), (eye - s.position).normalized());
  }
  Light light_;
  std::vector<std::shared_ptr<const View>> views_;
};

}  // namespace

std::string RefinedNormals::remark() const {
  return formatted(
      "the mesh's normals were corrected (light.refine_normals): by %.2g mrad (RMS) along the training contours, where %s "
      "leaves %.3g px instead of %.3g px; %.0f %% of a tilt shared by all contours stays undetermined, so the light may be "
      "further off than with the given normals; parts that no training highlight touched are as given",
      1e3 * slope, model.c_str(), refinedPx, plainPx, 100 * openTilt);
}

TrainingView onSurface(const TrainingView& view, std::shared_ptr<const Surface> surface) {
  TrainingView other = seenAgain(view, view.camera, carried(std::move(surface), view.fromScene));
  other.levels = view.levels;
  if (view.pixels && surface) other.pixels = std::make_shared<const PixelPatch>(glint::onSurface(*view.pixels, *surface));
  return other;
}

Outcome<std::optional<RefinedNormals>> refineNormals(const std::vector<TrainingView>& views, const LightEstimate& light,
                                                     const std::string& surface, const Settings& settings) {
  if (settings.text("light.solver") != "bundle")
    return Failure{Reason::NotSupported, "light.refine_normals needs light.solver=bundle"};
  if (meshPolicy(settings).normals == NormalPolicy::Facet)
    return Failure{Reason::NotSupported, "light.refine_normals does not work with surface.normals=facet"};
  const auto one = std::find_if(views.begin(), views.end(), [](const TrainingView& v) { return v.seen && v.surface; });
  if (one == views.end()) return Failure{Reason::TooFewViews, ""};
  const Surface& given = *one->surface;
  BundleOptions options;
  options.pointsPerView = settings.integer("light.bundle_points");
  options.robustPx = settings.number("light.robust_px");
  const double sigma = settings.number("light.normal_sigma");
  const std::vector<BundleView> bundleViews = bundleViewsOf(views, settings);

  // Bumps are what the better model leaves: a lobe that is no circle of one angle must not bend the normals.
  std::optional<ModelFit> lobe = reflectanceOf(views, light, settings);
  const bool constant = !light.extent && (!lobe || rms(light.residualPx) < rms(lobe->residualPx));
  if (constant) lobe.reset();
  if (!constant && !lobe) return std::optional<RefinedNormals>();
  RefinedNormals result;
  result.surface = surface;
  result.model = (constant ? levelSetModel() : radianceModel()).id();
  result.plainPx = rms(constant ? light.residualPx : lobe->residualPx);
  std::vector<TrainingView> now = views;
  for (int round = 0; round < (constant ? 1 : kRounds); ++round) {
    const std::optional<LobeAngles> angles = constant ? std::nullopt : std::optional<LobeAngles>(std::in_place, *lobe, now);
    const Outcome<NormalRefinement> refined =
        refineNormals(bundleViews, constant ? light.light : *lobe->lightEstimate, sigma, options,
                      angles ? ContourAngle([&](std::size_t v, const Pixel& p) { return angles->at(v, p); }) : ContourAngle());
    if (!refined) return refined.failure();
    if (!refined->correction.changesAnything()) return std::optional<RefinedNormals>();
    const Outcome<std::shared_ptr<const Surface>> mesh = correctedMesh(given, meshPolicy(settings), refined->correction);
    if (!mesh) return mesh.failure();
    now.clear();
    for (const TrainingView& v : views) now.push_back(!v.seen ? v : onSurface(v, *mesh));
    const Outcome<LightEstimate> again = estimateLight(now, settings);
    if (!again) return std::optional<RefinedNormals>();
    if (!constant) lobe = reflectanceOf(now, *again, settings);
    if (!constant && !lobe) return std::optional<RefinedNormals>();
    result.mesh = *mesh;
    result.slope = refined->slope;
    result.openTilt = refined->openTilt;
    result.refinedPx = rms(constant ? again->residualPx : lobe->residualPx);
    if (constant) result.uncertainty = refined->uncertainty;
  }
  if (!(result.refinedPx < result.plainPx))
    return std::optional<RefinedNormals>();  // the corrected mesh does not keep what the correction promised
  return std::optional<RefinedNormals>(std::move(result));
}

}  // namespace glint
