// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/reciprocal.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// An ellipsoid as its cones see it, and the same as points of the dual space: why a fit is linear in Q* and not in Q. A
/// photograph tells which planes touch the ellipsoid (pi^T Q* pi = 0, linear in Q*), not where they touch it.
struct Duality {
  struct Touch {
    ConePlane cone;
    Eigen::Vector3d at{0, 0, 0};          ///< on the plane, over the point of the ellipsoid that is nearest to it; world, m
    double away = 0;                      ///< m, of the plane from the ellipsoid's centre, outwards
    double gap = 0;                       ///< m, between plane and ellipsoid: positive beside it, negative where it cuts
    std::optional<Eigen::Vector3d> dual;  ///< in the chart; none if the plane goes through the ellipsoid's centre
  };
  struct View {
    int frame = -1;
    Eigen::Vector3d apex{0, 0, 0};  ///< centre of the camera, or of its mirror image
    bool mirrored = false;          ///< the latter
    std::vector<Touch> planes;      ///< at equal steps around the ellipse
    double rmsGap = 0;              ///< m
    std::optional<double> fitPx;    ///< ModelFit::residualPx of the view
  };
  std::string model, light;
  Ellipsoid ellipsoid;
  Reciprocal chart;  ///< about the ellipsoid's centre; its radius is the geometric mean of the semi-axes that are not 0
  std::optional<Ellipsoid> dual;  ///< of the ellipsoid, in the chart; none of a flat one, whose dual is a tube without ends
  std::vector<View> views;
  double rmsGap = 0;      ///< m, over all planes
  double rmsOffDual = 0;  ///< of |y| over that of the dual quadric in the same direction, minus 1; points at infinity left out
  int atInfinity = 0;     ///< planes without a dual point
};

/// The duality of the training views of one model's fit for this frame and light. Pure; microseconds.
/// @param light  "" = the first that the model has a fit of.
/// @param model  one without an ellipsoid here, or "" = the richest with one.
/// @param planes  of each cone, >= 3.
/// @return  NotAnEllipsoid if no model has one; what conePlanes() says; TooFewViews where a fit names no view.
Outcome<Duality> dualityOf(const Inspection& inspection, int frame, const std::string& light, const std::string& model,
                           int planes = 24);

}  // namespace glint
