// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/session_plugins.h"

#include <algorithm>
#include <iterator>

#include "core/app/load_plugins.h"

namespace glint {
namespace {

const LoadedPlugin* loaded(const SessionPlugin& plugin) {
  const std::vector<LoadedPlugin>& all = loadedPlugins();
  const auto it = std::find_if(all.begin(), all.end(), [&](const LoadedPlugin& p) { return p.name == plugin.name; });
  return it == all.end() ? nullptr : &*it;
}

}  // namespace

std::vector<SessionPlugin> pluginsToRecord(const std::vector<SessionPlugin>& known) {
  std::vector<SessionPlugin> all;
  for (const LoadedPlugin& p : loadedPlugins()) all.push_back({p.name, p.version, p.added});
  std::copy_if(known.begin(), known.end(), std::back_inserter(all), [](const SessionPlugin& p) { return !loaded(p); });
  return all;
}

std::vector<SessionPlugin> missingPlugins(const Session& session) {
  std::vector<SessionPlugin> missing;
  std::copy_if(session.plugins.begin(), session.plugins.end(), std::back_inserter(missing),
               [](const SessionPlugin& p) { return !loaded(p); });
  return missing;
}

std::string inWords(const std::vector<SessionPlugin>& plugins) {
  std::string words = plugins.size() == 1 ? "the plugin " : "the plugins ";
  for (std::size_t i = 0; i < plugins.size(); ++i) {
    if (i > 0) words += i + 1 == plugins.size() ? " and " : ", ";
    words += plugins[i].name + " " + plugins[i].version;
    std::string adds;
    for (const std::string& a : plugins[i].adds) adds += (adds.empty() ? "" : ", ") + a;
    if (!adds.empty()) words += " (" + adds + ")";
  }
  return words;
}

InputError withMissingPlugins(const InputError& failure, const std::vector<SessionPlugin>& missing) {
  std::string reason = failure.what();
  for (const std::string& before : {failure.file(), failure.place()})
    if (!before.empty() && reason.rfind(before + ": ", 0) == 0) reason.erase(0, before.size() + 2);
  return {failure.file(), failure.place(), reason + "; the session was saved with " + inWords(missing) + ", not loaded here"};
}

std::string pluginWarning(const Session& session) {
  std::string line;
  if (const std::vector<SessionPlugin> missing = missingPlugins(session); !missing.empty())
    line = "saved with " + inWords(missing) + ", which " + (missing.size() == 1 ? "is" : "are") +
           " not loaded; where results need what it adds, give --plugin FILE";
  for (const SessionPlugin& p : session.plugins)
    if (const LoadedPlugin* now = loaded(p); now && now->version != p.version)
      line += (line.empty() ? "" : "; ") + std::string("saved with the plugin ") + p.name + " " + p.version + ", and " +
              now->version + " is loaded";
  return line;
}

void requirePlugins(const Session& session) {
  for (const SessionPlugin& plugin : missingPlugins(session))
    for (const std::string& model : session.request.models)
      if (std::count(plugin.adds.begin(), plugin.adds.end(), "model " + model) > 0)
        throw InputError(session.file.string(), "request.models",
                         "the model '" + model + "' is from the plugin " + plugin.name + " " + plugin.version +
                             ", which is not loaded; give --plugin FILE");
}

}  // namespace glint
