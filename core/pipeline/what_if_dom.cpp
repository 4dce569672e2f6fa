// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/what_if_dom.h"

#include <algorithm>
#include <iterator>

#include "core/base/bounded_json.h"

namespace glint {
using json_dom::Json;

namespace {
Json toJson(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }
Json toJson(const Pixel& p) { return Json::array({p.x(), p.y()}); }

int frameOf(const JsonNode& node) {
  const int frame = node.at("frame").integer();
  if (frame < 0) node.at("frame").fail("must not be negative");
  return frame;
}

HighlightEdit editOf(const JsonNode& node) {
  using Kind = HighlightEdit::Kind;
  HighlightEdit edit;
  edit.frame = frameOf(node);
  const std::string name = node.at("kind").text();
  const Kind kinds[] = {Kind::Ignore, Kind::Merge, Kind::Split, Kind::Seed};
  const auto kind = std::find_if(std::begin(kinds), std::end(kinds), [&](Kind k) { return name == nameOf(k); });
  if (kind == std::end(kinds)) node.at("kind").fail("unknown edit '" + name + "' (ignore, merge, split, seed)");
  edit.kind = *kind;
  const JsonNode places = node.at("places");
  if (places.size() != placesOf(edit.kind))
    places.fail("needs " + std::to_string(placesOf(edit.kind)) + ", has " + std::to_string(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) edit.places.push_back(pixel(places.at(i)));
  if (const auto light = node.find("light")) edit.light = light->text();
  return edit;
}
}  // namespace

Json toJson(const WhatIf& w) {
  Json root = {{"poses", Json::array()}, {"highlights", Json::array()}};
  for (const auto& [frame, change] : w.poses)
    root["poses"].push_back(
        {{"frame", frame}, {"rotation", toJson(change.rotation)}, {"translation", toJson(change.translation)}});
  for (const auto& [at, change] : w.highlights)
    root["highlights"].push_back({{"frame", at.first},
                                  {"highlight", at.second},
                                  {"contour_by", toJson(change.contourBy)},
                                  {"contour_scale", change.contourScale},
                                  {"peak_by", toJson(change.peakBy)}});
  if (!w.edits.empty()) root["edits"] = Json::array();
  for (const HighlightEdit& e : w.edits) {
    Json edit = {{"frame", e.frame}, {"kind", nameOf(e.kind)}, {"places", Json::array()}};
    for (const Pixel& p : e.places) edit["places"].push_back(toJson(p));
    if (!e.light.empty()) edit["light"] = e.light;
    root["edits"].push_back(std::move(edit));
  }
  if (!w.lightsSwitched.empty()) root["lights_switched"] = Json::array();
  for (const auto& [at, on] : w.lightsSwitched)
    root["lights_switched"].push_back({{"frame", at.first}, {"light", at.second}, {"on", on}});
  if (w.synthesise) {
    Json synthetic = {
        {"lobe", nameOf(w.lobe)}, {"roughness", w.roughness}, {"lights_by", Json::object()}, {"surfaces", Json::object()}};
    for (const auto& [id, by] : w.lightsBy) synthetic["lights_by"][id] = toJson(by);
    for (const auto& [id, value] : w.surfaces) synthetic["surfaces"][id] = value;
    root["synthesise"] = std::move(synthetic);
  }
  return root;
}

WhatIf readWhatIf(const JsonNode& node) {
  WhatIf w;
  if (const auto poses = node.find("poses"))
    for (std::size_t i = 0; i < poses->size(); ++i) {
      const JsonNode n = poses->at(i);
      w.poses[frameOf(n)] = {boundedAll(n.at("rotation"), kLargestFactor).vector3(), lengths3(n.at("translation"))};
    }
  if (const auto highlights = node.find("highlights"))
    for (std::size_t i = 0; i < highlights->size(); ++i) {
      const JsonNode n = highlights->at(i);
      HighlightChange change{pixel(n.at("contour_by")), positive(n.at("contour_scale"), kFarthestPx), pixel(n.at("peak_by"))};
      w.highlights[{frameOf(n), n.at("highlight").integer()}] = change;
    }
  if (const auto edits = node.find("edits"))
    for (std::size_t i = 0; i < edits->size(); ++i) w.edits.push_back(editOf(edits->at(i)));
  if (const auto lights = node.find("lights_switched"))
    for (std::size_t i = 0; i < lights->size(); ++i) {
      const JsonNode n = lights->at(i);
      w.lightsSwitched[{frameOf(n), n.at("light").text()}] = n.at("on").boolean();
    }
  if (const auto s = node.find("synthesise"); s && !s->isNull()) {
    w.synthesise = true;
    const std::string lobe = s->at("lobe").text();
    const std::optional<Lobe> known = lobeOf(lobe);
    if (!known) s->at("lobe").fail("unknown lobe '" + lobe + "'");
    w.lobe = *known;
    w.roughness = positive(s->at("roughness"), kLargestFactor);
    if (const auto lights = s->find("lights_by"))
      for (const std::string& id : lights->keys()) w.lightsBy[id] = lengths3(lights->at(id));
    if (const auto surfaces = s->find("surfaces"))
      for (const std::string& id : surfaces->keys()) w.surfaces[id] = bounded(surfaces->at(id), kFarthest);
  }
  return w;
}

}  // namespace glint
