// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/bounded_json.h"
#include "core/base/json_text.h"
#include "core/geometry/camera_json.h"
#include "core/scene/scene.h"

namespace glint {

// The parts of scene.json (docs/formats.md, "Scene") that other documents share (synth SPEC.json, sessions). All throw
// InputError with file, place and reason. Keys that a part does not know are left to the caller (JsonNode::unknownKeys).

/// {"id", one of "position" | "direction" | "segment", "radius", "frame", "known", "sigma_m" | "sigma_deg"}. A direction is
/// normalised.
TrueLight readLightJson(const JsonNode& node);
/// The version of scene files that can say it: 2 for what moves or is known, else 1.
int versionOf(const Frame& frame);
int versionOf(const TrueLight& light);
/// The key of TrueLight::sigma.
const char* sigmaKey(bool ofDirection);

/// "made_by": "glint synth" at the top of a scene file says that `synth` wrote it as it is. It is read without a warning and not
/// kept, so that no copy that another command writes says so; another text under this key is an unknown key like others.
inline constexpr const char* kMadeBy = "made_by";
inline constexpr const char* kMadeBySynth = "glint synth";
bool isMadeBySynth(const JsonNode& root);

/// A scene from the text of a scene file. `file` names it in messages; paths are relative to its folder.
Scene readSceneJson(const std::string& text, const std::filesystem::path& file, const ReadOptions& options);
/// The text that `writeScene` writes for a file in `folder`.
/// InputError (place such as frames[0].image) when a path cannot be written relative to the folder.
std::string sceneToJson(const Scene& scene, const std::filesystem::path& folder);

}  // namespace glint
