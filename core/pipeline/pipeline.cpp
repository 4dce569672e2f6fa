// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/pipeline.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/pipeline/corrected_depth.h"
#include "core/pipeline/hand_edits.h"
#include "core/pipeline/lobe_stage.h"
#include "core/pipeline/stage_run.h"

namespace glint {
namespace {

using Known = std::vector<const Inspection*>;

/// The scene with what a what-if changes; contours of the frames that this question and earlier ones looked at.
std::shared_ptr<const Scene> whatIfScene(const std::shared_ptr<const Scene>& given, const Question& question,
                                         const TrainSpec& train, const ProgressFn& progress, const Known& known) {
  const WhatIf& w = question.request.whatIf;
  if (!w.changesScene()) return given;
  const double level = question.request.settings.number("detect.level");
  if (!w.synthesise) {
    for (const Inspection* k : known)
      if (!k->request.whatIf.synthesise && k->request.whatIf.poses == w.poses) return k->world;
    return changedScene(*given, w, level, progress);
  }
  const WhatIf part = synthesisOf(w);
  StageInputs asked;
  asked.evidence = evidenceInputs(question.request, false);
  asked.lobes = lobeInputs(question.request, train, false);
  const Inspection* same = evidenceSource(known, asked);  // whose evidence is taken, as that of these contours
  for (const Inspection* k : known)
    if (!same && k->request.settings.number("detect.level") == level && synthesisOf(k->request.whatIf) == part) same = k;
  std::vector<int> missing;
  for (int i = 0; i < static_cast<int>(given->frames.size()); ++i) {
    const bool wanted = question.part == Question::Part::Everything || train.perSurface || i == question.frame ||
                        std::binary_search(train.frames.begin(), train.frames.end(), i);
    if (wanted && !(same && same->evidence[static_cast<std::size_t>(i)].frame >= 0)) missing.push_back(i);
  }
  if (!same) return changedScene(*given, w, level, progress, &missing);
  return missing.empty() ? same->world : withContours(*same->world, w, level, missing, progress);
}

std::shared_ptr<const SurfaceCache> surfacesOf(const std::shared_ptr<const Scene>& scene, const Known& known) {
  for (const Inspection* k : known)
    if (k->scene == scene && k->surfaces) return k->surfaces;
  for (const Inspection* k : known)
    if (k->surfaces) return std::make_shared<SurfaceCache>(*scene, *k->surfaces);
  return std::make_shared<SurfaceCache>(*scene);
}

/// What is known before any stage runs. Wrong requests are refused here, before any work.
Inspection begun(std::shared_ptr<const Scene> scene, const Question& question, const ProgressFn& progress, const Known& known) {
  const InspectionRequest& request = question.request;
  Inspection r;
  r.given = scene;
  r.train = parseTrainSpec(request.train, *scene);
  r.world = whatIfScene(scene, question, r.train, progress, known);
  // Evidence is judged around the object, on which paint rests; StageRun::standInLightFrame() turns to the lights.
  r.scene = standsStill(*r.world) ? r.world : std::make_shared<const Scene>(inObject(*r.world));
  r.surfaces = surfacesOf(r.scene, known);
  r.request = request;
  r.correctedDepthMaps = std::make_shared<CorrectedDepthMaps>();
  // A model named twice is one model.
  std::vector<std::string>& models = r.request.models;
  for (auto m = models.begin(); m != models.end();) m = std::find(models.begin(), m, *m) != m ? models.erase(m) : m + 1;
  if (question.part == Question::Part::FirstLook)
    std::erase_if(models, [](const std::string& m) { return modelByName(m).takesPixels(); });
  if (request.noisePx > 0 && request.settings.text("fit.evidence") == "pixels")
    throw InputError("", "--noise-px", "noise is added to contours, which fit.evidence=pixels does not use");
  for (const std::string& m : request.models) modelByName(m);
  return r;
}

void requireFrame(const Scene& scene, const Question& question) {
  require(question.part == Question::Part::Everything ||
              (question.frame >= 0 && question.frame < static_cast<int>(scene.frames.size())),
          "inspect: there is no such frame");
}

/// What a question that is stopped leaves: its evidence, once all that it looks at is there.
using Left = std::function<void(Inspection)>;

Inspection answered(std::shared_ptr<const Scene> scene, const Question& question, const ProgressFn& progress, const Known& all,
                    const Left& left) {
  require(scene != nullptr, "inspect: no scene");
  requireFrame(*scene, question);
  Known known;
  std::copy_if(all.begin(), all.end(), std::back_inserter(known), [&](const Inspection* k) { return k->given == scene; });
  Inspection result = begun(std::move(scene), question, progress, known);
  const PhotographsHeld held(*result.scene, result.train.frames);
  StageRun run(result, progress, known,
               {question.part == Question::Part::Everything ? std::nullopt : std::optional(question.frame),
                question.part == Question::Part::FirstLook});
  run.highlights();
  run.lobes();
  run.changeHighlights();
  try {
    run.brightestPointsAndTangentPlanes();
    run.lights();
    run.canonicalContours();
    run.modelFits();
    run.predictionsAndComparisons();
  } catch (const Stopped&) {
    if (left) left(std::move(result).evidenceAlone());
    throw;
  }
  return result;
}

void add(WorkCounts& sum, const WorkCounts& more) {
  sum.framesHeldAtOnce = std::max(sum.framesHeldAtOnce, more.framesHeldAtOnce);
  for (int WorkCounts::*count :
       {&WorkCounts::framesDetected, &WorkCounts::pixelFits, &WorkCounts::framesContouredAgain, &WorkCounts::trainingViews,
        &WorkCounts::lights, &WorkCounts::canonicalContours, &WorkCounts::fits, &WorkCounts::predictions,
        &WorkCounts::comparisons, &WorkCounts::surfacesAsked})
    sum.*count += more.*count;
}

}  // namespace

Inspection answer(std::shared_ptr<const Scene> scene, const Question& question, const ProgressFn& progress, const Known& known) {
  return answered(std::move(scene), question, progress, known, {});
}

Inspection inspect(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress,
                   const Inspection* previous) {
  return answer(std::move(scene), {request}, progress, previous ? Known{previous} : Known{});
}

Pipeline::Pipeline(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {
  require(scene_ != nullptr, "Pipeline: no scene");
}

Pipeline::Answer Pipeline::ask(const Question& question, const ProgressFn& progress) {
  constexpr std::chrono::milliseconds kLook{20};
  requireFrame(*scene_, question);
  std::unique_lock lock(mutex_);
  const auto isAsked = [&] {
    return std::any_of(asked_.begin(), asked_.end(), [&](const Question* q) { return *q == question; });
  };
  Answer remembered = find(question);
  while (!remembered && isAsked()) {
    answered_.wait_for(lock, kLook);
    lock.unlock();
    const bool goesOn = report(progress, {"wait", 0, 0});
    lock.lock();
    if (!goesOn) throw Stopped{};
    remembered = find(question);
  }
  if (remembered) return remembered;
  const std::vector<Answer> answers = newestFirst();  // holds them
  Known known;
  for (const Answer& a : answers) known.push_back(a.get());
  if (question.part == Question::Part::FirstLook && !worthALook(*scene_, question.request, known)) return nullptr;
  asked_.push_back(&question);
  lock.unlock();
  struct Ends {
    Pipeline& p;
    const Question* const question;
    ~Ends() {
      const std::lock_guard ending(p.mutex_);
      std::erase(p.asked_, question);
      p.answered_.notify_all();
    }
  };
  const Ends ends{*this, &question};
  const auto left = [&](Inspection evidence) {
    const std::lock_guard keeping(mutex_);
    add(work_, evidence.work);
    keep({question, std::make_shared<const Inspection>(std::move(evidence)), false});
  };
  const auto now = std::make_shared<const Inspection>(answered(scene_, question, progress, known, left));
  const std::lock_guard keeping(mutex_);
  add(work_, now->work);
  keep({question, now, true});
  return now;
}

/// A complete answer serves every question about the request, but for first looks: who has everything needs none.
Pipeline::Answer Pipeline::find(const Question& question) const {
  for (auto k = kept_.rbegin(); k != kept_.rend(); ++k)
    if (k->whole &&
        (k->question == question || (k->question == Question{question.request} && question.part != Question::Part::FirstLook)))
      return k->answer;
  return nullptr;
}

void Pipeline::keep(Kept kept) {
  constexpr std::size_t kMostParts = 2, kMostWaiting = 3;  // complete ones that nobody has looked through yet
  const auto complete = [](const Kept& k) { return k.whole && k.question.part == Question::Part::Everything; };
  std::erase_if(kept_, [&](const Kept& k) { return k.question == kept.question; });
  if (complete(kept))  // it says all that its parts do
    std::erase_if(kept_, [&](const Kept& k) { return !complete(k) && k.question.request == kept.question.request; });
  kept_.push_back(std::move(kept));
  const auto forgetBeyond = [&](std::size_t most, bool ofComplete) {
    auto surplus = std::count_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return complete(k) == ofComplete; }) -
                   static_cast<std::ptrdiff_t>(most);
    std::erase_if(kept_, [&](const Kept& k) { return complete(k) == ofComplete && surplus-- > 0; });
  };
  forgetBeyond(kMostParts, false);
  forgetBeyond(kMost + kMostWaiting, true);
}

std::vector<Pipeline::Answer> Pipeline::newestFirst() const {
  std::vector<Answer> answers;
  for (auto k = kept_.rbegin(); k != kept_.rend(); ++k) answers.push_back(k->answer);
  return answers;
}

std::optional<Observation> Pipeline::contour(const InspectionRequest& request, int frame, const ProgressFn& progress,
                                             const Inspection* shown) const {
  return observeFrame(scene_, request, frame, progress, shown);
}

Pipeline::Answer Pipeline::known(const InspectionRequest& request) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.whole && k.question == Question{request}; });
  if (found == kept_.end()) return nullptr;
  std::rotate(found, found + 1, kept_.end());
  return kept_.back().answer;
}

void Pipeline::remember(const Question& question, Answer answer) {
  if (!answer || answer->given != scene_) return;
  const std::lock_guard lock(mutex_);
  keep({question, std::move(answer), true});
}

void Pipeline::makeRoom(const std::function<bool(const InspectionRequest&)>& wanted) {
  const std::lock_guard lock(mutex_);
  const auto complete = [](const Kept& k) { return k.whole && k.question.part == Question::Part::Everything; };
  while (std::count_if(kept_.begin(), kept_.end(), complete) > static_cast<std::ptrdiff_t>(kMost)) {
    const auto newest = std::find_if(kept_.rbegin(), kept_.rend(), complete).base() - 1;
    const auto passed =
        std::find_if(kept_.begin(), newest, [&](const Kept& k) { return complete(k) && !wanted(k.question.request); });
    kept_.erase(passed != newest ? passed : std::find_if(kept_.begin(), kept_.end(), complete));
  }
}

WorkCounts Pipeline::work() const {
  const std::lock_guard lock(mutex_);
  return work_;
}

}  // namespace glint
