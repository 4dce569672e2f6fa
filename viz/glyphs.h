// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkActor.h>
#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/draw/scene_drawing.h"
#include "viz/convert.h"
#include "viz/style.h"

namespace glint::viz {

/// Building blocks of layers. Lengths are world units, line widths pixels. Nothing here is lit, except where it says so.
vtkSmartPointer<vtkActor> lineActor(const std::vector<Points>& chains, const Colour& colour, double widthPx);
vtkSmartPointer<vtkActor> segmentActor(const std::vector<Segment>& segments, const Colour& colour, double widthPx);
/// Lit spheres, one for each centre, in one actor.
vtkSmartPointer<vtkActor> sphereActor(const Points& centres, double radius, const Colour& colour);
/// Lit arrows from `first` to `second`; those shorter than 1e-12 of the radius are left out.
vtkSmartPointer<vtkActor> arrowActor(const std::vector<Segment>& arrows, double radius, const Colour& colour);
/// Translucent filled disc.
vtkSmartPointer<vtkActor> discActor(const Eigen::Vector3d& centre, const Eigen::Vector3d& unitNormal, double radius,
                                    const Colour& colour, double opacity);
/// Unlit translucent triangles, seen from both sides.
vtkSmartPointer<vtkActor> sheetActor(const TriangleMesh& mesh, const Colour& colour, double opacity);
/// The lit unit sphere carried by an affine transformation.
vtkSmartPointer<vtkActor> ellipsoidActor(const Eigen::Affine3d& worldFromUnitSphere, const Colour& colour, double opacity);

/// Dashes of about `dash` with gaps of the same length, at most 200.
std::vector<Segment> dashed(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double dash);

}  // namespace glint::viz
