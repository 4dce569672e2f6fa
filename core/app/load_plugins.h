// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/app/plugin.h"

namespace glint {

struct LoadedPlugin {
  std::string name, version, about;
  std::filesystem::path file;      ///< absolute
  std::vector<std::string> added;  ///< "model flat-mirror", "lobe student-t", ...
  const PluginDeclaration* declaration = nullptr;
};

/// Loads one plugin and adds what it brings. Not thread-safe: before anything asks for models, lobes, surfaces or readers.
/// InputError(file, place, reason): the file cannot be loaded (the loader's own words), is no plugin of Glint, was compiled for
/// another version, has the name of a loaded one, adds what is there already or what is wrong (a lobe whose derivatives are), or
/// throws. Then nothing of it is kept.
void loadPlugin(const std::filesystem::path& file);
/// Folders whose `*.so` programs load: those in GLINT_PLUGIN_PATH (with colons), then `glint/plugins` beside libglint-core.
std::vector<std::filesystem::path> pluginFolders();
/// Loads the plugins of `named`, then those in pluginFolders(), each folder in the order of names.
/// @throw InputError for one of `named`. @return one line for each in a folder that was refused, with its file and the reason:
/// also for one in a folder, or a file, that other users can write to.
std::vector<std::string> loadPlugins(const std::vector<std::filesystem::path>& named);
/// The plugins, in the order in which they were loaded.
const std::vector<LoadedPlugin>& loadedPlugins();
/// One line each for --version and the like: "plugin flat-mirror 1.0: Predicts ... (model flat-mirror; /path/flat_mirror.so)".
std::string pluginLines();

}  // namespace glint
