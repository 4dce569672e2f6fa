// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/fit/detect_settings.h"
#include "core/fit/frame_evidence.h"
#include "core/highlight/specular_separation.h"
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
/// @param separated  FrameEvidence::separated: each pixel then holds the specular part by
///                the nearest one's combination, in footprints; below 0 where noise says so. Empty: the mean of the channels
Outcome<LinearPixels> pixelsOf(const Frame& frame, FrameSource source, const DetectSettings& settings,
                               const std::vector<SeparatedRegion>& separated = {});

/// Contours at other levels, to the highlight of the same light whose peak they enclose. One around several peaks counts once.
void addOtherLevels(const std::vector<Highlight>& given, std::vector<Highlight>& highlights);

/// Highlights of one frame in ideal pixels: those that the scene gives, else detected ones (each at the level of its own peak if
/// the frame states several lights). Sets the light if the frame says which one is on (one light: its id; none stated: "light").
FrameEvidence gatherEvidence(const Scene& scene, int frame, FrameSource source, const DetectSettings& settings,
                             const SeparateLights& lights = {});

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

}  // namespace glint
