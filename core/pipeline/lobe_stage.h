// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// The stage between detection and training (method.md section 15): the lobe of every light is fitted to the pixels of the
/// training frames, and the contours of all frames are found again with the background that this lobe leaves.

/// The request asks for pixels: as evidence, or for the background.
bool looksAtPixels(const InspectionRequest& request);

/// The models that take no pixels are worth a step of their own, see Pipeline::ask().
/// @param known  earlier results on the same scene, the newest first
bool worthALook(const Scene& scene, const InspectionRequest& request, const std::vector<const Inspection*>& known);

using SurfaceOfFrame = std::function<std::shared_ptr<const Surface>(int frame)>;

/// Fills patches and pixelFits from the training frames. Frames whose contours the scene gives have no pixels. Throws
/// Stopped.
void fitLobes(Inspection& inspection, const SurfaceOfFrame& surfaceOf, bool together, const ProgressFn& progress);

/// What serves of the training frames' cut highlights: `few` for lights with fewer than three whole ones, else nothing.
std::map<FitKey, CutUse> useOfCut(const Inspection& inspection, CutUse few);

/// The stage's fit of a light for the reflectance model, or what failed. No fit where the request names the lobe or the lamp's
/// shape: the stage does not look at these, so that contours are the same for all of them.
KnownPixels knownPixelsOf(const Inspection& inspection, const FitKey& key);

/// Replaces the evidence of frames that were not looked at before by contours with the lobe's background; keeps the evidence as
/// detected in Inspection::detected. Throws Stopped.
void contourAgain(Inspection& inspection, const SurfaceOfFrame& surfaceOf, const ProgressFn& progress);

/// One frame's evidence, contoured again with the lobes that an inspection found. Empty if no light's lobe explains the frame.
/// @param scene,in  whose frame and settings count; they may be newer than the inspection's
std::optional<FrameEvidence> contouredAgain(const Inspection& lobes, const Scene& scene, const EvidenceInputs& in, int frame,
                                            const FrameEvidence& detected, const std::shared_ptr<const Surface>& surface);

/// Where the evidence is `levels`: contours of a frame's detected highlights at those of `fit.levels` that are not their own,
/// found as their own were. None for what the user moved, and at levels that lie in clipped pixels.
void addDetectedLevels(const Inspection& inspection, const SurfaceOfFrame& surfaceOf, FrameEvidence& evidence);

/// Joins the views with their pixels: those of the highlight of the same light whose peak lies in the view's contour. None where
/// noise was added or the user moved the highlight: its contour then says more than the pixels do.
void attachPixels(Inspection& inspection);

/// Between detection and everything that uses its highlights: bright texture goes out of the evidence of these frames
/// (detect.motion, core/pipeline/highlight_motion.h).
/// @param frames  whose evidence was gathered, and is as detected
/// @param gather  gathers further frames that must be asked and judged. Not called while the present ones decide. Throws Stopped
void rejectTextures(Inspection& inspection, std::vector<int> frames, const SurfaceOfFrame& surfaceOf,
                    const std::function<void(const std::vector<int>&)>& gather, const ProgressFn& progress);

/// How much bright texture a fit's training frames show; "" without any.
std::string textureRemark(const Inspection& inspection);

}  // namespace glint
