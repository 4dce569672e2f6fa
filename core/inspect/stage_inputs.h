// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <set>
#include <string>

#include "core/base/settings.h"

namespace glint {

/// The stages of an inspection, in the order in which they run.
enum class Stage { Evidence, Lobes, Views, Lights, CanonicalContours, Fits, Predictions };

/// What the stages of an inspection of one scene were computed from. A stage's result may be taken from another inspection of the
/// scene where both computed it from the same inputs.
class StageInputs {
 public:
  StageInputs() = default;
  /// The inputs of a run that went no further than the evidence.
  explicit StageInputs(std::string evidence) { set(Stage::Evidence, std::move(evidence)); }

  void set(Stage stage, std::string inputs) { inputs_[index(stage)] = std::move(inputs); }
  /// The inputs of a stage that was set.
  const std::string& of(Stage stage) const { return inputs_[index(stage)].value(); }
  /// Both know the stage's inputs, and they are the same.
  bool same(Stage stage, const StageInputs& other) const { return is(stage, other.inputs_[index(stage)]); }
  bool is(Stage stage, const std::optional<std::string>& inputs) const { return inputs && inputs_[index(stage)] == inputs; }
  /// Only stages up to this one; the later ones count as not computed.
  StageInputs upTo(Stage last) const;

 private:
  static constexpr std::size_t kStages = static_cast<std::size_t>(Stage::Predictions) + 1;
  static std::size_t index(Stage stage) { return static_cast<std::size_t>(stage); }
  std::array<std::optional<std::string>, kStages> inputs_;
};

/// 17 significant digits: equal for equal numbers alone.
std::string exactText(double v);

/// Text that is equal when every input of a stage is: the values of all settings whose stage is named, and `more`.
std::string inputsText(const Settings& settings, const std::set<std::string>& stages, const std::string& more);

struct InspectionRequest;

/// What the evidence of a frame depends on, the user's changes to single highlights apart.
/// @param together  lights are told apart from all frames (lightsAreOpenIn()): surfaces and poses matter as well
std::string evidenceInputs(const InspectionRequest& request, bool together);

}  // namespace glint
