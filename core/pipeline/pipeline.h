// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/observation.h"

namespace glint {

/// What is asked of an inspection.
struct Question {
  enum class Part {
    /// What everything says about one frame, sooner: evidence of the training frames and of this one, all fits, but predictions
    /// for this frame alone. Every frame is looked at where a light can only be told from all of them.
    Frame,
    /// The same with those of the models alone that take no pixels: sooner, as a lobe's fit to the pixels is the longest part of
    /// many first runs. Contours that the lobe finds again (detect.background = lobe) are those of the smooth background for as
    /// long.
    FirstLook,
    Everything
  };
  InspectionRequest request;
  Part part = Part::Everything;
  int frame = -1;  ///< not for Everything
  friend bool operator==(const Question&, const Question&) = default;
};

/// The whole computation of one scene, in the order of its stages:
/// highlight -> lobe -> brightest point, tangent plane -> light -> virtual camera, canonical contour -> model fit -> prediction
/// -> comparison. Pure. InputError for wrong requests; Stopped when `progress` says so.
/// @param known  earlier answers for the same scene, the newest first: a stage whose inputs are the same is taken from them
Inspection answer(std::shared_ptr<const Scene> scene, const Question& question, const ProgressFn& progress = {},
                  const std::vector<const Inspection*>& known = {});

/// One scene, of which is asked what a program shows first and then the rest. It remembers its last answers, so that each stage
/// is computed once for the same inputs, whatever was asked in between. Files that change on disk do not count until there is
/// another pipeline. Thread-safe: questions run at the same time, and who asks what another thread is computing waits for it.
class Pipeline {
 public:
  using Answer = std::shared_ptr<const Inspection>;
  /// Complete answers that are kept: those on screen, those before and after a step of undo to either side of them, and room for
  /// one detour. They share what the change between them leaves alone; in the worst case each holds all its contours and
  /// predictions.
  static constexpr std::size_t kMost = 5;

  explicit Pipeline(std::shared_ptr<const Scene> scene);
  const std::shared_ptr<const Scene>& scene() const { return scene_; }

  /// Remembered, or computed from what is. Null where a first look is not worth a step of its own: no pixels are asked for, or
  /// every model takes them; the lobe, or contours found with one, are known; or the newest complete answer shows a model that
  /// takes pixels, which would be gone for a moment. A question that is stopped leaves its evidence for the next one.
  /// InputError; Stopped; std::invalid_argument for a frame that does not exist.
  Answer ask(const Question& question, const ProgressFn& progress = {});
  Answer everything(const InspectionRequest& request, const ProgressFn& progress = {}) { return ask({request}, progress); }

  /// What a frame shows, without any consequences: sooner than its models. Nothing if `shown` says it, or if lights can only be
  /// told from all frames. InputError; Stopped.
  std::optional<Observation> contour(const InspectionRequest& request, int frame, const ProgressFn& progress = {},
                                     const Inspection* shown = nullptr) const;

  /// The remembered complete answer to a request; null = none.
  Answer known(const InspectionRequest& request);
  /// Takes over an answer of this scene that was made elsewhere. Others are ignored.
  void remember(const Question& question, Answer answer);
  /// Forgets complete answers until kMost are left: first those whose request is not wanted, then the oldest.
  void makeRoom(const std::function<bool(const InspectionRequest&)>& wanted);
  /// What all questions computed so far; what was remembered counts nothing.
  WorkCounts work() const;

 private:
  struct Kept {
    Question question;
    Answer answer;
    bool whole = false;  ///< the answer to its question; else what was left of it when it was stopped
  };
  Answer find(const Question& question) const;
  void keep(Kept kept);
  std::vector<Answer> newestFirst() const;

  const std::shared_ptr<const Scene> scene_;
  mutable std::mutex mutex_;
  std::condition_variable answered_;
  std::vector<Kept> kept_;              ///< the newest last
  std::vector<const Question*> asked_;  ///< being computed
  WorkCounts work_;
};

}  // namespace glint
