// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/pipeline: the stages of pipeline.h's answer(), which calls them in their order.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/model/band.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/merged_peaks.h"

namespace glint {

/// Whose evidence a run starts from: of the answers from these inputs of Stage::Evidence the one with the same lobes, then the
/// most frames. Null = none.
const Inspection* evidenceSource(const std::vector<const Inspection*>& known, const StageInputs& asked);

class StageRun {
 public:
  /// Which frame is predicted; the training ones are looked at as well, and more where that is needed.
  struct Only {
    std::optional<int> frame;    ///< nothing = every frame
    bool withoutPixels = false;  ///< see Question::Part::FirstLook
    bool predicts(int i) const { return !frame || *frame == i; }
  };
  /// @param result    with its request, scenes and surfaces; the stages fill in the rest
  /// @param known     earlier answers for the same scene as read, the newest first
  StageRun(Inspection& result, const ProgressFn& progress, const std::vector<const Inspection*>& known, Only only);

  void highlights();
  void lobes();
  void changeHighlights();
  void brightestPointsAndTangentPlanes();
  void lights();
  void canonicalContours();
  void modelFits();
  void predictionsAndComparisons();

 private:
  /// What gets its own fit.
  struct Group {
    FitKey key;
    std::vector<int> views;  ///< indices into Inspection::views
  };
  bool serves(const Inspection& known, Stage stage) const;
  /// The newest answer that a stage may be taken from; null = none.
  template <class Also>
  const Inspection* source(Stage stage, Also also) const {
    for (const Inspection* k : known_)
      if (serves(*k, stage) && also(*k)) return k;
    return nullptr;
  }
  const Inspection* source(Stage stage) const {
    return source(stage, [](const Inspection&) { return true; });
  }
  /// The earlier answer left the pixels to this run.
  bool pixelsComeTo(const Inspection& known) const { return known.pixelsLeft && !only_.withoutPixels; }
  std::shared_ptr<const Surface> surfaceOf(int frame) const;
  Failure explained(int frame, const Failure& failure) const;
  std::vector<Group> groups() const;
  bool anyModel(bool (HighlightModel::*needs)() const) const;
  std::vector<TrainingView> ownViews(const Group& group) const;
  void correct(const Group& group, const SurfaceCorrection& correction, std::vector<TrainingView> corrected);
  /// What the highlights of a group say against any model of one lamp and one material.
  struct Doubts {
    std::string widths;  ///< widthDoubt()
    std::optional<MergedPeaks> merged;
    std::string place;  ///< knownLampDoubt()
  };
  ModelResult::Fit fitOf(const HighlightModel& model, const FitKey& key, const Doubts& doubts, const ProgressFn& goesOn) const;
  std::vector<std::shared_ptr<const Band>> bandsOf(const HighlightModel& model, ModelResult& result);
  void predict(const HighlightModel& model, ModelResult& result);
  void standInLightFrame();
  void assignSeveralLights();
  std::vector<Eigen::Isometry3d> elsewhereFromScene() const;
  void gather(const std::vector<int>& frames);
  std::vector<int> framesToGather() const;

  Inspection& r_;
  const ProgressFn& progress_;
  std::vector<const Inspection*> known_;
  const Only only_;
  const bool together_;           ///< lights are told apart from all frames
  bool viewsLackPixels_ = false;  ///< they are of an answer that left them out
};

}  // namespace glint
