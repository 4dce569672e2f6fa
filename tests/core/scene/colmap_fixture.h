// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>

#include "core/scene/capture.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::testing_support {

// A COLMAP model, written by hand from the format's documentation (colmap.github.io/format.html).

/// Two photographs of one camera. `b.jpg` stands first, with a quarter turn about x: y becomes z, z becomes -y.
inline const char* const kColmapCameras =
    "# Camera list with one line of data per camera:\n"
    "#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n"
    "7 PINHOLE 640 480 500 510 320 240\n";
inline const char* const kColmapImages =
    "# Image list with two lines of data per image:\n"
    "41 0.70710678118654757 0.70710678118654757 0 0 10 20 30 7 b.jpg\n"
    "11.5 22.5 -1 100.5 50.5 3\n"
    "4 1 0 0 0 0 0 5 7 a.jpg\n"
    "320.5 240.5 3 7.25 8.25 900\n";
inline const char* const kColmapPoints =
    "# 3D point list with one line of data per point:\n"
    "3 1 2 3 10 20 30 0.5 41 1 4 0\n"
    "900 -4 5 6 10 20 30 0.5 4 1\n";

/// Its files in a folder, which the path of `prefix` names ("sparse/0/").
inline void writeColmap(const TemporaryFolder& folder, const std::string& prefix = "",
                        const std::string& cameras = kColmapCameras, const std::string& images = kColmapImages,
                        const std::string& points = kColmapPoints) {
  folder.write(prefix + "cameras.txt", cameras);
  folder.write(prefix + "images.txt", images);
  folder.write(prefix + "points3D.txt", points);
}

/// Numbers of a binary file.
struct ColmapBytes {
  std::string text;
  template <class Number>
  ColmapBytes& number(Number value) {
    char bytes[sizeof value];  // the machines that run the tests are little-endian, as the format
    std::memcpy(bytes, &value, sizeof value);
    text.append(bytes, sizeof value);
    return *this;
  }
  ColmapBytes& u8(std::uint8_t v) { return number(v); }
  ColmapBytes& i32(std::int32_t v) { return number(v); }
  ColmapBytes& u32(std::uint32_t v) { return number(v); }
  ColmapBytes& u64(std::uint64_t v) { return number(v); }
  ColmapBytes& doubles(std::initializer_list<double> values) {
    for (const double v : values) number(v);
    return *this;
  }
  ColmapBytes& name(const std::string& v) {
    text.append(v.c_str(), v.size() + 1);
    return *this;
  }
};

inline std::string binaryColmapCameras() {
  ColmapBytes b;
  b.u64(1).u32(7).i32(1).u64(640).u64(480).doubles({500, 510, 320, 240});
  return b.text;
}
inline std::string binaryColmapImages() {
  constexpr double kHalfTurn = 0.70710678118654757;
  constexpr std::uint64_t kNoPoint = ~std::uint64_t(0);
  ColmapBytes b;
  b.u64(2);
  b.u32(41).doubles({kHalfTurn, kHalfTurn, 0, 0, 10, 20, 30}).u32(7).name("b.jpg").u64(2);
  b.doubles({11.5, 22.5}).u64(kNoPoint).doubles({100.5, 50.5}).u64(3);
  b.u32(4).doubles({1, 0, 0, 0, 0, 0, 5}).u32(7).name("a.jpg").u64(2);
  b.doubles({320.5, 240.5}).u64(3).doubles({7.25, 8.25}).u64(900);
  return b.text;
}
inline std::string binaryColmapPoints() {
  ColmapBytes b;
  b.u64(2);
  b.u64(3).doubles({1, 2, 3}).u8(10).u8(20).u8(30).doubles({0.5}).u64(2).u32(41).u32(1).u32(4).u32(0);
  b.u64(900).doubles({-4, 5, 6}).u8(10).u8(20).u8(30).doubles({0.5}).u64(1).u32(4).u32(1);
  return b.text;
}
inline void writeColmapBinary(const TemporaryFolder& folder, const std::string& prefix = "") {
  folder.write(prefix + "cameras.bin", binaryColmapCameras());
  folder.write(prefix + "images.bin", binaryColmapImages());
  folder.write(prefix + "points3D.bin", binaryColmapPoints());
}

inline const std::unique_ptr<const CaptureReader> kColmapReader = makeColmapReader();

/// What the reader makes of a folder or a file.
inline Capture readColmap(const std::filesystem::path& input, const CaptureOptions& options = {}) {
  const std::filesystem::path file = kColmapReader->recognise(input);
  EXPECT_FALSE(file.empty()) << input << " is not recognised";
  return kColmapReader->read(file, options);
}

}  // namespace glint::testing_support
