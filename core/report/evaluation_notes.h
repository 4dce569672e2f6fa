// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// What the evidence of one frame adds to what an evaluation says, whatever the model: plain data, which another process may have found.
struct FrameNote {
  int frame = -1;
  std::string id;                          ///< of the frame
  bool training = false, heldOut = false;  ///< neither: excluded
  bool clipped = false;                    ///< shows a clipped highlight
  bool levelKnown = true;                  ///< a lobe says what was cut off every clipped one
  bool given = false, detected = false;    ///< shows scored highlights of the scene file (of --truth), or found ones
  bool unreadable = false;                 ///< it cannot be scored because a file cannot be read
  std::string notParted;                   ///< see FrameEvidence
};
FrameNote noteOf(const Inspection& inspection, int frame);
/// Of every frame that the inspection looked at, in order.
std::vector<FrameNote> notesOf(const Inspection& inspection);

/// The warning about clipped highlights with their frames; "" where there are none.
std::string clippedWarning(const std::vector<FrameNote>& notes);
/// The warning about frames whose colours do not tell what is specular (detect.background = colours), with the reasons; "" where there are none.
std::string notPartedWarning(const std::vector<FrameNote>& notes);
/// Both, as far as they apply.
std::vector<std::string> evidenceWarnings(const std::vector<FrameNote>& notes);
/// What the predictions of held-out frames are scored against, without --truth: see scoredAgainst() of an inspection.
std::string scoredAgainst(const std::vector<FrameNote>& notes);

}  // namespace glint
