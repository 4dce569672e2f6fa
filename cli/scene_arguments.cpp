// SPDX-License-Identifier: BSD-3-Clause
#include "cli/scene_arguments.h"

namespace glint::cli {

void SceneArguments::declarePlaces(Options& o) {
  o.repeated(photographs, "--photographs", "DIR",
             "Folder to search first for photographs, by the ends of their paths; may be repeated");
  o.repeated(files, "--files", "KIND=DIR",
             "Folder to search first for other frame files: depth, normals, masks (or photographs); may be repeated");
  o.repeated(mesh, "--mesh", "NAME=FILE", "Use FILE as the mesh that the scene file calls NAME; may be repeated");
  o.repeated(meshFolders, "--meshes", "DIR", "Folder to search for meshes that are not in their place; may be repeated");
}

void SceneArguments::declareReading(Options& o) {
  for (const ChoiceOption& option : choiceOptions()) o.option(reading[option.flag], option.flag, option.value, option.help);
}

void SceneArguments::declare(Options& o) {
  declareReading(o);
  declareForSession(o);
}

void SceneArguments::declareForSession(Options& o) {
  o.flag(allowOutside, "--allow-outside", "Accept paths outside the folders of the session and the scene file");
  declarePlaces(o);
}

}  // namespace glint::cli
