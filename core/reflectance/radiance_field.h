// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "core/reflectance/lamp.h"
#include "core/reflectance/lobe.h"
#include "core/surface/surface.h"

namespace glint {

/// How far beyond the image a maximum is looked for, as a share of its larger side.
inline constexpr double kPeakMargin = 0.65;

/// Where one frame is brightest.
struct RadiancePeak {
  Pixel pixel;         ///< ideal pixel of the maximum, to about 1e-4 px where the field is smooth
  SurfacePoint point;  ///< normal faces the camera
  double logRadiance = 0;
  bool cut = false;  ///< the radiance still rises where the domain of the search ends: the true maximum lies beyond
};

/// What a camera sees at the pixels of a coarse grid over its image: found once for fields of any lamp and lobe.
struct CoarseScan {
  std::vector<Pixel> pixels;
  std::vector<std::optional<SurfacePoint>> hits;  ///< approximate; normals face the camera
};
CoarseScan coarseScan(const Surface& surface, const Camera& camera, double stepPx);

/// log I of one lobe under one lamp over the visible surface, up to a constant of the lamp (method.md section 7):
/// lobe, masking, cosines and falloff. Undefined off the surface, where the light is below the horizon, and in shadow.
class RadianceField {
 public:
  /// @param roughness  m > 0. The surface must outlive the field.
  /// @param lamp       a Light is a point. Shadows: where the lamp's centre is hidden, and both ends of a segment.
  RadianceField(const Surface& surface, const Camera& camera, Lobe lobe, const Roughness& roughness, const Lamp& lamp);
  /// The same with a quadrature that the caller chose for the lamp's shape and size.
  RadianceField(const Surface& surface, const Camera& camera, Lobe lobe, const Roughness& roughness, const Lamp& lamp,
                const lobe::LampRule& rule);

  /// @param visible  a visible point, normal towards the camera.
  /// `floor`: below it the value alone tells; the shadow ray, which costs more than all the rest, is left out.
  std::optional<double> at(const SurfacePoint& visible, double floor = -std::numeric_limits<double>::infinity()) const;
  std::optional<double> at(const Pixel& idealPixel) const;

  /// The maximum that is reached uphill from a pixel: Newton's method where the field is smooth, a shrinking pattern search where
  /// it ends (silhouette, shadow, border of the domain). Never leaves the image's outermost pixel centres by more than
  /// `marginPx`. Nothing where the field is undefined at the start.
  std::optional<RadiancePeak> climb(Pixel start, double marginPx) const;

  /// All maxima reached from `starts` and, when `scanStepPx` > 0, from the brightest pixel of a coarse scan of the image,
  /// brightest first, each once. Where the brightest is only the border of the image, or the image holds none, it is followed
  /// beyond, up to kPeakMargin of the image's larger side.
  std::vector<RadiancePeak> peaks(const std::vector<Pixel>& starts, double scanStepPx) const;
  /// The same with a scan that is known already, of this surface and camera.
  std::vector<RadiancePeak> peaks(const std::vector<Pixel>& starts, const CoarseScan& scan) const;

  /// How far the lobe itself has fallen at a point below its value in the mirror direction, in log I; the lamp's point nearest to
  /// that direction counts. A frame whose maximum lies far down the lobe shows no highlight.
  double fallOfLobe(const SurfacePoint& visible) const;

  /// The quadrature over the lamp: one for the whole field, so that it is smooth.
  const lobe::LampRule& rule() const { return rule_; }

 private:
  std::vector<RadiancePeak> peaksFrom(const std::vector<Pixel>& starts, const CoarseScan* scan) const;
  std::optional<SurfacePoint> visible(const Pixel& p) const;
  double largestSizeRatio() const;
  bool hidden(const SurfacePoint& visible, double distance) const;

  const Surface& surface_;
  const Camera& camera_;
  Eigen::AlignedBox2d image_;  ///< seenWindow, up to the centres of its outermost pixels
  Eigen::Vector3d eye_;
  Lobe lobe_;
  Roughness roughness_;
  Lamp lamp_;
  lobe::LampRule rule_;
};

}  // namespace glint
