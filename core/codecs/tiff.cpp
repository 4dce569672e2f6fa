// SPDX-License-Identifier: BSD-3-Clause
// Part of libglint-codecs: what OpenCV's own reader of TIFF refuses, or returns with wrong pixels.
#include <tiffio.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "core/base/bytes.h"
#include "core/codecs/codec_table.h"

namespace glint {
namespace {

struct TiffBytes {
  const std::string* bytes;
  std::uint64_t at = 0;
};

TiffBytes& tiffBytes(thandle_t handle) { return *static_cast<TiffBytes*>(handle); }

tmsize_t readTiff(thandle_t handle, void* to, tmsize_t count) {
  TiffBytes& from = tiffBytes(handle);
  const std::uint64_t size = from.bytes->size(), at = std::min(from.at, size);
  const auto length = std::min<std::uint64_t>(static_cast<std::uint64_t>(std::max<tmsize_t>(count, 0)), size - at);
  std::memcpy(to, from.bytes->data() + at, length);
  from.at = at + length;
  return static_cast<tmsize_t>(length);
}

tmsize_t writeNothing(thandle_t, void*, tmsize_t) { return 0; }

toff_t seekTiff(thandle_t handle, toff_t offset, int from) {
  TiffBytes& in = tiffBytes(handle);
  in.at = offset + (from == SEEK_CUR ? in.at : from == SEEK_END ? in.bytes->size() : 0);
  return in.at;
}

int closeNothing(thandle_t) { return 0; }
toff_t sizeOfTiff(thandle_t handle) { return tiffBytes(handle).bytes->size(); }
int saidNothing(TIFF*, void*, const char*, const char*, va_list) { return 1; }  // 1: handled

struct CloseTiff {
  void operator()(TIFF* t) const { TIFFClose(t); }
};
using OpenTiff = std::unique_ptr<TIFF, CloseTiff>;

OpenTiff openTiff(TiffBytes& bytes) {
  const std::unique_ptr<TIFFOpenOptions, decltype(&TIFFOpenOptionsFree)> options(TIFFOpenOptionsAlloc(), &TIFFOpenOptionsFree);
  TIFFOpenOptionsSetErrorHandlerExtR(options.get(), saidNothing, nullptr);
  TIFFOpenOptionsSetWarningHandlerExtR(options.get(), saidNothing, nullptr);
  return OpenTiff(TIFFClientOpenExt("", "rm", &bytes, readTiff, writeNothing, seekTiff, closeNothing, sizeOfTiff, nullptr,
                                    nullptr, options.get()));
}

struct TiffLayout {
  std::uint32_t width = 0, height = 0;
  std::uint16_t samples = 1, bits = 1, format = SAMPLEFORMAT_UINT, planes = PLANARCONFIG_CONTIG,
                photometric = PHOTOMETRIC_MINISBLACK, orientation = ORIENTATION_TOPLEFT;
};

TiffLayout layoutOf(TIFF* t) {
  TiffLayout l;
  TIFFGetField(t, TIFFTAG_IMAGEWIDTH, &l.width);
  TIFFGetField(t, TIFFTAG_IMAGELENGTH, &l.height);
  TIFFGetFieldDefaulted(t, TIFFTAG_SAMPLESPERPIXEL, &l.samples);
  TIFFGetFieldDefaulted(t, TIFFTAG_BITSPERSAMPLE, &l.bits);
  TIFFGetFieldDefaulted(t, TIFFTAG_SAMPLEFORMAT, &l.format);
  TIFFGetFieldDefaulted(t, TIFFTAG_PLANARCONFIG, &l.planes);
  TIFFGetField(t, TIFFTAG_PHOTOMETRIC, &l.photometric);
  TIFFGetField(t, TIFFTAG_ORIENTATION, &l.orientation);
  if (l.format == SAMPLEFORMAT_VOID) l.format = SAMPLEFORMAT_UINT;
  return l;
}

/// OpenCV's type of one sample; -1 = none.
int depthOf(const TiffLayout& l) {
  if (l.format == SAMPLEFORMAT_UINT) return l.bits == 8 ? CV_8U : l.bits == 16 ? CV_16U : -1;
  if (l.format == SAMPLEFORMAT_IEEEFP) return l.bits == 16 ? CV_16F : l.bits == 32 ? CV_32F : l.bits == 64 ? CV_64F : -1;
  return -1;
}

/// Samples of the strip or tile that begins at `at`, into the channels of the picture; alpha goes nowhere.
void place(const std::vector<unsigned char>& block, std::uint32_t blockWidth, int samples, int plane, cv::Point at,
           cv::Mat& picture) {
  const std::size_t size = picture.elemSize1();
  const int rows =
      std::min<int>(int(block.size() / (std::size_t(blockWidth) * std::size_t(samples) * size)), picture.rows - at.y);
  const int columns = std::min<int>(int(blockWidth), picture.cols - at.x);
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x)
      for (int s = 0; s < samples; ++s) {
        const int channel = picture.channels() - 1 - (plane + s);  // blue first
        if (channel < 0) continue;
        const std::size_t from = (std::size_t(y) * blockWidth + std::size_t(x)) * std::size_t(samples) + std::size_t(s);
        std::memcpy(picture.ptr(at.y + y, at.x + x) + std::size_t(channel) * size, block.data() + from * size, size);
      }
}

[[noreturn]] void damagedTiff() { throw std::runtime_error("the TIFF is damaged"); }

/// @throws std::runtime_error  a strip or tile is missing or cut
cv::Mat pixelsOf(TIFF* t, const TiffLayout& l, int depth) {
  const bool tiled = TIFFIsTiled(t), together = l.planes == PLANARCONFIG_CONTIG;
  std::uint32_t width = l.width, height = l.height;
  if (tiled) {
    TIFFGetField(t, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(t, TIFFTAG_TILELENGTH, &height);
  } else {
    TIFFGetFieldDefaulted(t, TIFFTAG_ROWSPERSTRIP, &height);
    height = std::min(height, l.height);
  }
  const int samples = together ? l.samples : 1;
  cv::Mat picture(int(l.height), int(l.width), CV_MAKETYPE(depth, l.samples < 3 ? 1 : 3), cv::Scalar::all(0));
  const std::uint64_t row = std::uint64_t(width) * std::uint64_t(samples) * picture.elemSize1();
  const tmsize_t whole = tiled ? TIFFTileSize(t) : TIFFStripSize(t);
  if (width == 0 || height == 0 || whole <= 0 || std::uint64_t(whole) != row * height) damagedTiff();
  for (int plane = 0; plane < (together ? 1 : l.samples); ++plane)
    for (std::uint32_t y = 0; y < l.height; y += height)
      for (std::uint32_t x = 0; x < l.width; x += width) {
        const std::uint64_t bytes = row * (tiled ? height : std::min(height, l.height - y));
        std::vector<unsigned char> block(bytes);
        const auto size = static_cast<tmsize_t>(bytes);
        const auto sample = static_cast<std::uint16_t>(plane);
        const tmsize_t got = tiled ? TIFFReadEncodedTile(t, TIFFComputeTile(t, x, y, 0, sample), block.data(), size)
                                   : TIFFReadEncodedStrip(t, TIFFComputeStrip(t, y, sample), block.data(), size);
        if (got != size) damagedTiff();
        place(block, width, samples, plane, {int(x), int(y)}, picture);
      }
  return picture;
}

}  // namespace

std::optional<cv::Mat> decodeTiff(const std::string& bytes, std::string& reason) {
  const bool big = bytes.starts_with("MM");
  if (!big && !bytes.starts_with("II")) return std::nullopt;
  constexpr std::uint64_t kTiff = 42, kBigTiff = 43;
  const std::optional<std::uint64_t> magic = NumbersInBytes(bytes, big).number(2, 2);
  if (magic != kTiff && magic != kBigTiff) return std::nullopt;
  TiffBytes in{&bytes};
  const OpenTiff tiff = openTiff(in);
  if (!tiff) damagedTiff();
  const TiffLayout l = layoutOf(tiff.get());
  const bool half = l.format == SAMPLEFORMAT_IEEEFP && l.bits == 16,
             apart = l.planes != PLANARCONFIG_CONTIG && l.samples > 1 && l.bits > 8;
  const bool turned = l.orientation >= ORIENTATION_LEFTTOP;  // OpenCV would return another size than the header's
  const bool wide = l.bits > 16 && !(l.format == SAMPLEFORMAT_IEEEFP && l.bits == 32);  // OpenCV calls such a file damaged
  if (magic == kTiff && !half && !apart && !turned && !wide) return std::nullopt;
  const int depth = depthOf(l);
  const bool known =
      l.photometric == PHOTOMETRIC_MINISBLACK ? l.samples <= 2 : l.photometric == PHOTOMETRIC_RGB && l.samples >= 3;
  if (depth < 0 || !known || l.samples > 4) {
    reason = "this kind of TIFF (" + std::to_string(l.samples) + " samples of " + std::to_string(l.bits) +
             (l.format == SAMPLEFORMAT_IEEEFP ? " bits of floating point," : " bits,") + " colours of kind " +
             std::to_string(l.photometric) + ") is not supported; save it as RGB or grey of 8 or 16 bits or floating point";
    return cv::Mat();
  }
  cv::Mat pixels = pixelsOf(tiff.get(), l, depth);
  if (depth == CV_16F || depth == CV_64F) pixels.convertTo(pixels, CV_32F);
  return pixels;
}

}  // namespace glint
