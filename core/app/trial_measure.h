// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/app/trial_search.h"
#include "core/base/outcome.h"
#include "core/choice/tradeoff.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// Measures settings on one scene. The evidence of every frame is gathered once; each trial then runs the pipeline from the
/// surface on, and its predictions are timed again on one thread.
class TradeoffBench {
 public:
  /// @param request  what stays the same in all trials: training frames, source, noise, truth. Stopped.
  TradeoffBench(std::shared_ptr<const Scene> scene, const InspectionRequest& request, int repeats, const ProgressFn& progress);

  /// Measures on the training frames and a few of the others (with `per-surface`: on a few surfaces).
  Outcome<TrialResult> coarse(const Trial& trial);
  /// Measures on all frames; gives the numbers that `evaluate` gives with these settings.
  Outcome<TradeoffPoint> full(const Trial& trial);

  /// Frames that are timed in a full measurement.
  int timedFrames() const;
  bool memoryResets() const { return memoryResets_; }

 private:
  struct Subset;
  Inspection run(const Subset& subset, const Trial& trial, const Inspection* previous) const;
  TradeoffPoint pointOf(const Inspection& inspection, const Trial& trial) const;
  /// Microseconds by frame and repeat.
  std::vector<std::vector<double>> timesOf(const Inspection& inspection, const Trial& trial, int frames, int repeats) const;
  double fitUs(const Inspection& inspection, const Trial& trial) const;
  void check() const;

  InspectionRequest request_;
  int repeats_;
  ProgressFn progress_;
  std::shared_ptr<Subset> few_, all_;
  std::optional<MeshPolicy> policy_;           ///< policy of the surfaces that `all_` holds
  std::map<std::string, Inspection> earlier_;  ///< coarse results by what their fits depend on
  bool memoryResets_ = true;
};

/// Starts a new measurement of the process's peak resident memory: gives freed memory back to the system and resets the
/// kernel's high-water mark. False if the system does not allow that; then the peak counts from the program's start.
bool restartPeakMemory();
/// Peak resident memory since then, 2^20 bytes; NaN where the system does not tell.
double peakMemoryMb();

}  // namespace glint
