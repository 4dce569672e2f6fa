// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/scene/scene.h"

namespace glint {

/// How a texture lies on a surface. u points right and v down the image, in textures: [0, 1) is the first one, then it repeats.
enum class TextureMapping {
  Natural,    ///< the surface's own coordinates where it has them (below), else Box
  Planar,     ///< world x and y
  Spherical,  ///< longitude and latitude about the middle of the bounding box, axis = world z
  Box,        ///< the two world coordinates across the largest component of the normal
};
inline const std::vector<std::string> kTextureMappings{"natural", "planar", "spherical", "box"};
/// std::invalid_argument for another name.
TextureMapping textureMappingNamed(const std::string& name);

/// Texture coordinates of a surface point. Natural:
///   plane      local x, y in metres;                sheet  arc length and local y, over length and width or in metres
///   sphere, ellipsoid  longitude / 2 pi and latitude / pi (of the sphere that the semi-axes stretch), axis = local z
///   cylinder   angle / 2 pi and local y over the girth;     torus  the two angles / 2 pi
/// Planar and Box: one texture across the bounding box's largest side; for depth maps, whose box varies, and surfaces without
/// bounds, one per metre. On an object that moves the texture moves with it: world coordinates are those of the object.
class TextureCoordinates {
 public:
  /// @param frame  whose surface it is. @param repeat  textures in place of one, > 0
  TextureCoordinates(const Scene& scene, int frame, const Surface& surface, TextureMapping mapping, double repeat);
  Eigen::Vector2d at(const SurfacePoint& p) const;
  const std::string& words() const { return words_; }  ///< what was taken, for the user: "longitude and latitude"

 private:
  std::function<Eigen::Vector2d(const SurfacePoint&)> map_;
  double repeat_;
  std::string words_;
  std::optional<Eigen::Isometry3d> objectFromScene_;  ///< of an object that moves
};

/// A texture with smaller copies of itself, each half the size of the one before.
class TexturePyramid {
 public:
  /// @param linear  3 channels, linear light.
  explicit TexturePyramid(const Image& linear);
  /// Bilinear, repeated; from the copy whose pixels are about as large as `footprint` (in textures).
  Eigen::Vector3d at(const Eigen::Vector2d& uv, double footprint) const;
  double mean() const { return mean_; }  ///< of all pixels and channels

 private:
  std::vector<Image> levels_;
  double mean_ = 0;
};

}  // namespace glint
