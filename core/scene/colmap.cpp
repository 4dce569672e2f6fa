// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <map>
#include <set>

#include "core/base/atomic_file.h"
#include "core/base/found_file.h"
#include "core/scene/capture_file_names.h"
#include "core/scene/colmap_parts.h"
#include "io/text_scan.h"

// COLMAP's sparse model. Its poses are ours (world to camera, x right, y down, z forward); pixels differ by half a pixel.

namespace glint::capture::colmap {
namespace fs = std::filesystem;
namespace {

// Recognising.

bool beginsLikeCamerasBinary(const std::string& head) {
  constexpr std::size_t kCount = sizeof(std::uint64_t), kModel = kCount + sizeof(std::uint32_t);
  constexpr std::int32_t kMostModels = 100;  // COLMAP has 18; a later one is refused by its number
  if (head.size() < kModel + sizeof(std::int32_t)) return head == std::string(kCount, '\0');
  const auto model = io::valueAt<std::int32_t>(head.data() + kModel, false);
  return io::valueAt<std::uint64_t>(head.data(), false) > 0 && model >= 0 && model < kMostModels;
}

bool beginsLikeCamerasText(const std::string& head) {
  io::Lines lines(head);
  bool titled = false;
  while (std::optional<std::string_view> line = lines.next()) {
    titled = titled || line->find("# Camera list") == 0;  // COLMAP's own first line
    const std::string_view id = io::takeWord(*line), model = io::takeWord(*line);
    if (id.empty() || id.front() == '#') continue;
    constexpr std::string_view kInNames = "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    return number32(id) && !model.empty() && model.front() >= 'A' &&
           model.find_first_not_of(kInNames) == std::string_view::npos && number32(io::takeWord(*line)) &&
           number32(io::takeWord(*line));
  }
  return titled;
}

/// The file of cameras where the folder holds a model of this kind.
fs::path camerasIn(const fs::path& folder, bool binary) {
  const Files files{folder, binary};
  if (!files.has("cameras") || !files.has("images")) return {};
  constexpr std::size_t kHead = 65536;  // bytes; comments before the first camera are far shorter
  const std::string head = firstBytes(files("cameras"), kHead);
  return (binary ? beginsLikeCamerasBinary(head) : beginsLikeCamerasText(head)) ? files("cameras") : fs::path();
}
fs::path camerasIn(const fs::path& folder) {
  const fs::path binary = camerasIn(folder, true);
  return binary.empty() ? camerasIn(folder, false) : binary;
}

fs::path recogniseModel(const fs::path& input) {
  std::error_code ignored;  // as above
  if (fs::is_directory(input, ignored)) {
    for (const fs::path& folder : {input, input / "sparse", input / "sparse" / "0"})
      if (fs::path cameras = camerasIn(folder); !cameras.empty()) return cameras;
    return {};
  }
  const std::string stem = input.stem().string(), ending = input.extension().string();
  constexpr std::array<const char*, 5> kStems{"cameras", "images", "points3D", "rigs", "frames"};
  if ((ending != ".bin" && ending != ".txt") || std::find(kStems.begin(), kStems.end(), stem) == kStems.end()) return {};
  return fs::is_regular_file(input, ignored) ? camerasIn(input.parent_path(), ending == ".bin") : fs::path();
}

// The project around a model.

bool isNumberName(const fs::path& name) {
  const std::string text = name.string();
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

/// `sparse` and `sparse/0` are in the folder that holds `images`, too. A folder `dense` is a project of its own: its images are
/// undistorted, so those of the folder above do not belong to its cameras.
fs::path projectRoot(const fs::path& model) {
  if (model.filename() == "sparse") return model.parent_path();
  if (model.parent_path().filename() == "sparse" && isNumberName(model.filename())) return model.parent_path().parent_path();
  return model;
}

/// Other models of the project, in the order of their numbers.
std::vector<std::string> otherModels(const fs::path& root, const fs::path& model) {
  std::vector<fs::path> folders{root, root / "sparse"};
  std::map<std::pair<std::size_t, std::string>, fs::path> numbered;  // "2" before "10"
  std::error_code error;                                             // what cannot be listed has no models
  for (fs::directory_iterator it(root / "sparse", error), end; !error && it != end; it.increment(error))
    if (const fs::path name = it->path().filename(); isNumberName(name))
      numbered[{name.string().size(), name.string()}] = it->path();
  for (const auto& [number, folder] : numbered) folders.push_back(folder);
  std::vector<std::string> others;
  for (const fs::path& folder : folders)
    if (folder != model && !camerasIn(folder).empty()) others.push_back(folder.lexically_relative(root).generic_string());
  return others;
}

std::string colmapListOf(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;  // as many as a person reads
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) list += (i ? ", " : "") + names[i];
  return names.size() > kMost ? list + " and " + std::to_string(names.size() - kMost) + " more" : list;
}

// Reading.

Files filesOf(const fs::path& cameras) {
  return {fs::absolute(cameras).lexically_normal().parent_path(), cameras.extension() == ".bin"};
}

void addViews(const std::vector<ModelImage>& images, const std::vector<ModelCamera>& cameras, const Files& files,
              const CaptureOptions& options, Capture& capture) {
  const std::string file = files("images").string();
  const auto cameraById = indexById(cameras, "cameras", files("cameras").string());
  const std::vector<fs::path> folders{capture.folder / "images", capture.folder, files.folder};
  FileNames names(options.rights, options.photographs);
  PassedOver lost;
  BadLines strayed;
  for (const ModelImage& image : images) {
    if (image.lost) {
      lost.add(image.place);
      continue;
    }
    const auto camera = cameraById.find(image.camera);
    if (camera == cameraById.end()) {
      strayed.add(InputError(file, image.place,
                             "image " + io::quoted(image.name) + " is of camera " + std::to_string(image.camera) + ", which " +
                                 files("cameras").filename().string() + " does not have"));
      continue;
    }
    CaptureView view;
    view.name = image.name;
    view.image = names.image(image.name, folders, file, image.place);
    view.camera = cameras[camera->second].camera;
    view.camera.camFromWorld = image.camFromWorld;
    capture.views.push_back(std::move(view));
  }
  if (capture.views.empty()) strayed.refuse();
  if (capture.views.empty()) throw InputError(file, "", "has no finite pose");
  orderByName(capture);
  strayed.tell(capture.warnings);
  lost.tell(files("images").filename().string(), kNoFinitePose, capture.warnings);
  names.tell(capture.warnings);
}

/// How many points there are, and what their tracks name that is missing. That happens where a person or a program took images
/// out of the model; `tracks` leaves such entries out.
std::size_t countPoints(const Files& files, const std::vector<ModelImage>& images, Capture& capture) {
  if (!files.has("points3D")) {
    capture.warnings.push_back("there is no " + files("points3D").filename().string() +
                               ": the cameras cannot be compared with COLMAP's own points");
    return 0;
  }
  capture.sources.push_back(files("points3D"));
  const auto index = indexById(images, "images", files("images").string());
  std::size_t points = 0, entries = 0, noImage = 0, noPixel = 0;
  readPoints(files, capture.warnings, [&](const Eigen::Vector3d&, const std::vector<TrackEntry>& track) {
    ++points;
    entries += track.size();
    for (const TrackEntry& entry : track) {
      const auto image = index.find(entry.image);
      if (image == index.end())
        ++noImage;
      else if (entry.pixel >= images[image->second].pixels)
        ++noPixel;
    }
  });
  if (noImage + noPixel > 0)
    capture.warnings.push_back("of " + counted(entries, "entry", "entries") + " in tracks of points, " + std::to_string(noImage) +
                               " name an image and " + std::to_string(noPixel) +
                               " a 2D point that the model does not have: left out when the cameras are compared with points");
  return points;
}

/// "2 cameras (OPENCV 640 x 480, PINHOLE 800 x 600)"
std::string camerasText(const std::vector<ModelCamera>& cameras) {
  std::set<std::string> seen;
  std::vector<std::string> kinds;
  for (const ModelCamera& c : cameras) {
    const std::string kind = c.model + " " + std::to_string(c.camera.width) + " x " + std::to_string(c.camera.height);
    if (seen.insert(kind).second) kinds.push_back(kind);
  }
  return counted(cameras.size(), "camera") + " (" + colmapListOf(kinds) + ")";
}

void addPhotographs(Capture& capture) {
  std::error_code ignored;  // unreadable counts as missing
  std::size_t missing = 0;
  const CaptureView* first = nullptr;
  for (const CaptureView& view : capture.views) {
    if (fs::is_regular_file(view.image, ignored)) continue;
    if (missing++ == 0) first = &view;
  }
  const std::size_t all = capture.views.size();
  if (missing < all)
    capture.facts.push_back("photographs found: " + std::to_string(all - missing) + " of " + std::to_string(all));
  if (missing > 0)
    capture.warnings.push_back(counted(missing, "photograph") + " of " + std::to_string(all) +
                               " not found, the first: " + first->image.string() + " (--photographs names their folder)");
}

Capture readModel(const fs::path& cameraFile, const CaptureOptions& options) {
  const Files files = filesOf(cameraFile);
  Capture capture;
  capture.kind = "colmap";
  capture.file = files("cameras");
  capture.folder = projectRoot(files.folder);
  capture.sources = {files("cameras"), files("images")};
  const std::vector<ModelCamera> cameras = readCameras(files, capture.warnings);
  std::vector<std::string> quaternions;
  std::vector<ModelImage> images;
  {
    const std::string bytes = readFile(files("images"), Limit::MeshMegabytes);  // large: not kept
    images = readImages(files, bytes, quaternions);
  }
  indexById(images, "images", files("images").string());  // refuses two of one number
  addViews(images, cameras, files, options, capture);
  addWarnings(quaternions, capture.warnings);
  const std::size_t points = countPoints(files, images, capture);
  const std::string where = files.folder.lexically_relative(capture.folder).generic_string();
  capture.facts.push_back(std::string("COLMAP model, ") + (files.binary ? "binary" : "text") +
                          (where == "." ? "" : ", in " + where) + ": " + counted(images.size(), "image") + " of " +
                          camerasText(cameras) + ", " + counted(points, "point"));
  capture.facts.push_back(
      "poses are world to camera, quaternions with w first, axes x right, y down, z forward: taken as they are");
  capture.facts.push_back(
      "COLMAP's pixels begin at the corner of the first one: 0.5 subtracted from principal points and 2D points");
  addPhotographs(capture);
  checkRigs(files, images, capture);
  if (const std::vector<std::string> others = otherModels(capture.folder, files.folder); !others.empty())
    capture.warnings.push_back("there are other models, which are not read: " + colmapListOf(others) +
                               "; to read one, name its folder");
  return capture;
}

/// Index in Capture::views and 2D points of each image, in the order of the file; no view where the caller has left it out.
struct Shown {
  int view = -1;
  std::vector<Pixel> pixels;
};
std::vector<Shown> shownIn(const Files& files, const Capture& capture, std::unordered_map<std::uint32_t, std::size_t>& index) {
  std::unordered_map<std::string, int> viewOf;
  for (std::size_t i = 0; i < capture.views.size(); ++i) viewOf.emplace(capture.views[i].name, int(i));
  const std::string bytes = readFile(files("images"), Limit::MeshMegabytes);
  std::vector<std::string> known;  // `read` has warned of them
  const std::vector<ModelImage> images = readImages(files, bytes, known);
  index = indexById(images, "images", files("images").string());
  std::vector<Shown> shown(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const auto view = viewOf.find(images[i].name);
    if (view != viewOf.end()) shown[i] = {view->second, pixelsOf(files, bytes, images[i])};
  }
  return shown;
}

std::vector<CaptureTrack> tracksOf(const Capture& capture) {
  const Files files = filesOf(capture.file);
  if (!files.has("points3D")) return {};
  std::unordered_map<std::uint32_t, std::size_t> index;
  const std::vector<Shown> shown = shownIn(files, capture, index);
  std::vector<CaptureTrack> tracks;
  std::vector<std::string> known;  // `read` has warned of them
  readPoints(files, known, [&](const Eigen::Vector3d& point, const std::vector<TrackEntry>& entries) {
    CaptureTrack track{point, {}};
    track.seen.reserve(entries.size());
    for (const TrackEntry& entry : entries) {
      const auto image = index.find(entry.image);
      if (image == index.end()) continue;
      const Shown& s = shown[image->second];
      if (s.view >= 0 && entry.pixel < s.pixels.size()) track.seen.push_back({s.view, s.pixels[entry.pixel]});
    }
    tracks.push_back(std::move(track));
  });
  return tracks;
}

class ColmapReader : public CaptureReader {
 public:
  std::string name() const override { return "colmap"; }
  std::string describe() const override { return "COLMAP model (cameras, images, points3D; binary or text)"; }
  fs::path recognise(const fs::path& input) const override {
    try {
      return recogniseModel(input);
    } catch (const std::exception&) {  // a path that this system cannot ask about
      return {};
    }
  }
  Capture read(const fs::path& file, const CaptureOptions& options) const override { return readModel(file, options); }
  std::vector<CaptureTrack> tracks(const Capture& capture, const CaptureOptions&) const override { return tracksOf(capture); }
};

}  // namespace
}  // namespace glint::capture::colmap

namespace glint {

std::unique_ptr<const CaptureReader> makeColmapReader() { return std::make_unique<capture::colmap::ColmapReader>(); }

}  // namespace glint
