// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "core/base/outcome.h"
#include "core/pipeline/inspection.h"

namespace glint {

// Changes by hand to which highlights a frame shows (HighlightEdit): how one is made of a click, and what evidence becomes of it.
// All pixels are ideal ones.

/// Whether an edit names this highlight: one of its places lies inside of the contour.
bool isIgnored(const WhatIf& whatIf, int frame, const Highlight& highlight);
bool hasEdits(const WhatIf& whatIf, int frame);

/// Applies a frame's edits in their order. Highlights that are left keep their number (FrameEvidence::asFound); of merged ones
/// the first, of a cut one the part that holds the peak keeps it, and what is new gets numbers behind those found. What was taken
/// out by Ignore is in FrameEvidence::ignored, and out of `truth`; the other kinds change nothing of the truth. An edit whose
/// highlight is missing, or whose image cannot be read, changes nothing. Where no highlight is left the failure is NoHighlight.
/// @param scene  with the request's what-if
void applyEdits(FrameEvidence& evidence, const Scene& scene, const InspectionRequest& request);

/// @param highlight  whose contour encloses an area
HighlightEdit ignoreEdit(int frame, const Highlight& highlight);
HighlightEdit mergeEdit(int frame, const Highlight& first, const Highlight& second);
/// The shortest cut of a highlight through a place inside of it: through the neck, where one clicks at a neck.
/// NotReached if the place is outside, or a part would have no area.
Outcome<HighlightEdit> splitEdit(int frame, const Highlight& highlight, const Pixel& at);
/// A highlight grown from one pixel, on trial: the reason where nothing can be grown there (NoHighlight: it does not stand out of
/// a brighter spot, or of its surroundings; FrameUnreadable; NotSupported if contours are synthesised).
/// @param light  whose it is
Outcome<HighlightEdit> seedEdit(const Scene& scene, const InspectionRequest& request, int frame, const Pixel& at,
                                const std::string& light);

/// Evidence of one frame, with truth where its inputs name a folder, but without the user's changes to single highlights.
/// @param scene    with the what-if
/// @param diffuse  what lies under the highlights, if that is known
FrameEvidence evidenceFor(const Scene& scene, int frame, const EvidenceInputs& in,
                          std::shared_ptr<const DiffuseLight> diffuse = {});

/// Whether a what-if moves highlights of a frame or changes which there are.
bool changesHighlights(const WhatIf& whatIf, int frame);
/// Highlights as they were moved by hand; after their edits, which they may be the result of.
void moveHighlights(FrameEvidence& evidence, const WhatIf& whatIf);

/// Takes what is of lights that the what-if switched off in this frame out of highlights and truth. Where nothing is left the
/// failure is NoHighlight.
void dropSwitchedOff(FrameEvidence& evidence, const WhatIf& whatIf);
bool showsSwitchedOff(const FrameEvidence& evidence, const WhatIf& whatIf);

/// lightsNeedAllFrames() for what a request asks for: what is synthesised knows its lights.
bool lightsAreOpenIn(const Scene& scene, const InspectionRequest& request);

}  // namespace glint
