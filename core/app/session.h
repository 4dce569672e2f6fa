// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/choice/tradeoff.h"
#include "core/pipeline/inspection.h"
#include "core/scene/relinked.h"

namespace glint {

/// A camera of a 3D view, world units.
struct SessionCamera {
  Eigen::Vector3d position{0, 0, 1}, focalPoint{0, 0, 0}, up{0, 1, 0};
  double viewAngleDeg = 30;  ///< vertical field of view
  bool parallel = false;     ///< orthographic, as high at the focal point as the perspective view would be
};

/// What the window showed; the results do not depend on it.
struct SessionView {
  std::string layout;                            ///< name of the arrangement of panels; "" = the program's own
  std::map<std::string, SessionCamera> cameras;  ///< by view name; "scene": of the first 3D view
  std::vector<SessionCamera> moreCameras;        ///< of the second 3D view and those after it
  std::map<std::string, bool> layers;            ///< visibility by layer name, where it differs from the default
  std::map<std::string, std::string> options;    ///< how views show things, as "VIEW/NAME"; absent = default
  std::string frame, model, light;               ///< selection; "" = none
  int highlight = -1;                            ///< index in the frame's evidence; -1 = none
  int predicted = -1;                            ///< of a spurious highlight, among those that the model predicts; -1 = none
};

/// A file that the results depend on.
struct SessionFile {
  std::filesystem::path path;  ///< absolute
  std::string sha256;          ///< 64 hexadecimal digits; "" = the file was missing or unreadable when the session was saved
};

/// A plugin that was loaded when the session was saved.
struct SessionPlugin {
  std::string name, version;
  std::vector<std::string> adds;  ///< as LoadedPlugin::added: "model flat-mirror", "lobe student-t"
};

/// A number of the results under a stable name ("canonical.contour_error_pct.mean"). NaN = not defined.
using KeyResults = std::vector<std::pair<std::string, double>>;

/// An autosave says what it would have been saved to.
struct Recovery {
  std::filesystem::path of;  ///< absolute: the session, or the scene that was opened without one
  bool isSession = false;
};

/// Everything of a session file *.glint (docs/formats.md, "Session"; resources/session.schema.json).
struct Session {
  std::filesystem::path file;        ///< as opened; empty for a new session
  std::filesystem::path input;       ///< absolute path of the scene
  std::optional<Recovery> recovery;  ///< set in autosaves only
  std::vector<FilesFolder> folders;  ///< in which frames' files are looked for before where the scene says; the last counts
  std::map<std::string, std::filesystem::path> meshes;  ///< absolute, those that lie elsewhere: by the path that the scene writes
  InputChoices choices;                                 ///< how a capture of another program is read
  /// The session and its scene may name files outside their folders. The caller says so, never the file: reading leaves it false.
  bool allowOutsidePaths = false;
  std::vector<SessionFile> files;      ///< the scene file first, then everything that it names
  std::vector<SessionPlugin> plugins;  ///< as read; what is written names those that are loaded, too
  InspectionRequest request;
  std::vector<std::string> training, heldOut;  ///< frame ids that `request.train` meant when it was saved
  SessionView view;
  std::string notes;
  std::optional<Tradeoff> tradeoff;   ///< measured speed against accuracy; a replay does not look at it
  KeyResults keyResults;              ///< empty if the session was saved without results
  std::string digest;                 ///< of all results, "" without results; equal on the same machine and build only
  std::vector<std::string> warnings;  ///< unknown keys, one line each (not written)
  std::string unknownJson;            ///< unknown top-level keys, kept for writing back; "" = none
};

/// InputError: file, place and reason; a version newer than this program's is refused.
Session readSession(const std::filesystem::path& file);
/// The same from text that is kept elsewhere (in a picture): paths start at the folder of `file`.
Session parseSession(const std::string& json, const std::filesystem::path& file);
/// Atomically; paths relative to the session's folder. InputError if it cannot be written.
void writeSession(const Session& session, const std::filesystem::path& file);
/// The text that `writeSession` writes.
std::string sessionText(const Session& session, const std::filesystem::path& file);

/// The scene of a session is not where the session says: the one failure that a person can repair by pointing at it.
class MissingScene : public InputError {
 public:
  MissingScene(const std::filesystem::path& session, std::filesystem::path scene);
  const std::filesystem::path& scene() const { return scene_; }  ///< absolute, where it was looked for

 private:
  std::filesystem::path scene_;
};

struct OpenedSession {
  Session session;
  std::shared_ptr<const Scene> scene;
  std::string warning;  ///< another file was given than the session was made with, or its plugins are not loaded; "" = neither
};
/// Reads a session and its scene; `changedFiles` checks the files' contents. InputError, also for a model of a plugin that is not
/// loaded; MissingScene, MissingMesh, OutsidePath.
/// @param instead  where inputs are now, if elsewhere; the session then names these places.
OpenedSession openSession(const std::filesystem::path& file, const Relinked& instead = {});
OpenedSession openSession(Session session, const Relinked& instead = {});

/// Makes an open session know that meshes of its scene lie elsewhere now, as `scene` says, and forgets the hashes of where they
/// were. One line about those whose content is not what the session was made with; "" = the same, or not known. Reads them.
std::string relinkMeshes(Session& session, const Scene& scene);

/// The session of a finished inspection, with hashes of its inputs, held-out frames, key results and digest; the view and notes
/// are left empty. Reads every input file once. Stopped.
Session sessionOf(const Inspection& inspection, const ProgressFn& progress = {});
/// Hashes of the scene, of the files that it names, and of the request's truth folder.
std::vector<SessionFile> hashInputs(const Scene& scene, const InspectionRequest& request, const ProgressFn& progress = {});

/// One line "path: changed" or "path: missing" for each input that is not what it was; of a file that the session may not name, a
/// line that says nothing about it. Stopped.
std::vector<std::string> changedFiles(const Session& session, const Relinked& instead = {}, const ProgressFn& progress = {});

/// Summaries of every model, limit angles and light positions; no times.
KeyResults keyResultsOf(const Inspection& inspection);
/// SHA-256 over the exact bits of lights, fits, predictions and metrics; no times.
std::string digestOf(const Inspection& inspection);

/// What a replay found. The inputs were unchanged.
struct Replay {
  std::vector<std::string> differences;  ///< key results beyond the tolerance, one line each; empty = they agree
  std::string firstChanged;              ///< the first stage whose results differ, in words; "" = none
  bool digestAgrees = false;
  int compared = 0;  ///< key results
  /// Largest one of a key result, relative to its size (at least 1e-3). It is compared with 1e-9.
  double largestDifference = 0;
};
/// Recomputes a session and compares: key results agree when they differ by at most 1e-9 relatively (or 1e-12 absolutely,
/// the round-off of numbers of order one).
/// @param instead  of it only the folders that a person named
/// @throw InputError if the session has no results, or (naming the first) an input changed or is missing; OutsidePath; Stopped.
Replay replay(const Session& session, const Relinked& instead = {}, const ProgressFn& progress = {});

/// Distance of two values of one key result, relative to the larger one plus a least size, so that a zero may be one that came
/// out as round-off: 1 px or 1 % for distances between contours and peaks, 1e-3 for the rest. 0 for two NaN, infinite for one.
/// @param keyResult  its name, as in KeyResults ("dual.contour_error_px.mean")
double keyResultDifference(const std::string& keyResult, double was, double is);

}  // namespace glint
