// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/advise/influence.h"
#include "core/choice/selection.h"
#include "core/choice/tradeoff.h"
#include "core/pipeline/pipeline.h"
#include "core/report/measured_lamps.h"
#include "core/scene/convention_report.h"
#include "core/scene/relinked.h"
#include "viz/scene_view.h"

namespace glint {
struct Session;
}

namespace glint::gui {

/// What a window starts from: a scene, and what a session file says about it (defaults for a plain scene).
struct Opened {
  std::string path;        ///< as opened
  bool isSession = false;  ///< `path` is a session, so "save" writes there
  bool unsaved = false;    ///< recovered or relinked: what is on screen is not what `path` holds
  std::string warning;     ///< one line to show once; "" = none
  std::string notice;      ///< the same, worth knowing only
  std::string stamp;       ///< of the session file as it was read (see stampOf); "" = not known
  std::shared_ptr<const Scene> scene;
  InspectionRequest request;
  draw::Selection selection;
  std::map<std::string, bool> layers;          ///< visibility by layer name, where it differs from the default
  std::map<std::string, std::string> options;  ///< how views show things, see ViewState
  std::string layout;                          ///< "" = keep the window's
  std::vector<viz::ViewPoint> viewPoints;      ///< of the 3D views, those beyond the last as the first; empty = show everything
  std::shared_ptr<const Tradeoff> tradeoff;    ///< measured speed against accuracy; null = none
  std::shared_ptr<const Session> session;      ///< what the file said besides (notes, unknown keys); null for a plain scene
};

/// Everything that the desktop program asks of `core`. `coreEngine()` is the real one; tests replace single
/// functions to make a run long, to count runs or to fail. All of them may be called from a worker thread.
struct Engine {
  /// InputError (file, place, reason) if the input cannot be used; MissingScene for a session whose scene is missing,
  /// MissingMesh for a scene whose mesh is not.
  /// @param instead  where these are now.
  std::function<Opened(const std::string& path, const Relinked& instead)> open;
  /// As Pipeline::ask: throws Stopped and InputError. Null for a part: it is not shown before everything is computed.
  std::function<Pipeline::Answer(Pipeline&, const Question&, const ProgressFn&)> ask;
  /// As Pipeline::contour; may be empty: then what is observed comes with the models.
  std::function<std::optional<Observation>(const Pipeline&, const InspectionRequest&, int frame, const ProgressFn&,
                                           const Inspection* shown)>
      contour;
  /// The automatic choice of the model; throws Stopped and InputError. Needs no fitted model.
  std::function<glint::Selection(std::shared_ptr<const Scene>, const InspectionRequest&, std::optional<double> goodEnoughPct,
                                 const ProgressFn&, const Inspection* previous)>
      choose;
  /// As glint::measureTradeoff on the models that the program knows; `file` is what is open, so that stopped work can be resumed.
  std::function<Tradeoff(std::shared_ptr<const Scene>, const InspectionRequest&, const std::string& file, const ProgressFn&)>
      tradeoff;
  /// As glint::measureInfluence: throws Stopped.
  std::function<Influence(const Inspection&, const ProgressFn&)> influence;
  /// The convention report, with the check of cameras by their highlights; empty without any findings. Throws Stopped and
  /// InputError.
  std::function<ConventionReport(const Scene&, const ProgressFn&)> check;
  /// What `glint lights` finds in a scene; may be empty: then nothing is found. Throws Stopped and InputError.
  /// @param input  as the user named it
  std::function<LampsReport(std::shared_ptr<const Scene>, const InspectionRequest&, const std::string& input, const ProgressFn&,
                            const Inspection* previous)>
      lamps;
  /// What it finds in photographs of balls; may be empty. Throws Stopped and InputError.
  std::function<Outcome<LampsReport>(const BallQuestion&, const ProgressFn&)> ballLamps;
  /// As glint::parseTrainSpec: InputError for a specification that does not parse.
  std::function<TrainSpec(const std::string&, const Scene&)> parseTrain;
  /// Writes a session file atomically; InputError if it cannot be written, Stopped. It hashes every input file, so it takes
  /// its time. @param results may be null.
  std::function<void(const Opened&, const Inspection* results, const std::string& path, const ProgressFn&)> save;
  /// Writes what is needed to go on after a crash, quickly: no hashes, no results. `open` reads it as `Opened::unsaved`.
  /// InputError.
  std::function<void(const Opened&, const std::string& path)> autosave;
  /// What `autosave` writes there.
  std::function<std::string(const Opened&, const std::string& path)> recoveryText;
};

/// The engine that the program uses: glint::core.
Engine coreEngine();

}  // namespace glint::gui
