// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <string>

#include "core/base/image_header.h"

namespace glint::exif_tests {

std::string number(unsigned long v, int size, bool big) {
  std::string s;
  for (int i = 0; i < size; ++i) s += static_cast<char>(v >> (8 * (big ? size - 1 - i : i)) & 0xFF);
  return s;
}

/// A JPEG of markers alone, laid out by hand after Exif 2.32: JFIF, then Exif with two directories.
std::string jpeg(bool big, unsigned focal, unsigned tag = 0xA405, unsigned orientation = 1) {
  const auto n = [&](unsigned long v, int size) { return number(v, size, big); };
  std::string tiff = (big ? "MM" : "II") + n(42, 2) + n(8, 4);
  tiff += n(2, 2);                                                         // at 8: two entries
  tiff += n(0x0112, 2) + n(3, 2) + n(1, 4) + n(orientation, 2) + n(0, 2);  // orientation
  tiff += n(0x8769, 2) + n(4, 2) + n(1, 4) + n(38, 4) + n(0, 4);           // the Exif directory, at 8 + 2 + 24 + 4
  tiff += n(1, 2) + n(tag, 2) + n(3, 2) + n(1, 4) + n(focal, 2) + n(0, 2) + n(0, 4);
  const std::string exif = std::string("Exif\0\0", 6) + tiff;
  const std::string jfif("JFIF\0\1\1\0\0\1\0\1\0\0", 14);
  return "\xFF\xD8\xFF\xE0" + number(jfif.size() + 2, 2, true) + jfif + "\xFF\xE1" + number(exif.size() + 2, 2, true) + exif +
         "\xFF\xDA";
}

TEST(FocalLength35mm, IsReadInBothByteOrders) {
  EXPECT_EQ(focalLength35mm(jpeg(true, 50)), 50);
  EXPECT_EQ(focalLength35mm(jpeg(false, 28)), 28);
}

TEST(FocalLength35mm, IsNothingWhereItIsNotSaid) {
  EXPECT_FALSE(focalLength35mm(jpeg(true, 0)));  // 0 means unknown
  EXPECT_FALSE(focalLength35mm(jpeg(true, 50, 0x920A)));
  EXPECT_FALSE(focalLength35mm(""));
  EXPECT_FALSE(focalLength35mm("\x89PNG\r\n\x1a\n"));
}

TEST(FocalLength35mm, ACutFileSaysNothingOrTheSame) {
  const std::string whole = jpeg(false, 35);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto found = focalLength35mm(std::string_view(whole).substr(0, size));
    EXPECT_TRUE(!found || *found == 35) << size;
  }
}

TEST(FocalLength35mm, WildOffsetsAreRefused) {
  std::string wild = jpeg(true, 50);
  const std::size_t at = wild.find("MM");
  for (const char* offset : {"\xFF\xFF\xFF\xFF", "\x7F\xFF\xFF\xF0"}) {
    wild.replace(at + 4, 4, offset, 4);
    EXPECT_FALSE(focalLength35mm(wild));
  }
}

/// The TIFF structure of such a JPEG.
std::string tiffOf(unsigned orientation) {
  const std::string file = jpeg(true, 50, 0xA405, orientation);
  const std::size_t at = file.find("MM");
  return file.substr(at, file.size() - at - 2);
}

std::string png(const std::string& exif) {
  return "\x89PNG\r\n\x1a\n" + number(13, 4, true) + "IHDR" + std::string(13 + 4, '\1') + number(exif.size(), 4, true) + "eXIf" +
         exif + std::string(4, '\0');
}

std::string webp(const std::string& exif) {
  const std::string odd("VP8L\3\0\0\0abc\0", 12);  // a chunk of 3 bytes is followed by one of padding
  return "RIFF" + number(4 + odd.size() + 8 + exif.size(), 4, false) + "WEBP" + odd + "EXIF" + number(exif.size(), 4, false) +
         exif;
}

TEST(ExifOrientation, IsReadInEachFormatThatCarriesIt) {
  for (unsigned o = 1; o <= 8; ++o) {
    EXPECT_EQ(exifOrientation(jpeg(true, 50, 0xA405, o)), int(o));
    EXPECT_EQ(exifOrientation(jpeg(false, 50, 0xA405, o)), int(o));
    EXPECT_EQ(exifOrientation(tiffOf(o)), int(o));
    EXPECT_EQ(exifOrientation(png(tiffOf(o))), int(o));
    EXPECT_EQ(exifOrientation(webp(tiffOf(o))), int(o));
    EXPECT_EQ(exifOrientation(webp(std::string("Exif\0\0", 6) + tiffOf(o))), int(o));  // as older programs write it
  }
}

TEST(ExifOrientation, IsAsStoredWhereTheFileDoesNotSay) {
  for (const unsigned o : {0u, 9u, 65535u}) EXPECT_EQ(exifOrientation(jpeg(true, 50, 0xA405, o)), 1);
  EXPECT_EQ(exifOrientation(""), 1);
  EXPECT_EQ(exifOrientation("\xFF\xD8\xFF\xD9"), 1);
  EXPECT_EQ(exifOrientation("II"), 1);
}

TEST(ExifOrientation, ACutFileSaysNothingOrTheSame) {
  for (const std::string& whole : {jpeg(false, 35, 0xA405, 6), png(tiffOf(6)), webp(tiffOf(6)), tiffOf(6)})
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const int found = exifOrientation(std::string_view(whole).substr(0, size));
      EXPECT_TRUE(found == 1 || found == 6) << size;
    }
}

}  // namespace glint::exif_tests
