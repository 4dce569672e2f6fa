// SPDX-License-Identifier: BSD-3-Clause
// Bundler's bundle.out and list.txt (Snavely, Seitz, Szeliski, Photo tourism, SIGGRAPH 2006): words, whatever the lines.

#include "core/base/atomic_file.h"
#include "core/base/number_text.h"
#include "core/capture/file_names.h"
#include "core/capture/text_rows.h"
#include "core/geometry/typed_pose.h"

namespace glint {
namespace {
namespace fs = std::filesystem;
using capture::Row;
using capture::RowReader;

constexpr std::string_view kBundlerMagic = "# Bundle file v";

struct BundlerCamera {
  std::string place;
  double focal = 0, k1 = 0, k2 = 0;                                ///< focal 0: not registered
  bool lost = false;                                               ///< its numbers are not finite; focal is 0
  Eigen::Isometry3d camFromWorld = Eigen::Isometry3d::Identity();  ///< ours: y down, z forward
};

struct BundlerMeasurement {
  std::size_t camera = 0;
  Eigen::Vector2d offset;  ///< px, y down, from the image's middle
};

struct BundlerPoint {
  Eigen::Vector3d place;
  std::vector<BundlerMeasurement> seen;
};

struct BundlerModel {
  std::vector<BundlerCamera> cameras;
  std::vector<BundlerPoint> points;
  std::size_t measurements = 0;
  std::vector<std::string> warnings;
};

/// One image of list.txt.
struct BundlerImage {
  std::string name, place;
  bool fisheye = false;
};

/// The words of the file: programs break its lines differently.
class BundlerWords {
 public:
  BundlerWords(std::string_view text, const std::string& file) : rows_(text, file), text_(text), file_(file) {}
  /// @param what  "camera 3 of 11", for a file that ends before it
  double number(const std::string& what) {
    advance(what);
    return capture::numberAt(row_, word_, file_);
  }
  /// NaN and infinite ones as well: they cost their camera only.
  double anyNumber(const std::string& what) {
    advance(what);
    const std::optional<double> value = io::numberOf(row_.words[word_]);
    return value && !std::isfinite(*value) ? *value : capture::numberAt(row_, word_, file_);
  }
  Eigen::Vector3d vector(const std::string& what) {
    Eigen::Vector3d v;
    for (double& x : v) x = number(what);
    return v;
  }
  std::int64_t integer(const std::string& what) {
    advance(what);
    return capture::integerAt(row_, word_, file_);
  }
  /// A count of what takes `wordsEach` words each.
  std::size_t count(const std::string& what, std::size_t wordsEach) {
    const std::int64_t n = integer("the number of " + what);
    constexpr std::size_t kWord = 2;  // bytes, with what separates it
    return capture::possibleCount(n, wordsEach * kWord, bytesLeft(), what, file_, place());
  }
  std::string place() const { return row_.place(); }  ///< of the word that was read last

 private:
  void advance(const std::string& what) {
    if (++word_ < row_.words.size()) return;
    row_ = rows_.need(what);
    word_ = 0;
  }
  std::size_t bytesLeft() const {
    const std::string_view word = row_.words[word_];
    return text_.size() - static_cast<std::size_t>(word.data() + word.size() - text_.data());
  }

  RowReader rows_;
  std::string_view text_;
  std::string file_;
  Row row_;
  std::size_t word_ = 0;
};

/// Our pose of Bundler's, whose camera has y up and looks along -z. As typedPose: a rotation of few digits is replaced by the nearest one.
Eigen::Isometry3d bundlerPose(const Eigen::Matrix3d& r, const Eigen::Vector3d& t, const std::string& file,
                              const std::string& place, std::vector<std::string>& repaired) {
  const TypedPose typed = typedPose(r, t);
  if (typed.rotation == TypedRotation::NotARotation)
    throw InputError(file, place, "the 3x3 matrix of the camera is not a rotation");
  if (typed.rotation == TypedRotation::Mirrored)
    throw InputError(file, place, "the 3x3 matrix of the camera is mirrored (determinant -1)");
  if (typed.rotation == TypedRotation::Repaired)
    repaired.push_back(place + ": not exactly a rotation, replaced by the nearest one");
  const Eigen::Vector3d flip(1, -1, -1);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = flip.asDiagonal() * typed.pose.linear();
  pose.translation() = flip.cwiseProduct(typed.pose.translation());
  return pose;
}

/// `f k1 k2`, the rotation row by row, the translation.
BundlerCamera bundlerCamera(BundlerWords& words, const std::string& what, const std::string& file,
                            std::vector<std::string>& repaired) {
  BundlerCamera camera;
  Eigen::Matrix<double, 15, 1> v;
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    v[i] = words.anyNumber(what);
    if (i == 0) camera.place = words.place();
  }
  camera.lost = !v.allFinite();
  if (camera.lost) return camera;
  camera.focal = v[0];
  camera.k1 = v[1];
  camera.k2 = v[2];
  const Eigen::Matrix3d rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(v.data() + 3);
  const Eigen::Vector3d translation = v.tail<3>();
  if (camera.focal == 0) return camera;  // not registered: the rest is zeros
  for (const double x : translation) capture::bounded(x, kFarthest, file, camera.place);
  camera.camFromWorld = bundlerPose(rotation, translation, file, camera.place, repaired);
  return camera;
}

/// Position, colour, and a list of `camera key x y`.
BundlerPoint bundlerPoint(BundlerWords& words, const std::string& what, std::size_t cameras, const std::string& file) {
  BundlerPoint point{words.vector(what), {}};
  for (const double x : point.place) capture::bounded(x, kFarthest, file, words.place());
  words.vector(what);  // the colour
  constexpr std::size_t kEach = 4;
  const std::size_t views = words.count("views", kEach);
  point.seen.reserve(views);
  for (std::size_t i = 0; i < views; ++i) {
    const std::int64_t index = words.integer(what);
    if (index < 0 || static_cast<std::uint64_t>(index) >= cameras)
      throw InputError(file, words.place(),
                       "there is no camera " + std::to_string(index) + ", there are " + std::to_string(cameras));
    words.integer(what);  // the key point
    const auto coordinate = [&] { return capture::bounded(words.number(what), kFarthestPx, file, words.place()); };
    const double x = coordinate(), y = coordinate();
    point.seen.push_back({static_cast<std::size_t>(index), {x, -y}});
  }
  return point;
}

BundlerModel readBundler(const fs::path& path) {
  const std::string file = path.string(), text = readFile(path, Limit::MeshMegabytes);
  const std::string_view whole = io::withoutMark(text), line = whole.substr(0, whole.find_first_of("\r\n"));
  const bool known = line.rfind(kBundlerMagic, 0) == 0;
  // Versions before 0.3 have no measurements and look along +z, later ones have more words per camera.
  if (!known) throw InputError(file, "line 1", "expected '# Bundle file v0.3', not " + io::quoted(line));
  std::string_view version = line.substr(kBundlerMagic.size());
  if (io::takeWord(version) != "0.3") throw InputError(file, "line 1", "only version 0.3 is supported, not " + io::quoted(line));

  BundlerWords words(text, file);
  BundlerModel model;
  constexpr std::size_t kCameraWords = 15, kPointWords = 7;
  const std::size_t cameras = words.count("cameras", kCameraWords), points = words.count("points", kPointWords);
  if (cameras == 0) throw InputError(file, words.place(), "holds no cameras");
  const auto which = [](const char* what, std::size_t i, std::size_t n) {
    return what + std::to_string(i + 1) + " of " + std::to_string(n) + " is complete";
  };
  std::vector<std::string> repaired;
  model.cameras.reserve(cameras);
  for (std::size_t i = 0; i < cameras; ++i)
    model.cameras.push_back(bundlerCamera(words, which("camera ", i, cameras), file, repaired));
  capture::addFew(model.warnings, repaired);
  model.points.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    model.points.push_back(bundlerPoint(words, which("point ", i, points), cameras, file));
    model.measurements += model.points.back().seen.size();
  }
  return model;
}

/// The list of images of a file: named after it ("model.out.list.txt" of "model.out"), or alike ("list.txt" of "bundle.out",
/// "scene.list.txt" of COLMAP's "scene.bundle.out"), else "list.txt" beside it, else in the folder around `bundle/`, where Bundler was started. Empty = none.
fs::path bundlerListOf(const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::vector<fs::path> places{folder / "list.txt"};
  std::string name = file.stem().string();
  if (const std::size_t at = name.rfind("bundle"); at != std::string::npos)
    places.insert(places.begin(), folder / (name.replace(at, std::string("bundle").size(), "list") + ".txt"));
  places.insert(places.begin(), {fs::path(file.string() + ".list.txt"), folder / (file.stem().string() + ".list.txt")});
  if (folder.filename() == "bundle") places.push_back(folder.parent_path() / "list.txt");
  std::error_code ignored;  // what cannot be asked about is not there
  for (const fs::path& p : places)
    if (fs::is_regular_file(p, ignored)) return p;
  return {};
}

bool isBundlerFile(const fs::path& file) { return capture::firstLineOf(file).rfind(kBundlerMagic, 0) == 0; }

/// bundle.out, also where Bundler put it, else the first other file *.out.
std::vector<fs::path> bundlerFilesIn(const fs::path& folder) {
  std::vector<fs::path> files{folder / "bundle.out", folder / "bundle" / "bundle.out"}, others;
  std::error_code error;  // what cannot be listed holds none
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->path().extension() == ".out" && it->path().filename() != "bundle.out") others.push_back(it->path());
  std::sort(others.begin(), others.end());
  files.insert(files.end(), others.begin(), others.end());
  std::erase_if(files, [](const fs::path& p) { return !isBundlerFile(p); });
  return files;
}

/// A line is the name, a flag for fisheye images and a guess of the focal length; both may be missing. Bundler's names have no
/// blanks, COLMAP's may.
std::vector<BundlerImage> readBundlerList(const fs::path& path) {
  const std::string file = path.string(), text = readFile(path, Limit::MeshMegabytes);
  RowReader rows(text, file);
  std::vector<BundlerImage> images;
  while (const std::optional<Row> row = rows.next()) {
    constexpr std::size_t kNumbers = 2;
    std::size_t name = row->words.size();
    while (name > 1 && row->words.size() - name < kNumbers && io::numberOf(row->words[name - 1])) --name;
    const std::string_view first = row->words.front(), last = row->words[name - 1];
    images.push_back({{first.data(), static_cast<std::size_t>(last.data() + last.size() - first.data())},
                      row->place(),
                      name < row->words.size() && row->words[name] == "1"});
  }
  return images;
}

Camera cameraOfBundler(const BundlerCamera& from, const std::array<int, 2>& size, const std::string& file) {
  Lens lens;
  if (from.k1 != 0 || from.k2 != 0) {
    lens.model = LensModel::Radial;  // of the same form; that y points up changes nothing, since only its square counts
    lens.parameters[0] = from.k1;
    lens.parameters[1] = from.k2;
  }
  const Pixel middle = capture::middleOf(size[0], size[1]);
  Camera camera = capture::cameraOf(size[0], size[1], from.focal, from.focal, middle.x(), middle.y(), lens, file, from.place);
  camera.camFromWorld = from.camFromWorld;
  return camera;
}

void describeBundler(const BundlerModel& model, const std::vector<std::string>& skipped, Capture& capture) {
  std::vector<std::string>& facts = capture.facts;
  facts.push_back("Bundler 0.3: " + std::to_string(model.cameras.size()) + " cameras (" + std::to_string(capture.views.size()) +
                  " registered), " + std::to_string(model.points.size()) + " points with " + std::to_string(model.measurements) +
                  " measurements");
  facts.push_back("poses: world to camera; y and z of the camera's frame turned round (Bundler looks along -z, y up)");
  facts.push_back("intrinsics: one focal length per image, the principal point is the image's middle");
  const auto bends = [](const CaptureView& v) { return v.camera.hasDistortion(); };
  if (const auto n = std::count_if(capture.views.begin(), capture.views.end(), bends))
    facts.push_back("distortion: " + std::to_string(n) + " images with Bundler's radial terms k1, k2");
  if (model.measurements) facts.push_back("measurements: from the image's middle, y turned down");
  capture.warnings.insert(capture.warnings.end(), model.warnings.begin(), model.warnings.end());
  if (!skipped.empty())
    capture.warnings.push_back(std::to_string(skipped.size()) + (skipped.size() == 1 ? " image is" : " images are") +
                               " not registered (focal length 0), left out: " + capture::someOf(skipped));
}

class BundlerReader : public CaptureReader {
 public:
  std::string name() const override { return "bundler"; }
  std::string describe() const override { return "Bundler (bundle.out and list.txt)"; }

  fs::path recognise(const fs::path& input) const override {
    std::error_code ignored;  // what cannot be asked about is not there
    if (!fs::is_directory(input, ignored)) return isBundlerFile(input) ? input : fs::path();
    for (const fs::path& p : bundlerFilesIn(input))
      if (!bundlerListOf(fs::absolute(p, ignored).lexically_normal()).empty()) return p;
    return {};
  }

  fs::path incomplete(const fs::path& folder) const override {
    const std::vector<fs::path> files = bundlerFilesIn(folder);
    return files.empty() ? fs::path() : files.front();
  }

  Capture read(const fs::path& file, const CaptureOptions& options) const override {
    Capture capture;
    capture.kind = name();
    capture.file = fs::absolute(file).lexically_normal();
    const BundlerModel model = readBundler(file);
    const Listed listed = imagesOf(capture.file, model, options);
    capture.folder = listed.file.parent_path();
    capture.sources = {capture.file, listed.file};
    std::vector<std::string> skipped;
    capture::FileNames names(options.rights, options.photographs);
    capture::PassedOver lost;
    for (std::size_t i = 0; i < model.cameras.size(); ++i) {
      const BundlerImage& image = listed.images[i];
      if (model.cameras[i].lost) {
        lost.add(model.cameras[i].place);
        continue;
      }
      if (model.cameras[i].focal == 0) {
        skipped.push_back(image.name);
        continue;
      }
      if (image.fisheye)
        throw InputError(listed.file.string(), image.place,
                         "is marked as a fisheye image, for which Bundler's files have no lens");
      CaptureView view;
      view.name = image.name;
      view.image = names.image(image.name, {capture.folder}, listed.file.string(), image.place);
      const std::array<int, 2> size = capture::sizeOfImage(view.image, listed.file.string(), image.place);
      view.camera = cameraOfBundler(model.cameras[i], size, file.string());
      capture.views.push_back(std::move(view));
    }
    if (capture.views.empty())
      throw InputError(file.string(), "",
                       lost.number() > 0 ? "no image has a finite pose and a focal length other than 0"
                                         : "no image is registered: every focal length is 0");
    capture::orderByName(capture);
    describeBundler(model, skipped, capture);
    lost.tell(capture.file.filename().string(), capture::kNoFinitePose, capture.warnings);
    names.tell(capture.warnings);
    return capture;
  }

  std::vector<CaptureTrack> tracks(const Capture& capture, const CaptureOptions& options) const override {
    const BundlerModel model = readBundler(capture.file);
    const Listed listed = imagesOf(capture.file, model, options);
    const std::map<std::string, int> indices = capture::viewsByName(capture);
    std::vector<CaptureTrack> tracks;
    for (const BundlerPoint& point : model.points) {
      CaptureTrack track{point.place, {}};
      for (const BundlerMeasurement& m : point.seen) {
        const auto found = indices.find(listed.images[m.camera].name);
        if (model.cameras[m.camera].focal == 0 || found == indices.end()) continue;
        const Camera& camera = capture.views[static_cast<std::size_t>(found->second)].camera;
        track.seen.push_back({found->second, capture::middleOf(camera.width, camera.height) + m.offset});
      }
      if (!track.seen.empty()) tracks.push_back(std::move(track));
    }
    return tracks;
  }

 private:
  struct Listed {
    fs::path file;
    std::vector<BundlerImage> images;  ///< one per camera
  };

  static Listed imagesOf(const fs::path& bundle, const BundlerModel& model, const CaptureOptions& options) {
    fs::path list = bundlerListOf(bundle);
    if (list.empty())
      throw InputError(bundle.string(), "",
                       "needs the list of its images beside it: list.txt (also in the folder around 'bundle') or " +
                           bundle.filename().string() + ".list.txt");
    list = resolveInside(list.parent_path(), list.filename().string(), options.rights, bundle.string(), "list of images");
    Listed listed{list, readBundlerList(list)};
    if (listed.images.size() != model.cameras.size())
      throw InputError(list.string(), "",
                       "names " + std::to_string(listed.images.size()) + " images, but " + bundle.filename().string() + " has " +
                           std::to_string(model.cameras.size()) + " cameras");
    return listed;
  }
};

}  // namespace

std::unique_ptr<const CaptureReader> makeBundlerReader() { return std::make_unique<BundlerReader>(); }

}  // namespace glint
