// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/highlight/frame_blur.h"
#include "core/highlight/highlight.h"
#include "core/highlight/report.h"
#include "core/highlight/specular_separation.h"
#include "core/pipeline/detect_settings.h"
#include "core/pipeline/frame_evidence.h"
#include "core/reflectance/pixel_patch.h"
#include "core/scene/scene.h"

namespace glint {

/// How the highlights of several lights are detected (DetectOptions::separatePeaks).
struct SeparateLights {
  bool separate = false;                  ///< also if the frame does not state several lights
  std::vector<PeakReference> references;  ///< ideal pixels
};

/// How a frame's image is searched, without references.
DetectOptions detectOptionsFor(const Frame& frame, FrameSource source, const DetectSettings& settings);

/// The image that detection sees, as evidence. FrameUnreadable.
/// @param under      FrameEvidence::diffuse, taken off; null = nothing
/// @param separated  FrameEvidence::separated: each pixel then holds the specular part by
///                the nearest one's combination, in footprints; below 0 where noise says so. Empty: the mean of the channels
Outcome<LinearPixels> pixelsOf(const Frame& frame, FrameSource source, const DetectSettings& settings,
                               const std::vector<SeparatedRegion>& separated = {}, const DiffuseLight* under = nullptr);

/// Contours at other levels, to the highlight of the same light whose peak they enclose. One around several peaks counts once.
void addOtherLevels(const std::vector<Highlight>& given, std::vector<Highlight>& highlights);

/// Highlights of one frame in ideal pixels: those that the scene gives, else detected ones (each at the level of its own peak if
/// the frame states several lights), over the diffuse light if that is known. Sets the light if the frame says which one is on
/// (one light: its id; none stated: "light").
FrameEvidence gatherEvidence(const Scene& scene, int frame, FrameSource source, const DetectSettings& settings,
                             const SeparateLights& lights = {}, std::shared_ptr<const DiffuseLight> diffuse = {});

/// Traces the detected highlights of a frame again on their specular part alone, where its colours allow it
/// (`separateHighlights`). Highlights that the scene gives stay as they are.
/// @return what came of it; the reason also if the lens distortion has no inverse
SpecularSeparation separateEvidence(const Scene& scene, int frame, FrameSource source, const DetectSettings& settings,
                                    FrameEvidence& evidence);

/// Contours stored as in data/cycles/*/contours (FOLDER/ID.json) at `level`, for scoring. FrameUnreadable if the frame has no
/// file. InputError if a file does not parse, does not hold the level or has a contour without area.
Outcome<std::vector<Highlight>> readTruth(const std::string& folder, const Scene& scene, int frame, double level);

/// InputError if `folder` is not a folder, or holds no frame's contours.
void requireTruthFolder(const std::string& folder, const Scene& scene);

/// The contour resampled to 72 points, with independent Gaussian noise per coordinate on them and on the peak (--noise-px).
/// Depends on seed, frame and index only, not on which frames train.
Highlight withNoise(const Highlight& highlight, double sigmaPx, unsigned seed, int frame, int index);

/// What a frame's pixels and surface say about its highlights beside their contours.
/// @param surface  that the frame sees; null = unknown: no flags about silhouettes and mirrored rays
/// @param blur     of the frame, where its edges show one
/// @return  one for each highlight, in their order
std::vector<HighlightQuality> highlightQualities(const Frame& frame, const LinearPixels& pixels, const Surface* surface,
                                                 const std::optional<FrameBlur>& blur, const std::vector<Highlight>& highlights);

/// Where the frame has one lamp, flags highlights whose mirrored ray does not meet that of the largest one (method.md section 4):
/// another lamp's, the reflection of something else, or texture.
/// @param qualities  one for each highlight, in their order
void flagStrangers(const Frame& frame, const Surface& surface, const std::vector<Highlight>& highlights,
                   std::vector<HighlightQuality>& qualities);

/// Some frame shows highlights whose light is not known from the frame alone: no frame's evidence is final before all are
/// gathered.
bool lightsNeedAllFrames(const Scene& scene);

/// Gives every highlight its light where several are on or none is stated (core/light/track.h), and brings the highlights of
/// one light in a frame to one level. Does nothing if every highlight has its light.
/// @param evidence     one per frame; changed in place
/// @param surfaceOf    of a frame; null if it has none
/// @param detectAgain  evidence of a frame with its lights kept apart; called from several threads
/// @param elsewhereFromScene  of each frame, to coordinates in which lights may stand still as well; empty without such
/// Throws Stopped.
void assignSeveralLights(const Scene& scene, std::vector<FrameEvidence>& evidence,
                         const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf,
                         const std::function<FrameEvidence(int frame, const SeparateLights&)>& detectAgain,
                         const std::vector<Eigen::Isometry3d>& elsewhereFromScene, const ProgressFn& progress);

}  // namespace glint
