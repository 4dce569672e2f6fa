// SPDX-License-Identifier: BSD-3-Clause
#include "core/capture/parts.h"

#include <algorithm>
#include <cmath>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/image_header.h"
#include "core/base/number_text.h"
#include "io/text_scan.h"

namespace glint::capture {
namespace fs = std::filesystem;

Eigen::Quaterniond unitQuaternion(double w, double x, double y, double z, const std::string& file, const std::string& place,
                                  std::vector<std::string>& warnings) {
  constexpr double kTyped = 1e-3;  // three digits: fewer were not meant as a rotation
  const Eigen::Vector4d q(w, x, y, z);
  const double length = q.stableNorm();
  if (!std::isfinite(length) || !(length > 0)) throw InputError(file, place, "the quaternion of the rotation must not be zero");
  if (std::abs(length - 1) > kTyped)
    warnings.push_back(place + ": the quaternion of the rotation has length " + formatted("%.4g", length) + ", normalised");
  const Eigen::Vector4d u = q / length;
  return Eigen::Quaterniond(u[0], u[1], u[2], u[3]).normalized();
}

double bounded(double value, double most, const std::string& file, const std::string& place) {
  if (!std::isfinite(value)) throw InputError(file, place, "is not a finite number");
  if (!(std::abs(value) <= most)) throw InputError(file, place, formatted("%.3g is larger than %.0e in size", value, most));
  return value;
}

Camera cameraOf(int width, int height, double fx, double fy, double cx, double cy, const Lens& lens, const std::string& file,
                const std::string& place) {
  constexpr int kMost = 65536;  // px
  if (width < 1 || height < 1 || width > kMost || height > kMost)
    throw InputError(file, place, formatted("an image of %d x %d pixels is not supported: 1 .. 65536 are", width, height));
  constexpr double kMega = 1e6;
  requireWithin(Limit::ImageMegapixels, double(width) * height / kMega, file, place);
  Camera camera;
  camera.width = width;
  camera.height = height;
  // One by one: a failure inside a comma initialiser would leave it unfinished, and its destructor asserts.
  camera.pixelFromRay(0, 0) = bounded(fx, kFarthestPx, file, place);
  camera.pixelFromRay(1, 1) = bounded(fy, kFarthestPx, file, place);
  camera.pixelFromRay(0, 2) = bounded(cx, kFarthestPx, file, place);
  camera.pixelFromRay(1, 2) = bounded(cy, kFarthestPx, file, place);
  if (!(fx > 0) || !(fy > 0))
    throw InputError(file, place, formatted("the focal length must be positive, not %.4g", std::min(fx, fy)));
  for (const double p : lens.parameters) bounded(p, kLargestFactor, file, place);
  camera.lens = lens;
  return camera;
}

fs::path imagePlace(const std::string& name, const std::vector<fs::path>& folders, const CaptureOptions& options,
                    const std::string& file, const std::string& place) {
  require(!folders.empty(), "imagePlace: no folder");
  std::error_code ignored;  // what cannot be asked about is not there
  fs::path below;           // the name without what leads out of a folder that a person named
  for (const fs::path& part : fs::path(name).relative_path())
    if (part != "..") below /= part;
  for (const fs::path& folder : options.photographs)
    if (fs::path found = sameUnder(fs::absolute(folder), below); !found.empty()) return found;
  const fs::path first = resolveInside(folders.front(), name, options.rights, file, place);
  for (const fs::path& folder : folders)
    if (const fs::path p = resolveInside(folder, name, options.rights, file, place); fs::is_regular_file(p, ignored)) return p;
  return first;
}

std::array<int, 2> sizeOfImage(const fs::path& image, const std::string& file, const std::string& place) {
  std::error_code ignored;  // what cannot be asked about is not there
  if (!fs::is_regular_file(image, ignored))
    throw InputError(file, place,
                     "does not say the size of its image, and there is no '" + image.string() +
                         "' (--photographs names the folder of the images)");
  const ImageHeader header = readImageHeader(readFile(image, Limit::ImageMegabytes));
  constexpr std::uint64_t kMost = 65536;  // px
  if (!header.problem.empty()) throw InputError(image.string(), "", header.problem);
  if (header.width < 1 || header.height < 1 || header.width > kMost || header.height > kMost)
    throw InputError(image.string(), "", "its size is not supported: 1 .. 65536 pixels are");
  return {int(header.width), int(header.height)};
}

void orderByName(Capture& capture) {
  std::stable_sort(capture.views.begin(), capture.views.end(),
                   [](const CaptureView& a, const CaptureView& b) { return a.name < b.name; });
  for (std::size_t i = 1; i < capture.views.size(); ++i)
    if (capture.views[i].name == capture.views[i - 1].name)
      throw InputError(capture.file.string(), "", "two images are called '" + capture.views[i].name + "'");
}

double numberAt(const Row& row, std::size_t word, const std::string& file) {
  if (word >= row.words.size())
    throw InputError(file, row.place(),
                     "needs at least " + std::to_string(word + 1) + " entries, has " + std::to_string(row.words.size()));
  const std::optional<double> value = io::numberOf(row.words[word]);
  if (!value || !std::isfinite(*value)) throw InputError(file, row.place(), io::quoted(row.words[word]) + " is not a number");
  return *value;
}

long long integerAt(const Row& row, std::size_t word, const std::string& file) {
  numberAt(row, word, file);
  const std::optional<std::int64_t> value = io::integerOf(row.words[word]);
  if (!value) throw InputError(file, row.place(), io::quoted(row.words[word]) + " is not a whole number");
  return *value;
}

}  // namespace glint::capture
