// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// Whether a lamp is on in a frame, as far as its highlight tells. CannotBeSeen: it would show no highlight there, on or off.
enum class LampIs { On, Off, CannotBeSeen, Unsure };
const char* wordOf(LampIs state);

/// One lamp in one frame. Radiances are linear, in the frame's unit.
struct LampInFrame {
  int frame = 0;
  std::string light;
  LampIs state = LampIs::Unsure;
  double confidence = 0;       ///< that the state is right, 0.5 to 1 for on and off; 0 where nothing was measured
  double contrast = 0;         ///< mean inside of the predicted contour less the median around it
  double expected = 0;         ///< the contrast of this lamp where frames state that it is on: median
  double noise = 0;            ///< standard deviation of the contrast where the lamp is off
  std::optional<Pixel> place;  ///< middle of the predicted contour, ideal pixels
  std::optional<bool> stated;  ///< what the scene says; nothing if the frame names no lamp
  std::string reason;          ///< in words; "" if the state needs none
};

/// A highlight that no lamp explains.
struct UnexpectedHighlight {
  int frame = 0;
  Pixel place{0, 0};  ///< ideal pixels
  double contrast = 0, noise = 0;
};

struct LampsOn {
  std::vector<LampInFrame> lamps;  ///< by frame, then by lamp
  std::vector<UnexpectedHighlight> unexpected;
  std::vector<std::string> warnings;
};

/// Which lamps are on in each frame. Predicts the highlight of each lamp, on or off, with the limit-angle model, and measures the
/// contrast there against two equally probable hypotheses: none (standard deviation: a third of the surroundings' spread, because
/// texture is correlated, and a twentieth of the expected contrast), and the expected one (+-40 %, for lobes change with the
/// view). Below 0.95 the answer is Unsure. If the highlights of two lamps coincide and something is bright, both are Unsure. A
/// detected highlight of at least 0.3 of the weakest expected contrast that lies in no prediction is unexpected.
/// @param inspection  of inspect() with that model, trained on frames that name their lamps
/// @return  no lamps where none was fitted; `warnings` has the reasons. Throws Stopped.
LampsOn lampsOnIn(const Inspection& inspection, const ProgressFn& progress = {});

}  // namespace glint
