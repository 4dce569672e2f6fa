// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/scene_arguments.h"
#include "core/pipeline/inspection.h"

namespace glint {
struct Session;
}

namespace glint::cli {

/// Arguments shared by evaluate, reconstruct and others: everything that an InspectionRequest holds.
struct InspectionArguments {
  std::string input, models, truth;
  std::string train, source, level;  ///< "" = the session's, else the default
  std::string exclude;               ///< "" = the session's, else none
  std::string preset;                ///< of the session's trade-off; "" = none
  std::vector<std::string> set;
  double noisePx = 0;
  unsigned seed = 1;
  SceneArguments places;
  mutable std::shared_ptr<const PhotographsHeld> photographs;  ///< of the frames that chose the level: they train next

  void declare(Options& options, const std::string& modelsHelp);
  /// Starts from the session's request when INPUT is one; what is given on the command line wins.
  /// InputError for unknown models, settings or values out of range.
  InspectionRequest request() const;
  /// `--set` names this setting.
  bool sets(const std::string& key) const;
  /// Reads the scene, and puts the frames of --exclude and the level of --level auto into the request: only the scene knows them.
  /// InputError; CannotAnswer if no training frame shows a highlight to choose a level by.
  /// @param levelReason  optional: why this level; "" if it was not chosen here
  std::shared_ptr<const Scene> scene(InspectionRequest& request, std::string* levelReason = nullptr) const;
};

/// `--exclude` of a command that trains.
inline constexpr const char* kExcludeHelp =
    "Frames to exclude from training and scoring: numbers, ids or ranges (default: the session's, else none)";
/// Puts the frames of --exclude into the request; an empty text keeps the request's own. InputError if it names no frame, or all.
void exclude(const std::string& spec, const Scene& scene, InspectionRequest& request);

/// Every KEY=VALUE of --set, in its order. InputError for a text of another form, an unknown key or a value out of range.
void applyEach(Settings& settings, const std::vector<std::string>& keysAndValues);

/// Of --level: chosen for the sequence.
inline constexpr const char* kAutoLevel = "auto";
/// What --level takes, in words: as the scene reader.
inline constexpr const char* kLevelRange = "must be a fraction of the peak, more than 0 and less than 1";

/// Model and settings of a point of the session's trade-off: "fast", "balanced", "exact" or "chosen".
/// InputError if the session has none.
void applyPreset(const Session& session, const std::string& preset, InspectionRequest& request);

/// Ids of all models, for help: "primal, dual, ...".
std::string modelNames();

/// "a,b,c" in parts; InputError (place `flag`) for an empty part.
std::vector<std::string> splitList(const std::string& text, const std::string& flag);

/// One warning when training frames could not be used, with the first reason; silent when all could.
void warnOfUnusedTrainingFrames(const Inspection& inspection, const Context& context);

/// Throws CannotAnswer if no training view could be used at all, with the first reason.
void requireUsableViews(const Inspection& inspection);

/// InputError for a light of --light that is neither fitted nor known.
void requireLights(const Inspection& result);

}  // namespace glint::cli
