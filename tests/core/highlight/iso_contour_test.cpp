// SPDX-License-Identifier: BSD-3-Clause
#include "core/highlight/iso_contour.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFlyingEdges2D.h>
#include <vtkIdList.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <utility>

namespace glint {
namespace {

Image imageOf(int width, int height, std::vector<float> values) {
  Image image(width, height, 1);
  image.data = std::move(values);
  return image;
}

using Segment = std::pair<Pixel, Pixel>;

/// What VTK's flying edges finds inside the image.
std::vector<Segment> segmentsOfVtk(const Image& image, double level) {
  vtkNew<vtkImageData> field;
  field->SetDimensions(image.width, image.height, 1);
  vtkNew<vtkDoubleArray> values;
  for (const float v : image.data) values->InsertNextValue(v);
  field->GetPointData()->SetScalars(values);
  vtkNew<vtkFlyingEdges2D> filter;
  filter->SetInputData(field);
  filter->SetValue(0, level);
  filter->ComputeScalarsOff();
  filter->Update();
  std::vector<Segment> segments;
  vtkPolyData* out = filter->GetOutput();
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < out->GetNumberOfCells(); ++i) {
    out->GetCellPoints(i, ids);
    double a[3], b[3];
    out->GetPoint(ids->GetId(0), a);
    out->GetPoint(ids->GetId(1), b);
    segments.push_back({Pixel(a[0], a[1]), Pixel(b[0], b[1])});
  }
  return segments;
}

// The oracle is another program's marching squares. White noise makes every kind of cell, a third of them saddles.
TEST(IsoContours, AreThoseOfVtksFlyingEdges) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> value(0, 1);
  constexpr double kSinglePx = 1e-5;  // VTK's points are single precision
  int saddles = 0, compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Image image(14, 11, 1);
    for (float& v : image.data) v = value(random);
    for (int y = 0; y + 1 < image.height; ++y)
      for (int x = 0; x + 1 < image.width; ++x) {
        const bool a = image.at(x, y) >= 0.5f, b = image.at(x + 1, y) >= 0.5f, c = image.at(x, y + 1) >= 0.5f,
                   d = image.at(x + 1, y + 1) >= 0.5f;
        saddles += a == d && b == c && a != b;
      }
    std::vector<Segment> own;
    for (const IsoContour& contour : isoContours(image, 0.5)) {
      const std::vector<Pixel>& p = contour.line.points;
      for (std::size_t i = 0; i < p.size(); ++i) {
        const Pixel &a = p[i], &b = p[(i + 1) % p.size()];
        // What runs along the border closes a contour that VTK leaves open.
        const auto alongEdge = [&](int axis, double edge) {
          return std::abs(a[axis] - edge) < 1e-3 && std::abs(b[axis] - edge) < 1e-3;
        };
        if (!alongEdge(0, 0) && !alongEdge(1, 0) && !alongEdge(0, image.width - 1) && !alongEdge(1, image.height - 1))
          own.push_back({a, b});
      }
    }
    const std::vector<Segment> vtk = segmentsOfVtk(image, 0.5);
    ASSERT_EQ(own.size(), vtk.size()) << trial;
    for (const auto& [a, b] : vtk) {
      const auto same = [&, a = a, b = b](const Segment& s) {
        return ((s.first - a).norm() < kSinglePx && (s.second - b).norm() < kSinglePx) ||
               ((s.first - b).norm() < kSinglePx && (s.second - a).norm() < kSinglePx);
      };
      EXPECT_EQ(std::count_if(own.begin(), own.end(), same), 1) << trial << ": " << a.transpose() << " to " << b.transpose();
      ++compared;
    }
  }
  EXPECT_GT(saddles, 500);
  EXPECT_GT(compared, 5000);
}

TEST(IsoContours, CrossingsLieWhereTheValuesSay) {
  const std::vector<IsoContour> found = isoContours(imageOf(3, 3, {0, 0, 0, 0, 1, 0, 0, 0, 0}), 0.25);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_FALSE(found[0].touchesBorder);
  EXPECT_THAT(found[0].line.points,
              testing::UnorderedElementsAre(Pixel(1, 0.25), Pixel(1.75, 1), Pixel(1, 1.75), Pixel(0.25, 1)));
  EXPECT_EQ(found[0].line.points.front(), Pixel(1, 0.25)) << "the first in the order of rows";
  EXPECT_NEAR(signedArea(found[0].line), 2 * 0.75 * 0.75, 1e-12);
}

TEST(IsoContours, OppositeCornersOfASaddleAreNotJoined) {
  const std::vector<IsoContour> found = isoContours(imageOf(4, 4, {0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}), 0.4);
  ASSERT_EQ(found.size(), 2u);
  for (const IsoContour& c : found) EXPECT_NEAR(signedArea(c.line), 2 * 0.6 * 0.6, 1e-6);  // single precision
}

TEST(IsoContours, HolesGoTheOtherWayRound) {
  Image image(7, 7, 1, 1.f);
  for (int i = 0; i < 7; ++i) image.at(i, 0) = image.at(i, 6) = image.at(0, i) = image.at(6, i) = 0;
  image.at(3, 3) = 0;
  const std::vector<IsoContour> found = isoContours(image, 0.5);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_GT(signedArea(found[0].line), 0);
  EXPECT_LT(signedArea(found[1].line), 0);
  EXPECT_GT(std::abs(signedArea(found[0].line)), std::abs(signedArea(found[1].line)));
}

TEST(IsoContours, TheBorderClosesWhatItCuts) {
  Image image(5, 4, 1, 0.f);
  for (int y = 0; y < 4; ++y) image.at(0, y) = image.at(1, y) = 1;
  const std::vector<IsoContour> found = isoContours(image, 0.5);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].touchesBorder);
  EXPECT_NEAR(signedArea(found[0].line), 1.5 * 3, 1e-6);
  EXPECT_NEAR(signedArea(isoContours(Image(5, 4, 1, 1.f), 0.5).front().line), 4 * 3, 1e-6) << "all of the image";
  EXPECT_TRUE(isoContours(Image(5, 4, 1, 0.f), 0.5).empty());
}

TEST(IsoContours, AValueAtTheLevelCounts) {
  const std::vector<IsoContour> found = isoContours(imageOf(4, 3, {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0}), 1);
  EXPECT_TRUE(found.empty()) << "it encloses nothing";
  EXPECT_EQ(isoContours(imageOf(4, 4, {0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0}), 1).size(), 1u);
  EXPECT_THROW(isoContours(imageOf(2, 1, {0, NAN}), 0.5), std::invalid_argument);
  EXPECT_THROW(isoContours(Image(2, 2, 1), NAN), std::invalid_argument);
}

}  // namespace
}  // namespace glint
