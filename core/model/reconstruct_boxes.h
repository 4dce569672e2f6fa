// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/ellipsoid.h"

namespace glint {

/// One view of an object by its bounding box, as detectors give it: sides along the image's axes that touch the object.
struct BoxView {
  Projection projection;        ///< of a real camera, ideal pixels; any scale and sign
  Pixel low{0, 0}, high{0, 0};  ///< corners of the box, low < high
  Eigen::Vector2i imageSize{
      0, 0};            ///< width, height, px; 0 = unknown. A side within 2 px of the border cuts the object and is not used
  bool visible = true;  ///< false: the object is not seen, and nothing of this view is used
};

/// The solid inside a box. Both kinds have nine unknowns, so their residuals may be compared.
enum class BoxSolid { Ellipsoid, Cuboid };
const char* nameOf(BoxSolid solid);

/// One solid fitted to the sides of all boxes.
struct SolidFit {
  BoxSolid solid = BoxSolid::Ellipsoid;
  Ellipsoid ellipsoid;        ///< itself, or the one nearest to the cuboid, see ellipsoidOfCuboid
  Eigen::Vector3d halfEdges;  ///< of the cuboid, along the ellipsoid's axes; its semi-axes when it is an ellipsoid
  double rmsPx = 0;           ///< of the sides used
  double condition = 0;       ///< first over last singular value of the sides' slopes
  bool converged = false;     ///< within round-off; else the iteration stopped at its limit
  std::optional<Eigen::Matrix3d> centreCovariance;  ///< units of the world, squared, from the residuals; nothing with 9 sides
  std::vector<Eigen::Vector4d> residualPx;  ///< per view: left, top, right, bottom; measured minus fitted; 0 where not used
  std::vector<double> leverage;  ///< of the sides used, in their order: by how much each decides on its own residual, 0 to 1
};

struct BoxReconstruction {
  SolidFit best;
  std::optional<SolidFit> other;     ///< the solid with the larger residual, where it could be fitted
  int sides = 0;                     ///< that were used
  std::vector<std::string> remarks;  ///< warnings in words: what makes the answer doubtful
};

/// Ellipsoid or cuboid from bounding boxes. A side of a box is a line l, its plane pi = P^T l = (n, d) touches the object:
///   n.c + d = h(R^T n),   h(n) = |diag(a) n|_q,   q = 2 of an ellipsoid with semi-axes a, q = 1 of a cuboid with half edges a,
/// with n away from the object and h the support function. (An ellipse inscribed in the box is no outline, unless the
/// object's axes happen to lie along the image's: of a tilted object such ellipses contradict each other.)
/// Minimises the sides' distances in px, first order, over centre, rotation and a; the least of several starts. The solid with
/// the smaller residual is the answer. A remark says where an F test at 95 % cannot tell the two apart, where one side stands out
/// (an object that is cut or occluded), and where the centre is not known to half of the object's size.
/// @return TooFewViews (fewer than 3 views with a side to use); TooFewPoints (fewer than 9 sides); RankDeficient (the views
///   repeat each other or share a centre); BehindCamera (the rays through the boxes do not meet in front of the cameras);
///   NotAnEllipse (a box without area); NotFinite; NotConverged.
/// @see Rubino, Crocco and Del Bue, 3D Object Localisation from Multi-View Image Detections, PAMI 2018 (inscribed ellipses,
///   linear); Nicholson, Milford and Suenderhauf, QuadricSLAM, RA-L 2019 (tangent planes of the sides).
Outcome<BoxReconstruction> reconstructFromBoxes(const std::vector<BoxView>& views);

/// Eq. (cuboid): squared semi-axes m_i^2 = a_i (a_i + (2 / pi) (a_j + a_k)): the ellipsoid along the cuboid's axes whose squared
/// support function differs least from the cuboid's, (sum a_i |n_i|)^2, over all directions n. Boxes of a cuboid, seen from all
/// around, look like boxes of this ellipsoid.
/// @param halfEdges  a, not negative. @return m
Eigen::Vector3d ellipsoidOfCuboid(const Eigen::Vector3d& halfEdges);

}  // namespace glint
