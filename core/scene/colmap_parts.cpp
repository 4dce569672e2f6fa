// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/colmap_parts.h"

#include <algorithm>
#include <limits>

#include "core/base/atomic_file.h"
#include "io/text_scan.h"

namespace glint::capture::colmap {
namespace fs = std::filesystem;
namespace {

/// The place in this list is the number of the model.
constexpr std::array<CameraModel, 18> kColmapModels{{
    {"SIMPLE_PINHOLE", true, 1, std::nullopt, 0},
    {"PINHOLE", true, 2, std::nullopt, 0},
    {"SIMPLE_RADIAL", true, 1, LensModel::SimpleRadial, 1},
    {"RADIAL", true, 1, LensModel::Radial, 2},
    {"OPENCV", true, 2, LensModel::OpenCv, 4},  // ours has a fifth, k3
    {"OPENCV_FISHEYE", true, 2, LensModel::OpenCvFisheye, 4},
    {"FULL_OPENCV", true, 2, LensModel::FullOpenCv, 8},
    {"FOV", true, 2, LensModel::Fov, 1},
    {"SIMPLE_RADIAL_FISHEYE", true, 1, LensModel::SimpleRadialFisheye, 1},
    {"RADIAL_FISHEYE", true, 1, LensModel::RadialFisheye, 2},
    {"THIN_PRISM_FISHEYE", true, 2, LensModel::ThinPrismFisheye, 8},
    {"RAD_TAN_THIN_PRISM_FISHEYE", false, 0, std::nullopt, 0},
    {"SIMPLE_DIVISION", false, 0, std::nullopt, 0},
    {"DIVISION", false, 0, std::nullopt, 0},
    {"SIMPLE_FISHEYE", false, 0, std::nullopt, 0},
    {"FISHEYE", false, 0, std::nullopt, 0},
    {"EUCM", false, 0, std::nullopt, 0},
    {"EQUIRECTANGULAR", false, 0, std::nullopt, 0},
}};

[[noreturn]] void refuseModel(const std::string& what, const std::string& file, const std::string& place) {
  throw InputError(
      file, place,
      "the camera model " + what + " is not supported ('colmap image_undistorter' makes images and a model without distortion)");
}

}  // namespace

bool Files::has(const char* stem) const {
  std::error_code ignored;  // unreadable counts as missing
  return fs::is_regular_file((*this)(stem), ignored);
}

const CameraModel& cameraModelOf(std::int64_t number, const std::string& file, const std::string& place) {
  if (number < 0 || number >= std::int64_t(kColmapModels.size())) refuseModel("number " + std::to_string(number), file, place);
  const CameraModel& model = kColmapModels[static_cast<std::size_t>(number)];
  if (!model.supported) refuseModel(model.name, file, place);
  return model;
}

const CameraModel& cameraModelOf(std::string_view name, const std::string& file, const std::string& place) {
  const auto found = std::find_if(kColmapModels.begin(), kColmapModels.end(), [&](const auto& m) { return m.name == name; });
  if (found == kColmapModels.end() || !found->supported) refuseModel(io::quoted(name), file, place);
  return *found;
}

ModelCamera cameraOf(std::uint32_t id, const CameraModel& model, std::uint64_t width, std::uint64_t height,
                     const std::vector<double>& parameters, const std::string& file, const std::string& place) {
  require(parameters.size() == std::size_t(model.parameters()), "colmap::cameraOf: number of parameters");
  constexpr std::uint64_t kMost = std::numeric_limits<int>::max();  // cameraOf refuses far smaller ones
  Lens lens;
  if (model.lens) lens.model = *model.lens;
  std::copy(parameters.end() - model.lensParameters, parameters.end(), lens.parameters.begin());
  const double* centre = parameters.data() + model.focalLengths;
  return {id, model.name,
          capture::cameraOf(int(std::min(width, kMost)), int(std::min(height, kMost)), parameters.front(), centre[-1],
                            centre[0] + kFromCorner, centre[1] + kFromCorner, lens, file, place)};
}

Eigen::Isometry3d poseOf(const std::array<double, 7>& values, const std::string& file, const std::string& place,
                         std::vector<std::string>& warnings) {
  const auto& [w, x, y, z, tx, ty, tz] = values;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = unitQuaternion(w, x, y, z, file, place, warnings).toRotationMatrix();
  pose.translation() = pointAt(tx, ty, tz, file, [&] { return place; });
  return pose;
}

std::string checkedName(std::string_view name, const std::string& file, const std::string& place) {
  constexpr std::size_t kLongest = 4096;  // bytes, of a path on Linux
  if (name.empty()) throw InputError(file, place, "the name of the image is missing");
  if (name.size() > kLongest)
    throw InputError(file, place, "the name of the image has " + std::to_string(name.size()) + " bytes; a path has at most 4096");
  const auto isControl = [](unsigned char c) { return c < ' ' || c == 0x7f; };
  if (std::any_of(name.begin(), name.end(), isControl))
    throw InputError(file, place, "the name of the image " + io::quoted(name) + " contains a control character");
  return std::string(name);
}

std::string byteNo(std::size_t byte) { return "byte " + std::to_string(byte); }
std::string lineNo(std::size_t line) { return "line " + std::to_string(line); }

std::string counted(std::size_t number, const std::string& noun, const std::string& nouns) {
  return std::to_string(number) + " " + (number == 1 ? noun : nouns.empty() ? noun + "s" : nouns);
}

void addWarnings(const std::vector<std::string>& lines, std::vector<std::string>& warnings) {
  constexpr std::size_t kMost = 8;  // as many as a person reads
  warnings.insert(warnings.end(), lines.begin(), lines.begin() + std::ptrdiff_t(std::min(lines.size(), kMost)));
  if (lines.size() > kMost) warnings.push_back("and " + std::to_string(lines.size() - kMost) + " more such warnings");
}

std::string_view Bytes::takeText() {
  const std::size_t end = bytes_.find('\0', at_);
  if (end == std::string_view::npos) truncated();
  const std::string_view text = bytes_.substr(at_, end - at_);
  at_ = end + 1;
  return text;
}

void Bytes::end() const {
  const std::size_t more = bytes_.find_first_not_of(std::string_view("\0\n\r ", 4), at_);  // padding
  if (more != std::string_view::npos) throw InputError(file_, byteNo(more), "unexpected data after the last element");
}

std::optional<std::uint32_t> number32(std::string_view word) {
  const std::optional<std::int64_t> value = io::integerOf(word);
  if (!value || *value < 0 || *value > std::int64_t(std::numeric_limits<std::uint32_t>::max())) return std::nullopt;
  return static_cast<std::uint32_t>(*value);
}

namespace {
bool isSameCamera(const ModelCamera& a, const ModelCamera& b) {
  return a.model == b.model && a.camera.width == b.camera.width && a.camera.height == b.camera.height &&
         a.camera.pixelFromRay == b.camera.pixelFromRay && a.camera.lens.model == b.camera.lens.model &&
         a.camera.lens.parameters == b.camera.lens.parameters;
}
}  // namespace

std::vector<ModelCamera> readCameras(const Files& files, std::vector<std::string>& warnings) {
  const fs::path file = files("cameras");
  const std::string bytes = readFile(file, Limit::MeshMegabytes);
  std::vector<ModelCamera> cameras =
      files.binary ? readCamerasBinary(bytes, file.string()) : readCamerasText(bytes, file.string(), warnings);
  if (cameras.empty()) throw InputError(file.string(), "", "contains no camera");
  std::unordered_map<std::uint32_t, const ModelCamera*> first;
  std::vector<ModelCamera> once;
  once.reserve(cameras.size());
  for (const ModelCamera& c : cameras)
    if (const auto [before, isNew] = first.emplace(c.id, &c); isNew || !isSameCamera(*before->second, c)) once.push_back(c);
  return once;
}

namespace {
bool isSameImage(const ModelImage& a, const ModelImage& b, std::string_view bytes) {
  return a.camera == b.camera && a.name == b.name && a.lost == b.lost && a.camFromWorld.matrix() == b.camFromWorld.matrix() &&
         bytes.substr(a.from, a.size) == bytes.substr(b.from, b.size);
}
}  // namespace

std::vector<ModelImage> readImages(const Files& files, std::string_view bytes, std::vector<std::string>& warnings) {
  const std::string file = files("images").string();
  std::vector<ModelImage> images = files.binary ? readImagesBinary(bytes, file, warnings) : readImagesText(bytes, file, warnings);
  if (images.empty()) throw InputError(file, "", "contains no image");
  std::unordered_map<std::uint32_t, const ModelImage*> first;
  PassedOver repeated;
  std::vector<ModelImage> once;
  once.reserve(images.size());
  for (ModelImage& image : images) {
    const auto before = first.find(image.id);
    const bool again = before != first.end() && isSameImage(*before->second, image, bytes);
    if (again) {
      repeated.add(image.place);
      continue;
    }
    once.push_back(std::move(image));
    first.emplace(once.back().id, &once.back());  // reserved: it does not move
  }
  repeated.tell(fs::path(file).filename().string(), kSaidBefore, warnings);
  return once;
}

std::vector<Pixel> pixelsOf(const Files& files, std::string_view bytes, const ModelImage& image) {
  const std::string file = files("images").string();
  return files.binary ? pixelsOfBinary(bytes, image, file) : pixelsOfText(bytes, image, file);
}

void readPoints(const Files& files, std::vector<std::string>& warnings, const EachPoint& each) {
  const fs::path file = files("points3D");
  const std::string bytes = readFile(file, Limit::MeshMegabytes);
  files.binary ? readPointsBinary(bytes, file.string(), each) : readPointsText(bytes, file.string(), warnings, each);
}

}  // namespace glint::capture::colmap
