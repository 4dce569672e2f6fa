// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/app: edges in photographs along lines across a ball's outline.

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/app/ball_outline.h"
#include "core/base/image.h"

namespace glint {

/// Sectors of equal angle around an outline; each photograph gives its edges in each.
inline constexpr int kOutlineSectors =
    120;  // 3 degrees: 22 px of a ball of 420 px, so noise is averaged and a sector is nearly straight

/// A circle, or with a camera the outline of a sphere: the cone of rays that touch it, cut by the image plane. Three unknowns x:
/// for the circle centre and radius; for the sphere the image of its centre and the outline's smaller half axis, f tan(alpha) /
/// cos(theta), alpha the cone's half angle, theta its axis against the optical axis.
struct OutlineModel {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  std::optional<OutlineCamera> camera;

  /// Distance of a point from the outline, px, positive outside; of a sphere to first order.
  double distance(const Eigen::Vector2d& place) const;
  /// Its derivatives by x.
  Eigen::Vector3d derivatives(const Eigen::Vector2d& place) const;
  /// Where the ray from (x0, x1) at this angle meets the outline.
  double radiusAt(double angle) const;
};

/// An edge where a line across the outline meets it in one photograph.
struct BallEdge {
  int photograph = 0, sector = 0;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  double step = 0;     ///< grey levels per px outwards, signed
  double sigmaPx = 0;  ///< from the neighbours' distances to a straight line
};

/// Linear light of photographs with 8-bit sRGB values, 0 to 255, mean of the channels.
std::vector<Image> linearLight(std::span<const Image> photographs);

/// Edges that continue through neighbouring sectors: steepest places of linear light on lines across the outline, within `reach`.
/// @param linear  one channel. @param blurPx  of the Gaussian's derivative. @param slant  an edge's largest step between sectors
std::vector<BallEdge> ballEdges(std::span<const Image> linear, const OutlineModel& outline, double reach, double blurPx,
                                double slant);

}  // namespace glint
