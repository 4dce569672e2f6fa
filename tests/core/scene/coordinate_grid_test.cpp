// SPDX-License-Identifier: BSD-3-Clause

#include <gmock/gmock.h>

#include <cmath>
#include <iomanip>
#include <numbers>
#include <random>
#include <sstream>

#include "core/scene/convention_report.h"
#include "core/scene/scene_reader.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using testing::HasSubstr;

/// A globe of 24 by 12 fields.
std::vector<Vector3d> globe(const Vector3d& centre) {
  std::vector<Vector3d> v;
  for (int i = 1; i < 12; ++i)
    for (int k = 0; k < 24; ++k) {
      const double a = i * std::numbers::pi / 12, b = k * std::numbers::pi / 12 + 0.1;
      v.push_back(centre + 0.4 * Vector3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
    }
  return v;
}
std::vector<Vector3d> asFloats(std::vector<Vector3d> v) {
  for (Vector3d& p : v) p = p.cast<float>().cast<double>();
  return v;
}
std::vector<Vector3d> rounded(std::vector<Vector3d> v, double step) {
  for (Vector3d& p : v) p = (p / step).array().round() * step;
  return v;
}

TEST(CoordinateGrid, DoublesLieOnNone) {
  for (const double far : {0.0, 1e3, 1e6}) EXPECT_FALSE(coordinateGrid(globe({far, 2 * far, -far}))) << far;
}

TEST(CoordinateGrid, FloatsLieOnTheirs) {
  // 2^-23 of the power of two below: 512 <= 1000 < 1024.
  const std::optional<CoordinateGrid> grid = coordinateGrid(asFloats(globe({1000, 0, 0})));
  ASSERT_TRUE(grid);
  EXPECT_TRUE(grid->singlePrecision);
  EXPECT_EQ(grid->spacing, std::ldexp(1.0, 9 - 23));
}

TEST(CoordinateGrid, TextsOfFewDigitsLieOnTheirs) {
  const std::optional<CoordinateGrid> grid = coordinateGrid(rounded(globe({1000, 0, 0}), 1e-3));
  ASSERT_TRUE(grid);
  EXPECT_FALSE(grid->singlePrecision);
  EXPECT_DOUBLE_EQ(grid->spacing, 1e-3);
}

/// Round coordinates of a shape are no loss: quarters of a metre, and a plane at a height that is a float.
TEST(CoordinateGrid, RoundShapesUseNoGrid) {
  std::vector<Vector3d> boxes;
  for (int i = 0; i < 64; ++i) boxes.push_back(Vector3d(1000 + 0.25 * (i % 4), 0.25 * (i / 4 % 4), double(1000.1f)));
  const std::optional<CoordinateGrid> grid = coordinateGrid(boxes);
  EXPECT_TRUE(!grid || !grid->singlePrecision);
  EXPECT_FALSE(coordinateGrid({{0.1, 0.2, 0.3}}));
}

/// A scene with one camera at 2 m from the globe, written to a file as `info` reads it.
std::vector<std::string> findingsOf(const std::vector<Vector3d>& vertices, const Vector3d& centre) {
  const TemporaryFolder folder;
  std::ostringstream obj;
  obj << std::setprecision(17);
  for (const Vector3d& v : vertices) obj << "v " << v.x() << " " << v.y() << " " << v.z() << "\n";
  for (int i = 0; i < 10; ++i)
    for (int k = 0; k < 24; ++k) {
      const int a = 24 * i + k + 1, b = 24 * i + (k + 1) % 24 + 1;
      obj << "f " << a << " " << a + 24 << " " << b + 24 << " " << b << "\n";
    }
  folder.write("globe.obj", obj.str());
  std::ostringstream pose;
  pose << std::setprecision(17) << "[1,0,0," << -centre.x() << "],[0,1,0," << -centre.y() << "],[0,0,1," << 2 - centre.z()
       << "],";
  const std::string text = with(with(minimalScene(), "[1,0,0,0],[0,1,0,0],[0,0,1,2],", pose.str()),
                                R"("analytic": {"type": "sphere", "radius": 0.4})", R"("mesh": "globe.obj")");
  return conventionReport(readScene(folder.write("scene.json", text))).findings;
}

TEST(CoordinateGrid, InfoTellsWhereItIsTooCoarse) {
  const auto coarse = [](const std::vector<std::string>& findings) {
    return std::count_if(findings.begin(), findings.end(),
                         [](const std::string& f) { return f.find("too coarse") != std::string::npos; });
  };
  const Vector3d far(100000, 0, 0);
  const std::vector<std::string> found = findingsOf(asFloats(globe(far)), far);
  ASSERT_EQ(coarse(found), 1);
  EXPECT_THAT(found, testing::Contains(HasSubstr("floats resolve steps of 7.8 mm")));  // 2^(16 - 23) m
  EXPECT_EQ(coarse(findingsOf(rounded(globe(far), 1e-2), far)), 1);
  EXPECT_EQ(coarse(findingsOf(globe(far), far)), 0);
  EXPECT_EQ(coarse(findingsOf(asFloats(globe({3, 0, 0})), {3, 0, 0})), 0);
  EXPECT_EQ(coarse(findingsOf(rounded(globe({0, 0, 0}), 1e-2), {0, 0, 0})), 0);  // near the origin round numbers may be meant
}

}  // namespace
}  // namespace glint
