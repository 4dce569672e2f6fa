// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core, as json_dom.h: parts of scene.json as the JSON library's documents.

#include <functional>

#include "core/base/json_dom.h"
#include "core/scene/input_choices.h"
#include "core/scene/surface_source.h"

namespace glint {

json_dom::Json toJson(const Eigen::VectorXd& v);
json_dom::Json toJson(const Eigen::Matrix4d& m);
/// The path that a document writes for a file. @param place  in the document; InputError (place) where it cannot be written
using WrittenPath = std::function<std::string(const std::filesystem::path& file, const std::string& place)>;
/// The form that `readSurfaceJson` reads. InputError (place) for a surface that a scene file cannot name.
json_dom::Json toJson(const SurfaceSource& source, const std::string& place, const WrittenPath& written);
/// As `readInputChoices` reads it. @param relative  the path of a file relative to the session's folder; asked for those that
/// are named
json_dom::Json toJson(const InputChoices& choices, const std::function<std::string(const std::filesystem::path&)>& relative);

}  // namespace glint
