// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/session_file.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "core/app/session.h"
#include "core/base/atomic_file.h"
#include "core/base/temporary_path.h"
#include "gui/base/text.h"
#include "gui/document/figure.h"
#include "gui/document/own_files.h"
#include "gui/scene/scene_options.h"

namespace glint::gui {

namespace fs = std::filesystem;

namespace {
const char* const kSceneView = "scene";
constexpr int kDefaultTraining = 6;  // InspectionRequest::train

/// The session that a path means; empty if it means a scene.
fs::path sessionAt(const fs::path& path) {
  std::error_code ignored;  // what cannot be read is reported by the reader, with its reason
  if (!fs::is_directory(path, ignored)) return path.extension() == ".glint" ? path : fs::path();
  if (fs::exists(path / "scene.json", ignored)) return {};
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, ignored))
    if (entry.path().extension() == ".glint" && entry.path().filename().string()[0] != '.') found.push_back(entry.path());
  return found.size() == 1 ? found.front() : fs::path();
}

viz::ViewPoint viewPointOf(const SessionCamera& c) { return {c.position, c.focalPoint, c.up, c.viewAngleDeg, c.parallel}; }
SessionCamera cameraOf(const viz::ViewPoint& v) { return {v.position, v.focalPoint, v.up, v.viewAngleDeg, v.parallel}; }

/// The frame to show first: a training frame shows how well a model fits, a held-out one what it predicts. 0 if all frames train.
int firstHeldOut(const Scene& scene, const InspectionRequest& request) {
  const std::vector<int> train = parseTrainSpec(request.train, scene).frames;
  for (int i = 0; i < int(scene.frames.size()); ++i)
    if (std::count(train.begin(), train.end(), i) + std::count(request.excluded.begin(), request.excluded.end(), i) == 0)
      return i;
  return 0;
}

/// @param id  of the frame that was on screen; "" = none was
int frameNumber(const Scene& scene, const InspectionRequest& request, const std::string& id) {
  const auto it = std::find_if(scene.frames.begin(), scene.frames.end(), [&](const Frame& f) { return f.id == id; });
  return it == scene.frames.end() ? firstHeldOut(scene, request) : int(it - scene.frames.begin());
}
/// What this program left behind may name what the session that it is of may name, and what it was told itself.
Relinked withFoldersOf(Relinked instead, const Recovery& recovery, const Session& session) {
  instead.folders.push_back(recovery.of.parent_path());
  for (const FilesFolder& f : session.folders) instead.folders.push_back(f.folder);
  for (const auto& [named, mesh] : session.meshes) instead.folders.push_back(mesh.parent_path());
  if (!session.request.truthFolder.empty()) instead.folders.emplace_back(session.request.truthFolder);
  return instead;
}

/// A scene file or a capture, which says nothing about what was on screen.
void openScene(Opened& opened, const std::string& path, const Relinked& instead) {
  ReadOptions options;
  options.meshes = instead.meshes;
  options.meshFolders = instead.meshFolders;
  options.folders = instead.folders;
  options.choices = instead.choices;
  opened.scene = std::make_shared<const Scene>(readScene(path, options));
  // A short scene opens too: the default would ask for more frames than there are.
  if (const int frames = int(opened.scene->frames.size()); frames < kDefaultTraining)
    opened.request.train = "first:" + std::to_string(frames);
  opened.selection.frame = firstHeldOut(*opened.scene, opened.request);
}
}  // namespace

Opened openInput(const std::string& path, const Relinked& instead) {
  for (const auto& [named, mesh] : instead.meshes) readMesh(mesh);  // what is no mesh must not take the place of what is open
  Opened opened;
  opened.unsaved = instead.any();
  opened.path = path;
  const fs::path session = sessionAt(path);
  const std::string inside = fs::path(path).extension() == ".png" ? sessionInFigure(exactQString(path)).toStdString() : "";
  if (session.empty() && inside.empty()) {
    openScene(opened, path, instead);
    return opened;
  }
  if (!session.empty()) removeAbandonedTemporaries(session.parent_path());  // of a program that was killed while it saved
  // Before it is read: what another program writes meanwhile is then seen as a change.
  const std::string stamp = inside.empty() ? stampOf(exactQString(session.string())) : "";
  Session stored = inside.empty() ? readSession(session) : parseSession(inside, path);
  const std::optional<Recovery> recovery = std::exchange(stored.recovery, std::nullopt);
  const bool ours = recovery && inside.empty() && isOwnRecovery(exactQString(session.string()));
  OpenedSession read = openSession(stored, ours ? withFoldersOf(instead, *recovery, stored) : instead);
  const SessionView& view = read.session.view;
  opened.warning = read.warning;
  if (ours) {
    opened.path = recovery->of.string();
    opened.isSession = recovery->isSession;
    opened.unsaved = true;
  } else if (inside.empty()) {
    opened.path = session.string();
    opened.isSession = true;
    opened.stamp = stamp;
    if (recovery)
      opened.notice =
          session.string() + ": recovery: ignored because this program did not write the file; saving writes to this file";
  } else {
    opened.unsaved = true;  // the picture holds it, and is no session to save to
  }
  opened.scene = read.scene;
  opened.request = read.session.request;
  opened.selection = {
      frameNumber(*read.scene, read.session.request, view.frame), view.model, view.highlight, view.light, {}, view.predicted};
  opened.layers = view.layers;
  opened.options = view.options;
  opened.layout = view.layout;
  // Kept views are options while they are on screen, so that keeping one can be undone, and cameras in the file.
  for (const auto& [name, camera] : view.cameras)
    if (name != kSceneView) opened.options[kSavedView + name] = toText(viewPointOf(camera));
  if (const auto first = view.cameras.find(kSceneView); first != view.cameras.end()) {
    opened.viewPoints = {viewPointOf(first->second)};
    for (const SessionCamera& camera : view.moreCameras) opened.viewPoints.push_back(viewPointOf(camera));
  }
  if (read.session.tradeoff) opened.tradeoff = std::make_shared<const Tradeoff>(*read.session.tradeoff);
  opened.session = std::make_shared<const Session>(std::move(read.session));
  return opened;
}

namespace {
/// What a session says besides its inputs and results.
void addState(Session& session, const Opened& opened) {
  const Scene& scene = *opened.scene;
  session.request = opened.request;
  session.folders = scene.folders;
  session.choices = scene.choices;
  session.meshes = scene.meshes;
  if (opened.tradeoff) session.tradeoff = *opened.tradeoff;
  if (opened.session) {
    session.notes = opened.session->notes;
    session.unknownJson = opened.session->unknownJson;
    session.plugins = opened.session->plugins;
  }
  session.view = viewOf(opened);
}
}  // namespace

SessionView viewOf(const Opened& opened) {
  SessionView view;
  view.layout = opened.layout;
  view.layers = opened.layers;
  const std::string kept = kSavedView;
  for (const auto& [name, value] : opened.options) {
    if (name.rfind(kept, 0) != 0)
      view.options[name] = value;
    else if (const std::optional<viz::ViewPoint> v = viewPointFromText(value))
      view.cameras[name.substr(kept.size())] = cameraOf(*v);
  }
  view.frame = opened.scene->frames.at(std::size_t(opened.selection.frame)).id;
  view.model = opened.selection.model;
  view.light = opened.selection.light;
  view.highlight = opened.selection.highlight;
  view.predicted = opened.selection.predicted;
  for (const viz::ViewPoint& seen : opened.viewPoints)
    if (&seen == &opened.viewPoints.front())
      view.cameras[kSceneView] = cameraOf(seen);
    else
      view.moreCameras.push_back(cameraOf(seen));
  return view;
}

void saveSession(const Opened& opened, const Inspection* results, const std::string& path, const ProgressFn& progress) {
  const Scene& scene = *opened.scene;
  Session session;
  if (results) {
    session = sessionOf(*results, progress);
  } else {
    session.input = fs::absolute(scene.file).lexically_normal();
    session.allowOutsidePaths = scene.allowOutsidePaths;
    session.files = hashInputs(scene, opened.request, progress);
    const TrainSpec train = parseTrainSpec(opened.request.train, scene);
    for (int i = 0; i < int(scene.frames.size()); ++i) {
      const std::string& id = scene.frames[std::size_t(i)].id;
      if (std::count(opened.request.excluded.begin(), opened.request.excluded.end(), i)) continue;
      const bool training = std::count(train.frames.begin(), train.frames.end(), i) > 0;
      if (training) session.training.push_back(id);
      if (!training || train.perSurface) session.heldOut.push_back(id);
    }
  }
  addState(session, opened);
  writeSession(session, path);
}

std::string recoveryText(const Opened& opened, const std::string& path) {
  Session session;
  session.input = fs::absolute(opened.scene->file).lexically_normal();
  session.allowOutsidePaths = opened.scene->allowOutsidePaths;
  const std::string& of = opened.isSession && !opened.path.empty() ? opened.path : opened.scene->file.string();
  session.recovery = Recovery{fs::absolute(of).lexically_normal(), opened.isSession && !opened.path.empty()};
  addState(session, opened);
  return sessionText(session, path);
}

void autosaveSession(const Opened& opened, const std::string& path) { atomicWrite(path, recoveryText(opened, path)); }

}  // namespace glint::gui
