// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/base/atomic_file.h"
#include "core/base/srgb.h"
#include "core/scene/scene.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_reader.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

Failure unreadable(const fs::path& file, const std::string& reason) {
  return Failure{Reason::FrameUnreadable, file.string() + ": " + reason};
}

std::string wrongSize(int width, int height, const Camera& camera) {
  return "the image has " + std::to_string(width) + " x " + std::to_string(height) + " pixels, the camera " +
         std::to_string(camera.width) + " x " + std::to_string(camera.height);
}

std::uint32_t bigEndian(const std::string& bytes, std::size_t at) {
  std::uint32_t v = 0;
  for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<unsigned char>(bytes[at + i]);
  return v;
}

std::uint64_t littleEndian(const std::string& bytes, std::size_t at, std::size_t size) {
  std::uint64_t v = 0;
  for (std::size_t i = 0; i < size; ++i) v |= std::uint64_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return v;
}

/// True when every block that the offset table of an OpenEXR file names lies inside the file. Only single-part scan-line files
/// are checked (what cameras and renderers write for one image); the decoder judges the others.
/// @see OpenEXR File Layout: magic, version, attributes (name, type, size, value) up to an empty name, offsets, blocks.
bool isCompleteExr(const std::string& bytes) {
  if (bytes.size() < 9) return false;
  const std::uint64_t flags = littleEndian(bytes, 4, 4) >> 8;
  if (flags & 0x1A) return true;  // tiled, deep or multi-part
  std::size_t at = 8;
  while (at < bytes.size() && bytes[at] != 0) {
    const std::size_t name = bytes.find('\0', at);
    const std::size_t type = name == std::string::npos ? name : bytes.find('\0', name + 1);
    if (type == std::string::npos || type + 5 > bytes.size()) return false;
    const std::uint64_t size = littleEndian(bytes, type + 1, 4);
    if (size > bytes.size() - type - 5) return false;
    at = type + 5 + static_cast<std::size_t>(size);
  }
  const std::size_t table = at + 1;
  // The table ends where the first block starts, so its length follows from the smallest offset in it.
  std::uint64_t smallest = bytes.size();
  for (std::size_t entry = table; entry + 8 <= smallest; entry += 8) {
    const std::uint64_t offset = littleEndian(bytes, entry, 8);
    if (offset + 8 > bytes.size() || offset <= table) return false;
    if (offset + 8 + littleEndian(bytes, static_cast<std::size_t>(offset) + 4, 4) > bytes.size()) return false;
    smallest = std::min(smallest, offset);
  }
  return smallest < bytes.size();
}

struct FileCheck {
  std::string problem;  ///< "" = complete as far as the container tells
  bool saysLinear = false;
};

/// The decoders print their own messages or return half an image when a file is cut off, so completeness is checked first:
/// a PNG's chunks must reach IEND, a JPEG must contain its end marker, an EXR all blocks of its table.
FileCheck checkContainer(const std::string& bytes) {
  FileCheck check;
  static const std::string pngMagic("\x89PNG\r\n\x1a\n", 8);
  if (bytes.empty()) {
    check.problem = "the file is empty (0 bytes)";
  } else if (bytes.compare(0, pngMagic.size(), pngMagic) == 0) {
    std::size_t at = pngMagic.size();
    std::string type;
    while (type != "IEND") {
      if (at + 12 > bytes.size() || bigEndian(bytes, at) > bytes.size() - at - 12) {
        check.problem = "the PNG is truncated";
        break;
      }
      const std::size_t length = bigEndian(bytes, at);
      type = bytes.substr(at + 4, 4);
      // gAMA holds 100000 times the exponent: 100000 declares linear values.
      if (type == "gAMA" && length == 4) check.saysLinear = bigEndian(bytes, at + 8) == 100000;
      at += 12 + length;
    }
  } else if (bytes.compare(0, 2, "\xff\xd8") == 0) {
    if (bytes.rfind("\xff\xd9") == std::string::npos) check.problem = "the JPEG is truncated";
  } else if (bytes.compare(0, 4, "\x76\x2f\x31\x01") == 0) {
    if (!isCompleteExr(bytes)) check.problem = "the EXR is truncated";
  }
  return check;
}

struct Decoded {
  cv::Mat pixels;  ///< 1 or 3 channels, RGB order, the file's own depth
  bool saysLinear = false;
};

Outcome<Decoded> decode(const fs::path& file, const Camera& camera) {
  // The library's own log would add lines to the one message that a problem gets.
  static const bool quiet = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  (void)quiet;
  std::string bytes;
  try {
    bytes = readFile(file);
  } catch (const InputError& e) {
    return Failure{Reason::FrameUnreadable, e.what()};
  }
  const FileCheck check = checkContainer(bytes);
  if (!check.problem.empty()) return unreadable(file, check.problem);
  Decoded decoded;
  decoded.saysLinear = check.saysLinear;
  try {
    const cv::Mat view(1, static_cast<int>(std::min<std::size_t>(bytes.size(), INT32_MAX)), CV_8U, bytes.data());
    decoded.pixels = cv::imdecode(view, cv::IMREAD_UNCHANGED);
  } catch (const std::exception&) {
    return unreadable(file, "the image cannot be decoded (truncated or damaged)");
  }
  cv::Mat& m = decoded.pixels;
  if (m.empty()) return unreadable(file, "the image cannot be decoded (not an image, truncated or damaged)");
  if (m.cols != camera.width || m.rows != camera.height)
    return unreadable(file, wrongSize(m.cols, m.rows, camera));
  if (m.channels() != 1 && m.channels() != 3 && m.channels() != 4)
    return unreadable(file, "the image has " + std::to_string(m.channels()) + " channels, expected 1, 3 or 4");
  if (m.channels() >= 3) {
    // Blue-green-red to red-green-blue; alpha is dropped.
    std::vector<cv::Mat> c;
    cv::split(m, c);
    cv::merge(std::vector<cv::Mat>{c[2], c[1], c[0]}, m);
  }
  return decoded;
}

bool isFloat(const cv::Mat& m) { return m.depth() == CV_32F || m.depth() == CV_64F; }

/// Every value through `map`, in the file's order.
Image toImage(const cv::Mat& m, const std::function<float(double)>& map) {
  Image image(m.cols, m.rows, m.channels());
  cv::Mat wide;
  m.convertTo(wide, CV_64F);
  float* out = image.data.data();
  for (int y = 0; y < wide.rows; ++y) {
    const double* row = wide.ptr<double>(y);
    for (int i = 0; i < wide.cols * wide.channels(); ++i) *out++ = map(row[i]);
  }
  return image;
}

Image floatImage(const cv::Mat& m) {
  cv::Mat f;
  m.convertTo(f, CV_32F);
  Image image(m.cols, m.rows, m.channels());
  const std::size_t rowSize = static_cast<std::size_t>(m.cols) * m.channels();
  for (int y = 0; y < f.rows; ++y) std::memcpy(image.data.data() + y * rowSize, f.ptr<float>(y), rowSize * sizeof(float));
  return image;
}

/// One value per code: 8- and 16-bit images have at most 65536.
Image throughTable(const cv::Mat& m, const std::function<double(double)>& curve) {
  const int largest = m.depth() == CV_8U ? 255 : 65535;
  std::vector<float> table(static_cast<std::size_t>(largest) + 1);
  for (int i = 0; i <= largest; ++i) table[static_cast<std::size_t>(i)] = static_cast<float>(curve(double(i) / largest));
  Image image(m.cols, m.rows, m.channels());
  float* out = image.data.data();
  for (int y = 0; y < m.rows; ++y) {
    for (int i = 0; i < m.cols * m.channels(); ++i)
      *out++ = table[m.depth() == CV_8U ? m.ptr<std::uint8_t>(y)[i] : m.ptr<std::uint16_t>(y)[i]];
  }
  return image;
}

bool isCode(const cv::Mat& m) { return m.depth() == CV_8U || m.depth() == CV_16U; }

Image threeChannels(const Image& image) {
  if (image.channels == 3) return image;
  Image out(image.width, image.height, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) out.data[3 * i + c] = image.data[i];
  return out;
}

/// Display copy of linear radiance: 99.9 % of the pixels below white, sRGB curve.
Image toneMapped(const Image& linear) {
  std::vector<float> values;
  for (const float v : linear.data)
    if (std::isfinite(v) && v > 0) values.push_back(v);
  double white = 1;
  if (!values.empty()) {
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(0.999 * double(values.size() - 1));
    std::nth_element(values.begin(), nth, values.end());
    white = *nth;
  }
  Image out = linear;
  for (float& v : out.data) v = std::isfinite(v) && v > 0 ? static_cast<float>(srgbFromLinear(std::min(1.0, v / white))) : 0.f;
  return threeChannels(out);
}

}  // namespace

Outcome<Image> readLinear(const Frame& frame, FrameSource source) {
  // Where only one of the two exists there is nothing to choose.
  const bool useRadiance = frame.image.empty() || (source == FrameSource::Radiance && !frame.radiance.empty());
  const fs::path& file = useRadiance ? frame.radiance : frame.image;
  if (file.empty()) return Failure{Reason::FrameUnreadable, "frame " + frame.id + " has neither radiance nor image"};
  Outcome<Decoded> decoded = decode(file, frame.camera);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = decoded->pixels;
  if (isFloat(m)) return floatImage(m);
  if (useRadiance) return unreadable(file, "radiance must be 32-bit float (give an 8- or 16-bit picture as image)");
  if (!isCode(m)) return unreadable(file, "the pixel type is not understood (8-bit, 16-bit or float)");
  if (m.depth() == CV_16U && decoded->saysLinear) return throughTable(m, [](double v) { return v; });
  return throughTable(m, linearFromSrgb);
}

Outcome<Image> readPhotograph(const Frame& frame) {
  if (frame.image.empty()) {
    const Outcome<Image> linear = readLinear(frame, FrameSource::Radiance);
    if (!linear) return linear.failure();
    return toneMapped(*linear);
  }
  Outcome<Decoded> decoded = decode(frame.image, frame.camera);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = decoded->pixels;
  if (isFloat(m)) return toneMapped(floatImage(m));
  if (!isCode(m)) return unreadable(frame.image, "the pixel type is not understood (8-bit, 16-bit or float)");
  if (m.depth() == CV_16U && decoded->saysLinear) return threeChannels(throughTable(m, srgbFromLinear));
  return threeChannels(throughTable(m, [](double v) { return v; }));
}

namespace {
std::string fileProblem(const fs::path& file, const Camera& camera) {
  if (file.empty()) return {};
  // What a TIFF's end must look like is not known without decoding it: that it is there is all that can be said.
  if (const std::string magic = firstBytes(file, 4); magic == std::string("II*\0", 4) || magic == std::string("MM\0*", 4))
    return {};
  try {
    const std::string bytes = readFile(file);
    const FileCheck check = checkContainer(bytes);
    if (!check.problem.empty()) return file.string() + ": " + check.problem;
    constexpr std::size_t kPngHeader = 24;  // signature 8, length and type of IHDR 8, width 4, height 4
    if (bytes.compare(0, 4, "\x89PNG") == 0 && bytes.size() >= kPngHeader) {
      const auto width = static_cast<int>(bigEndian(bytes, 16)), height = static_cast<int>(bigEndian(bytes, 20));
      if (width != camera.width || height != camera.height) return file.string() + ": " + wrongSize(width, height, camera);
    }
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}
}  // namespace

std::string frameFileProblem(const Frame& frame, FrameFile kind) {
  switch (kind) {
    case FrameFile::Depth:
      return fileProblem(frame.depth, frame.camera);
    case FrameFile::Normals:
      return fileProblem(frame.normals, frame.camera);
    case FrameFile::Mask:
      return fileProblem(frame.mask, frame.camera);
    case FrameFile::Photograph:
      break;
  }
  const std::string problem = fileProblem(frame.image, frame.camera);
  return problem.empty() ? fileProblem(frame.radiance, frame.camera) : problem;
}

Outcome<std::optional<Image>> readMask(const Frame& frame) {
  if (frame.mask.empty()) return std::optional<Image>();
  Outcome<Decoded> decoded = decode(frame.mask, frame.camera);
  if (!decoded) return decoded.failure();
  const Image all = toImage(decoded->pixels, [](double v) { return v != 0 ? 1.f : 0.f; });
  Image mask(all.width, all.height, 1);
  for (std::size_t i = 0; i < mask.data.size(); ++i)
    for (int c = 0; c < all.channels; ++c)
      mask.data[i] = std::max(mask.data[i], all.data[i * static_cast<std::size_t>(all.channels) + static_cast<std::size_t>(c)]);
  return std::optional<Image>(std::move(mask));
}

Outcome<std::optional<Image>> readDepth(const Frame& frame) {
  if (frame.depth.empty()) return std::optional<Image>();
  Outcome<Decoded> decoded = decode(frame.depth, frame.camera);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = decoded->pixels;
  if (m.channels() != 1)
    return unreadable(frame.depth, "a depth image has one channel, this one has " + std::to_string(m.channels()));
  if (!isFloat(m) && !(frame.depthScale > 0))
    return unreadable(frame.depth, "an integer depth image needs depth_scale (metres per unit)");
  const double scale = frame.depthScale > 0 ? frame.depthScale : 1.0;
  return std::optional<Image>(
      toImage(m, [&](double v) { return std::isfinite(v) && v > 0 ? static_cast<float>(v * scale) : 0.f; }));
}

Outcome<std::optional<Image>> readNormals(const Frame& frame) {
  if (frame.normals.empty()) return std::optional<Image>();
  Outcome<Decoded> decoded = decode(frame.normals, frame.camera);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = decoded->pixels;
  if (m.channels() != 3)
    return unreadable(frame.normals, "a normal image has three channels, this one has " + std::to_string(m.channels()));
  if (isFloat(m)) return std::optional<Image>(floatImage(m));
  if (m.depth() != CV_16U) return unreadable(frame.normals, "normals must be float or 16-bit");
  return std::optional<Image>(toImage(m, [](double v) { return static_cast<float>(v / 65532.0 * 2 - 1); }));
}

}  // namespace glint
