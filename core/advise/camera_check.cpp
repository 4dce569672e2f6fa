// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/camera_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/advise/camera_doubts.h"
#include "core/advise/known_lamp_check.h"
#include "core/advise/likely_mistakes.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/light/estimate.h"
#include "core/light/shared_lamp.h"
#include "core/model/model.h"
#include "core/model/plausible.h"
#include "core/model/reflectance_settings.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/light_frame_choice.h"
#include "core/pipeline/smoothed_mesh.h"
#include "core/pipeline/training.h"
#include "core/surface/mesh_policy.h"

namespace glint {
namespace {

constexpr int kMostViews = 8, kLeastViews = 4;
constexpr double kClearly = 0.5;       // of the residual as given: what is left by a change that is the truth is far less
constexpr double kClearlyOther = 0.2;  // mirrored images and turned meshes leave pixels where the right ones leave hundredths
constexpr double kDetectionPx = 0.02;  // residuals as given below this are what detection leaves on good data
constexpr double kGoodRadii = 0.01;    // residual over the contour's radius below which a light explains the contours
constexpr double kFits = 0.05;  // the same after a change, where nothing fits as given: photographs of 8 bits leave 1 to 3 %
constexpr double kNothingRadii = 0.1;   // above: no light explains the contours
constexpr double kCoarsePx = 1;         // px; the same for small highlights in coarse images
constexpr double kLeastFocalPct = 0.3;  // of errors that are told: smaller ones hide in those of surfaces
constexpr double kShiftSlackPx = 0.2;   // of what the highlights ask for about half a pixel
constexpr double kHalfGain = 0.7;       // of a half's residual as given that a true change leaves at most; noise leaves all of it
// By how much mirrored rays pass a lamp, rad. Off-specular peaks, blur and lamps with a size move them by a few degrees.
constexpr double kMeets = 0.05, kMayMeet = 0.2, kSameMiss = 1e-9;
// Share of the radius, without the noise of points, above which a light explains contours poorly: photographs of 8 bits leave
// 1 to 3 %; a mesh that is a tenth too large leaves 4.5 %.
constexpr double kPoorlyRadii = 0.04, kPoorlyPx = 0.3;  // small highlights in 8 bits leave 0.2 px

class Check {
 public:
  /// @param world  surfaces in the world, where `scene` is in the coordinates of the cameras; else null
  Check(const Scene& scene, const ProgressFn& progress, const SurfaceCache* world = nullptr)
      : scene_(scene),
        progress_(progress),
        surfaces_(world ? SurfaceCache(scene, *world) : SurfaceCache(scene)),
        carried_(world != nullptr) {}

  CameraCheck run() {
    gather();
    result_.views = static_cast<int>(views_.size());
    if (2 * dark_ > static_cast<int>(searched_.size()))
      result_.findings.push_back(noHighlightText(scene_, searched_, dark_, settings_));
    if (!result_.whyNot.empty()) return std::move(result_);
    if (result_.views < kLeastViews) {
      result_.whyNot =
          formatted("%d frames show a whole highlight on a named surface; %d are needed", result_.views, kLeastViews);
      return std::move(result_);
    }
    asGiven_ = lampAfter({});
    if (const LightFrameChoice choice = lightFrame(); choice.frame == LightFrame::Camera && !carried_) {
      result_ = Check(inCameras(scene_), progress_, &surfaces_).run();
      result_.lightFrame = choice.reason;
      return std::move(result_);
    }
    if (asGiven_ && asGiven_->miss < EIGEN_PI / 2) result_.missDeg = degrees(asGiven_->miss);
    const std::optional<Fitted> given = asGiven_ ? fit({}, *asGiven_, agreeing(*asGiven_), {}) : std::nullopt;
    add("as given", given);
    const std::size_t before = result_.findings.size();
    // Below that nothing else could be clearly better.
    if (given && given->rmsPx <= std::max(kGoodRadii * radiusOf(*asGiven_), kDetectionPx / kClearlyOther)) {
      intrinsics(*given);
    } else if (!explains(given) && !explainsShifted(given)) {
      if (nothingFits(given))
        sayThatNothingFits(given);
      else if (given)
        intrinsics(*given);
    }
    if (given && result_.findings.size() == before && result_.whyNot.empty()) {
      sayThatItFitsPoorly(*given);
      sayWhoIsOutvoted();
    }
    return std::move(result_);
  }

 private:
  struct View {
    FrameEvidence evidence;  ///< with the highlights of one light
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
  /// A mistake whose undoing lets mirrored rays meet.
  struct Suspect {
    const LikelyMistake* mistake;
    int place;  ///< in the list: likelier ones come first
    SharedLamp lamp;
    std::optional<Fitted> fitted;
    /// Steps of half as much again: those of one step do as well.
    int step() const { return static_cast<int>(std::floor(std::log(std::max(lamp.miss, 0.01)) / std::log(1.5))); }
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
    std::map<std::string, int> lights;
    const int tried = std::min(n, 2 * kMostViews);
    for (int i = 0; i < tried && static_cast<int>(views_.size()) < kMostViews; ++i) {
      // Every other one first, those between them where some of these show no highlight.
      const int evens = (tried + 1) / 2, k = i < evens ? 2 * i : 2 * (i - evens) + 1;
      const int frame = static_cast<int>(static_cast<long long>(k) * n / tried);
      stopIfAsked(i, tried);
      const Frame& f = scene_.frames[static_cast<std::size_t>(frame)];
      if (f.surface.empty()) continue;
      FrameEvidence evidence = gatherEvidence(scene_, frame, FrameSource::Radiance, settings_);
      searched_.push_back(frame);
      dark_ += evidence.failure && evidence.failure->reason == Reason::NoHighlight;
      std::erase_if(evidence.highlights, [](const Highlight& h) { return h.clipped || h.touchesBorder || !(h.areaPx2 > 0); });
      if (evidence.failure || evidence.highlights.empty()) continue;
      const Outcome<std::shared_ptr<const Surface>> surface = surfaces_.surfaceOf(frame, meshPolicy(settings_));
      if (!surface) continue;
      std::set<std::string> here;
      for (const Highlight& h : evidence.highlights) here.insert(h.light);
      for (const std::string& light : here) ++lights[light];
      views_.push_back({std::move(evidence), *surface});
    }
    if (!lights.empty())
      keepLight(
          std::max_element(lights.begin(), lights.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first,
          lights.size());
  }

  /// The views and highlights of the light that most frames show.
  void keepLight(const std::string& light, std::size_t ofLights) {
    constexpr std::size_t kMostHighlights = 6;  // of a frame: more are texture, and the lamp's is among the largest
    for (View& v : views_) {
      std::vector<Highlight>& list = v.evidence.highlights;
      std::erase_if(list, [&](const Highlight& h) { return h.light != light; });
      std::stable_sort(list.begin(), list.end(), [](const Highlight& a, const Highlight& b) { return a.areaPx2 > b.areaPx2; });
      if (list.size() > kMostHighlights) list.resize(kMostHighlights);
    }
    std::erase_if(views_, [](const View& v) { return v.evidence.highlights.empty(); });
    if (ofLights > 1 && static_cast<int>(views_.size()) < kLeastViews) result_.whyNot = "the frames show different lights";
  }

  const Camera& cameraOf(const View& v) const { return scene_.frames[static_cast<std::size_t>(v.evidence.frame)].camera; }

  /// The lamp that the mirrored rays of all highlights share; `chosen` are places among the highlights of each view.
  std::optional<SharedLamp> lampAfter(const CameraChange& change) const {
    stopIfAsked(0, 0);
    std::vector<std::vector<ReflectedRay>> rays(views_.size());
    std::vector<std::vector<int>> places(views_.size());
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const View& v = views_[i];
      const Camera camera = change.of(cameraOf(v));
      for (std::size_t k = 0; k < v.evidence.highlights.size(); ++k) {
        Highlight h = v.evidence.highlights[k];
        change.move(h, cameraOf(v));
        const Outcome<BrightestPoint> seen = observedBrightestPoint(*v.surface, camera, h.peak);
        if (!seen) continue;
        rays[i].push_back(reflectedRay(*seen, camera));
        places[i].push_back(static_cast<int>(k));
      }
    }
    std::optional<SharedLamp> lamp = sharedLamp(rays);
    if (!lamp) return lamp;
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (int& chosen = lamp->chosen[i]; chosen >= 0) chosen = places[i][static_cast<std::size_t>(chosen)];
    return lamp;
  }

  /// px, mean of the highlights of the lamp.
  double radiusOf(const SharedLamp& lamp) const {
    const std::vector<int> list = agreeing(lamp);
    double sum = 0;
    for (const int i : list) {
      const std::size_t view = static_cast<std::size_t>(i), chosen = static_cast<std::size_t>(lamp.chosen[view]);
      sum += std::sqrt(views_[view].evidence.highlights[chosen].areaPx2 / EIGEN_PI) / double(list.size());
    }
    return sum;
  }

  /// Views whose highlight is that of the lamp; every second one of them, from the first or second one on, is a half. A single
  /// frame may show something else.
  static std::vector<int> agreeing(const SharedLamp& lamp, int first = 0, int step = 1) {
    constexpr double kOther = 3;  // times the miss of three quarters of the views
    std::vector<int> list, chosen;
    for (std::size_t i = 0; i < lamp.misses.size(); ++i)
      if (lamp.chosen[i] >= 0 && lamp.misses[i] <= std::max(kOther * lamp.miss, kMeets)) list.push_back(static_cast<int>(i));
    if (static_cast<int>(list.size()) < kLeastViews) return {};
    for (std::size_t i = static_cast<std::size_t>(first); i < list.size(); i += static_cast<std::size_t>(step))
      chosen.push_back(list[i]);
    return chosen;
  }

  /// Light and lobe of some views as if the cameras were changed. @param lamp  names the highlight of each view
  /// @param near  a fit for cameras that differ little, if there is one
  std::optional<Fitted> fit(const CameraChange& change, const SharedLamp& lamp, const std::vector<int>& which, const Kind& kind,
                            const Fitted* near = nullptr) const {
    stopIfAsked(0, 0);
    if (which.empty()) return std::nullopt;
    Settings settings = settings_;
    settings.set("fit.lobe", kind.lobe);
    settings.set("fit.light_size", kind.lamp);
    settings.set("fit.evidence", std::string("contours"));  // pixels would move the residuals away from them
    settings.set("light.bundle_points", 36);                // as good for comparisons, in half the time
    settings.set("fit.most_residual", 0.3);                 // what wrong cameras leave is measured here, it is no answer
    std::vector<TrainingView> views;
    for (const int i : which) {
      const View& v = views_[static_cast<std::size_t>(i)];
      const int chosen = lamp.chosen[static_cast<std::size_t>(i)];
      if (chosen < 0) return std::nullopt;
      FrameEvidence evidence = v.evidence;
      change.move(evidence.highlights[static_cast<std::size_t>(chosen)], cameraOf(v));
      TrainingView view = trainingView(evidence, chosen, change.of(cameraOf(v)), v.surface);
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
    result.kind = {nameOf(lobe.lobe), nameOf(lobe.shape)};
    result.model = std::make_shared<const ModelFit>(*fitted);
    return std::isfinite(result.rmsPx) ? std::optional<Fitted>(result) : std::nullopt;
  }

  /// Those of the mistakes whose undoing lets mirrored rays meet, the best first; of equals the likelier one.
  std::vector<Suspect> suspects() const {
    constexpr std::size_t kMost = 5;  // contours are asked about them, which takes its time
    std::vector<Suspect> list;
    int place = 0;
    for (const LikelyMistake& mistake : likelyMistakes()) {
      const std::optional<SharedLamp> lamp = lampAfter(mistake.undoing);
      // A ball that is turned about its centre is the same ball.
      const bool changes = lamp && (!asGiven_ || std::abs(lamp->miss - asGiven_->miss) > kSameMiss);
      if (changes && lamp->miss < kMayMeet) list.push_back({&mistake, place, *lamp, {}});
      ++place;
    }
    std::stable_sort(list.begin(), list.end(), [](const Suspect& a, const Suspect& b) { return a.step() < b.step(); });
    if (list.size() > kMost) list.resize(kMost);
    return list;
  }

  /// Looks for a mistake whose undoing makes a light explain the highlights. @return whether it was found
  bool explains(const std::optional<Fitted>& given) {
    constexpr double kAsGood = 1.2;  // residuals of symmetric bodies differ by less; the likelier mistake comes first
    std::vector<Suspect> list = suspects();
    const Suspect* least = nullptr;
    for (Suspect& s : list) {
      if (least && least->fitted->rmsPx <= kGoodRadii * radiusOf(least->lamp) && s.step() > least->step()) break;
      // A change that half of the views refuse is not tried on all, nor with lamps of every shape.
      if (fit(s.mistake->undoing, s.lamp, agreeing(s.lamp, 0, 2), {"auto", "point"}))
        s.fitted = fit(s.mistake->undoing, s.lamp, agreeing(s.lamp), {});
      if (s.fitted && (!least || s.fitted->rmsPx < least->fitted->rmsPx)) least = &s;
    }
    addTried(list);
    const Suspect* best = least;
    for (const Suspect& s : list)
      if (s.fitted && s.fitted->rmsPx <= kAsGood * least->fitted->rmsPx && s.place < best->place) best = &s;
    if (!best || !clearlyBetter(*best->fitted, best->lamp, given)) {
      // Where no light explains anything else, coarse images may leave more.
      const auto fitted = std::count_if(list.begin(), list.end(), [](const Suspect& s) { return s.fitted.has_value(); });
      if (!best || given || fitted != 1 || best->fitted->rmsPx > std::min(kCoarsePx, kNothingRadii * radiusOf(best->lamp)))
        return false;
    }
    accuse(*best->mistake, given || best->fitted->rmsPx <= kGoodRadii * radiusOf(best->lamp), fittedText(*best->fitted, given));
    return true;
  }

  /// What a change leaves against what the scene as given does.
  bool clearlyBetter(const Fitted& changed, const SharedLamp& lamp, const std::optional<Fitted>& given) const {
    return changed.rmsPx <= (nothingFits(given) ? kFits : kGoodRadii) * radiusOf(lamp) &&
           !(given && changed.rmsPx > kClearlyOther * given->rmsPx);
  }

  /// Diagonal of the surfaces' boxes, m; nothing of unbounded ones.
  std::optional<double> size() const {
    Eigen::AlignedBox3d box;
    for (const View& v : views_) box.extend(v.surface->bounds());
    const double diagonal = box.diagonal().norm();
    return std::isfinite(diagonal) && diagonal > 0 ? std::optional(diagonal) : std::nullopt;
  }

  /// The shift of the mesh after which mirrored rays pass one lamp best: steps along and between the axes, halved if none helps.
  Eigen::Vector3d shiftByRays(double size) const {
    constexpr double kLast = 0.002;  // of the size
    constexpr int kMostTries = 1500, kWays = 27;
    const double given = squaredMiss(asGiven_);
    Eigen::Vector3d best(0, 0, 0);
    double least = given;
    for (const double first : {0.08, 0.02}) {  // of the size: long steps lead past a near valley, short ones end in a shallow one
      Eigen::Vector3d at(0, 0, 0);
      double here = given;
      int tries = 0;
      for (double step = first * size; step > kLast * size && tries < kMostTries;) {
        const Eigen::Vector3d from = at;
        for (int k = 0; k < kWays; ++k, ++tries) {
          const Eigen::Vector3d trial = from + step * Eigen::Vector3d(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
          const double cost = squaredMiss(lampAfter(shiftedBy(trial)));
          if (!(cost < here)) continue;
          here = cost;
          at = trial;
        }
        if (at == from) step /= 2;
      }
      if (here < least) best = at, least = here;
    }
    return best;
  }

  static CameraChange shiftedBy(const Eigen::Vector3d& metres) {
    CameraChange change;
    change.camerasFromMesh.translation = metres;
    return change;
  }

  /// Whether a shift of the mesh makes a light explain the highlights: found by mirrored rays, made exact by contours.
  bool explainsShifted(const std::optional<Fitted>& given) {
    const std::optional<double> whole = size();
    if (!whole || !asGiven_ || scene_.surfaces.size() != 1) return false;
    if (given && given->rmsPx <= kFits * radiusOf(*asGiven_)) return false;  // that much photographs may leave
    Eigen::Vector3d shift = shiftByRays(*whole);
    const std::optional<SharedLamp> lamp = lampAfter(shiftedBy(shift));
    if (!lamp || lamp->miss > kMeets || shift.isZero()) return false;
    const std::vector<int> which = agreeing(*lamp);
    // A shift towards the lamp changes little that another place of the lamp does not: the least lies in a narrow valley.
    std::optional<Fitted> here = fit(shiftedBy(shift), *lamp, which, {});
    const auto cost = [&](const Eigen::Vector3d& by) -> std::optional<double> {
      const auto fitted = fit(shiftedBy(by), *lamp, which, here->kind, &*here);
      if (fitted && fitted->rmsPx < here->rmsPx) here = fitted;
      return fitted ? std::optional(fitted->rmsPx * fitted->rmsPx) : std::nullopt;
    };
    if (here && here->rmsPx <= kNothingRadii * radiusOf(*lamp)) {  // what leaves more is no shift
      shift = lowestPlace(shift, 0.005 * *whole, cost);
      here = fit(shiftedBy(shift), *lamp, which, {});
    }
    add(formatted("Move the mesh by (%.3g, %.3g, %.3g) m", shift.x(), shift.y(), shift.z()), here);
    // Three numbers hide much of another shape: a flatter body left 4.5 %, right ones leave 1 to 3 % in 8 bits.
    constexpr double kShifted = 0.03;
    if (!here || !clearlyBetter(*here, *lamp, given) || here->rmsPx > kShifted * radiusOf(*lamp)) return false;
    const Eigen::Vector3d by = Eigen::Vector3d::Zero() - shift;  // no minus before a zero
    LikelyMistake mistake{"the mesh",       false, formatted("shifted by (%.3g, %.3g, %.3g) m", by.x(), by.y(), by.z()),
                          shiftedBy(shift), {},    {}};
    mistake.correction = meshSimilarityCorrection(mistake.undoing.camerasFromMesh);
    mistake.correction->words = "Move the mesh to where the highlights show it";
    accuse(mistake, false, fittedText(*here, given));
    return true;
  }

  std::string fittedText(const Fitted& fitted, const std::optional<Fitted>& given) const {
    return formatted("the highlights of %d frames fit one light to %.2g px; as given, ", result_.views, fitted.rmsPx) +
           (given ? formatted("only to %.2g px", given->rmsPx) : std::string("no light explains them"));
  }

  void accuse(const LikelyMistake& mistake, bool sure, const std::string& evidence) {
    const char* verb = mistake.many ? (sure ? " are " : " seem to be ") : (sure ? " is " : " seems to be ");
    result_.findings.push_back(mistake.subject + verb + mistake.is + ": corrected, " + evidence +
                               (mistake.remedy.empty() ? "" : " (" + mistake.remedy + ")"));
    if (!mistake.correction) return;
    try {
      corrected(scene_, mistake.correction->fix);
      result_.correction = mistake.correction;
    } catch (const InputError&) {  // several surfaces, maps of normals: a person has to undo it
    }
  }

  /// All mistakes that were tried, in the list's order.
  void addTried(const std::vector<Suspect>& list) {
    int place = 0;
    for (const LikelyMistake& mistake : likelyMistakes()) {
      const auto at = std::find_if(list.begin(), list.end(), [&](const Suspect& s) { return s.place == place; });
      add(mistake.correction ? mistake.correction->words : mistake.subject.substr(4) + " " + mistake.is,
          at == list.end() ? std::nullopt : at->fitted);
      ++place;
    }
  }

  /// Whether no light explains the contours, whatever one may expect of coarse images.
  bool nothingFits(const std::optional<Fitted>& given) const {
    return !given || given->rmsPx > std::max(kNothingRadii * radiusOf(*asGiven_), kCoarsePx);
  }

  /// As evaluations choose it.
  LightFrameChoice lightFrame() const {
    std::vector<FrameEvidence> evidence(scene_.frames.size());
    std::vector<int> frames;
    for (const View& v : views_) {
      evidence[static_cast<std::size_t>(v.evidence.frame)] = v.evidence;
      frames.push_back(v.evidence.frame);
    }
    return chooseLightFrame(scene_, surfaces_, frames, evidence, settings_);
  }

  /// The views as they are given, each with the highlight of the lamp that they share.
  std::vector<TrainingView> viewsAsGiven() const {
    std::vector<TrainingView> views;
    for (std::size_t i = 0; i < views_.size() && asGiven_; ++i)
      if (asGiven_->chosen[i] >= 0)
        views.push_back(trainingView(views_[i].evidence, asGiven_->chosen[i], cameraOf(views_[i]), views_[i].surface));
    return views;
  }

  /// What evaluations take off, or smooth: here it hides whether the scene fits.
  bool isSaidByEvaluations() {
    const auto textured =
        std::count_if(views_.begin(), views_.end(), [](const View& v) { return v.evidence.structure.isTexture(); });
    if (asGiven_ && asGiven_->miss < kMeets && 2 * textured > std::ssize(views_)) {
      result_.hypotheses.clear();
      result_.whyNot =
          "the surface is textured, which one photograph alone does not tell from a highlight; evaluations take the "
          "texture off (detect.texture)";
      return true;
    }
    if (scene_.surfaces.size() != 1 || !scene_.hasTriangles(scene_.surfaces.begin()->first)) return false;
    const std::vector<TrainingView> views = viewsAsGiven();
    const std::optional<SmoothedMesh> smoothed =
        smoothedMesh(views, estimateLight(views, settings_), scene_.surfaces.begin()->first, settings_);
    if (smoothed) result_.findings.push_back(smoothed->remark());
    return smoothed.has_value();
  }

  void sayThatNothingFits(const std::optional<Fitted>& given) {
    if (isSaidByEvaluations()) return;
    Unexplained found;
    found.views = result_.views;
    if (given) found.leftPx = given->rmsPx, found.radiusPx = radiusOf(*asGiven_);
    found.missRad = asGiven_ ? asGiven_->miss : EIGEN_PI;
    std::vector<EyeAndSurface> eyes;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      found.beside += !asGiven_ || asGiven_->chosen[i] < 0;
      eyes.emplace_back(cameraOf(views_[i]).centreInWorld(), views_[i].surface);
    }
    found.inside = insideOfSurfaces(eyes);
    found.mistakesTried = static_cast<int>(result_.hypotheses.size()) - 1;
    result_.findings.push_back(nothingFitsText(found, kMeets));
  }

  /// A light that leaves more than photographs do, though no mistake that is known explains it.
  void sayThatItFitsPoorly(const Fitted& given) {
    double noise = 0;
    const std::vector<int> list = agreeing(*asGiven_);
    for (const int i : list) {
      const std::size_t view = static_cast<std::size_t>(i);
      const Highlight& h = views_[view].evidence.highlights[static_cast<std::size_t>(asGiven_->chosen[view])];
      noise += std::pow(noisePx(h.contour), 2) / double(list.size());
    }
    const double left = std::sqrt(std::max(0.0, given.rmsPx * given.rmsPx - noise)), radius = radiusOf(*asGiven_);
    if (left > std::max(kPoorlyRadii * radius, kPoorlyPx))
      result_.findings.push_back(fitsPoorlyText(list.size(), given.rmsPx, left / radius));
  }

  void sayWhoIsOutvoted() {
    const std::vector<int> list = agreeing(*asGiven_);
    std::vector<Outvoted> others;
    for (std::size_t i = 0; i < views_.size(); ++i)
      if (std::find(list.begin(), list.end(), static_cast<int>(i)) == list.end())
        others.push_back({scene_.frames[static_cast<std::size_t>(views_[i].evidence.frame)].id, asGiven_->misses[i]});
    if (!others.empty()) result_.findings.push_back(outvotedText(others, static_cast<int>(list.size())));
  }

  static CameraChange along(const CameraChange& direction, double by) {
    return {by * direction.cx, by * direction.cy, by * direction.logFocal};
  }

  /// How far to go along a change until the sum of squares is least: a parabola through three fits, then one about its end, where
  /// another lobe may fit better than for the wrong cameras. The shape of the lamp stays, small errors of cameras do not hide it;
  /// every fit starts from the lamp of the one about which it lies.
  std::optional<double> least(const CameraChange& direction, const Fitted& given) const {
    const std::vector<int> which = agreeing(*asGiven_);
    double at = 0;
    Fitted here = given;
    for (int round = 0; round < 2; ++round) {
      if (round > 0) {
        const std::optional<Fitted> again = fit(along(direction, at), *asGiven_, which, {"auto", given.kind.lamp}, &given);
        if (!again) return std::nullopt;
        here = *again;
      }
      const auto up = fit(along(direction, at + 1), *asGiven_, which, here.kind, &here),
                 down = fit(along(direction, at - 1), *asGiven_, which, here.kind, &here);
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
  bool bothHalvesGain(const CameraChange& change, const Fitted& whole) const {
    for (const int first : {0, 1}) {
      const std::vector<int> half = agreeing(*asGiven_, first, 2);
      const std::optional<Fitted> before = fit({}, *asGiven_, half, whole.kind, &whole),
                                  after = fit(change, *asGiven_, half, whole.kind, &whole);
      if (!before || !after || !(after->rmsPx < kHalfGain * before->rmsPx)) return false;
    }
    return true;
  }

  void intrinsics(const Fitted& given) {
    if (given.rmsPx < kDetectionPx) return;
    // Steps are large against detection and small against what bends the parabola.
    const CameraChange shift{0.25, 0.25, 0}, focal{0, 0, 0.005};
    const std::optional<double> byShift = least(shift, given), byFocal = least(focal, given);
    std::optional<Fitted> atHalf, atFocal;
    CameraChange half, longer;
    if (byShift) {
      result_.shiftPx = *byShift * shift.cx;
      half.cx = half.cy = *byShift < 0 ? -0.5 : 0.5;
      atHalf = fit(half, *asGiven_, agreeing(*asGiven_), {"auto", given.kind.lamp}, &given);
      add("principal point half a pixel " + std::string(half.cx < 0 ? "less" : "more"), atHalf);
    }
    if (byFocal) {
      longer = along(focal, *byFocal);
      result_.focalPct = 100 * std::expm1(longer.logFocal);
      atFocal = fit(longer, *asGiven_, agreeing(*asGiven_), {"auto", given.kind.lamp}, &given);
      add(formatted("focal length %+.2g %%", *result_.focalPct), atFocal);
    }
    const auto clear = [&](const std::optional<Fitted>& here, const std::optional<Fitted>& other, const CameraChange& change) {
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
          "given, only to %.2g px (a wrong scale of the surface looks much the same)",
          result_.views, atFocal->rmsPx, std::abs(*result_.focalPct), *result_.focalPct > 0 ? "longer" : "shorter", given.rmsPx));
    }
  }

  const Scene& scene_;
  const ProgressFn& progress_;
  const SurfaceCache surfaces_;
  const bool carried_;
  Settings settings_;
  std::vector<View> views_;
  std::vector<int> searched_;  ///< frames
  int dark_ = 0;               ///< of them, those without any highlight
  std::optional<SharedLamp> asGiven_;
  CameraCheck result_;
};

}  // namespace

CameraCheck checkCameras(const Scene& scene, const ProgressFn& progress) { return Check(scene, progress).run(); }

ConventionReport fullReport(const Scene& scene, const ProgressFn& progress) {
  ConventionReport report = conventionReport(scene, progress);
  const auto seeing = std::count_if(report.frames.begin(), report.frames.end(), [](const auto& f) { return f.seesSurface; });
  // Where a mistake is known, highlights have nothing to add; where few see it, only what the mistake is.
  if (report.everyFrameSeesSurface() || report.corrections.empty()) {
    std::optional<CameraCheck> known = checkKnownLamps(scene, progress);
    CameraCheck check = known ? *std::move(known) : checkCameras(scene, progress);
    if (2 * seeing > std::ssize(report.frames) || check.correction) report.take(std::move(check));
  }
  placeMesh(scene, progress, report);
  return report;
}

}  // namespace glint
