// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/inspect/inspection.h"

namespace glint {

/// Evidence of one frame, with truth where its inputs name a folder, but without the user's changes to single highlights.
/// @param scene  with the what-if
FrameEvidence evidenceFor(const Scene& scene, int frame, const EvidenceInputs& in);

/// Whether a what-if moves highlights of a frame or changes which there are.
bool changesHighlights(const WhatIf& whatIf, int frame);
/// Highlights as they were moved by hand; after their edits (hand_edits.h), which they may be the result of.
void moveHighlights(FrameEvidence& evidence, const WhatIf& whatIf);

/// Takes what is of lights that the what-if switched off in this frame out of highlights and truth. Where nothing is left the
/// failure is NoHighlight.
void dropSwitchedOff(FrameEvidence& evidence, const WhatIf& whatIf);
bool showsSwitchedOff(const FrameEvidence& evidence, const WhatIf& whatIf);

/// lightsNeedAllFrames() for what a request asks for: what is synthesised knows its lights.
bool lightsAreOpenIn(const Scene& scene, const InspectionRequest& request);

}  // namespace glint
