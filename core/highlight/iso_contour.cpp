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
  // 1e7 times the range: the crossing then lies 1e-7 px from the border pixel's centre; + 1e-300 for an image of one value.
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

/// Segments (pairs of point ids) to closed chains of point ids. Every point lies on an edge of the grid, between two cells, and has one
/// segment in each. VTK directs the segments round their region, but not those of a cell with a saddle, which noise makes: a chain follows
/// neighbours, and goes in the direction of most of its segments.
std::vector<std::vector<vtkIdType>> chains(vtkPolyData& lines) {
  const std::size_t n = static_cast<std::size_t>(lines.GetNumberOfPoints());
  struct Ends {
    std::array<vtkIdType, 2> other{-1, -1};
    std::array<bool, 2> starts{};  ///< the segment is directed away from this point
    int count = 0;
  };
  std::vector<Ends> points(n);
  const auto add = [&](vtkIdType at, vtkIdType other, bool starts) {
    Ends& e = points[static_cast<std::size_t>(at)];
    if (e.count == 2) return;
    e.other[static_cast<std::size_t>(e.count)] = other;
    e.starts[static_cast<std::size_t>(e.count++)] = starts;
  };
  vtkCellArray* cells = lines.GetLines();
  vtkIdType count = 0;
  const vtkIdType* ids = nullptr;
  for (cells->InitTraversal(); cells->GetNextCell(count, ids);) {
    if (count != 2 || ids[0] == ids[1]) continue;
    add(ids[0], ids[1], true);
    add(ids[1], ids[0], false);
  }
  std::vector<std::vector<vtkIdType>> result;
  std::vector<char> seen(n, 0);
  for (std::size_t start = 0; start < n; ++start) {
    if (seen[start] || points[start].count < 2) continue;
    std::vector<vtkIdType> chain;
    vtkIdType at = static_cast<vtkIdType>(start), from = -1;
    int forward = 0;
    bool closed = false;
    while (at >= 0 && !seen[static_cast<std::size_t>(at)]) {
      const Ends& e = points[static_cast<std::size_t>(at)];
      if (e.count < 2) break;
      seen[static_cast<std::size_t>(at)] = 1;
      chain.push_back(at);
      const std::size_t on = e.other[0] == from ? 1 : 0;  // two segments to the same neighbour: the second time the other one is equal
      forward += e.starts[on] ? 1 : -1;
      from = at;
      at = e.other[on];
      closed = at == static_cast<vtkIdType>(start);
    }
    if (!closed) continue;
    if (forward < 0) std::reverse(chain.begin() + 1, chain.end());
    result.push_back(std::move(chain));
  }
  return result;
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
    contours.push_back(std::move(contour));
  }
  std::stable_sort(contours.begin(), contours.end(), [](const IsoContour& a, const IsoContour& b) {
    return std::abs(signedArea(a.line)) > std::abs(signedArea(b.line));
  });
  return contours;
}

}  // namespace glint
