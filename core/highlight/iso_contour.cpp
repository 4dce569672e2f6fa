// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/iso_contour.h"

#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges2D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr double kBorderPx = 1e-3;  // VTK's points are single precision

/// The image with a frame of one pixel around it that is far below the level: an open contour then closes itself through
/// the centres of the border pixels, to 1e-7 px.
vtkNew<vtkImageData> paddedField(const Image& image, double level) {
  float lowest = image.data.front(), highest = lowest;
  for (const float v : image.data) {
    require(std::isfinite(v), "isoContours: values must be finite");
    lowest = std::min(lowest, v);
    highest = std::max(highest, v);
  }
  const double outside = level - 1e7 * (std::max<double>(highest, level) - std::min<double>(lowest, level) + 1e-300);
  const int w = image.width + 2, h = image.height + 2;
  vtkNew<vtkImageData> field;
  field->SetDimensions(w, h, 1);
  field->SetOrigin(-1, -1, 0);
  vtkNew<vtkDoubleArray> values;
  values->SetNumberOfTuples(static_cast<vtkIdType>(w) * h);
  double* out = values->GetPointer(0);
  std::fill(out, out + static_cast<std::size_t>(w) * h, outside);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) out[static_cast<std::size_t>(y + 1) * w + x + 1] = image.at(x, y);
  field->GetPointData()->SetScalars(values);
  return field;
}

/// Segments (pairs of point ids) to closed chains of point ids, whatever the direction of each segment.
std::vector<std::vector<vtkIdType>> chains(vtkPolyData& lines) {
  const std::size_t n = static_cast<std::size_t>(lines.GetNumberOfPoints());
  std::vector<std::array<vtkIdType, 2>> neighbours(n, {-1, -1});
  const auto link = [&](vtkIdType from, vtkIdType to) {
    std::array<vtkIdType, 2>& slots = neighbours[static_cast<std::size_t>(from)];
    if (slots[0] < 0)
      slots[0] = to;
    else
      slots[1] = to;
  };
  vtkCellArray* cells = lines.GetLines();
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  for (cells->InitTraversal(); cells->GetNextCell(count, ids);)
    if (count == 2) {
      link(ids[0], ids[1]);
      link(ids[1], ids[0]);
    }
  std::vector<std::vector<vtkIdType>> result;
  std::vector<char> seen(n, 0);
  for (std::size_t start = 0; start < n; ++start) {
    if (seen[start] || neighbours[start][1] < 0) continue;
    std::vector<vtkIdType> chain;
    vtkIdType at = static_cast<vtkIdType>(start);
    while (at >= 0) {
      seen[static_cast<std::size_t>(at)] = 1;
      chain.push_back(at);
      const std::array<vtkIdType, 2>& slots = neighbours[static_cast<std::size_t>(at)];
      at = -1;
      for (const vtkIdType next : slots)
        if (next >= 0 && !seen[static_cast<std::size_t>(next)]) at = next;
    }
    // The frame of low values leaves no open end, so the walk ended where it began.
    result.push_back(std::move(chain));
  }
  return result;
}

/// True for the outer boundary of a region: the pixel above the level beside a vertex lies inside.
bool isOuter(const Image& image, const Polyline& line, double level) {
  for (const Pixel& p : line.points) {
    const bool onRow = std::abs(p.y() - std::round(p.y())) < std::abs(p.x() - std::round(p.x()));
    const int x0 = static_cast<int>(onRow ? std::floor(p.x()) : std::lround(p.x())),
              y0 = static_cast<int>(onRow ? std::lround(p.y()) : std::floor(p.y()));
    const int x1 = onRow ? x0 + 1 : x0, y1 = onRow ? y0 : y0 + 1;
    if (x0 < 0 || y0 < 0 || x1 >= image.width || y1 >= image.height) continue;
    const bool first = image.at(x0, y0) >= level, second = image.at(x1, y1) >= level;
    if (first != second) return contains(line, first ? Pixel(x0, y0) : Pixel(x1, y1));
  }
  return true;  // it runs along the image border all the way
}

}  // namespace

std::vector<IsoContour> isoContours(const Image& image, double level) {
  require(image.channels == 1 && !image.empty(), "isoContours: one channel, not empty");
  require(std::isfinite(level), "isoContours: level must be finite");
  vtkNew<vtkImageData> field = paddedField(image, level);
  vtkNew<vtkFlyingEdges2D> filter;
  filter->SetInputData(field);
  filter->SetValue(0, level);
  filter->ComputeScalarsOff();
  filter->Update();
  vtkPolyData* lines = filter->GetOutput();

  std::vector<IsoContour> contours;
  for (const std::vector<vtkIdType>& chain : chains(*lines)) {
    IsoContour contour;
    contour.line.points.reserve(chain.size());
    for (const vtkIdType id : chain) {
      std::array<double, 3> p{};
      lines->GetPoint(id, p.data());
      const Pixel raw(p[0], p[1]);
      const Pixel inside(std::clamp(raw.x(), 0.0, image.width - 1.0), std::clamp(raw.y(), 0.0, image.height - 1.0));
      contour.touchesBorder = contour.touchesBorder || inside.x() < kBorderPx || inside.y() < kBorderPx ||
                              inside.x() > image.width - 1 - kBorderPx || inside.y() > image.height - 1 - kBorderPx;
      contour.line.points.push_back(inside);
    }
    contour.line = withoutRepeats(contour.line);
    if (contour.line.points.size() < 3) continue;
    if (isOuter(image, contour.line, level) != (signedArea(contour.line) > 0))
      std::reverse(contour.line.points.begin(), contour.line.points.end());
    contours.push_back(std::move(contour));
  }
  std::stable_sort(contours.begin(), contours.end(), [](const IsoContour& a, const IsoContour& b) {
    return std::abs(signedArea(a.line)) > std::abs(signedArea(b.line));
  });
  return contours;
}

}  // namespace glint
