// SPDX-License-Identifier: BSD-3-Clause
// NVM of VisualSFM (Wu, Towards linear-time incremental structure from motion, 3DV 2013): a row per camera, a row per point.
#include "core/base/atomic_file.h"
#include "core/base/number_text.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/text_rows.h"

namespace glint {
namespace {
namespace fs = std::filesystem;
using capture::Row;
using capture::RowReader;

constexpr std::string_view kNvmMagic = "NVM_V";  // what all versions begin with; one of them is read

/// One calibration for all images, `FixedK fx cx fy cy [r]`.
struct NvmFixed {
  double fx = 0, cx = 0, fy = 0, cy = 0;
  double radial = 0;
};

struct NvmCamera {
  std::string name, place;
  double focal = 0;
  Eigen::Quaterniond camFromWorld = Eigen::Quaterniond::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radial = 0;
  bool lost = false;   ///< its numbers are not finite
  bool unread = true;  ///< its line cannot be read, which is told
};

struct NvmMeasurement {
  std::size_t camera = 0;
  Eigen::Vector2d offset;  ///< px, y down, from the principal point (or from the image's corner: nvmFromCorner)
};

struct NvmPoint {
  Eigen::Vector3d place;
  std::vector<NvmMeasurement> seen;
};

struct NvmModel {
  std::optional<NvmFixed> fixed;
  std::vector<NvmCamera> cameras;
  std::vector<NvmPoint> points;
  std::size_t measurements = 0;
  std::vector<std::string> warnings;
};

/// Reads `FixedK ...` from this word on.
NvmFixed nvmFixed(const Row& row, std::size_t word, const std::string& file) {
  const auto number = [&](std::size_t i) { return capture::numberAt(row, word + i, file); };
  if (row.words[word] != "FixedK")
    throw InputError(file, row.place(), io::quoted(row.words[word]) + " is not supported, only FixedK is");
  // VisualSFM's own order: fx before cx.
  NvmFixed fixed{number(1), number(2), number(3), number(4), 0};
  if (row.words.size() > word + 5) fixed.radial = number(5);
  if (row.words.size() > word + 6) throw InputError(file, row.place(), "FixedK has more than five numbers: fx cx fy cy r");
  return fixed;
}

/// The name of a camera's row, without the row's last `numbers` words. VisualSFM writes a quotation mark for each blank, other
/// programs write the blank itself; on Windows folders end with a backslash.
std::string nvmName(const Row& row, std::size_t numbers) {
  const std::string_view first = row.words.front(), last = row.words[row.words.size() - numbers - 1];
  std::string name(first.data(), static_cast<std::size_t>(last.data() + last.size() - first.data()));
  std::replace(name.begin(), name.end(), '"', ' ');
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

/// `name f qw qx qy qz cx cy cz r 0`
NvmCamera nvmCamera(const Row& row, const std::string& file, std::vector<std::string>& warnings) {
  constexpr std::size_t kNumbers = 10;
  if (row.words.size() < kNumbers + 1)
    throw InputError(
        file, row.place(),
        "a camera needs a name and 10 numbers, has " + capture::counted(row.words.size(), "entry", "entries") + " (a cut line?)");
  const std::size_t first = row.words.size() - kNumbers;
  const auto number = [&](std::size_t i) { return capture::numberAt(row, first + i, file); };
  NvmCamera camera;
  camera.name = nvmName(row, kNumbers);
  camera.place = row.place();
  camera.unread = false;
  camera.lost = capture::anyNotFinite(row, first, kNumbers);
  if (camera.lost) return camera;
  camera.focal = number(0);
  camera.camFromWorld = capture::unitQuaternion(number(1), number(2), number(3), number(4), file, row.place(), warnings);
  camera.centre = capture::placeAt(row, first + 5, file);
  camera.radial = number(8);
  if (number(9) != 0) throw InputError(file, row.place(), "the last entry of a camera must be 0");
  return camera;
}

/// `X Y Z R G B n`, then n times `camera feature x y`
NvmPoint nvmPoint(const Row& row, std::size_t cameras, const std::string& file) {
  constexpr std::size_t kHead = 7, kEach = 4;
  NvmPoint point{capture::placeAt(row, 0, file), {}};
  for (std::size_t i = 3; i < kHead - 1; ++i) capture::numberAt(row, i, file);  // the colour
  const long long count = capture::integerAt(row, kHead - 1, file);
  const std::size_t rest = row.words.size() - kHead;
  if (count < 0 || rest % kEach != 0 || static_cast<std::size_t>(count) != rest / kEach)
    throw InputError(
        file, row.place(),
        "states " + std::to_string(count) + " measurements of 4 entries, but " + std::to_string(rest) + " entries follow");
  point.seen.reserve(rest / kEach);
  for (std::size_t at = kHead; at < row.words.size(); at += kEach) {
    const long long index = capture::integerAt(row, at, file);
    if (index < 0 || static_cast<unsigned long long>(index) >= cameras)
      throw InputError(file, row.place(),
                       "there is no camera " + std::to_string(index) + ", only 0 .. " + std::to_string(cameras - 1));
    capture::integerAt(row, at + 1, file);  // the feature
    const auto coordinate = [&](std::size_t i) {
      return capture::bounded(capture::numberAt(row, at + i, file), kFarthestPx, file, row.place());
    };
    point.seen.push_back({static_cast<std::size_t>(index), {coordinate(2), coordinate(3)}});
  }
  return point;
}

/// The number that is alone in its row, if it is one.
std::optional<std::int64_t> nvmCountOf(const Row& row) {
  return row.words.size() == 1 ? io::integerOf(row.words.front()) : std::nullopt;
}

/// What follows the first model: others, then VisualSFM's list of the images without a pose (a model without points), then
/// a 0 and the numbers of meshes. None of it is read, so a damaged end is no error.
void skipOtherNvmModels(RowReader& rows, NvmModel& model) {
  std::size_t models = 0, cameras = 0, unposed = 0;
  const auto countOf = [&] {
    const std::optional<Row> row = rows.next();
    return row ? nvmCountOf(*row).value_or(0) : 0;
  };
  const auto skip = [&](std::int64_t count) {
    while (count > 0 && rows.next()) --count;
    return count == 0;
  };
  for (std::int64_t n = countOf(); n > 0; n = countOf()) {
    if (!skip(n)) break;
    const std::int64_t points = countOf();
    (points > 0 ? cameras : unposed) += static_cast<std::size_t>(n);
    if (points > 0) ++models;
    if (!skip(points)) break;
  }
  if (models)
    model.warnings.push_back("the file holds " + std::to_string(models) + (models == 1 ? " further model" : " further models") +
                             " with " + std::to_string(cameras) + " cameras: only the first is read");
  if (unposed) model.warnings.push_back(std::to_string(unposed) + " images have no pose and are left out");
}

/// The line that says what the file is, and the calibration where there is one.
/// @return  the row with the number of cameras
Row readNvmHeader(RowReader& rows, NvmModel& model, const std::string& file) {
  const Row header = rows.need("the line NVM_V3");
  if (header.words.front() != "NVM_V3")
    throw InputError(file, header.place(), io::quoted(header.words.front()) + " is not supported, only NVM_V3 is");
  const bool more = header.words.size() > 1 && header.words[1].front() != '#';
  if (more) model.fixed = nvmFixed(header, 1, file);
  Row row = rows.need("the number of cameras");
  if (more || row.words.front() != "FixedK") return row;
  model.fixed = nvmFixed(row, 0, file);
  return rows.need("the number of cameras");
}

NvmModel readNvm(const fs::path& path) {
  const std::string file = path.string(), text = readFile(path, Limit::MeshMegabytes);
  RowReader rows(text, file);
  NvmModel model;
  const auto countIn = [&](const Row& row, const std::string& what) {
    if (!nvmCountOf(row)) throw InputError(file, row.place(), "expected the number of " + what);
    return *nvmCountOf(row);
  };
  constexpr std::size_t kCameraBytes = 22;  // 11 words of one letter with what separates them
  const Row first = readNvmHeader(rows, model, file);
  const std::size_t cameras =
      capture::possibleCount(countIn(first, "cameras"), kCameraBytes, rows.bytesLeft(), "cameras", file, first.place());
  if (cameras == 0) throw InputError(file, "", "holds no cameras");
  std::vector<std::string> lengths;
  capture::BadLines bad;
  model.cameras.resize(cameras);
  for (std::size_t i = 0; i < cameras; ++i)
    bad.passes([&] {
      const Row row = rows.need("camera " + std::to_string(i + 1) + " of " + std::to_string(cameras));
      model.cameras[i] = nvmCamera(row, file, lengths);
    });
  capture::addFew(model.warnings, lengths);
  if (std::none_of(model.cameras.begin(), model.cameras.end(), [](const NvmCamera& c) { return !c.unread; })) bad.refuse();
  std::int64_t points = 0;
  // A file that is cut ends anywhere, also before the points that it states.
  if (rows.bytesLeft() > 0) points = countIn(rows.need("the number of points"), "points");
  if (points < 0) throw InputError(file, "", "the number of points must not be negative");
  for (std::int64_t i = 0; i < points; ++i) {
    const std::size_t left = rows.bytesLeft();
    if (bad.passes([&] {
          const Row row = rows.need("point " + std::to_string(i + 1) + " of " + std::to_string(points));
          model.points.push_back(nvmPoint(row, cameras, file));
        }))
      model.measurements += model.points.back().seen.size();
    else if (rows.bytesLeft() == left)
      break;  // nothing follows
  }
  bad.tell(model.warnings);
  if (points == 0) model.warnings.push_back("the model has no points: VisualSFM lists images without a pose so");
  skipOtherNvmModels(rows, model);
  return model;
}

/// COLMAP writes measurements from the image's corner, VisualSFM from its middle. From the corner all are positive, and some
/// would lie outside of their image if they were meant from the middle.
/// @param cameraOf  the camera of an index in the model; null = unknown
template <class CameraOf>
bool nvmFromCorner(const NvmModel& model, const CameraOf& cameraOf) {
  bool outside = false;
  for (const NvmPoint& point : model.points)
    for (const NvmMeasurement& m : point.seen) {
      const Camera* camera = cameraOf(m.camera);
      if (!camera) continue;
      if ((m.offset.array() < 0).any()) return false;
      const Pixel pixel = camera->pixelFromRay.topRightCorner<2, 1>() + m.offset;
      outside = outside || pixel.x() > camera->width - 0.5 || pixel.y() > camera->height - 0.5;
    }
  return outside;
}

Camera cameraOfNvm(const NvmCamera& from, const std::optional<NvmFixed>& fixed, const std::array<int, 2>& size,
                   const std::string& file) {
  Lens lens;
  // As VisualSFM's own loader: a fixed term of 0 leaves each camera its own.
  const double radial = fixed && fixed->radial != 0 ? fixed->radial : from.radial;
  if (radial != 0) {
    lens.model = LensModel::VisualSfm;
    lens.parameters[0] = radial;
  }
  const Pixel middle =
      fixed ? Pixel(fixed->cx, fixed->cy) + Pixel::Constant(capture::kFromCorner) : capture::middleOf(size[0], size[1]);
  Camera camera = capture::cameraOf(size[0], size[1], fixed ? fixed->fx : from.focal, fixed ? fixed->fy : from.focal, middle.x(),
                                    middle.y(), lens, file, from.place);
  camera.camFromWorld.linear() = from.camFromWorld.toRotationMatrix();
  camera.camFromWorld.translation() = -(camera.camFromWorld.linear() * from.centre);  // the file has the centre C, t = -R C
  return camera;
}

std::vector<fs::path> nvmFilesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;  // what cannot be listed has none
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".nvm" && capture::firstLineOf(it->path()).rfind(kNvmMagic, 0) == 0)
      files.push_back(it->path());
  std::sort(files.begin(), files.end());
  return files;
}

void describeNvm(const NvmModel& model, bool fromCorner, Capture& capture) {
  std::vector<std::string>& facts = capture.facts;
  facts.push_back("NVM (VisualSFM): " + std::to_string(model.cameras.size()) + " cameras, " +
                  std::to_string(model.points.size()) + " points with " + std::to_string(model.measurements) + " measurements");
  facts.push_back("poses: quaternions (w first) and camera centres, turned into world to camera");
  if (const auto& k = model.fixed)
    facts.push_back("intrinsics: the file's FixedK holds for all images, " +
                    formatted("fx %.6g, fy %.6g, cx %.6g, cy %.6g", k->fx, k->fy, k->cx, k->cy) +
                    " from the image's corner (0.5 subtracted)");
  else
    facts.push_back("intrinsics: one focal length per image, the principal point is the image's middle");
  const auto bends = [](const CaptureView& v) { return v.camera.hasDistortion(); };
  if (const auto n = std::count_if(capture.views.begin(), capture.views.end(), bends)) {
    facts.push_back("distortion: " + std::to_string(n) + " images with VisualSFM's term, which undistorts");
    // Its term distorts, and the same one with the other sign is the inverse to first order only.
    if (fromCorner)
      capture.warnings.push_back(
          "COLMAP wrote this file, and NVM has its distortion only roughly (pixels near the edges): better read the COLMAP "
          "model");
  }
  if (model.measurements)
    facts.push_back(fromCorner ? "measurements: from the image's corner, as COLMAP writes them (0.5 subtracted)"
                               : "measurements: from the principal point");
  capture.warnings.insert(capture.warnings.end(), model.warnings.begin(), model.warnings.end());
  std::vector<std::string> others;
  for (const fs::path& p : nvmFilesIn(capture.folder))
    if (p.filename() != capture.file.filename()) others.push_back(p.filename().string());
  if (!others.empty()) capture.warnings.push_back("the folder holds other NVM files: " + capture::someOf(others));
}

class NvmReader : public CaptureReader {
 public:
  std::string name() const override { return "nvm"; }
  std::string describe() const override { return "NVM of VisualSFM"; }

  fs::path recognise(const fs::path& input) const override {
    std::error_code ignored;  // unreadable counts as missing
    if (fs::is_directory(input, ignored)) {
      const std::vector<fs::path> files = nvmFilesIn(input);
      return files.empty() ? fs::path() : files.front();
    }
    return capture::firstLineOf(input).rfind(kNvmMagic, 0) == 0 ? input : fs::path();
  }

  Capture read(const fs::path& file, const CaptureOptions& options) const override {
    Capture capture;
    capture.kind = name();
    capture.file = fs::absolute(file).lexically_normal();
    capture.folder = capture.file.parent_path();
    capture.sources = {capture.file};
    const NvmModel model = readNvm(file);
    capture::FileNames names(options.rights, options.photographs);
    capture::PassedOver lost;
    capture::BadLines bad;
    std::vector<std::optional<std::size_t>> viewOf;  // of the cameras, in the model's own order
    for (const NvmCamera& from : model.cameras) {
      viewOf.push_back(std::nullopt);
      if (from.lost) lost.add(from.place);
      if (from.lost || from.unread) continue;
      CaptureView view;
      view.name = from.name;
      view.image = names.image(from.name, {capture.folder}, file.string(), from.place);
      const std::array<int, 2> size = capture::sizeOfImage(view.image, file.string(), from.place);
      if (!bad.passes([&] { view.camera = cameraOfNvm(from, model.fixed, size, file.string()); })) continue;
      viewOf.back() = capture.views.size();
      capture.views.push_back(std::move(view));
    }
    if (capture.views.empty()) bad.refuse();
    if (capture.views.empty()) throw InputError(file.string(), "", "has no finite pose");
    const bool fromCorner = nvmFromCorner(
        model, [&](std::size_t i) -> const Camera* { return viewOf[i] ? &capture.views[*viewOf[i]].camera : nullptr; });
    capture::orderByName(capture);
    describeNvm(model, fromCorner, capture);
    lost.tell(capture.file.filename().string(), capture::kNoFinitePose, capture.warnings);
    bad.tell(capture.warnings);
    names.tell(capture.warnings);
    return capture;
  }

  std::vector<CaptureTrack> tracks(const Capture& capture, const CaptureOptions&) const override {
    const NvmModel model = readNvm(capture.file);
    const std::map<std::string, int> indices = capture::viewsByName(capture);
    std::vector<int> views;  // of the cameras; -1 = none
    for (const NvmCamera& camera : model.cameras) {
      const auto found = indices.find(camera.name);
      views.push_back(found == indices.end() ? -1 : found->second);
    }
    const auto cameraOf = [&](std::size_t i) {
      return views[i] < 0 ? nullptr : &capture.views[static_cast<std::size_t>(views[i])].camera;
    };
    const bool fromCorner = nvmFromCorner(model, cameraOf);
    std::vector<CaptureTrack> tracks;
    for (const NvmPoint& point : model.points) {
      CaptureTrack track{point.place, {}};
      for (const NvmMeasurement& m : point.seen)
        if (const Camera* camera = cameraOf(m.camera)) {
          const Pixel origin =
              fromCorner ? Pixel::Constant(capture::kFromCorner) : Pixel(camera->pixelFromRay.topRightCorner<2, 1>());
          track.seen.push_back({views[m.camera], origin + m.offset});
        }
      if (!track.seen.empty()) tracks.push_back(std::move(track));
    }
    return tracks;
  }
};

}  // namespace

std::unique_ptr<const CaptureReader> makeNvmReader() { return std::make_unique<NvmReader>(); }

}  // namespace glint
