// SPDX-License-Identifier: BSD-3-Clause
// Sizes that a decoder would take from elsewhere than the check before it: files written by hand, byte for byte.
#include "core/base/image_header.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <vector>

namespace glint {
namespace {
using testing::HasSubstr;

void put(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xff);
}

struct Entry {
  int tag, type;
  std::uint64_t value;  // of 4 bytes
};
constexpr int kShort = 3, kLong = 4, kLong8 = 16, kWidth = 256, kHeight = 257;  // TIFF 6.0; LONG8 of libtiff

/// A little-endian TIFF that is a directory alone.
std::string tiff(const std::vector<Entry>& entries) {
  std::string bytes("II*\0", 4);
  put(bytes, 8, 4);
  put(bytes, entries.size(), 2);
  for (const Entry& e : entries) {
    put(bytes, static_cast<std::uint64_t>(e.tag), 2);
    put(bytes, static_cast<std::uint64_t>(e.type), 2);
    put(bytes, 1, 4);
    put(bytes, e.value, 4);
  }
  put(bytes, 0, 4);
  return bytes;
}

TEST(TiffHeader, SizeIsThatOfTheFirstTagAsForTheDecoder) {
  const ImageHeader once = readImageHeader(tiff({{kWidth, kShort, 64}, {kHeight, kLong, 48}}));
  EXPECT_EQ(once.problem, "");
  EXPECT_EQ(once.width, 64u);
  EXPECT_EQ(once.height, 48u);
  // libtiff ignores a tag that stands there again: 60000 x 60000 would be decoded for 64 x 48.
  const ImageHeader twice =
      readImageHeader(tiff({{kWidth, kLong, 60000}, {kHeight, kLong, 60000}, {kWidth, kLong, 64}, {kHeight, kLong, 48}}));
  EXPECT_EQ(twice.width, 60000u);
  EXPECT_EQ(twice.height, 60000u);
}

TEST(TiffHeader, SizeOfATypeThatStandsElsewhereIsRefused) {
  // The value of a LONG8 is the place where the width stands.
  const ImageHeader header = readImageHeader(tiff({{kWidth, kLong8, 64}, {kHeight, kLong, 48}}));
  EXPECT_THAT(header.problem, HasSubstr("the TIFF is damaged"));
  EXPECT_EQ(header.width, 0u);
}

/// A note, and the frame header of a picture of 1920 x 1080 (ITU T.81, B.2.2: length, bits, height, width, components).
const std::string kJpegStart =
    std::string("\xff\xd8\xff\xe0\0\x06glin", 10) + std::string("\xff\xc0\0\x0b\x08\x04\x38\x07\x80\x01\x01\x11\0", 13);

TEST(JpegStart, SaysTheSizeAsSoonAsTheFrameHeaderIsThere) {
  const auto size = jpegSizeAtStart(kJpegStart);
  ASSERT_TRUE(size);
  EXPECT_EQ(*size, (std::array<int, 2>{1920, 1080}));
  constexpr std::size_t kUpToComponents = 20;  // bytes: the size is read together with the number of components
  for (std::size_t n = 0; n < kUpToComponents; ++n) EXPECT_FALSE(jpegSizeAtStart(kJpegStart.substr(0, n))) << n;
  EXPECT_TRUE(jpegSizeAtStart(kJpegStart.substr(0, kUpToComponents)));
}

TEST(JpegStart, IsNoOtherFileAndNoEmptyPicture) {
  EXPECT_FALSE(jpegSizeAtStart("\x89PNG"));
  std::string empty = kJpegStart;
  empty[17] = empty[18] = 0;  // the width
  EXPECT_FALSE(jpegSizeAtStart(empty));
  EXPECT_THAT(readImageHeader(kJpegStart).problem, HasSubstr("truncated")) << "the whole file is asked for its end";
}

}  // namespace
}  // namespace glint
