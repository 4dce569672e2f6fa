// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/base/uncertainty.h"
#include "core/highlight/highlight.h"
#include "core/reflectance/lamp.h"
#include "core/reflectance/lobe.h"
#include "core/reflectance/pixel_patch.h"

namespace glint {

/// What lies under a highlight, in one patch. Cosine: albedo x N.L / r^2 of the highlight's own lamp, as a matt base would show;
/// with ambient: plus a constant, light from everywhere; sloped: times 1 + a u + b v. Quadratic: any smooth shading, six
/// coefficients in the pixel.
enum class BackgroundKind { None, Cosine, AmbientCosine, SlopedCosine, Quadratic };
/// "none", "cosine", "cosine with ambient", "sloped cosine", "quadratic".
const char* nameOf(BackgroundKind kind);

/// A lobe and its lamp: all that the shape of a highlight follows from.
struct LobeModel {
  Lobe lobe = Lobe::TorranceSparrow;
  Roughness roughness = 0.1;  ///< m
  Lamp lamp;
  /// Variance of the images' blur beside the square that a pixel averages over, px^2. -1/12 where a pixel is the radiance at
  /// its centre
  /// alone.
  double blurVariance = 0;

  double blurPx() const { return std::sqrt(std::max(0.0, blurVariance)); }
};

/// A lamp's light in one frame: I = exp(logStrength) x the lobe's radiance, before the blur.
struct LampLight {
  LobeModel model;
  double logStrength = 0;
};

/// The linear part of a patch under a lobe: I = strength x S + b.
struct PatchSolution {
  double strength = 0;             ///< of S = I / I(topPoint), before the blur; >= 0
  SurfacePoint topPoint;           ///< the brightest cell of the frame, where S = 1: scales S
  std::vector<double> background;  ///< b per cell of the patch, all cells on the surface
  std::vector<double> lobe;        ///< S per cell of the patch, with the blur
  double relativeRms = 0;  ///< of I - strength S - b over the used cells above a tenth of the top, as a share of the frame's top
};
/// Strength and backgrounds of one frame's patches under a known lobe, robust (soft L1).
/// @param patches  of one frame
/// NoBrightestPoint where the lobe does not reach the patches, or its strength comes out as zero.
Outcome<std::vector<PatchSolution>> solvePatches(const std::vector<const PixelPatch*>& patches, const LobeModel& model,
                                                 BackgroundKind background);

struct PixelFitOptions {
  int maxIterations = 60;
  bool blur = true;                          ///< estimate the blur where the pixels show it
  bool holdLamp = false;                     ///< the lamp is known: its place and shape stay those of the start
  std::optional<BackgroundKind> background;  ///< no other is tried
  /// Lamp and roughness are those of a fit to these patches and a few more, with the one lobe and `background`: nothing is
  /// searched on coarse cells.
  bool near = false;
  ProgressFn progress{};  ///< asked at every look at all cells
};

struct PixelFit {
  LobeModel model;
  BackgroundKind background = BackgroundKind::None;
  /// Uncertainty of L (homogeneous, |L| = 1: 4 entries) and log m (1), world, as RadianceFit::uncertainty.
  std::optional<ParameterUncertainty> uncertainty;
  Eigen::Matrix3d positionCovariance;  ///< m^2; not finite for a light at infinity
  double cost = 0;                     ///< robust sum of squares over (share of the frame's top)^2: lobes are compared by it
  double rmsPx = 0;                    ///< what remains, as a displacement of the contour at half the peak, px
  std::vector<double> residualPx;      ///< the same per patch
  std::vector<double> relativeRms;     ///< per patch: what remains as a share of the frame's top
  /// The share by which the cost would fall, to first order, if a point had a size or a length; 0 for other lamps and at
  /// infinity.
  double gainByExtent = 0;
  int cells = 0, iterations = 0;
  double independentCells = 0;  ///< fewer than `cells` where the residuals of neighbours go together
  /// What neighbouring cells share, unlike noise, is more than a hundredth of the contours' radius. Right lobes, lamps and
  /// surfaces leave less than a thousandth.
  bool patterned = false;
  bool poor = false;  ///< does not explain the pixels: more than a tenth of the contours' radius, or of the top, remains
};

/// Light and lobe from the pixels themselves (method.md section 15, "Pixels"): minimises over L, log m, the lamp's extent and the
/// blur the sum of rho(w (I - K_i S(L, m) - b) / I_i,max), w = (max(I, 0.05 I_max) / I_max)^-1/2 (photon noise), rho soft L1 at
/// 0.01. K_i of every frame and the backgrounds b are linear and eliminated in every step (variable projection). The kind of
/// background is chosen by the Bayesian information criterion, the lobe by the cost. The lamp keeps the shape of the start: a
/// point, a sphere or a segment.
/// @param lobes  tried in turn; the one with the least cost wins, a microfacet lobe where the costs do not tell
/// @param lamp,roughness  start (two widths keep their ratio, which contours find): what the contours say, which need not be
/// close (clipped highlights) TooFewPoints; NotConverged; NoBrightestPoint where no lobe reaches the patches. Stopped.
/// @see Golub, Pereyra, Separable nonlinear least squares, Inverse Problems 2003.
Outcome<PixelFit> fitPixels(const std::vector<Lobe>& lobes, const std::vector<const PixelPatch*>& patches, const Lamp& lamp,
                            const Roughness& roughness, const PixelFitOptions& options = {});

/// Whether a lamp with an extent is worth a trial beside this point: to first order it would take a tenth off the cost, or more
/// than the noise of the independent cells explains; or what the point leaves has a pattern, as far too large a lamp makes it,
/// where first order tells nothing.
bool asksForExtent(const PixelFit& point);
/// Whether a lamp with an extent is believed beside a point, or a segment beside a sphere: it must leave a tenth less of the
/// cost, or so much less that the noise of the independent cells cannot be the reason. (Noise is most of the cost of a grainy
/// image, whatever the lamp.)
bool explainsClearlyBetter(const PixelFit& larger, const PixelFit& smaller);

/// The highlights of one light in one frame, found again with what a known lobe leaves as background (method.md section 15, "Bias
/// of the detected level"): I = K S + b gives b and K, and contours are taken at q K S_peak of I - b. A background that is fitted
/// to the pixels around a highlight without the lobe takes in the tail of a long-tailed one, so that contours come out 2 % too
/// small (GGX).
///
/// Where the highlight is clipped, its peak is the lobe's. Where the contour at q lies in clipped pixels, the highlight as found
/// is returned, with the level at which it really lies.
/// @param found      of one light, ideal pixels, as detected
/// @param others     of other lights in this frame
/// @param alsoLit    what other lamps add to these pixels is no part of the highlights (core/reflectance/other_lamps.h)
/// @param options    as they were detected with (level, smallest area, contrast)
/// @return           the same highlights in the same order, each contoured again. NoBrightestPoint where the lobe does not reach
///                   them; NotConverged where it does not explain the frame; TooFewPoints.
Outcome<std::vector<Highlight>> contourWithLobe(const LinearPixels& pixels, const Camera& camera, const Surface& surface,
                                                int frame, const std::vector<Highlight>& found,
                                                const std::vector<Highlight>& others, const LobeModel& model,
                                                BackgroundKind background, const DetectOptions& options,
                                                const std::vector<LampLight>& alsoLit = {});

}  // namespace glint
