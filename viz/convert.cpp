// SPDX-License-Identifier: BSD-3-Clause
#include "viz/convert.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataNormals.h>
#include <vtkQuadricClustering.h>
#include <vtkRenderWindow.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace glint::viz {
namespace {

vtkSmartPointer<vtkPoints> doublePoints() {
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataTypeToDouble();  // kilometres with millimetres in them do not fit into floats
  return points;
}

}  // namespace

vtkSmartPointer<vtkPolyData> toPolyData(const TriangleMesh& mesh) {
  auto points = doublePoints();
  points->SetNumberOfPoints(static_cast<vtkIdType>(mesh.vertices.size()));
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) points->SetPoint(static_cast<vtkIdType>(i), mesh.vertices[i].data());
  vtkNew<vtkCellArray> cells;
  const int count = static_cast<int>(mesh.vertices.size());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    if (t.minCoeff() < 0 || t.maxCoeff() >= count) continue;
    cells->InsertNextCell({t.x(), t.y(), t.z()});
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  if (!mesh.vertices.empty() && mesh.normals.size() == mesh.vertices.size()) {
    vtkNew<vtkFloatArray> normals;
    normals->SetName("Normals");
    normals->SetNumberOfComponents(3);
    normals->SetNumberOfTuples(static_cast<vtkIdType>(mesh.normals.size()));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) normals->SetTuple(static_cast<vtkIdType>(i), mesh.normals[i].data());
    data->GetPointData()->SetNormals(normals);
  }
  return data;
}

vtkSmartPointer<vtkPolyData> toPolyData(const std::vector<Points>& chains) {
  auto points = doublePoints();
  vtkNew<vtkCellArray> lines;
  for (const Points& chain : chains) {
    if (chain.size() < 2) continue;
    lines->InsertNextCell(static_cast<int>(chain.size()));
    for (const Eigen::Vector3d& p : chain) lines->InsertCellPoint(points->InsertNextPoint(p.data()));
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(lines);
  return data;
}

vtkSmartPointer<vtkPolyData> toPolyData(const std::vector<Segment>& segments) {
  std::vector<Points> chains;
  chains.reserve(segments.size());
  for (const auto& [a, b] : segments) chains.push_back({a, b});
  return toPolyData(chains);
}

vtkSmartPointer<vtkMatrix4x4> toVtk(const Eigen::Matrix4d& matrix) {
  auto result = vtkSmartPointer<vtkMatrix4x4>::New();
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) result->SetElement(r, c, matrix(r, c));
  }
  return result;
}

vtkSmartPointer<vtkImageData> toTexture(const Image& image, int maxWidth) {
  const int width = std::max(1, std::min(image.width, maxWidth));
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(image.height) * width / std::max(1, image.width))));
  auto texture = vtkSmartPointer<vtkImageData>::New();
  texture->SetDimensions(width, height, 1);
  texture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < height; ++y) {
    const int y0 = y * image.height / height, y1 = std::max(y0 + 1, (y + 1) * image.height / height);
    auto* row = static_cast<unsigned char*>(texture->GetScalarPointer(0, height - 1 - y, 0));
    for (int x = 0; x < width; ++x) {
      const int x0 = x * image.width / width, x1 = std::max(x0 + 1, (x + 1) * image.width / width);
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int v = y0; v < y1; ++v) {
          for (int u = x0; u < x1; ++u) sum += image.at(u, v, image.channels == 3 ? c : 0);
        }
        const double mean = sum / ((y1 - y0) * (x1 - x0));
        row[3 * x + c] = static_cast<unsigned char>(std::lround(255 * std::clamp(std::isfinite(mean) ? mean : 0.0, 0.0, 1.0)));
      }
    }
  }
  return texture;
}

vtkSmartPointer<vtkImageData> toTexture(const unsigned char* rgb, int width, int height, int stride) {
  auto texture = vtkSmartPointer<vtkImageData>::New();
  texture->SetDimensions(width, height, 1);
  texture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  for (int y = 0; y < height; ++y)
    std::memcpy(texture->GetScalarPointer(0, height - 1 - y, 0), rgb + static_cast<std::ptrdiff_t>(y) * stride,
                3 * static_cast<std::size_t>(width));
  return texture;
}

vtkSmartPointer<vtkPolyData> withNormals(const vtkSmartPointer<vtkPolyData>& triangles) {
  if (triangles->GetPointData()->GetNormals() || triangles->GetNumberOfPolys() == 0) return triangles;
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(triangles);
  normals->SetFeatureAngle(40);
  normals->Update();
  return normals->GetOutput();
}

vtkSmartPointer<vtkPolyData> coarsened(const vtkSmartPointer<vtkPolyData>& triangles, int divisions) {
  double size[3];
  const double* bounds = triangles->GetBounds();
  for (int i = 0; i < 3; ++i) size[i] = bounds[2 * i + 1] - bounds[2 * i];
  const double longest = std::max({size[0], size[1], size[2]});
  vtkNew<vtkQuadricClustering> clustering;
  clustering->SetInputData(triangles);
  clustering->AutoAdjustNumberOfDivisionsOff();
  const auto count = [&](double s) { return std::max(2, static_cast<int>(std::lround(divisions * s / longest))); };
  clustering->SetNumberOfDivisions(count(size[0]), count(size[1]), count(size[2]));
  clustering->CopyCellDataOff();
  clustering->Update();
  vtkNew<vtkPolyDataNormals> normals;
  normals->SetInputData(clustering->GetOutput());
  normals->SplittingOff();
  normals->ConsistencyOff();
  normals->Update();
  return normals->GetOutput();
}

Image fromVtk(vtkImageData* rgb) {
  int size[3];
  rgb->GetDimensions(size);
  Image image(size[0], size[1], 3);
  for (int y = 0; y < size[1]; ++y) {
    for (int x = 0; x < size[0]; ++x) {
      const auto* pixel = static_cast<const unsigned char*>(rgb->GetScalarPointer(x, size[1] - 1 - y, 0));
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(pixel[c]) / 255.f;
    }
  }
  return image;
}

Image pictureOf(vtkRenderWindow* window) {
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(window);
  grab->SetInputBufferTypeToRGB();
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  grab->Update();
  return fromVtk(grab->GetOutput());
}

}  // namespace glint::viz
