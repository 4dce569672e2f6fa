// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/load_plugins.h"

#include <dlfcn.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <sstream>

#include "core/base/number_text.h"
#include "core/base/safe_text.h"
#include "core/scene/capture.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

std::vector<LoadedPlugin>& loaded() {
  static std::vector<LoadedPlugin> plugins;
  return plugins;
}

/// Keeps what a plugin adds until all of it has been checked.
class Staged final : public PluginRegistry {
 public:
  void add(std::unique_ptr<HighlightModel> model) override {
    require(model && !model->id().empty() && !findModel(model->id()), "a model needs a name of its own");
    take("model " + model->id());
    models_.push_back(std::move(model));
  }
  void add(std::unique_ptr<const LobeProfile> lobe) override {
    require(lobe != nullptr, "no lobe");
    checkLobe(*lobe);
    take("lobe " + lobe->name());
    lobes_.push_back(std::move(lobe));
  }
  void add(std::unique_ptr<const ShapeKind> surface) override {
    require(surface != nullptr, "no surface");
    checkShapeKind(*surface);
    take("surface " + surface->name());
    surfaces_.push_back(std::move(surface));
  }
  void add(std::unique_ptr<const CaptureReader> reader) override {
    require(reader != nullptr, "no reader");
    checkCaptureReader(*reader);
    take("reader " + reader->name());
    readers_.push_back(std::move(reader));
  }

  void keep() {
    for (auto& m : models_) addModel(std::move(m));
    for (auto& l : lobes_) addLobe(std::move(l));
    for (auto& s : surfaces_) addShapeKind(std::move(s));
    for (auto& r : readers_) addCaptureReader(std::move(r));
  }
  const std::vector<std::string>& added() const { return added_; }

 private:
  void take(const std::string& what) {
    require(std::find(added_.begin(), added_.end(), what) == added_.end(), "it adds " + what + " twice");
    added_.push_back(what);
  }

  std::vector<std::string> added_;
  std::vector<std::unique_ptr<HighlightModel>> models_;
  std::vector<std::unique_ptr<const LobeProfile>> lobes_;
  std::vector<std::unique_ptr<const ShapeKind>> surfaces_;
  std::vector<std::unique_ptr<const CaptureReader>> readers_;
};

/// The declaration, after the parts of it that say whether the rest can be read.
const PluginDeclaration& declarationOf(void* library, const fs::path& file) {
  const auto* const declared = static_cast<const PluginDeclaration*>(::dlsym(library, "glint_plugin"));
  if (!declared || declared->magic != kPluginMagic)
    throw InputError(file.string(), "", "is no plugin of Glint: it does not export glint_plugin (core/app/plugin.h)");
  if (declared->interface != GLINT_INTERFACE_VERSION)
    throw InputError(file.string(), "",
                     formatted("was made for version %d of Glint's plugin interface, and this is version %d: compile it again",
                               int(declared->interface), GLINT_INTERFACE_VERSION));
  const std::string name = declared->name ? declared->name : "";
  if (std::string(declared->headers) != GLINT_VERSION)
    throw InputError(file.string(), "plugin '" + name + "'",
                     std::string("was compiled with the headers of Glint ") + declared->headers + ", and this is " +
                         GLINT_VERSION + ": compile it again");
  if (declared->alignment != EIGEN_MAX_ALIGN_BYTES)
    throw InputError(
        file.string(), "plugin '" + name + "'",
        formatted(
            "was compiled for vectors aligned to %d bytes, and this program has %d: compile it without -march=native or the like",
            int(declared->alignment), EIGEN_MAX_ALIGN_BYTES));
  if (name.empty() || !declared->version || !declared->about || !declared->add)
    throw InputError(file.string(), "", "is incomplete: it does not say its name, version, purpose and what it adds");
  return *declared;
}

/// Why nothing may be loaded from a file or folder; empty if it may.
std::string distrust(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return "cannot be read";
  if ((status.st_mode & S_IWOTH) != 0) return "every user can write to it";
  return {};
}

}  // namespace

void loadPlugin(const fs::path& file) {
  const fs::path path = fs::absolute(file).lexically_normal();
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw InputError(path.string(), "", "no such file");
  for (const LoadedPlugin& other : loaded())
    if (fs::equivalent(other.file, path, error)) return;
  // Local: a symbol of a plugin must not take the place of one of the program's.
  void* const library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    const char* const words = ::dlerror();
    throw InputError(path.string(), "", std::string("cannot be loaded: ") + (words ? words : "unknown reason"));
  }
  const PluginDeclaration& declared = declarationOf(library, path);
  const std::string name = withoutControls(declared.name);
  for (const LoadedPlugin& other : loaded())
    if (other.name == name)
      throw InputError(path.string(), "plugin '" + name + "'", "has the name of one that is loaded: " + other.file.string());
  Staged staged;
  try {
    declared.add(staged);
  } catch (const std::exception& e) {
    throw InputError(path.string(), "plugin '" + name + "'", std::string("is refused: ") + e.what());
  } catch (...) {
    throw InputError(path.string(), "plugin '" + name + "'",
                     "is refused: it threw something that is no exception of the standard library");
  }
  staged.keep();
  const std::string version = withoutControls(declared.version), about = withoutControls(declared.about);
  loaded().push_back(LoadedPlugin{name, version, about, path, staged.added(), &declared});
}

std::vector<fs::path> pluginFolders() {
  std::vector<fs::path> folders;
  if (const char* const listed = std::getenv("GLINT_PLUGIN_PATH")) {
    std::istringstream list(listed);
    for (std::string folder; std::getline(list, folder, ':');)
      if (!folder.empty()) folders.emplace_back(folder);
  }
  Dl_info here{};
  if (::dladdr(reinterpret_cast<const void*>(&loadPlugin), &here) != 0 && here.dli_fname)
    folders.push_back(fs::absolute(here.dli_fname).parent_path() / "glint/plugins");
  return folders;
}

std::vector<std::string> loadPlugins(const std::vector<fs::path>& named) {
  for (const fs::path& file : named) loadPlugin(file);
  std::vector<std::string> refused;
  for (const fs::path& folder : pluginFolders()) {
    std::error_code error;
    std::set<fs::path> files;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
      if (it->path().extension() == ".so" && it->is_regular_file(error)) files.insert(it->path());
    if (files.empty()) continue;
    if (const std::string why = distrust(folder); !why.empty()) {
      refused.push_back(folder.string() + ": no plugin is loaded from this folder: " + why);
      continue;
    }
    for (const fs::path& file : files) {
      try {
        if (const std::string why = distrust(file); !why.empty()) throw InputError(file.string(), "", why);
        loadPlugin(file);
      } catch (const InputError& e) {
        refused.push_back(std::string("plugin not loaded: ") + e.what());
      }
    }
  }
  return refused;
}

const std::vector<LoadedPlugin>& loadedPlugins() { return loaded(); }

std::string pluginLines() {
  std::string lines;
  for (const LoadedPlugin& p : loaded()) {
    lines += "\nplugin " + p.name + " " + p.version + ": " + p.about + " (";
    for (const std::string& what : p.added) lines += what + "; ";
    lines += p.file.string() + ")";
  }
  return lines;
}

}  // namespace glint
