// SPDX-License-Identifier: BSD-3-Clause
// The files of photographs that `glint synth` writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/synth/synth.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {

std::string specWith(const std::string& render) {
  return R"({"glint_scene": 1, "camera": {"width": 48, "height": 40, "fx": 60, "fy": 60, "cx": 23.5, "cy": 19.5},
    "surfaces": {"body": {"analytic": {"type": "sphere", "radius": 0.5}}}, "lights": [{"id": "lamp", "position": [1, 0, 2]}],
    "path": {"orbit": {"centre": [0, 0, 0], "radius": 2, "from": 0, "to": 0, "height": 0.5, "count": 1}},
    "render": {"roughness": 0.2, "diffuse": 0.5, )" +
         render + "}}";
}

std::vector<unsigned char> bytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Frame firstFrame(const testing_support::TemporaryFolder& folder, const std::string& render) {
  std::ofstream(folder.path() / "spec.json") << specWith(render);
  return synthesise(readSynthSpec(folder.path() / "spec.json"), folder.path() / "out").frames.at(0);
}

// ITU-T T.81: a file starts with SOI, and the example table K.1 begins with 16. The usual scale for a quality q of 50 and more is
// 2 - q / 50 (Independent JPEG Group), so that quality 60 gives round(16 * 0.8) = 13 as the first entry of the luminance table.
TEST(Photograph, JpegHasTheQuantisationOfItsQuality) {
  const testing_support::TemporaryFolder folder;
  const Frame frame = firstFrame(folder, R"("jpeg_quality": 60)");
  EXPECT_EQ(frame.image.extension(), ".jpg");
  const std::vector<unsigned char> bytes = bytesOf(frame.image);
  ASSERT_GT(bytes.size(), 100u);
  EXPECT_EQ(bytes[0], 0xff);
  EXPECT_EQ(bytes[1], 0xd8);
  const std::vector<unsigned char> marker{0xff, 0xdb};  // DQT, then its length (2 bytes), precision and number (1), the entries
  const auto table = std::search(bytes.begin(), bytes.end(), marker.begin(), marker.end());
  ASSERT_GT(bytes.end() - table, 10);
  EXPECT_EQ(table[4], 0);
  EXPECT_EQ(table[5], 13);
}

TEST(Photograph, WithoutAQualityItIsPng) {
  const testing_support::TemporaryFolder folder;
  const Frame frame = firstFrame(folder, R"("bits": 16)");
  EXPECT_EQ(frame.image.extension(), ".png");
  EXPECT_EQ(bytesOf(frame.image).at(1), 'P');
}

TEST(Photograph, JpegOfSixteenBitsIsRefused) {
  const testing_support::TemporaryFolder folder;
  for (const char* render : {R"("bits": 16, "jpeg_quality": 60)", R"("jpeg_quality": 0)", R"("jpeg_quality": 101)"})
    EXPECT_THROW(firstFrame(folder, render), InputError) << render;
}

}  // namespace
}  // namespace glint
