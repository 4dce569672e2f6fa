// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "cli/scene_arguments.h"
#include "core/app/session.h"
#include "viz/scene_view.h"

namespace glint::cli {

/// What `render` and `movie` draw: the input and how it is shown.
struct PictureInput {
  std::string input, layers, models, train, exclude, theme = "dark", source;
  std::vector<std::string> set;
  double glyphs = 1;
  SceneArguments places;

  void declare(Options& options);
  bool dark() const { return theme == "dark"; }

  struct Opened {
    std::shared_ptr<const Scene> scene;
    InspectionRequest request;
    SessionView saved;             ///< of a session
    std::set<std::string> models;  ///< drawn; empty = all
  };
  /// Reads the input and checks every argument, so that mistakes are reported before the long work. InputError; CannotAnswer for
  /// an input without frames.
  Opened open(const Context& context) const;
  /// The look of a scene view: theme, models, sizes, layers, the session's 3D camera.
  void apply(viz::SceneView& view, const Opened& opened, const std::shared_ptr<const Inspection>& inspection) const;
};

/// "1600x1000"; InputError (place --size) outside 64 .. 16384.
std::pair<int, int> parseSize(const std::string& text);
/// The first held-out frame, which shows what the models are worth; 0 without one.
int firstHeldOut(const Inspection& inspection);

}  // namespace glint::cli
