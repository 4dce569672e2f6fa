// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/hidden_objects_option.h"

#include <map>
#include <sstream>
#include <string>

namespace glint::gui {

namespace {
const std::string kOption = "scene/hidden";
const std::string kCamera = "camera ", kSurface = "surface ", kLight = "light ", kEllipsoid = "ellipsoid ";

/// What follows the prefix of a line; nothing if it has another one.
std::optional<std::string> after(const std::string& prefix, const std::string& line) {
  if (line.rfind(prefix, 0) != 0) return {};
  return line.substr(prefix.size());
}
}  // namespace

viz::HiddenObjects hiddenObjects(const Document& document) {
  viz::HiddenObjects hidden;
  const std::string text = document.option(kOption, std::string());
  if (text.empty() || !document.scene()) return hidden;
  std::map<std::string, int> frames;
  for (int i = 0; i < document.frameCount(); ++i) frames[document.scene()->frames[std::size_t(i)].id] = i;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const auto id = after(kCamera, line)) {
      if (const auto found = frames.find(*id); found != frames.end()) hidden.frames.insert(found->second);
    } else if (const auto key = after(kSurface, line)) {
      hidden.surfaces.insert(*key);
    } else if (const auto light = after(kLight, line)) {
      hidden.lights.insert(*light);
    } else if (const auto which = after(kEllipsoid, line)) {
      const std::size_t at = which->find(' ');  // no model's name holds one
      if (at != std::string::npos) hidden.ellipsoids.insert({which->substr(0, at), which->substr(at + 1)});
    }
  }
  return hidden;
}

void setHiddenObjects(Document& document, const viz::HiddenObjects& hidden, const QString& text) {
  if (!document.scene() || hidden == hiddenObjects(document)) return;
  std::string lines;
  for (const int frame : hidden.frames) lines += kCamera + document.scene()->frames[std::size_t(frame)].id + '\n';
  for (const std::string& key : hidden.surfaces) lines += kSurface + key + '\n';
  for (const std::string& light : hidden.lights) lines += kLight + light + '\n';
  for (const auto& [model, light] : hidden.ellipsoids) lines += kEllipsoid + model + ' ' + light + '\n';
  document.setOption(kOption, lines, text);
}

}  // namespace glint::gui
