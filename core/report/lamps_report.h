// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/app/lamp_fit.h"
#include "core/app/lamps_on.h"
#include "core/scene/scene.h"

namespace glint {

/// One photograph in a list of light positions (.lp).
struct LampLine {
  std::string file;                                       ///< name with ending
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< in the camera's frame: x right, y down, z forward
};

/// What `glint lights` found.
struct LampsReport {
  std::string input;       ///< as the user named it
  std::string lengthUnit;  ///< "m", "ball radius"; "" = no lengths are known
  std::vector<LampAnswer> lamps;
  std::vector<LampLine> lines;
  std::optional<BallLamps> balls;     ///< of photographs of balls; its lamps are not read
  std::vector<std::string> warnings;  ///< in words
};

/// One line per frame with exactly one lamp on and an answer, its direction from the object's middle. Warns of the others.
/// @param lamps  of lampsOfScene()
std::vector<LampLine> lampLinesOf(const Scene& scene, const std::vector<LampAnswer>& lamps, std::vector<std::string>& warnings);

/// Why a lamp has no answer, or no position; "" if it has one.
std::string reasonOf(const LampAnswer& lamp);
/// docs/formats.md, "lights --json". Numbers that are not finite become null.
std::string lampsJson(const LampsReport& report);
/// The first line of `lampsCsv`.
extern const char* const kLampsCsvHeader;
/// One row per lamp, with a header row.
std::string lampsCsv(const LampsReport& report);
/// A list of light positions as Relight and other RTI programs read it: the count, then for each photograph its name without
/// blanks (each becomes '_') and the unit vector, x right, y up, z towards the camera.
std::string lampsLp(const LampsReport& report);
/// A plain-text table for people.
std::string lampsTable(const LampsReport& report);

/// The first line of `lampsOnCsv`.
extern const char* const kLampsOnCsvHeader;
/// docs/formats.md, "lights --on": one row for each lamp in each frame, then one for each highlight that no lamp explains.
std::string lampsOnCsv(const LampsOn& lamps, const Scene& scene);
/// One line for people: how many lamps are on, off and so on.
std::string lampsOnSummary(const LampsOn& lamps);

}  // namespace glint
