// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <opencv2/core.hpp>

#include "core/base/atomic_file.h"
#include "core/base/image.h"
#include "core/base/image_header.h"
#include "core/base/limits.h"
#include "core/base/memory.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/scene/decoded_images.h"
#include "core/scene/image_decode.h"
#include "core/scene/image_scale.h"
#include "core/scene/scene.h"
#include "core/scene/scene_files.h"
#include "core/surface/depth_images.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

Failure unreadable(const fs::path& file, const std::string& reason) {
  return Failure{Reason::FrameUnreadable, file.string() + ": " + reason};
}

std::string wrongSize(std::uint64_t width, std::uint64_t height, const Camera& camera) {
  constexpr std::uint64_t kMost = 65536;  // px
  const std::optional<double> scale =
      width > kMost || height > kMost ? std::nullopt : imageScale(int(width), int(height), camera);
  return "the image has " + std::to_string(width) + " x " + std::to_string(height) + " pixels, the camera " +
         std::to_string(camera.width) + " x " + std::to_string(camera.height) +
         (scale ? formatted(" (resized photographs: glint convert INPUT --fix image-scale=%.10g fits the cameras)", *scale) : "");
}

/// The EXIF orientation with which the picture has the camera's size, where that takes a quarter turn; 1 = none. OpenCV, which
/// calibrates, turns such pictures; COLMAP does not, and its cameras have the size of the stored pixels.
int orientationThatFits(const std::string& bytes, const ImageHeader& header, const Camera& camera) {
  constexpr int kFirstOfQuarterTurns = 5;
  if (header.width != static_cast<std::uint64_t>(camera.height) || header.height != static_cast<std::uint64_t>(camera.width) ||
      header.width == header.height)
    return 1;
  const int orientation = exifOrientation(bytes);
  return orientation >= kFirstOfQuarterTurns ? orientation : 1;
}

/// The pixels as a viewer shows them.
cv::Mat turnedBy(int orientation, const cv::Mat& stored) {
  if (orientation == 1) return stored;
  cv::Mat turned;
  cv::transpose(stored, turned);  // orientation 5
  constexpr int kRight = 6, kBoth = 7, kLeft = 8;
  if (orientation == kRight) cv::flip(turned, turned, 1);
  if (orientation == kBoth) cv::flip(turned, turned, -1);
  if (orientation == kLeft) cv::flip(turned, turned, 0);
  return turned;
}

/// What is wrong with a file as far as its header tells; "" = nothing.
std::string headerProblem(const std::string& bytes, const ImageHeader& header, const Camera& camera) {
  if (!header.problem.empty()) return header.problem;
  if ((header.width != static_cast<std::uint64_t>(camera.width) || header.height != static_cast<std::uint64_t>(camera.height)) &&
      orientationThatFits(bytes, header, camera) == 1)
    return wrongSize(header.width, header.height, camera);
  constexpr int kMostChannels = 4;
  if (header.channels > kMostChannels)
    return "the image has " + std::to_string(header.channels) + " channels, expected 1, 3 or 4";
  return "";
}

constexpr double kMega = 1e6;

Outcome<DecodedImage> decodeFile(const fs::path& file, const Camera& camera) {
  std::string bytes;
  ImageHeader header;
  try {
    bytes = readFile(file, Limit::ImageMegabytes);
    header = readImageHeader(bytes);
    if (const std::string problem = headerProblem(bytes, header, camera); !problem.empty()) return unreadable(file, problem);
    const double megapixels = double(header.width) * double(header.height) / kMega;
    requireWithin(Limit::ImageMegapixels, megapixels, file.string());
    requireRoomForImage(megapixels, file.string());
    expectImages(megapixels);
  } catch (const InputError& e) {
    return Failure{Reason::FrameUnreadable, e.what()};
  }
  countDecoded();
  Outcome<cv::Mat> pixels = decodeImage(bytes, header);
  if (!pixels) return unreadable(file, pixels.failure().detail);
  const int orientation = orientationThatFits(bytes, header, camera);
  return DecodedImage{std::make_shared<const cv::Mat>(turnedBy(orientation, *pixels)), header.saysLinear, orientation,
                      header.severalChannels};
}

/// What an earlier read of the same file found. Nothing beyond a limit that was lowered since.
std::optional<DecodedImage> keptImage(const fs::path& name, const FileVersion& version) {
  std::optional<DecodedImage> kept = decodedImages().find(name, version);
  if (!kept || double(version.bytes) / kMega > limitOf(Limit::ImageMegabytes) ||
      double(kept->pixels->total()) / kMega > limitOf(Limit::ImageMegapixels))
    return std::nullopt;
  return kept;
}

/// @param name  by which it is kept: the file, and which picture of a video
/// @param read  decodes it
Outcome<DecodedImage> decodeOnce(const fs::path& file, const fs::path& name, const Camera& camera,
                                 const std::function<Outcome<DecodedImage>()>& read) {
  const std::optional<FileVersion> version = decodedImages().keeps(name) ? versionOf(file) : std::nullopt;
  std::optional<DecodedImage> image = version ? keptImage(name, *version) : std::nullopt;
  const auto hasSize = [&camera](const cv::Mat& m) { return m.cols == camera.width && m.rows == camera.height; };
  if (!image || !hasSize(*image->pixels)) {  // one that is kept may be turned for a camera of another size
    Outcome<DecodedImage> now = read();
    if (!now) return now.failure();
    if (version) decodedImages().keep(name, *version, *now);
    image = *std::move(now);
  }
  const cv::Mat& m = *image->pixels;
  if (!hasSize(m))  // a decoder may know better than the header
    return unreadable(file, wrongSize(static_cast<std::uint64_t>(m.cols), static_cast<std::uint64_t>(m.rows), camera));
  return *std::move(image);
}

Outcome<DecodedImage> decode(const fs::path& file, const Camera& camera) {
  return decodeOnce(file, file, camera, [&] { return decodeFile(file, camera); });
}

/// The picture of a frame. All decoders give 8 bits of a video.
Outcome<DecodedImage> decode(const Frame& frame, const fs::path& file) {
  if (!frame.ofVideo || file != frame.image) return decode(file, frame.camera);
  const auto read = [&]() -> Outcome<DecodedImage> {
    countDecoded();
    const Outcome<cv::Mat> pixels = videoPicture(file, *frame.ofVideo);
    if (!pixels) return pixels.failure();
    return DecodedImage{std::make_shared<const cv::Mat>(*pixels), false};
  };
  return decodeOnce(file, pictureName(file, *frame.ofVideo), frame.camera, read);
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

template <class Code>
void lookUp(const cv::Mat& codes, const std::vector<float>& table, Image& image) {
  const std::size_t channels = static_cast<std::size_t>(codes.channels());
  float* out = image.data.data();
  for (int y = 0; y < codes.rows; ++y) {
    const Code* code = codes.ptr<Code>(y);
    for (int x = 0; x < codes.cols; ++x)
      for (std::size_t c = 0; c < channels; ++c) *out++ = table[*code++ * channels + c];
  }
}

/// One value per code: 8- and 16-bit images have at most 65536.
/// @param curve  of a code in 0..1 and its channel
Image throughTable(const cv::Mat& m, const std::function<double(double, int)>& curve) {
  const int largest = m.depth() == CV_8U ? 255 : 65535, channels = m.channels();
  std::vector<float> table;
  for (int i = 0; i <= largest; ++i)
    for (int c = 0; c < channels; ++c) table.push_back(static_cast<float>(curve(double(i) / largest, c)));
  Image image(m.cols, m.rows, channels);
  if (m.depth() == CV_8U)
    lookUp<std::uint8_t>(m, table, image);
  else
    lookUp<std::uint16_t>(m, table, image);
  return image;
}

/// 1 where a channel of an 8-bit image is not 0, else 0.
Image notZero(const cv::Mat& codes) {
  Image mask(codes.cols, codes.rows, 1);
  float* out = mask.data.data();
  for (int y = 0; y < codes.rows; ++y) {
    const std::uint8_t* code = codes.ptr<std::uint8_t>(y);
    for (int x = 0; x < codes.cols; ++x, code += codes.channels())
      *out++ = std::any_of(code, code + codes.channels(), [](std::uint8_t c) { return c != 0; }) ? 1.f : 0.f;
  }
  return mask;
}

/// The values where no response is stated.
bool takenAsLinear(const DecodedImage& d) { return d.pixels->depth() == CV_16U && d.saysLinear; }

std::string howLinear(const Frame& frame, const DecodedImage& d) {
  if (d.orientation != 1) {
    DecodedImage stored = d;
    stored.orientation = 1;
    return howLinear(frame, stored) + "; turned by its EXIF orientation " + std::to_string(d.orientation) +
           ", with which the sizes agree";
  }
  if (isFloat(*d.pixels))
    return frame.response.isStated() ? "float values as stored (the response is of codes)" : "float values as stored";
  return std::string(d.pixels->depth() == CV_8U ? "8-bit codes " : "16-bit codes ") + frame.response.words(takenAsLinear(d)) +
         (frame.response.isStated() ? " (stated)"
          : takenAsLinear(d)        ? ""
                                    : " (default: no response is stated)");
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
  if (!values.empty()) white = ranked(values, static_cast<std::size_t>(0.999 * double(values.size() - 1)));
  Image out = linear;
  for (float& v : out.data) v = std::isfinite(v) && v > 0 ? static_cast<float>(srgbFromLinear(std::min(1.0, v / white))) : 0.f;
  return threeChannels(out);
}

}  // namespace

namespace {
/// How opaque the pixels of a photograph are, as the file has it; empty where it does not say, or nothing that can be read.
cv::Mat alphaIn(const Frame& frame) {
  try {
    const std::string bytes = readFile(frame.image, Limit::ImageMegabytes);
    const ImageHeader header = readImageHeader(bytes);
    const bool mayHaveAlpha = header.channels == 2 || header.channels == 4;
    if (!mayHaveAlpha || header.format == ImageFormat::Jpeg || !headerProblem(bytes, header, frame.camera).empty()) return {};
    countDecoded();
    const Outcome<cv::Mat> alpha = decodeAlpha(bytes);
    return alpha ? turnedBy(orientationThatFits(bytes, header, frame.camera), *alpha) : cv::Mat();
  } catch (const InputError&) {
    return {};  // who reads the photograph says so
  }
}

/// A cut-out: what colour its transparent pixels have is arbitrary, so they are outside. Nothing where all is opaque.
std::optional<Image> opaquePart(const Frame& frame) {
  if (frame.image.empty() || frame.ofVideo || !frame.radiance.empty()) return std::nullopt;
  const fs::path name = alphaName(frame.image);
  const std::optional<FileVersion> version = decodedImages().keeps(name) ? versionOf(frame.image) : std::nullopt;
  std::optional<DecodedImage> read = version ? keptImage(name, *version) : std::nullopt;
  if (!read) {
    read = DecodedImage{std::make_shared<const cv::Mat>(alphaIn(frame))};
    if (version) decodedImages().keep(name, *version, *read);
  }
  const cv::Mat& alpha = *read->pixels;
  if (alpha.empty() || !isCode(alpha) || alpha.cols != frame.camera.width || alpha.rows != frame.camera.height)
    return std::nullopt;
  const Image mask = toImage(alpha, [](double v) { return v != 0 ? 1.f : 0.f; });
  if (std::all_of(mask.data.begin(), mask.data.end(), [](float v) { return v != 0; })) return std::nullopt;
  return mask;
}

void undoVignetting(Image& image, const CameraResponse& response) {
  float* value = image.data.data();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < image.channels; ++c, ++value)
        *value = static_cast<float>(response.withoutVignetting(*value, x, y, image.width, image.height));
}

/// @param opaqueOf  says opaquePart(frame)
Outcome<Image> linearOf(const Frame& frame, FrameSource source, std::string* how,
                        const std::function<std::optional<Image>()>& opaqueOf) {
  // Where only one of the two exists there is nothing to choose.
  const bool useRadiance = frame.image.empty() || (source == FrameSource::Radiance && !frame.radiance.empty());
  const fs::path& file = useRadiance ? frame.radiance : frame.image;
  if (file.empty()) return Failure{Reason::FrameUnreadable, "frame " + frame.id + " has neither radiance nor image"};
  Outcome<DecodedImage> decoded = decode(frame, file);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = *decoded->pixels;
  if (how) *how = howLinear(frame, *decoded);
  if (isFloat(m)) return floatImage(m);
  if (useRadiance) return unreadable(file, "radiance must be 32-bit float (give an 8- or 16-bit picture as image)");
  if (!isCode(m)) return unreadable(file, "the pixel type is not supported (8-bit, 16-bit or float)");
  Image image = throughTable(
      m, [&frame, linear = takenAsLinear(*decoded)](double v, int c) { return frame.response.lightOf(v, c, linear); });
  if (frame.response.vignetting() > 0) undoVignetting(image, frame.response);
  // Hidden colours are arbitrary, and a blur or an edge would bring them in: transparent pixels are dark.
  if (const std::optional<Image> opaque = useRadiance ? std::nullopt : opaqueOf())
    for (std::size_t i = 0; i < image.data.size(); ++i)
      if (opaque->data[i / static_cast<std::size_t>(image.channels)] == 0) image.data[i] = 0;
  return image;
}
}  // namespace

Outcome<Image> readLinear(const Frame& frame, FrameSource source, std::string* how) {
  return linearOf(frame, source, how, [&] { return opaquePart(frame); });
}

Outcome<MaskedImage> readMasked(const Frame& frame, FrameSource source) {
  std::optional<std::optional<Image>> opaque;
  const auto opaqueOnce = [&] {
    if (!opaque) opaque = opaquePart(frame);
    return *opaque;
  };
  Outcome<Image> linear = linearOf(frame, source, nullptr, opaqueOnce);
  if (!linear) return linear.failure();
  Outcome<std::optional<Image>> mask = frame.mask.empty() ? opaqueOnce() : readMask(frame);
  if (!mask) return mask.failure();
  return MaskedImage{*std::move(linear), *std::move(mask)};
}

Outcome<Image> readPhotograph(const Frame& frame) {
  if (frame.image.empty()) {
    const Outcome<Image> linear = readLinear(frame, FrameSource::Radiance);
    if (!linear) return linear.failure();
    return toneMapped(*linear);
  }
  Outcome<DecodedImage> decoded = decode(frame, frame.image);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = *decoded->pixels;
  if (isFloat(m)) return toneMapped(floatImage(m));
  if (!isCode(m)) return unreadable(frame.image, "the pixel type is not supported (8-bit, 16-bit or float)");
  const CameraResponse& response = frame.response;
  const bool linear = takenAsLinear(*decoded);
  if (response.kind() == CameraResponse::Kind::Srgb || (!response.isStated() && !linear))
    return threeChannels(throughTable(m, [](double v, int) { return v; }));
  return threeChannels(throughTable(m, [&](double v, int c) { return srgbFromLinear(response.lightOf(v, c, linear)); }));
}

namespace {
std::string fileProblem(const fs::path& file, const Camera& camera) {
  if (file.empty()) return {};
  try {
    const std::string bytes = readFile(file, Limit::ImageMegabytes);
    const std::string problem = headerProblem(bytes, readImageHeader(bytes), camera);
    if (!problem.empty()) return file.string() + ": " + problem;
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

/// The frame's own depth camera; else, for a depth map of lower or higher resolution, the photograph's camera in that resolution.
/// Nothing where the depth is that of the photograph's camera, or cannot be read.
std::optional<Camera> depthCameraOf(const Frame& frame) {
  if (frame.depthCamera || frame.depth.empty()) return frame.depthCamera;
  try {
    const ImageHeader header = readImageHeader(readFile(frame.depth, Limit::ImageMegabytes));
    constexpr std::uint64_t kMost = 65536;  // px
    if (!header.problem.empty() || header.width > kMost || header.height > kMost) return std::nullopt;
    const int width = int(header.width), height = int(header.height);
    if (!imageScale(width, height, frame.camera)) return std::nullopt;
    Camera camera = resized(frame.camera, width, height);
    camera.camFromWorld.setIdentity();  // from the frame's camera
    return camera;
  } catch (const InputError&) {
    return std::nullopt;  // it is said where the file is read
  }
}
}  // namespace

std::string frameFileProblem(const Frame& frame, FrameFile kind) {
  switch (kind) {
    case FrameFile::Depth: return fileProblem(frame.depth, depthCameraOf(frame).value_or(frame.camera));
    case FrameFile::Normals: return fileProblem(frame.normals, frame.camera);
    case FrameFile::Mask: return fileProblem(frame.mask, frame.camera);
    case FrameFile::Photograph: break;
  }
  if (frame.ofVideo)  // its pictures are looked at when they are decoded: that takes a pass over the video
    return looksLikeVideo(frame.image) ? "" : frame.image.string() + ": is missing or no video";
  const std::string problem = fileProblem(frame.image, frame.camera);
  return problem.empty() ? fileProblem(frame.radiance, frame.camera) : problem;
}

Outcome<std::optional<Image>> readMask(const Frame& frame) {
  if (frame.mask.empty()) return opaquePart(frame);
  Outcome<DecodedImage> decoded = decode(frame.mask, frame.camera);
  if (!decoded) return decoded.failure();
  const cv::Mat& codes = *decoded->pixels;
  if (codes.depth() == CV_8U) return std::optional<Image>(notZero(codes));
  const Image all = toImage(codes, [](double v) { return v != 0 ? 1.f : 0.f; });
  Image mask(all.width, all.height, 1);
  for (std::size_t i = 0; i < mask.data.size(); ++i)
    for (int c = 0; c < all.channels; ++c)
      mask.data[i] = std::max(mask.data[i], all.data[i * static_cast<std::size_t>(all.channels) + static_cast<std::size_t>(c)]);
  return std::optional<Image>(std::move(mask));
}

namespace {
/// The depth in a picture: its only channel, the depth channel of an EXR file with colours, or one of three equal channels
/// (programs that can only write pictures write those).
Outcome<cv::Mat> depthChannel(const fs::path& file, const DecodedImage& image) {
  const cv::Mat& picture = *image.pixels;
  std::string reason = "a depth image has one channel; this one has " + std::to_string(picture.channels());
  if (image.hasOthers) {
    try {
      Outcome<cv::Mat> depth = decodeDepth(readFile(file, Limit::ImageMegabytes));
      if (depth && depth->size() == picture.size()) return depth;
      if (!depth) reason = depth.failure().detail;
    } catch (const InputError& e) {
      return Failure{Reason::FrameUnreadable, e.what()};
    }
  }
  if (picture.channels() == 1) return picture;
  std::vector<cv::Mat> channels;
  cv::split(picture, channels);
  const auto differs = [&](const cv::Mat& c) { return cv::norm(c, channels[0], cv::NORM_INF) != 0; };
  if (std::none_of(channels.begin(), channels.end(), differs)) return channels[0];
  return unreadable(file, reason);
}
}  // namespace

Outcome<std::optional<Image>> readDepth(const Frame& frame) {
  if (frame.depth.empty()) return std::optional<Image>();
  std::optional<Camera> depthCamera = frame.depthCamera;
  Outcome<DecodedImage> decoded = decode(frame.depth, depthCamera.value_or(frame.camera));
  if (!decoded && !depthCamera) {
    depthCamera = depthCameraOf(frame);
    if (depthCamera) decoded = decode(frame.depth, *depthCamera);
  }
  if (!decoded) return decoded.failure();
  const Outcome<cv::Mat> single = depthChannel(frame.depth, *decoded);
  if (!single) return single.failure();
  const cv::Mat& m = *single;
  if (!isFloat(m) && !(frame.depthScale > 0))
    return unreadable(frame.depth, "an integer depth image needs depth_scale (metres per unit)");
  const double scale = frame.depthScale > 0 ? frame.depthScale : 1.0;
  Image depth = toImage(m, [&](double v) { return std::isfinite(v) && v > 0 ? static_cast<float>(v * scale) : 0.f; });
  if (depthCamera) depth = registeredDepth(depth, *depthCamera, frame.camera);
  return std::optional<Image>(std::move(depth));
}

Outcome<std::optional<Image>> readDepth(const Frame& frame, const DepthPolicy& policy) {
  Outcome<std::optional<Image>> depth = readDepth(frame);
  if (!depth || !*depth || policy.noise == 0) return depth;
  unsigned seed = 2166136261u;  // FNV-1a: the same on every machine
  for (const unsigned char c : frame.id) seed = (seed ^ c) * 16777619u;
  addKinectNoise(**depth, policy.noise, seed + 7919u * static_cast<unsigned>(policy.seed));
  return depth;
}

Outcome<std::optional<Image>> readNormals(const Frame& frame) {
  if (frame.normals.empty()) return std::optional<Image>();
  Outcome<DecodedImage> decoded = decode(frame.normals, frame.camera);
  if (!decoded) return decoded.failure();
  const cv::Mat& m = *decoded->pixels;
  if (m.channels() != 3)
    return unreadable(frame.normals, "a normal image has three channels; this one has " + std::to_string(m.channels()));
  if (isFloat(m)) return std::optional<Image>(floatImage(m));
  if (m.depth() != CV_16U) return unreadable(frame.normals, "normals must be float or 16-bit");
  return std::optional<Image>(toImage(m, [](double v) { return static_cast<float>(v / 65532.0 * 2 - 1); }));
}

}  // namespace glint
