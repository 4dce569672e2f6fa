// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/reflectance/fit.h"
#include "core/reflectance/radiance_field.h"

/// What the fit of a lobe sees of the contours. Internal to core/reflectance.
namespace glint::lobe {

/// Largest step of the finite differences that turn log I into pixels, and the largest as a share of the highlight's radius.
inline constexpr double kStencilStepPx = 0.5, kStencilShare = 0.1;

/// In normalised world coordinates: a pixel's surface point and those of the pixels stepPx away.
struct Stencil {
  Seen at, left, right, up, down;
  double stepPx = kStencilStepPx;
};

/// One contour point. The residual is offsetPx - biasPx + pixelsPerUnit (g(foot) - level): the distance from the measured pixel
/// to the contour, linearised at the foot, its nearest point on the contour of the last round. Linearised at the measured pixel
/// instead, noise in the residual would correlate with noise in its derivatives, and contours would grow by sigma^2 / radius.
struct Evidence {
  int view = 0, frame = 0;  ///< frame: index into ContourEvidence::frames
  double level = 0;         ///< sqrt(-log q)
  Pixel observed{0, 0};
  Stencil measured, foot;    ///< the foot begins at the measured pixel
  double offsetPx = 0;       ///< from foot to measured, positive away from the peak
  double pixelsPerUnit = 1;  ///< 1 / |d g / d pixel| at the foot
  double curvature = 0;      ///< of the contour there, 1/px
  double biasPx = 0;         ///< expected distance of a measured pixel outside the contour
};

/// log I with its derivatives by the unknowns of a fit: L (4), log m, then those of the lamp's shape.
struct LogAndSlopes {
  double value = 0;
  Eigen::Matrix<double, 5 + kMostShapeUnknowns, 1> slopes = Eigen::Matrix<double, 5 + kMostShapeUnknowns, 1>::Zero();
};

/// A frame's maximum under the present light.
struct FramePeak {
  Camera camera;
  const Surface* surface = nullptr;
  std::vector<Pixel> starts;
  std::optional<CoarseScan> scan;   ///< of the image, from the first time that it was scanned
  std::optional<Seen> at;           ///< empty where nothing in the frame is lit
  std::optional<LogAndSlopes> log;  ///< there; shared by all points of the frame
};

/// Normalised coordinates are (x - origin) / scale.
struct ContourEvidence {
  std::vector<Evidence> points;  ///< contour by contour, in order
  std::vector<FramePeak> frames;
  Eigen::Vector3d origin{0, 0, 0};
  double scale = 1;     ///< mean distance from the cameras
  double radiusPx = 0;  ///< of the contours' regions, mean
};

/// Surface points around a pixel. Nothing where the surface ends within the stencil.
std::optional<Stencil> look(const RadianceView& view, const Pixel& p, const Eigen::Vector3d& origin, double scale, double stepPx);

/// Contour points of all views on their surfaces. TooFewPoints (< 5); PeakOffSurface when none hits the surface; NotFinite.
Outcome<ContourEvidence> gatherEvidence(const std::vector<RadianceView>& views, int pointsPerView);

}  // namespace glint::lobe
