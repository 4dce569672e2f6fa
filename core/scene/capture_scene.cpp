// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <map>
#include <set>

#include "core/base/bounded_json.h"
#include "core/base/found_file.h"
#include "core/base/number_text.h"
#include "core/base/permitted.h"
#include "core/scene/scene_files.h"
#include "core/scene/scene_json.h"
#include "core/scene/scene_reader.h"
#include "core/surface/point_surface.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

constexpr const char* kSurfaceId = "surface";

bool endsLikeAMesh(const fs::path& file) {
  const std::string ending = lowerEnding(file);
  return ending == ".ply" || ending == ".obj" || ending == ".stl" || ending == ".gltf" || ending == ".glb";
}

/// Meshes directly in the folder, in the order of their names.
std::vector<fs::path> meshesIn(const fs::path& folder) {
  std::vector<fs::path> meshes;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
    if (it->is_regular_file(error) && endsLikeAMesh(it->path()) && !isCloudFile(it->path())) meshes.push_back(it->path());
  std::sort(meshes.begin(), meshes.end());
  return meshes;
}

std::string listOf(const std::vector<fs::path>& files) {
  constexpr std::size_t kMost = 8;  // as many as a person reads
  std::string list;
  for (std::size_t i = 0; i < std::min(files.size(), kMost); ++i) list += (i ? ", " : "") + files[i].filename().string();
  return files.size() > kMost ? list + ", ..." : list;
}

UndecidedInput undecidedSurface(const fs::path& file, const std::string& reason, const std::vector<fs::path>& meshes) {
  std::vector<UndecidedInput::Answer> answers;
  for (const fs::path& mesh : meshes) answers.push_back({mesh.string(), mesh.filename().string()});
  return {file.string(), reason, UndecidedInput::Question::Surface, std::move(answers)};
}

/// The mesh or cloud to take; "" = the frames' depth maps, or the sparse points.
fs::path meshOf(const Capture& capture, const InputChoices& choices) {
  static const std::set<std::string> kWithoutPoints{"bop", "tum", "images",
                                                    "video"};  // kinds of captures that have no sparse points
  const bool hasPoints = kWithoutPoints.count(capture.kind) == 0;
  const bool anyDepth = std::any_of(capture.views.begin(), capture.views.end(), [](const auto& v) { return !v.depth.empty(); });
  switch (choices.surface) {
    case InputChoices::Surface::File: return choices.surfaceFile;
    case InputChoices::Surface::Points: return {};
    case InputChoices::Surface::Depth:
      if (!anyDepth) throw InputError(capture.file.string(), "--surface depth", "no frame has a depth map");
      return {};
    case InputChoices::Surface::Default: break;
  }
  if (capture.mesh) return capture.mesh->file;
  const std::vector<fs::path> meshes = meshesIn(capture.folder);
  const auto isNamedMesh = [](const fs::path& p) { return p.stem() == "mesh"; };
  const auto named = std::find_if(meshes.begin(), meshes.end(), isNamedMesh);
  if (std::count_if(meshes.begin(), meshes.end(), isNamedMesh) == 1) return *named;
  if (meshes.size() == 1) return meshes.front();
  if (meshes.size() > 1)
    throw undecidedSurface(capture.folder, "contains several meshes (" + listOf(meshes) + "); choose one by --surface FILE",
                           meshes);
  if (anyDepth) return {};
  throw undecidedSurface(capture.file,
                         "names no surface, and there is no mesh in " + capture.folder.string() + "; name one by --surface FILE" +
                             (capture.hasScale ? " (in another unit than the capture's: with --surface-units)" : "") +
                             (hasPoints ? ", or try --surface points (the sparse points)" : ""),
                         {});
}

/// Names without folder and ending; with the folder where they repeat; as they are where they still do.
std::vector<std::string> idsOf(const std::vector<CaptureView>& views) {
  std::vector<std::string> ids(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) ids[i] = fs::path(slashed(views[i].name)).stem().string();
  const auto renameRepeated = [&](const auto& longer) {
    std::map<std::string, int> count;
    for (const std::string& id : ids) ++count[id];
    for (std::size_t i = 0; i < views.size(); ++i)
      if (count[ids[i]] > 1) ids[i] = longer(fs::path(slashed(views[i].name)));
  };
  renameRepeated([](fs::path name) { return name.replace_extension().generic_string(); });
  renameRepeated([](const fs::path& name) { return name.generic_string(); });
  for (std::size_t i = 0; i < views.size(); ++i)
    if (!isIdentifier(ids[i])) ids[i] = formatted("frame %zu", i);
  return ids;
}

/// Checks that every file found for the capture lies where a capture may name files: in its project's folder or in one that a
/// person named. A harmless name may be a link that leads out, and so may a folder that programs look into (`images`).
class InsideCapture {
 public:
  InsideCapture(const Capture& capture, const ReadOptions& options)
      : file_(capture.file), anywhere_(options.allowOutsidePaths), photographs_(options.photographs) {
    allowed_ = foldersOfCapture(capture.file);
    allowed_.push_back(capture.folder);
    allowed_.push_back(realPath(capture.file).parent_path());  // the model itself is what was named or recognised
    allowed_.insert(allowed_.end(), options.folders.begin(), options.folders.end());
  }

  /// @throw OutsidePath (place) for a file that lies elsewhere; says nothing about what is there
  void require(const fs::path& file, const std::string& place, const char* option) {
    if (anywhere_ || file.empty() || file == file_ || isPhotographNamed(file)) return;
    std::error_code ignored;  // a path that cannot be looked at counts as no link
    // For thousands of photographs in one folder, only the folder and the links in it are looked at.
    const bool known = !fs::is_symlink(file, ignored) && !folders_.insert(file.parent_path()).second;
    if (known || liesIn(allowed_, file)) return;
    throw OutsidePath(file_.string(), place,
                      "'" + file.string() + "' is a link that leaves the folder of the capture (" + option +
                          " names it, --allow-outside accepts it)",
                      realPath(file).parent_path());
  }

 private:
  /// In a folder that a person named for photographs, links may lead anywhere: people collect photographs like that.
  bool isPhotographNamed(const fs::path& file) const {
    return std::any_of(photographs_.begin(), photographs_.end(), [&](const fs::path& folder) {
      const fs::path below = file.lexically_relative(fs::absolute(folder).lexically_normal());
      return !below.empty() && *below.begin() != "..";
    });
  }

  fs::path file_;
  bool anywhere_;
  std::vector<fs::path> photographs_, allowed_;
  std::set<fs::path> folders_;  // that were looked at
};

void requireInside(const Capture& capture, const fs::path& mesh, const ReadOptions& options) {
  InsideCapture inside(capture, options);
  for (const fs::path& source : capture.sources)
    if (source != options.choices.poses) inside.require(source, source.filename().string(), "the path of the real capture");
  for (const CaptureView& view : capture.views) {
    inside.require(view.image, view.name, "--photographs DIR");
    inside.require(view.depth, view.name, "--files depth=DIR");
    inside.require(view.mask, view.name, "--files masks=DIR");
  }
  if (options.choices.surface != InputChoices::Surface::File) inside.require(mesh, "surface", "--surface FILE");
}

/// The capture's own sparse points, for `--surface points`, in units of its poses.
std::shared_ptr<const PointCloud> sparsePoints(const Capture& capture, const ReadOptions& options) {
  const std::vector<CaptureTrack> tracks = [&]() -> std::vector<CaptureTrack> {
    const CaptureReader* reader = captureReaderNamed(capture.kind);
    if (!reader) return {};
    return reader->tracks(capture, captureOptionsOf(options));
  }();
  if (tracks.empty())
    throw InputError(capture.file.string(), "--surface points", "it has no sparse points; name a cloud by --surface FILE");
  auto cloud = std::make_shared<PointCloud>();
  for (const CaptureTrack& track : tracks) cloud->points.push_back(track.point);
  return cloud;
}

}  // namespace

CaptureOptions captureOptionsOf(const ReadOptions& options) {
  CaptureOptions c;
  c.rights = options.rights();
  c.photographs = options.photographs;
  if (!options.choices.camera.empty()) c.camera = cameraOfNumbers(options.choices.camera);
  c.object = options.choices.object;
  c.world = options.choices.world;
  c.poses = options.choices.poses;
  c.posesByOrder = options.choices.posesByOrder;
  return c;
}

CaptureOptions captureOptionsOf(const Scene& scene) {
  ReadOptions options;
  options.allowOutsidePaths = scene.allowOutsidePaths;
  options.choices = scene.choices;
  for (const FilesFolder& f : scene.folders) {
    options.folders.push_back(f.folder);
    if (f.kind == FrameFile::Photograph) options.photographs.push_back(f.folder);
  }
  return captureOptionsOf(options);
}

Scene sceneOfCapture(const Capture& capture, const ReadOptions& options) {
  const InputChoices& choices = options.choices;
  Scene scene;
  scene.kind = capture.kind;
  scene.name = capture.folder.filename().string();
  scene.file = capture.file;
  scene.folder = capture.folder;
  scene.allowOutsidePaths = options.allowOutsidePaths;
  scene.choices = choices;
  scene.choices.as = capture.kind;
  scene.sources = capture.sources;
  scene.facts = capture.facts;
  scene.warnings = capture.warnings;
  const double metres = choices.metresPerUnit.value_or(capture.metresPerUnit);
  if (!capture.hasScale && !choices.metresPerUnit)
    scene.facts.push_back("the unit of length is not known: it is taken as metres (--units says another)");

  const fs::path mesh = meshOf(capture, choices);
  requireInside(capture, mesh, options);
  const bool onPoints = choices.surface == InputChoices::Surface::Points;
  if (onPoints) {
    const auto points = sparsePoints(capture, options);
    scene.surfaces[kSurfaceId] = CapturePoints{{capture.file, "", metres}, points};
    scene.facts.push_back(formatted("surface: made of the %zu sparse points", points->points.size()));
  } else if (!mesh.empty()) {
    SurfaceFile file{fs::absolute(mesh).lexically_normal()};
    file.named = file.file.lexically_relative(capture.folder).generic_string();
    const bool own = capture.mesh && capture.mesh->file == mesh;
    file.metresPerUnit = choices.surfaceMetresPerUnit.value_or(own ? capture.mesh->metresPerUnit : metres);
    file.file = placeOfMesh(
        file.named, [place = file.file] { return place; }, options, scene, "surface");
    const bool isCloud = isCloudFile(file.file);
    scene.facts.push_back("surface: " + file.named + (isCloud ? ", a cloud of points: the surface is made of them" : ""));
    scene.surfaces[kSurfaceId] = isCloud ? SurfaceSource(PointsFile{std::move(file)}) : MeshFile{std::move(file)};
  } else if (choices.surfaceMetresPerUnit) {
    throw InputError(capture.file.string(), "--surface-units", "the surface is no mesh");
  }

  const CameraResponse response = responseOf(choices);
  if (const std::string doubt = response.doubt(); !doubt.empty()) scene.warnings.push_back(doubt);
  const std::vector<std::string> ids = idsOf(capture.views);
  for (const CaptureView& view : capture.views) {
    Frame frame;
    frame.id = ids[scene.frames.size()];
    frame.image = view.image;
    frame.depth = view.depth;
    frame.mask = view.mask;
    frame.ofVideo = view.ofVideo;
    frame.depthScale = view.depth.empty() ? 0 : choices.depthScale.value_or(view.depthScale);
    frame.camera = view.camera;
    frame.response = response;
    frame.worldFromObject = view.worldFromObject;
    for (Eigen::Isometry3d* pose : {&frame.camera.camFromWorld, &frame.worldFromObject}) pose->translation() *= metres;
    if (!(frame.camera.camFromWorld.translation().cwiseAbs().maxCoeff() <= kFarthest))
      throw InputError(capture.file.string(), view.name, "its camera is farther than 1e15 m from the origin");
    if (onPoints || !mesh.empty()) frame.surface = kSurfaceId;
    scene.frames.push_back(std::move(frame));
  }
  return scene;
}

}  // namespace glint
