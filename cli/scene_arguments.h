// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/command.h"
#include "core/app/scene_places.h"

namespace glint::cli {

/// The flags of an input's places; the same for every command that reads one.
struct SceneArguments : ScenePlaces {
  /// --photographs, --files, --mesh and --meshes.
  void declarePlaces(Options& options);
  /// These and --allow-outside; a session keeps the rest.
  void declareForSession(Options& options);
  /// All.
  void declare(Options& options);

 private:
  void declareReading(Options& options);
};

}  // namespace glint::cli
