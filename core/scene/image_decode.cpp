// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/image_decode.h"

#include <jerror.h>
#include <jpeglib.h>
#include <png.h>

#include <csetjmp>
#include <cstdio>  // jpeglib.h needs it first
#include <cstring>
#include <iostream>
#include <mutex>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <streambuf>
#include <vector>

#include "core/codecs/codecs.h"

namespace glint {
namespace {

Failure undecodable(const std::string& reason) {
  return Failure{Reason::FrameUnreadable, "the image cannot be decoded: " + reason};
}

// ---- PNG. libpng reports errors by a jump over C frames, so the functions that it may leave own nothing.

struct PngJob {
  const std::string* bytes = nullptr;
  std::size_t at = 0;
  std::jmp_buf back;
  char error[120] = "";
};

void readPngBytes(png_structp png, png_bytep out, png_size_t count) {
  auto& job = *static_cast<PngJob*>(png_get_io_ptr(png));
  if (count > job.bytes->size() - job.at) png_error(png, "truncated");
  std::memcpy(out, job.bytes->data() + job.at, count);
  job.at += count;
}

[[noreturn]] void leavePng(png_structp png, png_const_charp message) {
  auto& job = *static_cast<PngJob*>(png_get_error_ptr(png));
  std::snprintf(job.error, sizeof job.error, "%s", message);
  std::longjmp(job.back, 1);
}

void ignorePngWarning(png_structp, png_const_charp) {}  // such as an unusual colour profile: the pixels are not touched

/// Reads the header and sets the transformations. False = job.error.
bool startPng(PngJob& job, png_structp png, png_infop info, int& channels, int& bits) {
  if (setjmp(job.back)) return false;
  png_set_read_fn(png, &job, readPngBytes);
  png_read_info(png, info);
  const int colour = png_get_color_type(png, info);
  bits = png_get_bit_depth(png, info);
  if (colour == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(png);
  if (colour == PNG_COLOR_TYPE_GRAY && bits < 8) png_set_expand_gray_1_2_4_to_8(png);
  // Grey with alpha becomes three equal channels, as with OpenCV, so that an image does not change its kind with its reader.
  if (colour == PNG_COLOR_TYPE_GRAY_ALPHA) png_set_gray_to_rgb(png);
  png_set_strip_alpha(png);
  if (bits == 16) png_set_swap(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  channels = png_get_channels(png, info);
  bits = png_get_bit_depth(png, info);
  return true;
}

bool readPngRows(PngJob& job, png_structp png, png_bytepp rows) {
  if (setjmp(job.back)) return false;
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

Outcome<cv::Mat> decodePng(const std::string& bytes, const ImageHeader& header) {
  PngJob job;
  job.bytes = &bytes;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, leavePng, ignorePngWarning);
  if (!png) throw std::bad_alloc();
  png_infop info = png_create_info_struct(png);
  if (!info) {
    png_destroy_read_struct(&png, nullptr, nullptr);
    throw std::bad_alloc();
  }
  int channels = 0, bits = 0;
  bool done = startPng(job, png, info, channels, bits);
  cv::Mat pixels;
  if (done && (png_get_image_width(png, info) != header.width || png_get_image_height(png, info) != header.height ||
               (channels != 1 && channels != 3) || (bits != 8 && bits != 16))) {
    std::snprintf(job.error, sizeof job.error, "its header is inconsistent");
    done = false;
  }
  if (done) {
    pixels.create(static_cast<int>(header.height), static_cast<int>(header.width),
                  CV_MAKETYPE(bits == 16 ? CV_16U : CV_8U, channels));
    std::vector<png_bytep> rows(static_cast<std::size_t>(pixels.rows));
    for (int y = 0; y < pixels.rows; ++y) rows[static_cast<std::size_t>(y)] = pixels.ptr(y);
    done = readPngRows(job, png, rows.data());
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (!done) return undecodable(std::string("the PNG is damaged (") + job.error + ")");
  return pixels;
}

// ---- JPEG. The same with libjpeg.

struct JpegJob {
  jpeg_error_mgr errors;  // first, so that a pointer to it is one to the job
  jpeg_progress_mgr progress;
  std::jmp_buf back;
  char error[JMSG_LENGTH_MAX] = "";
};

[[noreturn]] void leaveJpeg(j_common_ptr info) {
  auto& job = *reinterpret_cast<JpegJob*>(info->err);
  if (!job.error[0]) info->err->format_message(info, job.error);
  std::longjmp(job.back, 1);
}

/// A warning says that pixels are not what was stored. Warnings about other things pass.
void judgeJpeg(j_common_ptr info, int level) {
  if (level >= 0) return;  // traces
  switch (info->err->msg_code) {
    case JWRN_EXTRANEOUS_DATA:  // bytes between segments, which some cameras write
    case JWRN_ADOBE_XFORM:
    case JWRN_JFIF_MAJOR:
    case JWRN_TOO_MUCH_DATA: return;
    default: leaveJpeg(info);
  }
}

void countScans(j_common_ptr info) {
  constexpr int kMostScans = 200;  // encoders write about ten; a hostile file has thousands, each as costly as an image
  const auto* decompress = reinterpret_cast<j_decompress_ptr>(info);
  if (decompress->input_scan_number <= kMostScans) return;
  auto& job = *reinterpret_cast<JpegJob*>(info->err);
  std::snprintf(job.error, sizeof job.error, "more than %d scans", kMostScans);
  leaveJpeg(info);
}

bool startJpeg(JpegJob& job, jpeg_decompress_struct& info, const std::string& bytes) {
  if (setjmp(job.back)) return false;
  jpeg_create_decompress(&info);
  job.progress.progress_monitor = countScans;
  info.progress = &job.progress;
  jpeg_mem_src(&info, reinterpret_cast<const unsigned char*>(bytes.data()), static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&info, TRUE);
  return true;
}

bool readJpegRows(JpegJob& job, jpeg_decompress_struct& info, unsigned char* pixels, std::size_t rowBytes) {
  if (setjmp(job.back)) return false;
  jpeg_start_decompress(&info);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = pixels + info.output_scanline * rowBytes;
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

Outcome<cv::Mat> decodeJpeg(const std::string& bytes, const ImageHeader& header) {
  JpegJob job{};
  jpeg_decompress_struct info{};
  info.err = jpeg_std_error(&job.errors);
  job.errors.error_exit = leaveJpeg;
  job.errors.emit_message = judgeJpeg;
  job.errors.output_message = [](j_common_ptr) {};
  bool done = startJpeg(job, info, bytes);
  const auto failure = [&](const std::string& reason) {
    jpeg_destroy_decompress(&info);
    return undecodable(reason);
  };
  if (!done) return failure(std::string("the JPEG is damaged (") + job.error + ")");
  if (info.num_components != 1 && info.num_components != 3)
    return failure("the JPEG has " + std::to_string(info.num_components) + " components (CMYK is not supported; save it as RGB)");
  if (info.image_width != header.width || info.image_height != header.height) return failure("the JPEG has two different sizes");
  info.out_color_space = info.num_components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  cv::Mat pixels(static_cast<int>(header.height), static_cast<int>(header.width), info.num_components == 1 ? CV_8UC1 : CV_8UC3);
  done = readJpegRows(job, info, pixels.data, pixels.step);
  if (!done) return failure(std::string("the JPEG is damaged (") + job.error + ")");
  jpeg_destroy_decompress(&info);
  return pixels;
}

// ---- The others, with OpenCV, which writes what goes wrong to std::cerr.

/// While one lives, std::cerr goes nowhere. Glint itself does not use it. Narrower than QuietLibraries on purpose: images are
/// decoded on several threads, and messages of other threads must still be seen.
class QuietCerr {
 public:
  QuietCerr() {
    const std::lock_guard<std::mutex> lock(mutex());
    if (count()++ == 0) before() = std::cerr.rdbuf(&nowhere());
  }
  ~QuietCerr() {
    const std::lock_guard<std::mutex> lock(mutex());
    if (--count() == 0) std::cerr.rdbuf(before());
  }
  QuietCerr(const QuietCerr&) = delete;
  QuietCerr& operator=(const QuietCerr&) = delete;

 private:
  struct Nowhere : std::streambuf {
    int overflow(int c) override { return c; }
  };
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  static int& count() {
    static int n = 0;
    return n;
  }
  static std::streambuf*& before() {
    static std::streambuf* buffer = nullptr;
    return buffer;
  }
  static std::streambuf& nowhere() {
    static Nowhere buffer;
    return buffer;
  }
};

/// The picture as a function of core/codecs gives it.
Outcome<cv::Mat> decodeBy(cv::Mat (*decoder)(const std::string&, std::string&), const std::string& bytes) {
  static const bool quiet = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  (void)quiet;
  loadCodecs();
  cv::Mat m;
  std::string reason;
  try {
    const QuietCerr guard;
    m = decoder(bytes, reason);
  } catch (const std::exception&) {
    return undecodable("truncated or damaged");
  }
  if (!reason.empty()) return Failure{Reason::FrameUnreadable, reason};
  if (m.empty()) return undecodable("not an image, truncated or damaged");
  if (m.channels() != 1 && m.channels() != 3 && m.channels() != 4)
    return undecodable("it has " + std::to_string(m.channels()) + " channels, expected 1, 3 or 4");
  return m;
}

/// All channels in OpenCV's order.
Outcome<cv::Mat> decodeAll(const std::string& bytes) { return decodeBy(&decodeOtherFormat, bytes); }

Outcome<cv::Mat> decodeOther(const std::string& bytes) {
  Outcome<cv::Mat> all = decodeAll(bytes);
  if (!all || all->channels() == 1) return all;
  // Blue-green-red to red-green-blue; alpha is dropped.
  std::vector<cv::Mat> c;
  cv::Mat m;
  cv::split(*all, c);
  cv::merge(std::vector<cv::Mat>{c[2], c[1], c[0]}, m);
  return m;
}

}  // namespace

Outcome<cv::Mat> decodeAlpha(const std::string& bytes) {
  const Outcome<cv::Mat> all = decodeAll(bytes);
  if (!all) return all.failure();
  std::vector<cv::Mat> c;
  cv::split(*all, c);
  if (c.size() != 4) return undecodable("it has no alpha");
  return c[3];
}

Outcome<cv::Mat> decodeDepth(const std::string& bytes) { return decodeBy(&decodeExrDepth, bytes); }

Outcome<cv::Mat> decodeImage(const std::string& bytes, const ImageHeader& header) {
  switch (header.format) {
    case ImageFormat::Png: return decodePng(bytes, header);
    case ImageFormat::Jpeg: return decodeJpeg(bytes, header);
    default: return decodeOther(bytes);
  }
}

}  // namespace glint
