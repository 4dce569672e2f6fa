// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <typeinfo>
#include <vector>

#include "core/app/session.h"
#include "core/base/words.h"

namespace glint {

/// What a session that is saved now says of plugins: those that are loaded, and those of `known` that are not.
std::vector<SessionPlugin> pluginsToRecord(const std::vector<SessionPlugin>& known);

/// Plugins of the session that are not loaded.
std::vector<SessionPlugin> missingPlugins(const Session& session);

/// One line: plugins that are not loaded, with what they add, or are loaded in another version; "" = none.
std::string pluginWarning(const Session& session);

/// InputError, by name, when the request has a model that a missing plugin adds.
void requirePlugins(const Session& session);

/// "the plugin example 1.0 (model flat-mirror, lobe student-t)", or "the plugins A (...) and B (...)".
std::string inWords(const std::vector<SessionPlugin>& plugins);

/// The same failure, with the plugins that are missing at its end: what they add may be what a reader stumbled over.
InputError withMissingPlugins(const InputError& failure, const std::vector<SessionPlugin>& missing);

/// Runs `read`. If it lacks something that a plugin may add, names the missing plugins. Other failures stay.
template <class Read>
auto namingMissingPlugins(const std::vector<SessionPlugin>& missing, Read&& read) {
  try {
    return read();
  } catch (const InputError& e) {
    if (missing.empty() || typeid(e) != typeid(InputError) ||
        std::string_view(e.what()).find(kPluginHint) == std::string_view::npos)
      throw;
    throw withMissingPlugins(e, missing);
  }
}

}  // namespace glint
