// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/training.h"

#include <algorithm>
#include <cmath>

#include "core/light/contour_evidence.h"
#include "core/light/estimate.h"
#include "core/light/left_out.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/model/walk.h"

namespace glint {

namespace {
Outcome<SeenOnSurface> seenOnSurface(const TrainingView& view) {
  if (std::optional<Failure> small = tooSmall(view.highlight.contour)) return *std::move(small);
  if (!view.surface) return Failure{Reason::NoSurface, ""};
  if (view.highlight.touchesBorder && view.cut != CutUse::Pixels) {
    if (view.cut == CutUse::None) return Failure{Reason::OutsideImage, "the image border cuts the highlight"};
    if (view.highlight.peakCut) return Failure{Reason::OutsideImage, "the image border cuts off the highlight's peak"};
  }
  const Outcome<BrightestPoint> brightest = observedBrightestPoint(*view.surface, view.camera, view.highlight.peak);
  if (!brightest) return brightest.failure();
  const Plane plane = Plane::through(brightest->point.position, brightest->point.normal);
  return SeenOnSurface{*brightest, plane, virtualCamera(view.camera, plane)};
}
}  // namespace

TrainingView trainingView(const FrameEvidence& evidence, int index, const Camera& camera, std::shared_ptr<const Surface> surface,
                          CutUse cut) {
  TrainingView view;
  view.cut = cut;
  view.frame = evidence.frame;
  view.frameId = evidence.id;
  view.camera = camera;
  view.highlight = evidence.highlights[index];
  view.levels = view.highlight.otherLevels;
  view.surface = std::move(surface);
  view.seen = seenOnSurface(view);
  return view;
}

TrainingView seenAgain(const TrainingView& view, const Camera& camera, std::shared_ptr<const Surface> surface) {
  FrameEvidence evidence;
  evidence.frame = view.frame;
  evidence.id = view.frameId;
  evidence.highlights = {view.highlight};
  TrainingView again = trainingView(evidence, 0, camera, std::move(surface), view.cut);
  again.known = view.known;
  again.fromScene = view.fromScene;
  return again;
}

namespace {

/// Whether the limit angle gets an extent. With -1 the views decide: an extent is tried only if one constant leaves visible,
/// systematic residuals, and kept if it predicts left-out views better by more than the standard error of the gain.
int limitOrders(const std::vector<ContourEvidence>& evidence, const std::vector<int>& places, const Bundle& constant,
                const BundleOptions& options, int asked) {
  if (asked >= 0) return asked;
  constexpr double kVisiblePx = 0.05;  // a renderer's own noise and the detection stay below
  constexpr double kSystematic =
      0.5;  // of the points count as independent: less means that residuals keep their sign along contours
  if (countOf(places) < 4 || !(constant.rmsPx > kVisiblePx) || !constant.uncertainty) return 0;
  if (constant.uncertainty->degreesOfFreedom > kSystematic * double(options.pointsPerView) * double(places.size())) return 0;
  constexpr int kLeftOut = 6;  // more places left out would not change a choice between two
  const Outcome<LeftOutErrors> errors = leftOutErrors(evidence, places, constant.light, options, kLeftOut);
  return errors && predictsLeftOutBetter(errors->directed, errors->constant) ? 1 : 0;
}

/// The lamp of all views, where it is known; null where it is not, or where they were not carried to one.
const KnownLamp* knownLampOf(const std::vector<TrainingView>& views) {
  const KnownLamp* known = nullptr;
  for (const TrainingView& v : views) {
    if (!v.seen) continue;
    if (!v.known || (known && !(known->lamp == v.known->lamp))) return nullptr;
    known = &*v.known;
  }
  return known;
}

/// The known light, with the limit angle that the contours show under it.
Outcome<LightEstimate> knownLight(const std::vector<TrainingView>& views, const Lamp& lamp, const Settings& settings) {
  LightEstimate estimate;
  estimate.light = lightOf(lamp);
  estimate.known = lamp.shape;
  estimate.solver = "known";
  BundleOptions options;
  options.pointsPerView = settings.integer("light.bundle_points");
  options.robustPx = settings.number("light.robust_px");
  options.holdLight = true;
  std::vector<ReflectedRay> rays;
  std::vector<BundleView> bundleViews;
  for (const TrainingView& v : views) {
    if (!v.seen) continue;
    rays.push_back(reflectedRay(v.seen->brightest, v.camera));
    bundleViews.push_back(bundleView(v, options.pointsPerView));
  }
  estimate.condition = conditionOf(rays);
  const Outcome<Bundle> b = bundleLight(bundleViews, estimate.light, options);
  if (!b) return b.failure();
  estimate.limitAngle = b->limitAngle;
  estimate.rmsPx = b->rmsPx;
  estimate.residualPx = b->typicalPx;
  estimate.uncertainty = b->uncertainty;
  return estimate;
}

/// The light, whichever side of the surface it is on.
Outcome<LightEstimate> estimateAnyLight(const std::vector<TrainingView>& views, const Settings& settings) {
  std::vector<ReflectedRay> rays;
  std::vector<BundleView> bundleViews;
  const int points = settings.integer("light.bundle_points");
  for (const TrainingView& v : views) {
    if (!v.seen) continue;
    rays.push_back(reflectedRay(v.seen->brightest, v.camera));
    bundleViews.push_back(bundleView(v, points));
  }
  const Outcome<Triangulation> t = triangulateLight(rays);
  if (!t && t.failure().reason == Reason::TooFewViews)
    return Failure{Reason::TooFewViews, t.failure().detail + unusedViews(views)};
  const bool bundle = settings.text("light.solver") == "bundle";
  LightEstimate estimate;
  estimate.solver = "triangulated";
  estimate.condition = conditionOf(rays);
  if (t) {
    estimate.light = t->light;
    if (!t->light.atInfinity()) estimate.covariance = t->covariance;
  } else if (!bundle || t.failure().reason != Reason::LightBehindSurface || rays.empty()) {
    return t.failure();
  } else {
    // The rays of a narrow baseline may meet behind the surface; contours still tell: start at infinity along the mean ray.
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const ReflectedRay& r : rays) mean += r.direction;
    if (!(mean.norm() > 1e-6)) return t.failure();  // directions that cancel have no mean
    estimate.light = Light::towards(mean);
  }
  const Outcome<std::vector<ContourEvidence>> evidence = contoursOnSurfaces(bundleViews, points);
  if (bundle) {
    BundleOptions options;
    options.pointsPerView = points;
    options.robustPx = settings.number("light.robust_px");
    if (!evidence) return evidence.failure();
    Outcome<Bundle> b = bundleLight(*evidence, bundleViews.size(), estimate.light, options);
    if (!b) return b.failure();
    if (limitOrders(*evidence, placesOf(bundleViews), *b, options, settings.integer("light.limit_orders")) > 0) {
      options.limitOrders = 1;
      const Outcome<Bundle> directed = bundleLight(*evidence, bundleViews.size(), b->light, options);
      if (directed && !lightBehind(views, directed->light)) b = directed;
    }
    if (settings.flag("light.refine_poses")) {
      const Outcome<PoseRefinement> refined = refinePoses(bundleViews, b->light, settings.number("light.pose_sigma"), options);
      if (refined && !lightBehind(views, refined->bundle.light)) b = refined->bundle;
    }
    estimate.extent = b->extent;
    estimate.solver = "bundle";
    estimate.light = b->light;
    estimate.limitAngle = b->limitAngle;
    estimate.rmsPx = b->rmsPx;
    estimate.residualPx = b->typicalPx;
    estimate.uncertainty = b->uncertainty;
    estimate.covariance.reset();
    if (!b->light.atInfinity() && b->positionCovariance.allFinite()) estimate.covariance = b->positionCovariance;
    return estimate;
  }
  estimate.limitAngle = medianContourAngle(views, estimate.light, points);
  if (evidence) estimate.residualPx = typicalResidualsPx(*evidence, bundleViews.size(), estimate.light, estimate.limitAngle);
  return estimate;
}

}  // namespace

Outcome<LightEstimate> estimateLight(const std::vector<TrainingView>& views, const Settings& settings) {
  const KnownLamp* const known = knownLampOf(views);
  Outcome<LightEstimate> estimate = known ? knownLight(views, known->lamp, settings) : estimateAnyLight(views, settings);
  if (!estimate) return estimate;
  if (std::optional<Failure> behind = lightBehind(views, estimate->light)) return *std::move(behind);
  return estimate;
}

Outcome<DepthRefinement> refineDepth(const std::vector<TrainingView>& views, const Light& start, const Settings& settings) {
  if (settings.text("light.solver") != "bundle")
    return Failure{Reason::NotSupported, "light.refine_depth needs light.solver=bundle"};
  if (settings.integer("surface.depth_fuse") > 0)
    return Failure{Reason::NotSupported, "light.refine_depth needs surface.depth_fuse=0: it corrects the frames' own maps"};
  BundleOptions options;
  options.pointsPerView = settings.integer("light.bundle_points");
  std::vector<BundleView> bundleViews;
  for (const TrainingView& v : views)
    if (v.seen) bundleViews.push_back(bundleView(v, options.pointsPerView));
  options.robustPx = settings.number("light.robust_px");
  return refineDepth(bundleViews, start, settings.number("light.depth_sigma"), options);
}

BundleView bundleView(const TrainingView& view, int points) {
  require(bool(view.seen), "bundleView: a view that can be used");
  return {view.camera, view.surface.get(),
          view.highlight.touchesBorder ? levelSetPoints(view, points) : view.highlight.contour.points, view.seen->brightest};
}

void addCanonicalContour(TrainingView& view, const Light& light, const Settings& settings) {
  if (!view.seen || view.highlight.touchesBorder) return;
  WalkOptions options;
  options.toleranceRad = settings.number("fit.walk_tolerance");
  const TangentWalk walk(*view.surface, view.camera, view.seen->brightest, light, options);
  view.canonical = canonicalContour(walk, view.camera, view.highlight.contour, settings.integer("fit.directions"));
}

}  // namespace glint
