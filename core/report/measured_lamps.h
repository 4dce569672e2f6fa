// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/app/ball_photographs.h"
#include "core/base/progress.h"
#include "core/pipeline/inspection.h"
#include "core/report/lamps_report.h"
#include "core/scene/outputs.h"

// How `glint lights` and the inspector measure lamps: one way, so that both agree.
namespace glint {

/// What the lamps of a scene need of inspect(): evidence and views of all frames that count, and no model.
/// @param asked  settings, source, excluded frames and what-if are kept; noise on training contours is not
InspectionRequest lampsRequest(const InspectionRequest& asked, const Scene& scene);

/// The lamps of a scene, with warnings. `lines` stays empty: see lampLinesOf().
/// @param inspection  of lampsRequest(). @param input  as the user named it
/// Throws Stopped.
LampsReport lampsReportOf(const Inspection& inspection, const std::string& input, const ProgressFn& progress = {});

/// Photographs of balls, as a person asks about them.
struct BallQuestion {
  std::string input;  ///< folder, as the user named it
  std::vector<NamedBall> balls;
  std::string exclude;               ///< a frame SPEC over the photographs; "" = none
  std::optional<Camera> camera;      ///< none: what EXIF data say, else a distant one
  std::optional<double> ballRadius;  ///< m, of every ball
  Outlines outlines = Outlines::Fitted;
  double outlineSigmaPx = 1;  ///< the accuracy of a circle that a person draws
};

/// "fitted", "edges", "given", as `--outlines` takes them; std::invalid_argument for another text.
Outlines outlinesOf(const std::string& text);
const char* toText(Outlines outlines);

/// The lamps of photographs of balls, with warnings and, of those that have an answer, `lines`.
/// @param shots  of ballShotsIn() with the same balls
/// @return  what lampsOfShots() says; throws what it throws
Outcome<LampsReport> lampsReportOf(const BallQuestion& question, const BallShots& shots, const ProgressFn& progress = {});

/// Why there is no lamp at all; nothing if one has an answer.
std::optional<Failure> nothingMeasured(const LampsReport& report);

/// The kind of a file of lamps, by its ending: .json, .csv or .lp. InputError (file, `place`) for another one.
OutputKind lampsKind(const std::string& file, const std::string& place);
/// The text of that file.
std::string lampsText(const LampsReport& report, const std::string& file);

/// As `--camera` takes it, to the last bit. @pre of cameraOfNumbers()
std::string cameraText(const Camera& camera);

/// The command line that asks the same. Camera and balls are written so that they are read back to the last bit.
std::string lightsCommand(const BallQuestion& question);

}  // namespace glint
