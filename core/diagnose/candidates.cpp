// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/candidates.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/inspect/summary.h"
#include "core/model/reflectance_settings.h"
#include "core/reflectance/added_lobe.h"
#include "core/scene/frame_spec.h"

namespace glint {
namespace {

constexpr std::size_t kMostExcluded = 2;  // frames tried one by one
constexpr std::size_t kFewestViews = 4;   // an exclusion must leave one more than a fit with a free centre needs
constexpr std::size_t kMoreFrames = 12;   // twice the default: enough to tell whether more help

class Candidates {
 public:
  Candidates(const Inspection& inspection, const std::string& model, const ProgressFn& progress)
      : r_(inspection), model_(modelByName(model)), evidence_(highlightEvidence(inspection, model_, progress)) {}

  std::vector<CandidateChange> run() {
    filters();
    lobes();
    otherFrames();
    lightSolver();
    exclusions();
    ellipsoidSolvers();
    surface();
    cameras();
    return std::move(all_);
  }

 private:
  void set(const std::string& key, const std::string& value, const std::string& why) {
    Settings other = r_.request.settings;
    other.setFromText(key, value);
    if (!(other.value(key) == r_.request.settings.value(key))) all_.push_back({{.set = key + "=" + value}, why});
  }

  void filters() {
    const ModelSummary summary = summarise(r_, r_.models.at(model_.id()));
    if (summary.spurious == 0) return;
    set("predict.filter_area", "true", "predictions that are smaller than what detection takes");
    set("predict.filter_shadow", "true", "predictions in the shadow of the object itself");
  }

  void lightSolver() {
    if (!model_.needsLight()) return;
    set("light.solver", "triangulated", "the light from peaks alone, which one odd contour does not move");
    set("light.solver", "bundle", "the light from whole contours");
  }

  void exclusions() {
    std::map<int, double> weights;  // by frame
    std::set<int> frames;
    for (const HighlightEvidence& e : evidence_) {
      frames.insert(e.frame);
      weights[e.frame] = std::max(weights[e.frame], e.weight);
    }
    if (frames.size() <= kFewestViews) return;
    std::vector<std::pair<double, int>> worst;
    for (const auto& [frame, weight] : weights) worst.emplace_back(-weight, frame);
    std::sort(worst.begin(), worst.end());
    for (std::size_t i = 0; i < worst.size() && i < kMostExcluded; ++i) {
      if (i > 0 && worst[i].first == 0) break;  // one is tried even where none stands out
      exclude({worst[i].second}, worst[i].first == 0 ? "no frame stands out; the first one" : "it contradicts the model most");
    }
    if (worst.size() > kFewestViews + 1 && worst[1].first < 0)
      exclude({worst[0].second, worst[1].second}, "the two frames that contradict the model most");
  }
  void exclude(std::vector<int> frames, const std::string& why) {
    frames.insert(frames.end(), r_.request.excluded.begin(), r_.request.excluded.end());  // the flag replaces those
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    all_.push_back({{.exclude = frameSpec(frames, *r_.scene)}, why});
  }

  void otherFrames() {
    if (r_.train.perSurface) return;
    const std::size_t n = r_.scene->frames.size(), used = r_.train.frames.size();
    if (n < used + 2) return;  // nothing would be left to predict
    train("spread:" + std::to_string(std::max<std::size_t>(used, 4)), "views farther apart");
    if (n >= kMoreFrames + 2 && used < kMoreFrames) train("spread:" + std::to_string(kMoreFrames), "more views");
    if (used < n / 2) train("first:" + std::to_string(std::min(2 * used, n - 2)), "more views");
  }
  void train(const std::string& spec, const std::string& why) {
    if (spec != r_.request.train && parseTrainSpec(spec, *r_.scene).frames != r_.train.frames)
      all_.push_back({{.train = spec}, why});
  }

  void ellipsoidSolvers() {
    if (!model_.hasOutlines()) return;
    for (const char* solver : {"refined", "anchored", "linear"}) set("fit.solver", solver, "another solver of the ellipsoid");
  }

  /// Shapes of the lamp and lobes that no fit of this model has already.
  void lobes() {
    if (!mayHaveLobe()) return;
    std::set<std::string> found;
    if (const auto result = r_.models.find(model_.id()); result != r_.models.end())
      for (const ModelResult::Fit& f : result->second.fits)
        if (const ReflectanceFit* lobe = f.fit ? f.fit->as<ReflectanceFit>() : nullptr)
          found.insert({nameOf(lobe->shape), nameOf(lobe->lobe)});
    const auto setOther = [&](const std::string& key, const std::string& value, const std::string& why) {
      if (!found.count(value)) set(key, value, why);
    };
    for (const LampShape& shape : allLampShapes())
      setOther("fit.light_size", nameOf(shape), std::visit([](const auto& s) { return s.kWords; }, shape));
    set("fit.evidence", "contours", "a lobe that the pixels do not follow");
    std::vector<std::string> lobes{"ggx", "torrance-sparrow"};
    for (const Lobe lobe : allLobes())
      if (profileOf(lobe)) lobes.emplace_back(nameOf(lobe));  // of a plugin
    for (const std::string& lobe : lobes) setOther("fit.lobe", lobe, "another lobe");
  }

  /// Its fits have a lobe; without fits, it reconstructs no ellipsoid.
  bool mayHaveLobe() const {
    const auto result = r_.models.find(model_.id());
    if (result != r_.models.end())
      for (const ModelResult::Fit& f : result->second.fits)
        if (f.fit) return f.fit->as<ReflectanceFit>() != nullptr;
    return model_.needsLight() && !model_.hasOutlines();
  }

  void surface() {
    const bool mesh = std::any_of(r_.views.begin(), r_.views.end(), [&](const TrainingView& v) {
      return r_.scene->hasTriangles(r_.scene->frames[std::size_t(v.frame)].surface);
    });
    if (!mesh) return;
    set("surface.normals", "curved", "a coarse mesh");
    if (model_.needsLight()) set("light.refine_normals", "true", "a mesh whose normals are off");
  }

  void cameras() {
    if (model_.needsLight()) set("light.refine_poses", "true", "poses that are off by a little");
  }

  const Inspection& r_;
  const HighlightModel& model_;
  const std::vector<HighlightEvidence> evidence_;
  std::vector<CandidateChange> all_;
};

}  // namespace

std::vector<CandidateChange> candidateChanges(const Inspection& inspection, const std::string& model,
                                              const ProgressFn& progress) {
  return Candidates(inspection, model, progress).run();
}

}  // namespace glint
