// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/fit_engine.h"

#include <algorithm>

#include "core/base/progress.h"
#include "core/pipeline/training.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

class LightFitter {
 public:
  LightFitter(const Scene& scene, const SurfaceCache& surfaces, const Settings& settings)
      : scene_(scene), surfaces_(surfaces), settings_(settings), policy_(meshPolicy(settings)) {}

  LightFit run(std::vector<TrainingView> views, const SurfaceCorrection* chosen) const {
    // The light of the mesh as given only tells whether to smooth it.
    const bool smooth = chosen && chosen->smoothed && settings_.text("light.smooth_mesh") != "off" && oneMesh(views);
    LightFit fit{
        smooth ? Outcome<LightEstimate>(Failure{Reason::NoLight, ""}) : estimateLight(views, settings_), std::move(views), {}};
    smoothMesh(fit, chosen);
    if (fit.light && settings_.flag("light.refine_depth")) refineDepth(fit);
    if (fit.light && settings_.flag("light.refine_normals")) refineNormals(fit);
    return fit;
  }

 private:
  std::vector<TrainingView> corrected(std::vector<TrainingView> views, const SurfaceCorrection& correction) const {
    correctViews(views, scene_, surfaces_, correction, policy_);
    return views;
  }

  void refineDepth(LightFit& fit) const {
    for (const TrainingView& v : fit.views)
      if (!scene_.frames[static_cast<std::size_t>(v.frame)].surface.empty())
        return;  // a mesh or a shape has no depth that could be off
    const Outcome<DepthRefinement> refined = glint::refineDepth(fit.views, fit.light->light, settings_);
    if (!refined || !refined->correction.changesAnything()) return;
    SurfaceCorrection correction;
    correction.depth = refined->correction;
    std::vector<TrainingView> views = corrected(fit.views, correction);
    const Outcome<LightEstimate> again = estimateLight(views, settings_);
    if (!again || !(again->rmsPx < fit.light->rmsPx)) return;  // the corrected surfaces do not keep what the correction promised
    fit = {again, std::move(views), std::move(correction)};
    if (!fit.light->extent && refined->uncertainty) fit.light->uncertainty = refined->uncertainty;
  }

  /// The mesh that all views see: one correction describes the errors of one mesh only.
  std::optional<std::string> oneMesh(const std::vector<TrainingView>& views) const {
    if (views.empty()) return std::nullopt;
    const std::string surface = surfaces_.keyOf(views.front().frame);
    if (!scene_.hasTriangles(surface)) return std::nullopt;  // a shape is exact, a depth map has a depth that could be off
    if (std::any_of(views.begin(), views.end(), [&](const TrainingView& v) { return surfaces_.keyOf(v.frame) != surface; }))
      return std::nullopt;
    return surface;
  }

  void smoothMesh(LightFit& fit, const SurfaceCorrection* chosen) const {
    const std::optional<std::string> surface = oneMesh(fit.views);
    if (!surface || settings_.text("light.smooth_mesh") == "off") return;
    fit.correction.smoothed = chosen ? chosen->smoothed : smoothedMesh(fit.views, fit.light, *surface, settings_);
    if (!fit.correction.smoothed) return;
    fit.views = corrected(std::move(fit.views), fit.correction);
    fit.light = estimateLight(fit.views, settings_);
  }

  void refineNormals(LightFit& fit) const {
    const std::optional<std::string> surface = oneMesh(fit.views);
    if (!surface) return;
    // Bumps are described in the world, where those of an object that moves, or is carried to another lamp, do not stay.
    const auto moves = [&](const TrainingView& v) {
      return v.known || !standsStill(scene_.frames[static_cast<std::size_t>(v.frame)]);
    };
    if (std::any_of(fit.views.begin(), fit.views.end(), moves)) return;
    Outcome<std::optional<RefinedNormals>> refined = glint::refineNormals(fit.views, *fit.light, *surface, settings_);
    if (!refined || !*refined) return;
    const std::optional<ParameterUncertainty> uncertainty = (*refined)->uncertainty;
    fit.correction.normals = **std::move(refined);
    fit.views = corrected(std::move(fit.views), fit.correction);
    if (Outcome<LightEstimate> again = estimateLight(fit.views, settings_)) fit.light = std::move(again);
    if (!fit.light->extent && uncertainty) fit.light->uncertainty = uncertainty;
  }

  const Scene& scene_;
  const SurfaceCache& surfaces_;
  const Settings& settings_;
  MeshPolicy policy_;
};

}  // namespace

LightFit fitLight(std::vector<TrainingView> views, const Scene& scene, const SurfaceCache& surfaces, const Settings& settings,
                  const SurfaceCorrection* chosen) {
  return LightFitter(scene, surfaces, settings).run(std::move(views), chosen);
}

FitInput fitInput(const HighlightModel& model, std::vector<TrainingView> views,
                  const std::optional<Outcome<LightEstimate>>& light, const Settings& settings, KnownPixels pixels,
                  const ProgressFn& progress) {
  FitInput input;
  input.views = std::move(views);
  input.pixels = std::move(pixels);
  input.progress = progress;
  if (!model.needsLight() || !light) return input;
  if (!*light) {
    input.lightFailure = light->failure();
    return input;
  }
  input.light = **light;
  if (model.needsCanonicalContours())
    parallelFor(
        static_cast<int>(input.views.size()),
        [&](int i) {
          TrainingView& v = input.views[static_cast<std::size_t>(i)];
          if (!v.canonical) addCanonicalContour(v, input.light->light, settings);
        },
        progress, "canonical");
  return input;
}

Outcome<ModelFit> fitModel(const HighlightModel& model, std::vector<TrainingView> views,
                           const std::optional<Outcome<LightEstimate>>& light, const Settings& settings, KnownPixels pixels,
                           const ProgressFn& progress) {
  return model.fit(fitInput(model, std::move(views), light, settings, std::move(pixels), progress), settings);
}

}  // namespace glint
