// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/settings.h"
#include "core/pipeline/detect_settings.h"
#include "core/pipeline/training.h"
#include "core/pipeline/what_if.h"
#include "core/scene/scene.h"

namespace glint {

struct InspectionRequest;
struct TrainSpec;

/// The stages of an inspection whose answers are remembered, in the order in which they run.
enum class Stage { Evidence, Lobes, Views, Lights, Fits, Predictions };

/// What each stage takes beside the answers of those before it. It holds the part of a what-if that the stage sees
/// (what_if.h), the rest at its default.
using StageSettings = std::map<std::string, SettingValue>;

/// Inputs of the evidence of a frame, the user's changes to single highlights apart.
struct EvidenceInputs {
  FrameSource source = FrameSource::Radiance;
  std::string truthFolder;
  DetectSettings detect;
  StageSettings surface;  ///< where lights are told apart from all frames: they reflect rays on it
  WhatIf whatIf;          ///< synthesis; poses where lights are told apart from all frames
  friend bool operator==(const EvidenceInputs&, const EvidenceInputs&) = default;
};

/// Which frames train.
struct TrainingInputs {
  std::vector<int> frames, excluded;
  bool perSurface = false;
  friend bool operator==(const TrainingInputs&, const TrainingInputs&) = default;
};

/// Inputs of the lobes that are fitted to pixels: the stage looks at evidence of its own, at half the peak.
struct LobeInputs {
  EvidenceInputs evidence;
  StageSettings surface;
  TrainingInputs training;
  WhatIf whatIf;        ///< poses, lights that are off, highlights that are ignored
  bool pixels = false;  ///< asked for
  friend bool operator==(const LobeInputs&, const LobeInputs&) = default;
};

/// Inputs of the training views.
struct ViewInputs {
  StageSettings surface;
  TrainingInputs training;
  double noisePx = 0;
  unsigned seed = 0;
  WhatIf whatIf;       ///< poses, changes of highlights, lights that are off
  std::string levels;  ///< fit.levels, where they are the evidence
  friend bool operator==(const ViewInputs&, const ViewInputs&) = default;
};

/// Inputs of the estimates of lights. The keys are part of it: a look at one frame may not have seen them all.
struct LightInputs {
  StageSettings light;
  std::vector<FitKey> keys;
  friend bool operator==(const LightInputs&, const LightInputs&) = default;
};

/// What the stages of an inspection of one scene were computed from; nothing for one that was not. A stage's answer may be taken
/// from another inspection of the scene where both computed it, and all before it, from the same inputs.
struct StageInputs {
  std::optional<EvidenceInputs> evidence;
  std::optional<LobeInputs> lobes;
  std::optional<ViewInputs> views;
  std::optional<LightInputs> lights;
  std::optional<StageSettings> fits;         ///< of canonical contours, too
  std::optional<StageSettings> predictions;  ///< and their comparison

  bool same(Stage stage, const StageInputs& other) const;
  /// Evidence and lobes alone; the later stages count as not computed.
  StageInputs upToLobes() const;
};

/// Those that are set, of the stages of ParamSpec::stage.
StageSettings settingsOf(const Settings& settings, const std::set<std::string>& stages);

/// @param together  lights are told apart from all frames (lightsAreOpenIn()): surfaces and poses matter as well
EvidenceInputs evidenceInputs(const InspectionRequest& request, bool together);
TrainingInputs trainingInputs(const InspectionRequest& request, const TrainSpec& train);
/// The models' settings do not count; neither does the level that a user drags, see LobeInputs. Where lights are told apart from
/// all frames, the highlights of the request's own level are taken.
LobeInputs lobeInputs(const InspectionRequest& request, const TrainSpec& train, bool together);
ViewInputs viewInputs(const InspectionRequest& request, const TrainSpec& train);

}  // namespace glint
