// SPDX-License-Identifier: BSD-3-Clause
// What other programs send back: poses line by line, labels that were corrected.
#include <cmath>
#include <sstream>

#include "core/pipeline/given_labels.h"
#include "core/scene/pose_lines.h"
#include "core/scene/scene_json.h"
#include "tests/fuzz/readers.h"
#include "tests/fuzz/scratch_file.h"

namespace glint::fuzz {
namespace {

constexpr const char* kLabelledScene =
    R"({"glint_scene":1,"camera":{"width":64,"height":48,"fx":80,"fy":80,"cx":31.5,"cy":23.5,"distortion":[0.1,0,0,0,0]},
"frames":[{"id":"0000","camera_from_world":[[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]],"lights_on":["lamp"]},
{"id":"0001","image":"pictures/0001.png","camera_from_world":[[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]]}],
"surfaces":{"body":{"analytic":{"type":"sphere","radius":0.4}}}})";

void requireRigid(const PoseLine& pose) {
  const Eigen::Matrix3d r = pose.cameraFromWorld.linear();
  if (!pose.cameraFromWorld.matrix().allFinite()) throw Finding{"a pose that is not finite"};
  constexpr double kRigid = 1e-5;  // a pose is repaired from 1e-6 on
  if (!((r * r.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < kRigid) || r.determinant() < 0)
    throw Finding{"a pose that is not rigid"};
  if (pose.id.empty()) throw Finding{"a pose without an id"};
  if (pose.time && !std::isfinite(*pose.time)) throw Finding{"a time that is not finite"};
}

}  // namespace

bool feedPoses(const std::string& bytes) {
  std::istringstream in(bytes);
  PoseLineReader reader(in, "fed.poses");
  bool all = true;
  for (std::size_t calls = 0; !reader.ended(); ++calls) {
    if (calls > bytes.size() + 1) throw Finding{"more lines than bytes"};
    try {
      const std::optional<PoseLine> pose = reader.next();
      if (!pose) break;
      requireRigid(*pose);
    } catch (const InputError& e) {
      checkRefusal(e, "fed.poses");
      if (e.place().empty()) throw Finding{"a refused line without its place"};
      all = false;
    }
  }
  return all;
}

bool feedLabels(const std::string& bytes) {
  static const std::filesystem::path file = scratch().path() / "labelled.json";
  static const Scene scene = readSceneJson(kLabelledScene, file, {});
  try {
    const LabelledScene labelled = withLabels(scene, bytes, "fed.json", {});
    try {
      readSceneJson(sceneToJson(labelled.scene, scene.folder), file, {});
    } catch (const InputError& e) {
      throw Finding{std::string("labels that were read make a scene that cannot be: ") + e.what()};
    }
    return true;
  } catch (const InputError& e) {
    checkRefusal(e, "fed.json");
    return false;
  }
}

}  // namespace glint::fuzz
