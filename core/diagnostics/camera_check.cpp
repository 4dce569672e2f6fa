// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnostics/camera_check.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/median.h"
#include "core/base/number_text.h"
#include "core/diagnostics/likely_mistakes.h"
#include "core/fit/evidence.h"
#include "core/fit/fit_engine.h"
#include "core/fit/training.h"
#include "core/light/estimate.h"
#include "core/model/model.h"
#include "core/model/plausible.h"
#include "core/model/reflectance_settings.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr int kMostViews = 8, kLeastViews = 4;
constexpr double kClearly = 0.5;       // of the residual as given: what is left by a change that is the truth is far less
constexpr double kClearlyFlip = 0.2;   // mirrored images leave pixels where the right ones leave hundredths
constexpr double kDetectionPx = 0.02;  // residuals as given below this are what detection leaves on good data
constexpr double kGoodRadii = 0.01;    // residual over the contour's radius below which a light explains the contours
constexpr double kOnlyPx = 1;          // px; the same for coarse images, where no other hypothesis has any light; said as a guess
constexpr double kFits = 0.05;  // the same after a change, where nothing fits as given: photographs of 8 bits leave 1 to 3 %
constexpr double kNothingRadii = 0.1;   // above: no light explains the contours
constexpr double kLeastFocalPct = 0.3;  // of errors that are told: smaller ones hide in those of surfaces
constexpr double kShiftSlackPx = 0.2;   // of what the highlights ask for about half a pixel
constexpr double kHalfGain = 0.7;       // of a half's residual as given that a true change leaves at most; noise leaves all of it

using Change = CameraChange;

class Check {
 public:
  Check(const Scene& scene, const ProgressFn& progress) : scene_(scene), progress_(progress) {}

  CameraCheck run() {
    gather();
    result_.views = static_cast<int>(views_.size());
    if (searched_ > 0 && dark_ == searched_)
      result_.findings.push_back(
          formatted("no highlight was found in any of %d frames (are they the right photographs? Is the "
                    "background brighter than the highlight, or the mask of another part?)",
                    searched_));
    if (!result_.whyNot.empty()) return std::move(result_);
    if (result_.views < kLeastViews) {
      result_.whyNot =
          formatted("%d frames show one whole highlight on a named surface; %d are needed", result_.views, kLeastViews);
      return std::move(result_);
    }
    const std::vector<int> all = every(0, 1);
    const std::optional<Fitted> given = fit({}, all, {});
    add("as given", given);
    if (!given || given->rmsPx > kGoodRadii * radiusPx_) explains(mirroredImages(), given);
    if (result_.findings.empty() && nothingFits(given) && !explains(misplacedMeshes(), given)) sayThatNothingFits(given);
    if (given && result_.findings.empty()) intrinsics(*given, all);
    return std::move(result_);
  }

 private:
  struct View {
    FrameEvidence evidence;
    std::shared_ptr<const Surface> surface;
  };
  struct Kind {
    std::string lobe = "auto", lamp = "auto";  ///< values of fit.lobe and fit.light_size
  };
  struct Fitted {
    double rmsPx = 0;
    Kind kind;
    std::shared_ptr<const ModelFit> model;
  };

  void stopIfAsked(int done, int total) const {
    if (!report(progress_, {"cameras", done, total})) throw Stopped{};
  }

  void add(const std::string& change, const std::optional<Fitted>& fitted) {
    result_.hypotheses.push_back({change, fitted ? std::optional<double>(fitted->rmsPx) : std::nullopt});
  }

  /// Up to kMostViews frames, spread evenly over those that a sequence offers.
  void gather() {
    const int n = static_cast<int>(scene_.frames.size());
    const SurfaceCache surfaces(scene_);
    std::set<std::string> lights;
    const int tried = std::min(n, 2 * kMostViews);
    for (int i = 0; i < tried && static_cast<int>(views_.size()) < kMostViews; ++i) {
      // Every other one first, those between them where some of these show no highlight.
      const int evens = (tried + 1) / 2, k = i < evens ? 2 * i : 2 * (i - evens) + 1;
      const int frame = static_cast<int>(static_cast<long long>(k) * n / tried);
      stopIfAsked(i, tried);
      const Frame& f = scene_.frames[static_cast<std::size_t>(frame)];
      if (f.surface.empty()) continue;
      FrameEvidence evidence = gatherEvidence(scene_, frame, FrameSource::Radiance, settings_);
      ++searched_;
      dark_ += evidence.failure && evidence.failure->reason == Reason::NoHighlight;
      if (evidence.failure || evidence.highlights.size() != 1) continue;
      const Highlight& h = evidence.highlights.front();
      if (h.clipped || (h.touchesBorder && !h.fromScene) || !(h.areaPx2 > 0)) continue;
      lights.insert(h.light);
      const Outcome<std::shared_ptr<const Surface>> surface = surfaces.surfaceOf(frame, meshPolicy(settings_));
      if (!surface) continue;
      radiusPx_ += std::sqrt(h.areaPx2 / EIGEN_PI);
      views_.push_back({std::move(evidence), *surface});
    }
    if (lights.size() > 1) result_.whyNot = "the frames show different lights";
    radiusPx_ /= std::max<double>(1, double(views_.size()));
  }

  std::vector<int> every(int first, int step) const {
    std::vector<int> list;
    for (int i = first; i < static_cast<int>(views_.size()); i += step) list.push_back(i);
    return list;
  }

  /// Light and lobe of some views as if the cameras were changed. @param near  a fit for cameras that differ little, if there is
  /// one
  std::optional<Fitted> fit(const Change& change, const std::vector<int>& which, const Kind& kind,
                            const Fitted* near = nullptr) const {
    stopIfAsked(0, 0);
    Settings settings = settings_;
    settings.set("fit.lobe", kind.lobe);
    settings.set("fit.light_size", kind.lamp);
    settings.set("fit.evidence", std::string("contours"));  // pixels would move the residuals away from them
    settings.set("light.bundle_points", 36);                // as good for comparisons, in half the time
    settings.set("fit.most_residual", 0.3);                 // what wrong cameras leave is measured here, it is no answer
    std::vector<TrainingView> views;
    for (const int i : which) {
      const View& v = views_[static_cast<std::size_t>(i)];
      const Camera& asRead = scene_.frames[static_cast<std::size_t>(v.evidence.frame)].camera;
      FrameEvidence evidence = v.evidence;
      change.move(evidence.highlights.front(), asRead);
      const Camera camera = change.of(asRead);
      TrainingView view = trainingView(evidence, 0, camera, v.surface);
      if (!view.seen) return std::nullopt;
      views.push_back(std::move(view));
    }
    LightEstimate known;  // should the search be needed all the same
    if (near) known.light = *near->model->lightEstimate;
    const Outcome<LightEstimate> light = near ? Outcome<LightEstimate>(known) : estimateLight(views, settings);
    const HighlightModel& model = radianceModel();
    FitInput input = fitInput(model, std::move(views), light, settings);
    if (near) input.near = near->model;
    const Outcome<ModelFit> fitted = accepted(model.fit(input, settings), PoorFits::Refuse);
    if (!fitted || fitted->residualPx.size() != which.size()) return std::nullopt;
    Fitted result;
    for (const double r : fitted->residualPx) result.rmsPx += r * r / double(which.size());
    result.rmsPx = std::sqrt(result.rmsPx);
    const ReflectanceFit& lobe = std::get<ReflectanceFit>(fitted->family);
    result.kind = {nameOf(lobe.lobe), lampChoiceOf(lobe)};
    result.model = std::make_shared<const ModelFit>(*fitted);
    return std::isfinite(result.rmsPx) ? std::optional<Fitted>(result) : std::nullopt;
  }

  /// Looks for the one of some mistakes whose undoing makes a light explain the contours. @return whether it was found
  bool explains(const std::vector<LikelyMistake>& mistakes, const std::optional<Fitted>& given) {
    constexpr double kAsGood = 1.2;  // residuals of symmetric bodies differ by less; the likelier mistake comes first
    const double sureBelow = kGoodRadii * radiusPx_;
    const LikelyMistake* best = nullptr;
    double bestPx = 0;
    int explained = 0;
    for (const LikelyMistake& mistake : mistakes) {
      // A change that half of the views refuse is not tried on all.
      const bool refused = !fit(mistake.undoing, every(0, 2), {});
      const std::optional<Fitted> fitted = refused ? std::nullopt : fit(mistake.undoing, every(0, 1), {});
      add(mistake.correction ? mistake.correction->words : "images " + mistake.is, fitted);
      explained += fitted.has_value();
      if (!fitted || (best && kAsGood * fitted->rmsPx >= bestPx)) continue;
      best = &mistake;
      bestPx = fitted->rmsPx;
      if (bestPx <= sureBelow) break;  // the list has the likely ones first
    }
    // Where no light explains anything else, coarse images may leave more.
    const double good = !given && explained == 1 ? std::max(kOnlyPx, sureBelow)
                        : nothingFits(given)     ? kFits * radiusPx_
                                                 : sureBelow;
    if (!best || bestPx > good || (given && bestPx > kClearlyFlip * given->rmsPx)) return false;
    const bool sure = given || bestPx <= sureBelow;
    const char* verb = best->many ? (sure ? " are " : " seem to be ") : (sure ? " is " : " seems to be ");
    result_.findings.push_back(
        best->subject + verb + best->is +
        formatted(": corrected, the highlights of %d frames fit one light to %.2g px; as given, ", result_.views, bestPx) +
        (given ? formatted("only to %.2g px", given->rmsPx) : std::string("no light explains them")) +
        (best->remedy.empty() ? "" : " (" + best->remedy + ")"));
    result_.correction = best->correction;
    return true;
  }

  /// Whether no light explains the contours, whatever one may expect of coarse images.
  bool nothingFits(const std::optional<Fitted>& given) const {
    return !given || given->rmsPx > std::max(kNothingRadii * radiusPx_, kOnlyPx);
  }

  /// By how much, as a median, the mirrored rays of all views pass beside the lamp that they share, rad. @param withCamera  a lamp that moves with
  /// the camera, in its axes. Nothing where they share none.
  std::optional<double> missOfRays(bool withCamera) const {
    std::vector<ReflectedRay> rays;
    for (const View& v : views_) {
      const Camera& camera = scene_.frames[static_cast<std::size_t>(v.evidence.frame)].camera;
      const TrainingView view = trainingView(v.evidence, 0, camera, v.surface);
      if (!view.seen) return std::nullopt;
      ReflectedRay ray = reflectedRay(view.seen->brightest, camera);
      if (withCamera) {
        ray.origin = camera.camFromWorld * ray.origin;
        ray.direction = camera.camFromWorld.linear() * ray.direction;
        ray.normal = camera.camFromWorld.linear() * ray.normal;
      }
      rays.push_back(ray);
    }
    const Outcome<Triangulation> lamp = triangulateLight(rays);
    if (!lamp) return std::nullopt;
    std::vector<double> misses;
    for (const ReflectedRay& r : rays)
      misses.push_back(std::acos(std::clamp(r.direction.dot(lamp->light.directionFrom(r.origin)), -1.0, 1.0)));
    return upperMedian(misses);
  }

  void sayThatNothingFits(const std::optional<Fitted>& given) {
    constexpr double kDegrees = 180 / double(EIGEN_PI);
    constexpr double kShared = 0.03, kNotShared = 0.1;  // rad: off-specular peaks and blur move mirrored rays by a degree
    const std::optional<double> fixed = missOfRays(false), carried = missOfRays(true);
    std::string words = formatted("no light explains the highlights of %d frames", result_.views);
    if (given)
      words += formatted(": the best leaves %.2g px, %.0f %% of their radius", given->rmsPx, 100 * given->rmsPx / radiusPx_);
    if (carried && *carried < kShared && !(fixed && *fixed < kNotShared))
      words += formatted(
          "; the lamp seems to move with the camera: in the camera's axes the mirrored rays pass one place by %.2g degrees, "
          "in the world's by %s (a flash or a ring light; Glint expects a lamp that stands still)",
          *carried * kDegrees, fixed ? formatted("%.2g", *fixed * kDegrees).c_str() : "more than can be measured");
    else
      words += formatted(
          "; none of %zu likely mistakes explains it. Either mesh, poses and photographs do not belong together (is it the "
          "mesh of another object, or is it shifted or deformed? Are the poses those of other photographs?), or the scene is "
          "outside of the models (print or wood under the highlight, bumps of a scanned mesh, brushed metal, a lamp that moves)",
          result_.hypotheses.size() - 1);
    result_.findings.push_back(words);
  }

  static Change along(const Change& direction, double by) {
    return {by * direction.cx, by * direction.cy, by * direction.logFocal};
  }

  /// How far to go along a change until the sum of squares is least: a parabola through three fits, then one about its end, where
  /// another lobe may fit better than for the wrong cameras. The shape of the lamp stays, small errors of cameras do not hide it;
  /// every fit starts from the lamp of the one about which it lies.
  std::optional<double> least(const Change& direction, const Fitted& given, const std::vector<int>& which) const {
    double at = 0;
    Fitted here = given;
    for (int round = 0; round < 2; ++round) {
      if (round > 0) {
        const std::optional<Fitted> again = fit(along(direction, at), which, {"auto", given.kind.lamp}, &given);
        if (!again) return std::nullopt;
        here = *again;
      }
      const auto up = fit(along(direction, at + 1), which, here.kind, &here),
                 down = fit(along(direction, at - 1), which, here.kind, &here);
      if (!up || !down) return std::nullopt;
      const double u = up->rmsPx * up->rmsPx, d = down->rmsPx * down->rmsPx, bend = u + d - 2 * here.rmsPx * here.rmsPx;
      if (!(bend > 0)) return std::nullopt;
      at += (d - u) / 2 / bend;
      constexpr double kFar = 10;  // steps: outside of what parabolas through these say
      if (!(std::abs(at) < kFar)) return std::nullopt;
    }
    return at;
  }

  /// Both halves of the views fit better after the change, too.
  bool bothHalvesGain(const Change& change, const Fitted& whole) const {
    for (const int first : {0, 1}) {
      const std::vector<int> half = every(first, 2);
      const std::optional<Fitted> before = fit({}, half, whole.kind, &whole), after = fit(change, half, whole.kind, &whole);
      if (!before || !after || !(after->rmsPx < kHalfGain * before->rmsPx)) return false;
    }
    return true;
  }

  void intrinsics(const Fitted& given, const std::vector<int>& all) {
    if (given.rmsPx < kDetectionPx) return;
    // Steps are large against detection and small against what bends the parabola.
    const Change shift{0.25, 0.25, 0}, focal{0, 0, 0.005};
    const std::optional<double> byShift = least(shift, given, all), byFocal = least(focal, given, all);
    std::optional<Fitted> atHalf, atFocal;
    Change half, longer;
    if (byShift) {
      result_.shiftPx = *byShift * shift.cx;
      half.cx = half.cy = *byShift < 0 ? -0.5 : 0.5;
      atHalf = fit(half, all, {"auto", given.kind.lamp}, &given);
      add("principal point half a pixel " + std::string(half.cx < 0 ? "less" : "more"), atHalf);
    }
    if (byFocal) {
      longer = along(focal, *byFocal);
      result_.focalPct = 100 * std::expm1(longer.logFocal);
      atFocal = fit(longer, all, {"auto", given.kind.lamp}, &given);
      add(formatted("focal length %+.2g %%", *result_.focalPct), atFocal);
    }
    const auto clear = [&](const std::optional<Fitted>& here, const std::optional<Fitted>& other, const Change& change) {
      return here && here->rmsPx < kClearly * given.rmsPx && !(other && other->rmsPx < here->rmsPx) &&
             bothHalvesGain(change, *here);
    };
    if (byShift && std::abs(*result_.shiftPx - half.cx) < kShiftSlackPx && clear(atHalf, atFocal, half)) {
      result_.correction = principalPointCorrection(half.cx);
      result_.findings.push_back(
          formatted("the principal point is half a pixel off: the highlights of %d frames fit one light to %.2g px with %+.1f px "
                    "added to cx and cy; as given, only to %.2g px ",
                    result_.views, atHalf->rmsPx, half.cx, given.rmsPx) +
          (half.cx < 0 ? "(COLMAP and nerfstudio put (0.5, 0.5) at the centre of the first pixel; here it is (0, 0))"
                       : "(was half a pixel subtracted twice?)"));
    } else if (byFocal && std::abs(*result_.focalPct) >= kLeastFocalPct && clear(atFocal, atHalf, longer)) {
      result_.correction = focalLengthCorrection(std::exp(longer.logFocal));
      result_.findings.push_back(formatted(
          "the focal length is wrong: the highlights of %d frames fit one light to %.2g px with one that is %.2g %% %s; as "
          "given, "
          "only to %.2g px (a wrong scale of the surface looks much the same)",
          result_.views, atFocal->rmsPx, std::abs(*result_.focalPct), *result_.focalPct > 0 ? "longer" : "shorter", given.rmsPx));
    }
  }

  const Scene& scene_;
  const ProgressFn& progress_;
  Settings settings_;
  std::vector<View> views_;
  int searched_ = 0, dark_ = 0;  ///< frames, and those without any highlight
  double radiusPx_ = 0;          ///< mean of the contours
  CameraCheck result_;
};

}  // namespace

CameraCheck checkCameras(const Scene& scene, const ProgressFn& progress) { return Check(scene, progress).run(); }

ConventionReport fullReport(const Scene& scene, const ProgressFn& progress) {
  ConventionReport report = conventionReport(scene, progress);
  if (report.everyFrameSeesSurface()) report.take(checkCameras(scene, progress));
  return report;
}

}  // namespace glint
