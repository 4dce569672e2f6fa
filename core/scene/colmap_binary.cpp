// SPDX-License-Identifier: BSD-3-Clause
#include <array>

#include "core/scene/colmap_parts.h"

// cameras.bin, images.bin and points3D.bin. Each begins with the number of its elements, 64 bits.

namespace glint::capture::colmap {
namespace {

constexpr std::size_t kPixelBytes = 2 * sizeof(double) + sizeof(std::uint64_t);  // x, y, number of the point

}  // namespace

std::vector<ModelCamera> readCamerasBinary(std::string_view bytes, const std::string& file) {
  constexpr std::size_t kLeast = 2 * sizeof(std::uint32_t) + 2 * sizeof(std::uint64_t) + 3 * sizeof(double);  // SIMPLE_PINHOLE
  Bytes in(bytes, file);
  std::vector<ModelCamera> cameras;
  for (std::size_t left = in.takeCount<std::uint64_t>(kLeast, "cameras"); left > 0; --left) {
    const std::string place = in.place();
    const auto id = in.take<std::uint32_t>();
    const CameraModel& model = cameraModelOf(std::int64_t(in.take<std::int32_t>()), file, place);
    const auto width = in.take<std::uint64_t>(), height = in.take<std::uint64_t>();
    std::vector<double> parameters(std::size_t(model.parameters()));
    for (double& p : parameters) p = in.take<double>();
    cameras.push_back(cameraOf(id, model, width, height, parameters, file, place));
  }
  in.end();
  return cameras;
}

std::vector<ModelImage> readImagesBinary(std::string_view bytes, const std::string& file, std::vector<std::string>& warnings) {
  constexpr std::size_t kLeast = 2 * sizeof(std::uint32_t) + 7 * sizeof(double) + 2 + sizeof(std::uint64_t);  // name of a letter
  Bytes in(bytes, file);
  std::vector<ModelImage> images;
  for (std::size_t left = in.takeCount<std::uint64_t>(kLeast, "images"); left > 0; --left) {
    ModelImage image;
    image.place = in.place();
    image.id = in.take<std::uint32_t>();
    const std::array<double, 7> pose = in.takeDoubles<7>();
    image.lost = anyNotFinite(pose);
    if (!image.lost) image.camFromWorld = poseOf(pose, file, image.place, warnings);
    image.camera = in.take<std::uint32_t>();
    image.name = checkedName(in.takeText(), file, image.place);
    image.pixels = in.takeCount<std::uint64_t>(kPixelBytes, "2D points of an image");
    image.from = in.at();
    image.size = image.pixels * kPixelBytes;
    in.skip(image.size);
    images.push_back(std::move(image));
  }
  in.end();
  return images;
}

std::vector<Pixel> pixelsOfBinary(std::string_view bytes, const ModelImage& image, const std::string& file) {
  std::vector<Pixel> pixels;
  pixels.reserve(image.pixels);
  for (std::size_t i = 0; i < image.pixels; ++i) {
    const std::size_t at = image.from + i * kPixelBytes;
    const auto x = io::valueAt<double>(bytes.data() + at, false), y = io::valueAt<double>(bytes.data() + at + sizeof x, false);
    pixels.push_back(pixelAt(x, y, file, [at] { return byteNo(at); }));
  }
  return pixels;
}

void readPointsBinary(std::string_view bytes, const std::string& file, const EachPoint& each) {
  constexpr std::size_t kColourBytes = 3;
  constexpr std::size_t kLeast = 2 * sizeof(std::uint64_t) + 4 * sizeof(double) + kColourBytes;
  Bytes in(bytes, file);
  const auto count = in.takeCount<std::uint64_t>(kLeast, "points");
  std::vector<TrackEntry> track;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = in.at();
    in.skip(sizeof(std::uint64_t));  // its number
    const auto [x, y, z] = in.takeDoubles<3>();
    const Eigen::Vector3d point = pointAt(x, y, z, file, [at] { return byteNo(at); });
    in.skip(kColourBytes + sizeof(double));  // and its error
    track.resize(in.takeCount<std::uint64_t>(2 * sizeof(std::uint32_t), "entries of a track"));
    for (TrackEntry& entry : track) {
      entry.image = in.take<std::uint32_t>();
      entry.pixel = in.take<std::uint32_t>();
    }
    each(point, track);
  }
  in.end();
}

}  // namespace glint::capture::colmap
