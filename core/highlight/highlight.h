// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/outcome.h"
#include "core/geometry/conic.h"
#include "core/geometry/polyline.h"

namespace glint {

struct ClippedFlank;
struct DiffuseLight;

/// A contour of a highlight at one more level.
struct LevelContour {
  double level = 0;  ///< fraction of (reference - background)
  Polyline contour;  ///< closed, ideal pixels
};

/// One highlight in one frame: evidence. All coordinates are ideal pixels (lens distortion removed).
struct Highlight {
  std::string light;               ///< id of its light; "" while unknown
  double level = 0.5;              ///< fraction of (reference - background) at which the contour was taken
  Polyline contour;                ///< outer contour, closed, sub-pixel
  Pixel peak{0, 0};                ///< maximum of the log-quadratic fit; ellipse centre when clipped
  double peakValue = 0;            ///< fitted radiance at the peak, background removed; 0 when unknown
  std::optional<Ellipse> ellipse;  ///< least-squares ellipse of the contour
  double areaPx2 = 0;
  bool clipped = false;  ///< saturated: the peak is the ellipse centre, or that of a known lobe
  /// A detected clipped one has its slope at several levels, the peak that continues it, and the contour's place on it.
  std::shared_ptr<const ClippedFlank> flank;
  /// Where a known lobe says that the contour lies at another fraction of the true peak than `level`: clipped above the level.
  std::optional<double> trueLevel;
  bool touchesBorder = false;  ///< cut by the image border: the contour is closed along it, and only the rest is a level set
  /// Cut, and brightest at the border: the level is a fraction of the radiance at `peak`, which is no maximum.
  bool peakCut = false;
  double cutPx2 = 0;                      ///< area of streaks that were cut off; clipped highlights only
  bool fromScene = false;                 ///< given in the scene file, not detected
  std::string byHand{};                   ///< what a person did to its shape, and what that leaves in doubt; "" = nothing
  std::vector<LevelContour> otherLevels;  ///< beside `contour`, where several levels are evidence (fit.evidence = levels)
};

/// Radiance (background removed) whose fraction the contour of the highlight with this peak lies at.
struct PeakReference {
  Pixel peak;
  double value;
};

/// Something that stands out of the background and is no highlight, with the reason.
struct RejectedCandidate {
  Pixel place{0, 0};  ///< measured pixels of the image
  double areaPx2 = 0;
  std::string reason;  ///< in words
};

struct DetectOptions {
  double level = 0.5;            ///< contour level, fraction of the strongest peak above the background
  double minContrast = 3.0;      ///< peak over the background's spread; below this it is noise or a diffuse bump
  double minAreaPx2 = 12;        ///< smaller blobs do not constrain the 5 ellipse parameters
  double minRelativePeak = 0.0;  ///< blobs whose own peak is below this fraction of the strongest are dropped
  double peakWindowLevel = 0.9;  ///< pixels above this fraction of the peak enter the log-quadratic fit
  double clipValue = 0;          ///< values at or above are saturated; 0 = none
  bool removeBackground = true;  ///< subtract the local diffuse background (median of the surrounding glossy pixels)
  /// For several lights of unequal strength: finds weaker peaks, too. Each contour lies at `level` of its own peak, or of the
  /// reference that names it (the strongest peak of its light, once known). Peaks inside a stronger one's contour do not count.
  bool separatePeaks = false;
  std::vector<PeakReference> references;
  const DiffuseLight* under = nullptr;  ///< taken off before anything is looked for; pixels where it is unknown are not used
  std::optional<double> reference;      ///< contours lie at `level` of this value, wherever the strongest peak is
};

/// Highlights of a linear image (method.md section 1): level relative to the strongest fitted peak, sub-pixel contours by
/// marching squares on the float values (never a mask's border), peak by a log-quadratic fit in a window around each maximum.
/// @param linear  1 or 3 channels (3 are averaged), linear radiance. Non-finite or negative values are not used: where one
///                touches a highlight, that highlight fails.
/// @param mask    optional, non-zero on the glossy object; same size.
/// The slope around a clipped core tells its peak (`traceFlank`). The contour lies at `level` of the peak if that is
/// outside of the core, else at `level` of the clip value. Cuts off narrow streaks (`withoutStreaks`), drops narrow pieces.
/// @param rejected  optional: where candidates go that became no highlight, largest first, at most 32.
/// @return at least one highlight, strongest first. NoHighlight; NotFinite (detail counts the bad pixels); Clipped never fails,
/// it flags.
Outcome<std::vector<Highlight>> detectHighlights(const Image& linear, const Image* mask, const DetectOptions& options,
                                                 std::vector<RejectedCandidate>* rejected = nullptr);

}  // namespace glint
