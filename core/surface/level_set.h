// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/polyline.h"

namespace glint {

/// A scalar field over the image; empty where it is undefined (no surface, unlit). Inside = value < level.
using PixelField = std::function<std::optional<double>(const Pixel&)>;
/// The same for many pixels at once and at reduced precision. Finds the topology only. May be empty.
using PixelFieldBatch = std::function<std::vector<std::optional<double>>(const std::vector<Pixel>&)>;

struct LevelSetOptions {
  double gridStepPx = 4;      ///< spacing of the scan that finds components; smaller ones need a seed inside
  double marginPx = 0;        ///< how far beyond the image borders the field is followed
  double sagittaPx = 5e-4;    ///< chords are split until they are this close to the curve
  double tolerancePx = 1e-9;  ///< root finding along grid edges and normals
  std::vector<Pixel> seeds;   ///< pixels known to be inside; the grid is refined around them so that small components are found
};

/// One connected component of { field < level } in the image, by its outer boundary.
struct LevelSetComponent {
  Polyline outline;  ///< closed, positively oriented; every vertex on the level set or on the border of the domain
  std::vector<char>
      onBorder;        ///< per vertex: 1 where the field ends there (surface edge, occlusion, image margin), 0 on the level set
  double minimum = 0;  ///< smallest field value met inside
  Pixel minimumAt{0, 0};
};

/// All components, largest first. Vertices are polished on `field` itself, whatever the batch returned.
/// Components are whole regions: one that encloses several minima is returned once; holes are not returned.
/// @param window  of the image, with the outer edges of its pixels (seenWindow, core/geometry/camera.h)
std::vector<LevelSetComponent> traceLevelSets(const PixelField& field, const PixelFieldBatch& batch, double level,
                                              const Eigen::AlignedBox2d& window, const LevelSetOptions& options = {});
/// The same in an image without distortion.
std::vector<LevelSetComponent> traceLevelSets(const PixelField& field, const PixelFieldBatch& batch, double level, int width,
                                              int height, const LevelSetOptions& options = {});

}  // namespace glint
