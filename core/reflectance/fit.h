// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/base/uncertainty.h"
#include "core/geometry/light.h"
#include "core/reflectance/lamp.h"
#include "core/reflectance/lobe.h"
#include "core/surface/surface.h"

namespace glint {

/// One contour as evidence of the radiance: ideal pixels on the level set I = q max I of its frame.
struct RadianceView {
  int frame = 0;  ///< contours of one frame share its maximum
  Camera camera;
  const Surface* surface = nullptr;
  std::vector<Pixel> contour;  ///< closed, about equally spaced
  Pixel peak{0, 0};            ///< where the search for the frame's maximum starts
  double level = 0.5;          ///< q in (0, 1)
};

struct RadianceFitOptions {
  int pointsPerView = 72;  ///< contour points used, equally spaced in arc length
  double robustPx = 1.0;   ///< scale of the Huber loss, px
  int maxIterations = 100;
  bool lightSize = true;    ///< estimate the light's radius where the contours show it
  bool holdLamp = false;    ///< the lamp is known: its place and shape stay those of the start
  bool otherStarts = true;  ///< try other distances and widths when the first guess converges badly
  ProgressFn progress{};    ///< asked after every iteration: fits and searches with these options throw Stopped
};

/// A place from which a fit is worth trying.
struct RadianceStart {
  Lobe lobe = Lobe::TorranceSparrow;
  Light light;
  double roughness = 0;
  double cost = 0;        ///< mean robust square per point after a short fit, px^2: starts of all lobes are compared by it
  double excess = 0;      ///< what remains over what a fit may leave that is not poor; far above 1: not worth trying
  Eigen::VectorXd place;  ///< normalised: L with |L| = 1, log m

  bool promises() const;
  /// Both lead to the same minimum.
  bool isNear(const RadianceStart& other) const;
};

/// Starts along the first guess's direction at other distances and at infinity, narrower and wider; or around it, tilted by 20
/// and 45 degrees.
enum class StartGrid { Distances, Directions };
/// Each start of the grid after a short fit to few points; best first. Empty where fitRadiance would fail.
std::vector<RadianceStart> screenStarts(Lobe lobe, const std::vector<RadianceView>& views, const Light& light, double roughness,
                                        StartGrid grid = StartGrid::Distances, const RadianceFitOptions& options = {});

struct RadianceFit {
  Lobe lobe = Lobe::TorranceSparrow;
  Roughness roughness;  ///< m
  Lamp lamp;            ///< a point where the contours show no size
  /// Of (L homogeneous with |L| = 1 (4), log m (1)), then of the unknowns of the lamp's shape (m, or m^2), then the logarithm
  /// of the ratio of two widths, where the lobe has them; none where a direction is free.
  std::optional<ParameterUncertainty> uncertainty;
  Eigen::Matrix3d positionCovariance;  ///< m^2; not finite for a light at infinity
  double rmsPx = 0;
  double cost = 0;                 ///< robust sum of squares, px^2: lobes are compared by it
  std::vector<double> residualPx;  ///< per view, rmsWithoutTail() of core/base/residual_spread.h
  bool poor = false;               ///< residuals are large against the contours: a wrong lobe, or a minimum that is not the best
  bool doubtful = false;           ///< larger than a right lobe leaves: worth another search (also where poor)
  bool noiseOnly = false;          ///< nothing that neighbours on a contour share remains
  int points = 0, iterations = 0;

  Light light() const { return lightOf(lamp); }
};

/// Light and roughness of one lobe from contours alone (method.md section 7, `reflectance`): minimises over L = (l, w) on the
/// unit sphere and log m the robust sum of ((g(P_ij) - sqrt(-log q)) / |d g / d pixel|)^2, g = sqrt(log I(P_peak_i) - log
/// I(P_ij)), residuals in pixels, by Ceres. P_peak_i is the maximum of I in frame i under the present light. It moves with the
/// light, but the derivative of its value is that at a fixed point, because the gradient of I over the surface vanishes there.
/// The square root makes the residual nearly linear in the distance to the contour, however far it is.
/// @param light,roughness  first guess. Other distances are tried when it converges badly.
/// TooFewPoints; PeakOffSurface when no contour point hits the surface; NoBrightestPoint when no frame has a lit maximum;
/// NotConverged; NotFinite.
Outcome<RadianceFit> fitRadiance(Lobe lobe, const std::vector<RadianceView>& views, const Light& light, double roughness,
                                 const RadianceFitOptions& options = {});

/// The minimum that one start leads to, with everything free that the lamp's shape has: a point stays a point, a segment a
/// segment. `lightSize` and `otherStarts` do not matter. Failures as fitRadiance; NotConverged also where a lamp grows beyond
/// what its quadrature serves (2.5 lobe widths for a sphere, 12 for a segment).
Outcome<RadianceFit> fitLamp(Lobe lobe, const std::vector<RadianceView>& views, const Lamp& lamp, const Roughness& roughness,
                             const RadianceFitOptions& options = {});

/// RMS residual of every view under a fit, px, whether it was fitted to the view or not. Not finite where a frame shows no
/// maximum.
std::vector<double> rmsOfViews(const RadianceFit& fit, const std::vector<RadianceView>& views,
                               const RadianceFitOptions& options = {});

/// Lobe, lamp and roughness that explain the contours best: the lobe of the smallest residual. Every lobe is fitted; once the
/// best is known, every other one starts again from its light with the same width, until none gains. Where none explains the
/// contours well, the most promising starts of all lobes are tried. Where the residuals do not tell, a microfacet lobe is
/// taken: surfaces are rather microfacets than cosine powers. A sphere must lower the squared residuals by a fifth; for lamps
/// with a length see fitExtended.
/// @param lobes     at least one. With one only, another lobe may show the way to the light.
/// @param light     first guess
/// @param widthRad  of the lobe at the contours' level, as an angle theta_h (widthOf), in (0, pi / 2)
/// @return what fitRadiance returns; check `poor`.
Outcome<RadianceFit> searchRadiance(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const Light& light,
                                    double widthRad, const LampChoices& lamps, const RadianceFitOptions& options = {});

/// The same where a fit to nearly the same views is known, as for cameras that were moved a little: every lobe starts from its
/// lamp with the same width, and the lamp keeps its shape. This takes one solve for each lobe in place of a search.
/// @param near  lobe, roughness and lamp are read
Outcome<RadianceFit> fitNear(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const RadianceFit& near,
                             const RadianceFitOptions& options = {});

}  // namespace glint
