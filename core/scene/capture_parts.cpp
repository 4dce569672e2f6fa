// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/capture_parts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>

#include "core/base/atomic_file.h"
#include "core/base/bounded_json.h"
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

std::array<int, 2> sizeOfImage(const fs::path& image, const std::string& file, const std::string& place) {
  std::error_code ignored;  // unreadable counts as missing
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
  std::vector<CaptureView>& views = capture.views;
  std::stable_sort(views.begin(), views.end(), [](const CaptureView& a, const CaptureView& b) { return a.name < b.name; });
  PassedOver repeated;
  const auto same = [&](const CaptureView& a, const CaptureView& b) {
    if (a.name != b.name) return false;
    const Camera &c = a.camera, &d = b.camera;
    if (c.camFromWorld.matrix() != d.camFromWorld.matrix() || c.pixelFromRay != d.pixelFromRay ||
        c.lens.parameters != d.lens.parameters)
      throw InputError(capture.file.string(), "", "two images are called '" + a.name + "'");
    repeated.add("'" + b.name + "'");
    return true;
  };
  views.erase(std::unique(views.begin(), views.end(), same), views.end());
  repeated.tell(capture.file.filename().string(), "the image is there twice with the same camera", capture.warnings);
}

void PassedOver::tell(const std::string& file, const std::string& why, std::vector<std::string>& warnings) const {
  if (number_ == 0) return;
  warnings.push_back(file + ": " + first_ + (number_ > 1 ? " and " + std::to_string(number_ - 1) + " more" : "") + ": " + why +
                     (number_ > 1 ? "; they are left out" : "; it is left out"));
}

void BadLines::tell(std::vector<std::string>& warnings) const {
  if (!first_) return;
  const std::string more = number_ > 1 ? "; it and " + std::to_string(number_ - 1) + " more are left out" : "; it is left out";
  warnings.push_back(fs::path(first_->file()).filename().string() + std::string(first_->what()).substr(first_->file().size()) +
                     more);
}

bool isLostPose(const JsonNode& pose) {
  if (!pose.isArray()) return pose.isNull();
  constexpr std::size_t kRows = 3;
  std::size_t numbers = 0, zeros = 0;  // of a matrix by rows
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const JsonNode row = pose.at(i);
    if (row.isNull()) return true;
    for (std::size_t j = 0; row.isArray() && j < row.size(); ++j) {
      const JsonNode number = row.at(j);
      if (number.isNull()) return true;
      if (i >= kRows) continue;  // the last one may be right
      ++numbers;
      zeros += number.isNumber() && number.number() == 0;
    }
  }
  return numbers > 0 && zeros == numbers;
}

bool isCutPose(const JsonNode& pose) {
  constexpr std::size_t kRows = 3, kColumns = 4;
  if (!pose.isArray()) return false;
  bool cut = pose.size() < kRows;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const JsonNode row = pose.at(i);
    if (!row.isArray()) return false;  // not a matrix by rows: its reader says so
    cut = cut || row.size() < kColumns;
  }
  return cut;
}

bool anyNotFinite(const Row& row, std::size_t word, std::size_t words) {
  const std::size_t end = std::min(row.words.size(), word + words);
  for (std::size_t i = word; i < end; ++i)
    if (const std::optional<double> value = io::numberOf(row.words[i]); value && !std::isfinite(*value)) return true;
  return false;
}

bool isLostTum(const Row& row) {
  constexpr std::size_t kNumbers = 8, kQuaternion = 4;
  if (anyNotFinite(row, 1, kNumbers - 1)) return true;
  return row.words.size() == kNumbers && std::all_of(row.words.begin() + kQuaternion, row.words.end(), [](std::string_view word) {
           return io::numberOf(word) == std::optional(0.0);
         });
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

double secondsOf(double time) {
  constexpr double kMostSeconds = 1e11, kThousand = 1e3;
  for (double unit = 1;; unit *= kThousand)
    if (!(std::abs(time) >= kMostSeconds * unit) || unit >= 1e9) return time / unit;
}

std::vector<std::size_t> timePairs(const std::vector<double>& times, const std::vector<double>& others) {
  struct Moment {
    double time;
    bool isOther;
    std::size_t index, before, after;
  };
  std::vector<Moment> line;
  for (std::size_t i = 0; i < times.size(); ++i) line.push_back({times[i], false, i, 0, 0});
  for (std::size_t i = 0; i < others.size(); ++i) line.push_back({others[i], true, i, 0, 0});
  std::sort(line.begin(), line.end(), [](const Moment& a, const Moment& b) {
    return std::tie(a.time, a.isOther, a.index) < std::tie(b.time, b.isOther, b.index);
  });
  struct Neighbours {
    double apart;
    std::size_t left, right;
    bool operator>(const Neighbours& b) const { return std::tie(apart, left) > std::tie(b.apart, b.left); }
  };
  std::priority_queue<Neighbours, std::vector<Neighbours>, std::greater<>> closest;
  const auto consider = [&](std::size_t left, std::size_t right) {
    if (left == kNoPair || right >= line.size() || line[left].isOther == line[right].isOther) return;
    const double apart = line[right].time - line[left].time;
    if (apart <= kApart) closest.push({apart, left, right});
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    line[i].before = i - 1;  // of the first: kNoPair
    line[i].after = i + 1;
    consider(i, i + 1);
  }
  std::vector<std::size_t> pairs(times.size(), kNoPair);
  std::vector<char> used(line.size());
  while (!closest.empty()) {
    const auto [apart, left, right] = closest.top();
    closest.pop();
    if (used[left] || used[right]) continue;
    used[left] = used[right] = true;
    const bool turned = line[left].isOther;
    pairs[line[turned ? right : left].index] = line[turned ? left : right].index;
    const std::size_t before = line[left].before, after = line[right].after;
    if (before != kNoPair) line[before].after = after;
    if (after < line.size()) line[after].before = before;
    consider(before, after);
  }
  return pairs;
}

}  // namespace glint::capture
