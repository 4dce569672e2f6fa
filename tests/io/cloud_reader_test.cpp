// SPDX-License-Identifier: BSD-3-Clause
#include "io/cloud_reader.h"

#include <gmock/gmock.h>

#include "core/base/outcome.h"
#include "tests/io/mesh_texts.h"

namespace glint::cloud_reader_tests {
namespace {
using testing::HasSubstr;
using testing_support::put;

const char* const kPoints = "0 0 0\n1 0 0.5\n-2 3e-1 4\n";

std::string pcdHead(const std::string& data, int points = 3, const std::string& fields = "x y z",
                    const std::string& sizes = "4 4 4", const std::string& types = "F F F", const std::string& counts = "1 1 1") {
  const std::string n = std::to_string(points);
  return "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types +
         "\nCOUNT " + counts + "\nWIDTH " + n + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA " + data + "\n";
}

void expectThePoints(const CloudContent& cloud) {
  ASSERT_EQ(cloud.points.size(), 3u);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(cloud.points[1], Eigen::Vector3d(1, 0, 0.5));
  EXPECT_NEAR((cloud.points[2] - Eigen::Vector3d(-2, 0.3, 4)).norm(), 0, 1e-7);  // single precision
}

std::string refusal(const std::string& bytes, const std::string& name = "c.pcd") {
  try {
    parseCloud(bytes, name);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

/// The same three points as rows, and as columns, which is what the compressed form holds.
std::string rows() {
  std::string b;
  for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.5f, -2.f, 0.3f, 4.f}) put(b, v);
  return b;
}
std::string columns() {
  std::string b;
  for (const float v : {0.f, 1.f, -2.f, 0.f, 0.f, 0.3f, 0.f, 0.5f, 4.f}) put(b, v);
  return b;
}

std::string compressed(const std::string& packed, std::size_t size) {
  std::string b = pcdHead("binary_compressed");
  put(b, static_cast<std::uint32_t>(packed.size()));
  put(b, static_cast<std::uint32_t>(size));
  return b + packed;
}

/// LZF by hand: literal runs of at most 32 bytes.
std::string literally(const std::string& bytes) {
  std::string packed;
  for (std::size_t i = 0; i < bytes.size(); i += 32) {
    const std::string run = bytes.substr(i, 32);
    packed += static_cast<char>(run.size() - 1);
    packed += run;
  }
  return packed;
}

TEST(CloudReader, PcdInAllThreeForms) {
  expectThePoints(parseCloud(pcdHead("ascii") + kPoints, "c.pcd"));
  expectThePoints(parseCloud(pcdHead("binary") + rows(), "c.pcd"));
  expectThePoints(parseCloud(compressed(literally(columns()), 36), "c.pcd"));
}

TEST(CloudReader, LzfReferencesAreFollowed) {
  // 36 zero bytes: one literal zero, then 9 + 2 and 22 + 2 bytes from one byte back (a long length is 7 and the next byte).
  std::string packed{'\0', '\0'};
  packed += {static_cast<char>(7 << 5), '\x02', '\0'};  // 7 + 2 + 2 = 11 bytes
  packed += {static_cast<char>(7 << 5), '\x0f', '\0'};  // 7 + 15 + 2 = 24 bytes
  const CloudContent cloud = parseCloud(compressed(packed, 36), "c.pcd");
  ASSERT_EQ(cloud.points.size(), 3u);
  for (const Eigen::Vector3d& p : cloud.points) EXPECT_EQ(p, Eigen::Vector3d::Zero().eval());
  // One that points in front of the beginning, and a result of another length.
  EXPECT_THAT(refusal(compressed({'\0', '\0', static_cast<char>(7 << 5), '\x1a', '\x05'}, 36)), HasSubstr("damaged"));
  EXPECT_THAT(refusal(compressed(literally(columns().substr(0, 32)), 36)), HasSubstr("damaged"));
}

TEST(CloudReader, FieldsInAnyOrderAndTypes) {
  std::string b = pcdHead("binary", 1, "intensity z y x normal_x normal_y normal_z label", "2 8 8 8 4 4 4 1", "U F F F F F F I",
                          "3 1 1 1 1 1 1 1");
  for (int k = 0; k < 3; ++k) put(b, std::uint16_t(7));
  for (const double v : {3.0, 2.0, 0.1}) put(b, v);
  for (const float v : {0.f, 0.f, 2.f}) put(b, v);
  put(b, std::int8_t(-1));
  const CloudContent cloud = parseCloud(b, "c.pcd");
  ASSERT_EQ(cloud.points.size(), 1u);
  EXPECT_EQ(cloud.points[0], Eigen::Vector3d(0.1, 2, 3)) << "doubles keep all of their digits";
  ASSERT_EQ(cloud.normals.size(), 1u);
  EXPECT_EQ(cloud.normals[0], Eigen::Vector3d::UnitZ().eval());
}

TEST(CloudReader, PlacesWhereASensorSawNothingAreCounted) {
  const CloudContent cloud = parseCloud(pcdHead("ascii") + "0 0 0\nnan nan nan\n1 1 1\n", "c.pcd");
  EXPECT_EQ(cloud.points.size(), 2u);
  EXPECT_EQ(cloud.without, 1u);
  EXPECT_THAT(refusal(pcdHead("ascii", 1) + "nan nan nan\n"), HasSubstr("the cloud has no points"));
}

TEST(CloudReader, PlyWithoutFaces) {
  const std::string head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  expectThePoints(parseCloud(head + "end_header\n" + kPoints, "c.ply"));
  EXPECT_TRUE(looksLikeCloud(head + "end_header\n"));
  EXPECT_TRUE(looksLikeCloud(pcdHead("ascii")));
  EXPECT_FALSE(looksLikeCloud(testing_support::plyText()));
  EXPECT_FALSE(looksLikeCloud("v 0 0 0\n"));
  EXPECT_THAT(refusal(testing_support::plyText(), "m.ply"), HasSubstr("it is a mesh"));
}

TEST(CloudReader, WhatIsWrongIsNamedWithItsPlace) {
  EXPECT_THAT(refusal(pcdHead("ascii") + "0 0 0\n1 0\n"), HasSubstr("more than the file can hold"));
  EXPECT_THAT(refusal(pcdHead("ascii") + "0 0 0\n1 0     \n1 1 1\n"), HasSubstr("line 13"));
  EXPECT_THAT(refusal(pcdHead("ascii") + "0 0 0\n1 0 x\n1 1 1\n"), HasSubstr("'x' is not a number"));
  EXPECT_THAT(refusal(pcdHead("ascii") + std::string(kPoints) + "9 9 9\n"), HasSubstr("unexpected data"));
  EXPECT_THAT(refusal(pcdHead("binary") + rows().substr(1)), HasSubstr("truncated"));
  EXPECT_THAT(refusal(pcdHead("binary", 2000000000) + rows()), HasSubstr("truncated"));
  EXPECT_THAT(refusal(pcdHead("ascii", 3, "x y", "4 4", "F F", "1 1")), HasSubstr("lack x, y or z"));
  EXPECT_THAT(refusal(pcdHead("ascii", 3, "x y z x", "4 4 4 4", "F F F F", "1 1 1 1")), HasSubstr("duplicate field"));
  EXPECT_THAT(refusal(pcdHead("ascii", 3, "x y z", "4 4", "F F F")), HasSubstr("SIZE must have as many entries"));
  EXPECT_THAT(refusal(pcdHead("ascii", 3, "x y z", "2 4 4")), HasSubstr("SIZE 4 or 8"));
  EXPECT_THAT(refusal(pcdHead("zipped")), HasSubstr("unknown PCD data"));
  EXPECT_THAT(refusal(pcdHead("ascii", 0)), HasSubstr("no points"));
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal("hello"), HasSubstr("is no cloud"));
  // Three bytes give 264 at most: nothing is made room for that they cannot give.
  std::string bomb = pcdHead("binary_compressed", 100000000);
  put(bomb, std::uint32_t(3));
  put(bomb, std::uint32_t(1200000000));
  EXPECT_THAT(refusal(bomb + "abc"), HasSubstr("too few"));
}

TEST(CloudReader, CutAnywhere) {
  for (const std::string& whole : {pcdHead("ascii") + kPoints, pcdHead("binary") + rows(), compressed(literally(columns()), 36)})
    for (std::size_t n = 0; n + 4 < whole.size(); ++n) EXPECT_NE(refusal(whole.substr(0, n)), "") << n;
}

}  // namespace
}  // namespace glint::cloud_reader_tests
