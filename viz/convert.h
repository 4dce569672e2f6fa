// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vtkImageData.h>
#include <vtkMatrix4x4.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "core/base/image.h"
#include "core/surface/surface.h"

class vtkRenderWindow;

namespace glint::viz {

using Points = std::vector<Eigen::Vector3d>;
using Segment = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

/// Triangles with point normals where the mesh has them; triangles with an index out of range are left out.
vtkSmartPointer<vtkPolyData> toPolyData(const TriangleMesh& mesh);
/// One polyline per chain with at least two points. World units.
vtkSmartPointer<vtkPolyData> toPolyData(const std::vector<Points>& chains);
vtkSmartPointer<vtkPolyData> toPolyData(const std::vector<Segment>& segments);
/// Row-major copy of a 4x4 transformation.
vtkSmartPointer<vtkMatrix4x4> toVtk(const Eigen::Matrix4d& matrix);
/// 8-bit RGB texture of a 1- or 3-channel image with values 0..1 (clamped), at most `maxWidth` wide (area-averaged).
/// Rows are flipped: VTK's first row is the bottom one.
vtkSmartPointer<vtkImageData> toTexture(const Image& image, int maxWidth);
/// The same of bytes, RGB, top row first. @param stride  bytes from row to row.
vtkSmartPointer<vtkImageData> toTexture(const unsigned char* rgb, int width, int height, int stride);
/// The triangles with point normals: their own where they have them, else computed, edges above 40 degrees kept sharp.
vtkSmartPointer<vtkPolyData> withNormals(const vtkSmartPointer<vtkPolyData>& triangles);
/// A coarse copy with normals: vertices gathered in a grid of cubes, `divisions` along the longest side. Any thread.
vtkSmartPointer<vtkPolyData> coarsened(const vtkSmartPointer<vtkPolyData>& triangles, int divisions);
/// 3-channel values 0..1, top row first, of a VTK RGB or RGBA 8-bit image (bottom row first).
Image fromVtk(vtkImageData* rgb);

/// What a window shows, 3 channels 0..1; it was rendered.
Image pictureOf(vtkRenderWindow* window);

inline Eigen::Vector3d toEigen(const double* xyz) { return {xyz[0], xyz[1], xyz[2]}; }

}  // namespace glint::viz
