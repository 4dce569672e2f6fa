// SPDX-License-Identifier: BSD-3-Clause
// Bundler's bundle.out and list.txt (Snavely, Seitz, Szeliski, Photo tourism, SIGGRAPH 2006): words, whatever the lines.

#include "core/base/atomic_file.h"
#include "core/base/number_text.h"
#include "core/geometry/transforms.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/text_rows.h"

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
  bool unread = false;                                             ///< its lines cannot be read, which is told; focal is 0
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

constexpr std::size_t kWord = 2;                                     // bytes, with what separates it
constexpr std::size_t kCameraLines = 5, kInLine = 3, kEachView = 4;  // lines, and numbers in each; numbers of a measurement

/// The words of the file. Programs break its lines differently; if cameras have the lines that Bundler writes, a bad
/// line does not touch what follows it.
class BundlerWords {
 public:
  BundlerWords(std::string_view text, const std::string& file) : rows_(text, file), text_(text), file_(file) {}
  std::int64_t integer(const std::string& what) {
    advance(what);
    return capture::integerAt(row_, word_, file_);
  }
  /// Looks how the lines of so many cameras are broken.
  void lookAtLines(std::size_t cameras) {
    constexpr std::size_t kLooked = 1000;  // lines: a program breaks all of them in one way
    RowReader ahead = rows_;
    std::size_t seen = 0, ofThree = 0;
    while (seen < std::min(kLooked, kCameraLines * cameras)) {
      const std::optional<Row> row = ahead.next();
      if (!row) break;
      ++seen;
      ofThree += row->words.size() == kInLine;
    }
    inLines_ = word_ + 1 == row_.words.size() && 2 * ofThree > seen;
  }
  bool inLines() const { return inLines_; }
  /// Three numbers, whatever they are. @param what  "camera 3 of 11", for a file that ends before it
  Row three(const std::string& what) {
    if (inLines_) return rows_.need(what);
    Row row;
    for (std::size_t i = 0; i < kInLine; ++i) take(row, what);
    return row;
  }
  /// The number of views of a point, and four numbers for each.
  Row views(const std::string& what) {
    if (inLines_) return rows_.need(what);
    Row row;
    take(row, what);
    const std::size_t n =
        capture::possibleCount(capture::integerAt(row, 0, file_), kEachView * kWord, bytesLeft(), "views", file_, place());
    for (std::size_t i = 0; i < kEachView * n; ++i) take(row, what);
    return row;
  }
  std::string place() const { return row_.place(); }  ///< of the word that was read last
  std::size_t bytesLeft() const {
    const std::string_view word = row_.words[word_];
    return inLines_ ? rows_.bytesLeft() : text_.size() - static_cast<std::size_t>(word.data() + word.size() - text_.data());
  }

 private:
  void take(Row& to, const std::string& what) {
    advance(what);
    if (to.words.empty()) to.number = row_.number;
    to.words.push_back(row_.words[word_]);
  }
  /// Stays at the last word where the file ends: its reader may go on without what is missing.
  void advance(const std::string& what) {
    if (word_ + 1 < row_.words.size()) {
      ++word_;
      return;
    }
    row_ = rows_.need(what);
    word_ = 0;
  }

  RowReader rows_;
  std::string_view text_;
  std::string file_;
  Row row_;
  std::size_t word_ = 0;
  bool inLines_ = false;
};

void requireWords(const Row& row, std::size_t words, const std::string& file) {
  if (row.words.size() != words)
    throw InputError(file, row.place(),
                     "needs " + std::to_string(words) + " entries, has " + std::to_string(row.words.size()) + " (a cut line?)");
}

/// Our pose of Bundler's, whose camera has y up and looks along -z. typedPose repairs a rotation of few digits.
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
  std::array<Row, kCameraLines> rows;
  for (Row& row : rows) row = words.three(what);  // all of them before any is refused: the next camera begins behind them
  BundlerCamera camera;
  camera.place = rows[0].place();
  Eigen::Matrix<double, kCameraLines * kInLine, 1> v;
  for (std::size_t i = 0; i < kCameraLines * kInLine; ++i) {
    const Row& row = rows[i / kInLine];
    requireWords(row, kInLine, file);
    const std::optional<double> value = io::numberOf(row.words[i % kInLine]);  // NaN and infinite ones are lost poses
    v[Eigen::Index(i)] = value && !std::isfinite(*value) ? *value : capture::numberAt(row, i % kInLine, file);
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
  const Row place = words.three(what), colour = words.three(what), seen = words.views(what);  // as above
  for (const Row* row : {&place, &colour}) requireWords(*row, kInLine, file);
  BundlerPoint point{capture::placeAt(place, 0, file), {}};
  const std::int64_t views = capture::integerAt(seen, 0, file);
  requireWords(seen, 1 + kEachView * capture::possibleCount(views, 1, seen.words.size(), "views", file, seen.place()), file);
  for (std::size_t at = 1; at < seen.words.size(); at += kEachView) {
    const std::int64_t index = capture::integerAt(seen, at, file);
    if (index < 0 || static_cast<std::uint64_t>(index) >= cameras)
      throw InputError(file, seen.place(),
                       "there is no camera " + std::to_string(index) + ", there are " + std::to_string(cameras));
    capture::integerAt(seen, at + 1, file);  // the key point
    const auto coordinate = [&](std::size_t word) {
      return capture::bounded(capture::numberAt(seen, word, file), kFarthestPx, file, seen.place());
    };
    point.seen.push_back({static_cast<std::size_t>(index), {coordinate(at + 2), -coordinate(at + 3)}});
  }
  return point;
}

/// Reads the points, which follow the cameras. A bad point ends the reading if the lines do not tell where the next one begins.
void readBundlerPoints(BundlerWords& words, std::uint64_t points, const std::string& file, BundlerModel& model) {
  capture::BadLines bad;
  for (std::uint64_t i = 0; i < points; ++i) {
    const std::size_t before = words.bytesLeft();
    const std::string what = "point " + std::to_string(i + 1) + " of " + std::to_string(points) + " is complete";
    if (bad.passes([&] { model.points.push_back(bundlerPoint(words, what, model.cameras.size(), file)); })) {
      model.measurements += model.points.back().seen.size();
      continue;
    }
    if (!words.inLines() || words.bytesLeft() == before) break;  // the latter: nothing follows
  }
  bad.tell(model.warnings);
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
  const std::int64_t stated = words.integer("the number of cameras");
  const std::size_t cameras =
      capture::possibleCount(stated, kCameraLines * kInLine * kWord, words.bytesLeft(), "cameras", file, words.place());
  const std::int64_t points = words.integer("the number of points");  // of which a file that is cut holds fewer
  if (points < 0) throw InputError(file, words.place(), "the number of points must not be negative");
  if (cameras == 0) throw InputError(file, words.place(), "holds no cameras");
  words.lookAtLines(cameras);
  std::vector<std::string> repaired;
  capture::BadLines bad;
  model.cameras.resize(cameras);
  bool any = false;
  for (std::size_t i = 0; i < cameras; ++i) {
    const std::string what = "camera " + std::to_string(i + 1) + " of " + std::to_string(cameras) + " is complete";
    BundlerCamera& camera = model.cameras[i];
    camera.unread = !bad.passes([&] { camera = bundlerCamera(words, what, file, repaired); });
    any = any || camera.focal != 0;
  }
  if (!any) bad.refuse();
  bad.tell(model.warnings);
  capture::addFew(model.warnings, repaired);
  readBundlerPoints(words, std::uint64_t(points), file, model);
  return model;
}

/// The list of images of a file: named after it ("model.out.list.txt" of "model.out"), or alike ("list.txt" of "bundle.out",
/// "scene.list.txt" of COLMAP's "scene.bundle.out"), else "list.txt" beside it or in the folder around `bundle/`. Empty = none.
fs::path bundlerListOf(const fs::path& file) {
  const fs::path folder = file.parent_path();
  std::vector<fs::path> places{folder / "list.txt"};
  std::string name = file.stem().string();
  if (const std::size_t at = name.rfind("bundle"); at != std::string::npos)
    places.insert(places.begin(), folder / (name.replace(at, std::string("bundle").size(), "list") + ".txt"));
  places.insert(places.begin(), {fs::path(file.string() + ".list.txt"), folder / (file.stem().string() + ".list.txt")});
  if (folder.filename() == "bundle") places.push_back(folder.parent_path() / "list.txt");
  std::error_code ignored;  // unreadable counts as missing
  for (const fs::path& p : places)
    if (fs::is_regular_file(p, ignored)) return p;
  return {};
}

bool isBundlerFile(const fs::path& file) { return capture::firstLineOf(file).rfind(kBundlerMagic, 0) == 0; }

/// bundle.out, even in Bundler's own subfolder, else the first other file *.out.
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
    std::error_code ignored;  // unreadable counts as missing
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
    capture::BadLines bad;
    for (std::size_t i = 0; i < model.cameras.size(); ++i) {
      const BundlerImage& image = listed.images[i];
      if (model.cameras[i].unread) continue;
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
      if (bad.passes([&] { view.camera = cameraOfBundler(model.cameras[i], size, file.string()); }))
        capture.views.push_back(std::move(view));
    }
    if (capture.views.empty()) bad.refuse();
    if (capture.views.empty())
      throw InputError(file.string(), "",
                       lost.number() > 0 ? "no image has a finite pose and a focal length other than 0"
                                         : "no image is registered: every focal length is 0");
    capture::orderByName(capture);
    describeBundler(model, skipped, capture);
    lost.tell(capture.file.filename().string(), capture::kNoFinitePose, capture.warnings);
    bad.tell(capture.warnings);
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
