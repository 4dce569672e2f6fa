// SPDX-License-Identifier: BSD-3-Clause
#include "io/mesh_reader.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <set>

#include "core/base/number_text.h"
#include "tests/core/scene/scene_fixture.h"
#include "tests/io/mesh_texts.h"

namespace glint {
namespace {
using namespace testing_support;
using Eigen::Vector3d;
using Eigen::Vector3i;
using testing::ElementsAre;
using testing::HasSubstr;

MeshContent parsed(const std::string& bytes, const char* name = "m") {
  MeshContent mesh = parseMesh(bytes, name);
  EXPECT_EQ(brokenPromise(mesh), "");
  return mesh;
}

void expectSquare(const MeshContent& mesh, const std::string& what) {
  ASSERT_EQ(mesh.vertices.size(), 4u) << what;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(mesh.vertices[std::size_t(i)], Vector3d(kSquare[i])) << what;
  EXPECT_THAT(mesh.triangles, ElementsAre(Vector3i(0, 1, 2), Vector3i(0, 2, 3))) << what;
}

TEST(MeshReader, EveryFormatGivesTheSameSquare) {
  for (const auto& [name, bytes] : {std::pair<std::string, std::string>{"ply text", plyText()},
                                    {"ply text, normals, polygon", plyTextWithNormals()},
                                    {"float, little", plyBinary<float>("float", false)},
                                    {"float, big", plyBinary<float>("float32", true)},
                                    {"double, little", plyBinary<double>("double", false)},
                                    {"double, big", plyBinary<double>("float64", true)},
                                    {"stl text", stlText()},
                                    {"stl binary", stlBinary()},
                                    {"obj", objText()},
                                    {"gltf", gltfText()},
                                    {"glb", glb()}})
    expectSquare(parsed(bytes), name);
}

TEST(MeshReader, EveryScalarTypeOfPlyInBothByteOrders) {
  for (const bool big : {false, true}) {
    expectSquare(parsed(plyBinary<std::int8_t>("char", big)), "char");
    expectSquare(parsed(plyBinary<std::uint8_t>("uint8", big)), "uint8");
    expectSquare(parsed(plyBinary<std::int16_t>("short", big)), "short");
    expectSquare(parsed(plyBinary<std::uint16_t>("uint16", big)), "uint16");
    expectSquare(parsed(plyBinary<std::int32_t>("int32", big)), "int32");
    expectSquare(parsed(plyBinary<std::uint32_t>("uint", big)), "uint");
  }
  const double negative[4][3] = {{-1, -100, 0}, {1, 0, 0}, {1, 1, -128}, {0, 127, 0}};
  EXPECT_EQ(parsed(plyBinary<std::int8_t>("int8", true, negative)).vertices[2], Vector3d(1, 1, -128));
  EXPECT_EQ(parsed(plyBinary<std::int16_t>("int16", true, negative)).vertices[0], Vector3d(-1, -100, 0));
}

/// A million metres away, single precision keeps 6 cm. The expected values are the literals of this page.
TEST(MeshReader, CoordinatesKeepEveryDigitOfTheFile) {
  const double far[4][3] = {{1000000.1234567, 0.1, -2e-9}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const bool big : {false, true}) EXPECT_EQ(parsed(plyBinary<double>("double", big, far)).vertices[0], Vector3d(far[0]));
  const std::string written = "1000000.1234567 0.1 -2e-9";
  EXPECT_EQ(parsed(with(plyText(), "\n0 0 0\n", "\n" + written + "\n")).vertices[0], Vector3d(far[0]));
  EXPECT_EQ(parsed(with(objText(), "v 0 0 0", "v " + written)).vertices[0], Vector3d(far[0]));
  EXPECT_EQ(parsed(with(stlText(), "vertex 0 0 0", "vertex " + written)).vertices[0], Vector3d(far[0]));
}

TEST(MeshReader, NumbersOfAllKinds) {
  const auto x = [](const std::string& number) {
    return parsed(with(objText(), "v 1 0 0", "v " + number + " 0 0")).vertices[1].x();
  };
  EXPECT_EQ(x("+1.5"), 1.5);
  EXPECT_EQ(x("-.5e+3"), -500);
  EXPECT_EQ(x("1e-400"), 0);  // too small for a double
  EXPECT_EQ(x("0." + std::string(400, '0') + "1"), 0);
  EXPECT_EQ(x("1" + std::string(20, '0') + "." + std::string(5000, '1')), 1e20);
}

/// Files from programs with other ideas of a line.
TEST(MeshReader, LineBreaksOfEveryKind) {
  const auto withBreaks = [](std::string text, const std::string& lineBreak) {
    std::string out;
    for (const char c : text) out += c == '\n' ? lineBreak : std::string(1, c);
    return out;
  };
  for (const char* lineBreak : {"\r\n", "\r"})
    for (const std::string& text : {plyText(), stlText(), objText()})
      expectSquare(parsed(withBreaks(text, lineBreak)), text.substr(0, 8));
  const std::string head = plyHead("binary_little_endian", "float");
  expectSquare(parsed(withBreaks(head, "\r\n") + plyBinary<float>("float", false).substr(head.size())), "binary");
  expectSquare(parsed(with(objText(), "f 1/1/1 2", "f 1/1/1 \\\n 2")), "continued line");
  expectSquare(parsed(plyText() + "\n \n"), "empty lines at the end");
}

TEST(MeshReader, FurtherElementsAndPropertiesAreSkipped) {
  const std::string head =
      "ply\nformat binary_big_endian 1.0\nobj_info any\nelement camera 2\nproperty list ushort double weights\nproperty char c\n"
      "element face 1\nproperty float quality\nproperty list int short vertex_index\nproperty list uchar float uv\n"
      "element vertex 3\nproperty list uchar uchar tags\nproperty double z\nproperty ushort w\nproperty double y\nproperty "
      "double x\n"
      "element edge 1\nproperty int vertex1\nend_header\n";
  std::string bytes = head;
  for (const int weights : {2, 0}) {
    put(bytes, std::uint16_t(weights), true);
    for (int i = 0; i < weights; ++i) put(bytes, 7.5, true);
    put(bytes, std::int8_t(-3), true);
  }
  put(bytes, 0.5f, true);
  put(bytes, std::int32_t(3), true);
  for (const int i : {2, 0, 1}) put(bytes, std::int16_t(i), true);
  put(bytes, std::uint8_t(1), true);
  put(bytes, 0.25f, true);
  for (int i = 0; i < 3; ++i) {
    put(bytes, std::uint8_t(i), true);
    for (int k = 0; k < i; ++k) put(bytes, std::uint8_t(255), true);
    put(bytes, 0.5 * i, true);
    put(bytes, std::uint16_t(9), true);
    put(bytes, 2.0 * i * i, true);
    put(bytes, -1.0 * i, true);
  }
  put(bytes, std::int32_t(1), true);
  const MeshContent mesh = parsed(bytes);
  EXPECT_THAT(mesh.triangles, ElementsAre(Vector3i(2, 0, 1)));  // faces may come first
  EXPECT_THAT(mesh.vertices, ElementsAre(Vector3d(0, 0, 0), Vector3d(-1, 2, 0.5), Vector3d(-2, 8, 1)));
}

TEST(MeshReader, LegalButUnusualPly) {
  // From the collection of inputs that broke the program: indices as doubles, 5000 properties, a long comment.
  std::string bytes = plyHead("binary_little_endian", "float", "uchar double");
  for (const auto& corner : kSquare)
    for (const double v : corner) put(bytes, static_cast<float>(v));
  for (const auto& t : {std::vector<double>{0, 1, 2}, std::vector<double>{0, 2, 3}}) {
    put(bytes, std::uint8_t(3));
    for (const double i : t) put(bytes, i);
  }
  expectSquare(parsed(bytes), "double indices");
  std::string many = "property float x\n", values;
  for (int i = 0; i < 5000; ++i) {
    many += "property float p" + std::to_string(i) + "\n";
    values += " 7";
  }
  std::string text = with(plyText(), "property float x\n", "property float y\nproperty float z\n" + many);
  text = with(text, "property float x\nproperty float p0", "property float x\nproperty float p0");
  text = with(text, "property float p4999\nproperty float y\nproperty float z\n", "property float p4999\n");
  for (const auto& corner : kSquare) {
    const std::string numbers = std::to_string(int(corner[0])) + " " + std::to_string(int(corner[1])) + " 0\n";
    text = with(text, "\n" + numbers,
                "\n" + std::to_string(int(corner[1])) + " 0 " + std::to_string(int(corner[0])) + values + "\n");
  }
  expectSquare(parsed(text), "5000 properties");
  expectSquare(parsed(with(plyText(), "by hand", std::string(100000, 'a'))), "long comment");
}

TEST(MeshReader, NormalsOfPlyAreTakenAndNormalised) {
  const MeshContent mesh = parsed(plyTextWithNormals());
  ASSERT_EQ(mesh.normals.size(), 4u);
  for (const Vector3d& n : mesh.normals) EXPECT_EQ(n, Vector3d(0, 0, 1));
  // One that is missing costs its vertex, and no other.
  for (const char* bad : {"0 0 0", "nan 0 1", "inf 0 0"}) {
    const MeshContent one = parsed(with(plyTextWithNormals(), "1 1 0 0 0 1 0", std::string("1 1 0 ") + bad + " 0"));
    ASSERT_EQ(one.normals.size(), 4u) << bad;
    int zero = 0;
    for (const Vector3d& n : one.normals) zero += n == Vector3d(0, 0, 0);
    EXPECT_EQ(zero, 1) << bad;
    const std::string lonely =
        with(with(plyTextWithNormals(), "vertex 4", "vertex 5"), "\n4 0 1 2 3", "\n5 5 5 " + std::string(bad) + " 0\n4 0 1 2 3");
    EXPECT_EQ(parsed(lonely).normals.size(), 5u) << bad;
  }
  EXPECT_TRUE(parsed(with(plyTextWithNormals(), "float nz", "float nq")).normals.empty());
}

TEST(MeshReader, PolygonsBecomeFans) {
  const MeshContent mesh = parsed("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf 3 4 5 1 2\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Vector3i(2, 3, 4), Vector3i(2, 4, 0), Vector3i(2, 0, 1)));
}

/// Twice the signed area of a triangle of a flat mesh, seen from above.
double areaFromAbove(const MeshContent& mesh, const Vector3i& t) {
  const auto at = [&](int k) -> const Vector3d& { return mesh.vertices[std::size_t(t[k])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).z();
}

/// How often triangles of a flat mesh cover a place.
int coversOf(const MeshContent& mesh, const Vector3d& place) {
  int covers = 0;
  for (const Vector3i& t : mesh.triangles) {
    bool inside = true;
    for (int k = 0; k < 3; ++k) {
      const Vector3d &a = mesh.vertices[std::size_t(t[k])], &b = mesh.vertices[std::size_t(t[(k + 1) % 3])];
      inside = inside && (b - a).cross(place - a).z() > 0;
    }
    covers += inside;
  }
  return covers;
}

/// Whether a polygon surrounds a place, by the crossings of its outline with a line to the right.
bool surrounds(const std::vector<std::array<double, 2>>& outline, const Vector3d& place) {
  bool inside = false;
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const auto &a = outline[i], &b = outline[j];
    if ((a[1] > place.y()) != (b[1] > place.y()) && place.x() < (b[0] - a[0]) * (place.y() - a[1]) / (b[1] - a[1]) + a[0])
      inside = !inside;
  }
  return inside;
}

TEST(MeshReader, ConcavePolygonsAreCutInsideThemselves) {
  using Outline = std::vector<std::array<double, 2>>;
  Outline star, spiral;
  for (int i = 0; i < 20; ++i)
    star.push_back({(i % 2 ? 1 : 2.5) * std::cos(i * 0.1 * M_PI), (i % 2 ? 1 : 2.5) * std::sin(i * 0.1 * M_PI)});
  for (int i = 0; i <= 30; ++i) spiral.push_back({(1 + 0.05 * i) * std::cos(0.3 * i), (1 + 0.05 * i) * std::sin(0.3 * i)});
  for (int i = 30; i >= 0; --i) spiral.push_back({(0.9 + 0.05 * i) * std::cos(0.3 * i), (0.9 + 0.05 * i) * std::sin(0.3 * i)});
  const std::vector<Outline> outlines = {
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},                                  // an L
      {{0, 0}, {2, -1}, {0.5, 0}, {2, 1}},                                               // an arrow
      {{0, 0}, {3, 0}, {3, 3}, {0, 3}, {0, 0}, {1, 1}, {1, 2}, {2, 2}, {2, 1}, {1, 1}},  // a hole
      star,
      spiral};
  for (const Outline& outline : outlines)
    for (std::size_t first = 0; first < outline.size(); ++first)
      for (const bool ply : {false, true}) {
        std::string points, face;
        for (std::size_t i = 0; i < outline.size(); ++i) {
          const auto& p = outline[(first + i) % outline.size()];
          points += (ply ? "" : "v ") + shortestText(p[0]) + " " + shortestText(p[1]) + " 0\n";
          face += " " + std::to_string(ply ? i : i + 1);
        }
        const std::string n = std::to_string(outline.size());
        const MeshContent mesh = ply ? parsed("ply\nformat ascii 1.0\nelement vertex " + n +
                                              "\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty "
                                              "list uchar int vertex_indices\nend_header\n" +
                                              points + n + face + "\n")
                                     : parsed("f" + face + "\n" + points);
        ASSERT_EQ(mesh.triangles.size(), outline.size() - 2);
        for (const Vector3i& t : mesh.triangles) EXPECT_GE(areaFromAbove(mesh, t), -1e-9);
        for (double x = -2.963; x < 3; x += 0.31)
          for (double y = -2.957; y < 3; y += 0.31)
            EXPECT_EQ(coversOf(mesh, {x, y, 0}), int(surrounds(outline, {x, y, 0})))
                << n << " corners from " << first << ", " << x << " " << y;
      }
}

TEST(MeshReader, CornersKeepTheirNormalsWhenAPolygonIsCut) {
  std::string text = "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\n";
  for (int i = 1; i <= 6; ++i) text += "vn 0 " + std::to_string(i) + " 1\n";
  const MeshContent mesh = parsed(text + "f 1//1 2//2 3//3 4//4 5//5 6//6\n");
  ASSERT_EQ(mesh.normals.size(), 6u);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(mesh.normals[std::size_t(i)], Vector3d(0, i + 1, 1).normalized());
}

TEST(MeshReader, PolygonsWithoutAreaAndCrossingOutlinesKeepAllTheirCorners) {
  for (const char* points : {"v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 4 0 0\n", "v 1 1 1\nv 1 1 1\nv 1 1 1\nv 1 1 1\nv 1 1 1\n",
                             "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv -1 -3 0\n"}) {
    const MeshContent mesh = parsed(std::string(points) + "f 1 2 3 4 5\n");
    std::set<int> used;
    for (const Vector3i& t : mesh.triangles) used.insert(t.begin(), t.end());
    EXPECT_EQ(mesh.triangles.size(), 3u);
    EXPECT_EQ(used.size(), 5u) << points;
  }
}

/// Without a bound on its steps the reader would not come back within the time that a test may take.
TEST(MeshReader, HugeConcavePolygonsAreRefused) {
  // A comb of 150,000 teeth, whose tips come so that hardly a corner is an ear.
  std::string points, face = "f";
  const int teeth = 150000;
  for (int i = 0; i < teeth; ++i) {
    const double angle = 2 * M_PI * i / teeth, radius = i % 2 ? 1 : 1.0001 + 0.5 * (i % 7);
    points += "v " + shortestText(radius * std::cos(angle)) + " " + shortestText(radius * std::sin(angle)) + " 0\n";
    face += " " + std::to_string(i + 1);
  }
  try {
    parsed(points + face + "\n");
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("cut the mesh into triangles"));
  }
}

TEST(MeshReader, VerticesThatNoFaceUsesMayBeNaN) {
  for (const char* bad : {"nan nan nan", "1 inf 0", "1e31 0 0"}) {
    const std::string ply = with(with(plyTextWithNormals(), "vertex 4", "vertex 5"), "end_header\n",
                                 std::string("end_header\n") + bad + " 0 0 1 255\n");
    // The vertices move on by one: so do the numbers of the face.
    const MeshContent mesh = parsed(with(ply, "\n4 0 1 2 3", "\n4 1 2 3 4"));
    EXPECT_EQ(mesh.vertices.size(), 4u);
    expectSquare(mesh, bad);
    const MeshContent obj = parsed(std::string("v ") + bad + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 2//1 3//1 4//1\n");
    EXPECT_THAT(obj.triangles, ElementsAre(Vector3i(0, 1, 2)));
    EXPECT_EQ(obj.normals.size(), 3u);
    try {
      parsed(std::string("v 0 0 0\nv 1 0 0\nv ") + bad + "\nf 1 2 3\n");
      ADD_FAILURE() << bad;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("line 3, vertex 2: is "));
    }
  }
}

TEST(MeshReader, TriangleStripsOfPly) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement tristrips "
      "1\nproperty list int int "
      "vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";
  // Each strip begins with the winding of its first triangle; corners that stand twice make no triangle.
  const MeshContent mesh = parsed(head + "10 0 1 2 3 -1 2 3 4 4 5\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Vector3i(0, 1, 2), Vector3i(2, 1, 3), Vector3i(2, 3, 4)));
  const MeshContent whole = parsed(head + "6 0 1 2 3 4 5\n");
  ASSERT_EQ(whole.triangles.size(), 4u);
  for (const Vector3i& t : whole.triangles) EXPECT_GT(areaFromAbove(whole, t), 0);
  EXPECT_THROW(parsed(head + "3 0 1 6\n"), InputError);
  EXPECT_THROW(parsed(head + "3 0 1 -2\n"), InputError);
  EXPECT_THROW(parsed(head + "4 0 -1 1 2\n"), InputError);  // no triangle
}

TEST(MeshReader, TextStlBeginsWithBlanksOrCapitals) {
  std::string capitals = stlText();
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), [](unsigned char c) { return std::toupper(c); });
  for (const std::string& text :
       {" " + stlText(), "\n\r\n\t " + stlText(), capitals, "  " + capitals, "\xef\xbb\xbf" + stlText()})
    expectSquare(parsed(text), text.substr(0, 20).c_str());
}

TEST(MeshReader, NormalsOfObj) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 2\nvn 1 0 0\nvn 0 0 2\n";
  // The same normal under two numbers is one; a crease doubles the vertices on it.
  const MeshContent smooth = parsed(points + "f 1//1 2//1 3//1\nf 1//3 2//3 4//3\n");
  EXPECT_EQ(smooth.vertices.size(), 4u);
  ASSERT_EQ(smooth.normals.size(), 4u);
  EXPECT_EQ(smooth.normals[3], Vector3d(0, 0, 1));
  const MeshContent crease = parsed(points + "f 1//1 2//1 3//1\nf 1//2 3//2 4//2\nf 3//-2 1//2 2//2\n");
  ASSERT_EQ(crease.vertices.size(), 7u);
  EXPECT_THAT(crease.triangles, ElementsAre(Vector3i(0, 1, 2), Vector3i(4, 5, 3), Vector3i(5, 4, 6)));
  EXPECT_EQ(crease.vertices[4], crease.vertices[0]);
  EXPECT_EQ(crease.normals[4], Vector3d(1, 0, 0));
  // A corner without a normal costs its vertex, and no other; it may have one elsewhere.
  const MeshContent half = parsed(points + "f 1//1 2//1 3\nf 2 1 4//2\n");
  ASSERT_EQ(half.normals.size(), 4u);
  EXPECT_EQ(half.normals[1], Vector3d(0, 0, 1));
  EXPECT_EQ(half.normals[2], Vector3d(0, 0, 0));
  EXPECT_EQ(half.normals[3], Vector3d(1, 0, 0));
  EXPECT_TRUE(parsed(points + "f 1 2 3\n").normals.empty());
  // A face may name what comes later in the file.
  EXPECT_EQ(parsed("f 1//1 2//1 3//1\n" + points).triangles.size(), 1u);
}

TEST(MeshReader, AFacetOfStlWithoutAPlaceIsLeftOut) {
  const std::string text = stlText();
  EXPECT_EQ(parsed(text).leftOut, 0u);
  const std::size_t corner = 84 + 12, facet = 50;  // bytes before the first corner, and of a facet
  for (const float bad : {std::nanf(""), std::numeric_limits<float>::infinity(), 3e38f}) {
    std::string binary = stlBinary();
    std::memcpy(binary.data() + corner + 4, &bad, sizeof bad);  // y of the first corner
    const MeshContent second = parsed(binary, "a.stl");
    EXPECT_THAT(second.vertices, ElementsAre(Vector3d(0, 0, 0), Vector3d(1, 1, 0), Vector3d(0, 1, 0)));
    EXPECT_THAT(second.triangles, ElementsAre(Vector3i(0, 1, 2)));
    EXPECT_EQ(second.leftOut, 1u);
    std::memcpy(binary.data() + corner + facet, &bad, sizeof bad);
    EXPECT_THAT(inputErrorOf([&] { parseMesh(binary, "a.stl"); }), HasSubstr("byte 84, facet 0: a vertex is"));
  }
  for (const char* bad : {"nan", "-nan(ind)", "inf", "1e31"}) {
    const std::string once = with(text, "vertex 1 0 0", std::string("vertex 1 0 ") + bad);
    EXPECT_THAT(parsed(once).vertices, ElementsAre(Vector3d(0, 0, 0), Vector3d(1, 1, 0), Vector3d(0, 1, 0))) << bad;
    EXPECT_EQ(parsed(once).leftOut, 1u) << bad;
    EXPECT_THAT(inputErrorOf([&] { parseMesh(with(once, "vertex 0 1 0", std::string("vertex 0 1 ") + bad), "m"); }),
                HasSubstr("line 6: a vertex is"));
  }
}

TEST(MeshReader, EqualCornersOfStlAreOneVertex) {
  EXPECT_EQ(parsed(with(stlText(), "vertex 0 0 0\n   vertex 1 1 0", "vertex -0 0 -0.0\n   vertex 1 1 0")).vertices.size(), 4u);
  EXPECT_EQ(parsed(stlText() + stlText()).triangles.size(), 4u);  // two solids in a file
  std::string solid = stlBinary();
  solid.replace(0, 5, "solid");  // some programs write that into the comment
  expectSquare(parsed(solid), "binary that begins as text does");
  expectSquare(parsed(stlBinary() + std::string(3, '\0'), "a.STL"), "padded");
}

/// What is wrong, and where.
TEST(MeshReader, DamageIsNamedWithItsPlace) {
  struct Case {
    std::string bytes, expected;
    const char* name = "m";
  };
  const std::string ply = plyText(), binary = plyBinary<float>("float", false), obj = objText(), stl = stlText();
  const std::size_t head = plyHead("binary_little_endian", "float").size();
  std::string manyElements;
  for (int i = 0; i < 60000; ++i) manyElements += "element a 0\n";
  std::string wrongIndex = binary, wrongCount = binary, nan = binary;
  wrongIndex[head + 48 + 13 + 1] = 9;
  wrongCount[head + 48] = 2;
  for (int i = 0; i < 4; ++i) nan[head + 12 + std::size_t(i)] = '\xff';
  const std::string at = std::to_string(head + 48), second = std::to_string(head + 61), nanAt = std::to_string(head + 12);
  const Case cases[] = {
      {"", "m: the file is empty"},
      {with(ply, "3 0 2 3", "3 0 2 9"), "m: line 16, face 1: names vertex 9; the file has 4"},
      {with(ply, "3 0 2 3", "3 0 2 -1"), "line 16, face 1: names vertex -1"},
      {with(ply, "3 0 2 3", "3 0 2 1.5"), "line 16, face 1: names vertex 1.5"},
      {with(ply, "3 0 2 3", "3 0 2 nan"), "face 1: names vertex nan"},
      {with(ply, "3 0 2 3", "-3 0 2 3"), "face 1: a list has -3 entries"},
      {with(ply, "3 0 2 3", "1e300 0 2 3"), "face 1: a list has 1e+300 entries"},
      {with(ply, "3 0 2 3", "4000000 0 2 3"), "line 16, face 1: the PLY is truncated"},
      {with(ply, "3 0 2 3", "2 0 2"), "face 1: has 2 corners; a face needs three"},
      {with(ply, "3 0 2 3", "3 0 2 3 1"), "face 1: has more values"},
      {ply + "3 0 1 2\n", "line 17: unexpected data after the last element"},
      {with(ply, "1 1 0", "1 nan 0"), "line 13, vertex 2: is not finite"},
      {with(ply, "1 1 0", "1 1e999 0"), "vertex 2: is not finite"},
      {with(ply, "1 1 0", "1 1e31 0"), "vertex 2: is farther than 1e30"},
      {with(ply, "1 1 0", "1 x\x1b 0"), "vertex 2: 'x?' is not a number"},
      {with(ply, "1 1 0", "1 1,5 0"), "vertex 2: '1,5' is not a number"},
      {with(ply, "1 1 0", "1 +-1 0"), "vertex 2: '+-1' is not a number"},
      {with(ply, "1 1 0", "1 1"), "vertex 2: the PLY is truncated"},
      {with(ply, "vertex 4", "vertex 4000000000000"), "header declares 4000000000000 of element 'vertex'"},
      {with(ply, "vertex 4", "vertex 99999999999999999999"), "line 4: the PLY element has no count"},
      {with(ply, "vertex 4", "vertex -4"), "line 4: the PLY element has no count"},
      {with(ply, "face 2", "face 2000000000"), "line 16, face 2: the PLY is truncated"},
      {with(ply, "face 2\n", "face 0\n"), "the mesh has no faces"},
      {with(ply, "float x", "floot x"), "line 5: unknown PLY type 'floot'"},
      {with(ply, "float x", "list uchar float x"), "line 5: 'x' of a vertex must be a number"},
      {with(ply, "float y", "float x"), "line 6: duplicate property 'x'"},
      {with(ply, "float y", "float yy"), "the vertices lack x, y or z"},
      {with(ply, "list uchar int", "int"), "line 9: 'vertex_indices' of a face must be a list"},
      {with(ply, "vertex_indices", "corners"), "the faces have no list 'vertex_indices'"},
      {with(ply, "element face 2\n", "element face 2\nproperty list uchar int vertex_index\n"),
       "line 10: duplicate property 'vertex_indices'"},
      {with(ply, "element face 2", "element vertex 2\nelement face 2"), "line 8: duplicate element 'vertex'"},
      {with(ply, "element face 2", manyElements + "element face 2"), "line 1007: more than 1000 elements"},
      {with(ply, "comment by hand", "property float early"), "line 3: a PLY property before any element"},
      {with(ply, "comment by hand", "format ascii 1.0"), "line 3: duplicate format"},
      {with(ply, "comment by hand", "elephant"), "line 3: 'elephant' is not a PLY header statement"},
      {with(ply, "format ascii 1.0", "comment"), "the PLY has no format"},
      {with(ply, "ascii", "ebcdic"), "line 2: unknown PLY format 'ebcdic'"},
      {with(ply, "ascii 1.0", "ascii 2.0"), "line 2: unknown PLY version '2.0'"},
      {with(ply, "float x", "float " + std::string(100000, 'x')), "line 5: a PLY property name of 100000 characters"},
      {"ply\nformat ascii 1.0\nelement vertex 9000000000000000000\nelement face 1\nproperty list uchar int "
       "vertex_indices\nend_header\n",
       "element 'vertex' has no properties"},
      {wrongIndex, "byte " + second + ", face 1: names vertex"},
      {wrongCount, "byte " + at + ", face 0: has 2 corners"},
      {nan, "byte " + nanAt + ", vertex 1: is not finite"},
      {binary + "x", "unexpected data after the last element"},
      {with(binary, "face 2", "face 1"), "unexpected data after the last element"},
      {with(binary, "vertex 4", "vertex 4000000000000000000"), "truncated"},
      {with(obj, "f -4", "f -5"), "line 12: a face names vertex -5, which does not exist"},
      {with(obj, "f -4", "f 5"), "line 12: a face names vertex 5; the file has 4"},
      {with(obj, "f -4", "f 0"), "line 12: a face names vertex 0"},
      {with(obj, "f -4", "f 99999999999999999999"), "line 12: '99999999999999999999//-1' is not a vertex number"},
      {with(obj, "-4//-1", "1//2"), "line 12: a face names normal 2; the file has 1"},
      {with(obj, "-4//-1", "1/7"), "line 12: a face names texture coordinate 7; the file has 1"},
      {with(obj, "-4//-1", "1/1/1/1"), "line 12: '1/1/1/1' is not a vertex number"},
      {with(obj, "-4//-1", "/1"), "line 12: '/1' is not a vertex number"},
      {with(obj, "f -4//-1", "f"), "line 12: a face needs three vertices"},
      {with(obj, "v 1 1 0", "v 1 1"), "line 6: a vertex needs three numbers"},
      {with(obj, "v 1 1 0", "v 1 1 0 red"), "line 6: 'red' is not a number"},
      {with(obj, "v 1 1 0", "v 1 inf 0"), "line 6, vertex 2: is not finite"},
      {"v 1 2 3\n", "as OBJ it has no faces"},
      {with(stl, "vertex 1 1 0", "vertex 1 1"), "line 6: a vertex needs three numbers"},
      {with(stl, "vertex 1 1 0", "vertex 1 1 0 0"), "line 6: unexpected '0' after a vertex"},
      {with(stl, "  outer loop\n", ""), "line 3: the STL has 'vertex' where outer loop is expected"},
      {with(stl, "  endloop\n", ""), "line 7: the STL has 'endfacet' where endloop is expected"},
      {with(stl, "endsolid s\n", ""), "endsolid is missing"},
      {stl + "x", "line 17: the STL has 'x' where solid is expected"},
      {"solid a\nendsolid a\n", "no faces"},
      {stlBinary().substr(0, 150), "byte 150, facet 1: the STL is truncated: its header declares 2 facets", "a.stl"},
      {stlBinary().substr(0, 60), "byte 60: the STL is truncated", "a.stl"},
      {stlBinary() + "more", "byte 184: unexpected data after the 2 facets", "a.stl"},
      {"\x89PNG\r\n", "is not a mesh; supported: PLY, OBJ, STL, glTF"},
      {std::string("v \0 f", 5), "is not a mesh"},
  };
  for (const Case& c : cases) EXPECT_THAT(inputErrorOf([&] { parseMesh(c.bytes, c.name); }), HasSubstr(c.expected));
}

}  // namespace
}  // namespace glint
