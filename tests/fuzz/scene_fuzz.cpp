// SPDX-License-Identifier: BSD-3-Clause
// The readers of JSON documents: scene, session, specification of synth, contours of --truth. What was read can be written, and
// what was written is read again.
#include "core/app/session.h"
#include "core/base/outcome.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/inspection.h"
#include "core/scene/scene_json.h"
#include "core/synth/synth.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/scratch_file.h"

namespace glint::fuzz {
namespace {

constexpr const char* kScene =
    R"({"glint_scene":1,"camera":{"width":64,"height":48,"fx":80,"fy":80,"cx":31.5,"cy":23.5,"distortion":[0.1,0,0,0,0]},
"frames":[{"id":"0000","camera_from_world":[[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]],"lights_on":["lamp"]}],
"surfaces":{"body":{"analytic":{"type":"sphere","radius":0.4}}}})";
constexpr const char* kMesh =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

/// Runs `read`; false = refused by an InputError with the file's name, or with that of a file that it names.
/// @param names  whether it may name files that are read with it
template <class Read>
bool refusable(const std::string& file, const Read& read, bool names = false) {
  try {
    read();
    return true;
  } catch (const InputError& e) {
    const std::string other = std::filesystem::path(e.file()).filename().string();
    checkRefusal(e, names && !other.empty() ? other : file);
    return false;
  }
}

}  // namespace

const ScratchFolder& scratch() {
  static const ScratchFolder folder;
  static const bool filled = [] {
    folder.write("body.ply", kMesh);
    folder.write("scene.json", kScene);
    return true;
  }();
  (void)filled;
  return folder;
}

bool feedScene(const std::string& bytes) {
  const std::filesystem::path file = scratch().path() / "fed.json";
  const auto read = [&] {
    const Scene scene = readSceneJson(bytes, file, {});
    std::string written;
    try {
      written = sceneToJson(scene, scene.folder);
      readSceneJson(written, file, {});
    } catch (const InputError& e) {
      throw Finding{std::string("a scene that was read cannot be written and read again: ") + e.what()};
    }
  };
  return refusable("fed.json", read, /*names=*/true);  // the camera's response may be a file
}

bool feedSession(const std::string& bytes) {
  const std::filesystem::path file = scratch().path() / "fed.glint";
  return refusable("fed.glint", [&] {
    Session session = parseSession(bytes, file);
    if (session.allowOutsidePaths) throw Finding{"a session that gives itself rights"};
    // What it names may be missing, no scene, a device: a refusal that names that file, not the session.
    try {
      openSession(session);
    } catch (const InputError& e) {
      checkRefusal(e, "");
    }
    try {
      for (const std::string& line : changedFiles(session)) checkRefusal(std::runtime_error(line), "");
    } catch (const InputError& e) {
      checkRefusal(e, "");
    }
  });
}

bool feedSynth(const std::string& bytes) {
  const std::filesystem::path file = scratch().write("spec.json", bytes);
  return refusable("spec.json", [&] { readSynthSpec(file); });
}

bool feedTruth(const std::string& bytes) {
  static const Scene scene = readSceneJson(kScene, scratch().path() / "scene.json", {});
  scratch().write("0000.json", bytes);
  return refusable("0000.json", [&] {
    const Outcome<std::vector<Highlight>> truth = readTruth(scratch().path().string(), scene, 0, 0.5);
    if (!truth && truth.failure().message().empty()) throw Finding{"contours refused without words"};
  });
}

}  // namespace glint::fuzz
