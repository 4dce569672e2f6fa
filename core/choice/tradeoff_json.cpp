// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>

#include "core/base/json_dom.h"
#include "core/base/json_text.h"
#include "core/base/outcome.h"
#include "core/base/settings_dom.h"
#include "core/choice/tradeoff.h"
#include "core/choice/tradeoff_dom.h"

namespace glint {
namespace {

using json_dom::Json;
using json_dom::numberOrNull;

/// "settings": short names of the knobs for people and scripts; "set": every setting that differs from the default, by the
/// dotted names that `--set` takes.
void addSettings(Json& j, const Tradeoff& t, const std::string& model, const Settings& settings) {
  j["settings"]["model"] = model;
  for (const std::string& key : t.knobs) j["settings"][knobName(key)] = toJson(settings.value(key));
  j["set"] = Json::object();
  for (const auto& [key, value] : settings.values()) j["set"][key] = toJson(value);
}

double optionalNumber(const JsonNode& node) { return node.isNull() ? std::nan("") : node.number(); }

}  // namespace

Json toJson(const Tradeoff& t) {
  Json j = {{"glint_tradeoff", 1},     {"input", t.input},          {"train", t.train},
            {"train_ids", t.trainIds}, {"train_spec", t.trainSpec}, {"knobs", t.knobs}};
  j["points"] = Json::array();
  for (const TradeoffPoint& p : t.points) {
    Json point;
    addSettings(point, t, p.model, p.settings);
    point["status"] = p.poor.empty() ? "ok" : "poor";
    point["reason"] = p.poor;
    point["contour_error_pct"] = numberOrNull(p.contourErrorPct);
    point["iou"] = numberOrNull(p.iou);
    point["coverage"] = numberOrNull(p.coverage);
    point["predict_us"] = numberOrNull(p.predictUs);
    point["fit_us"] = numberOrNull(p.fitUs);
    point["peak_mb"] = numberOrNull(p.peakMb);
    point["pareto"] = p.pareto;
    point["ranked_error_pct"] = numberOrNull(p.rankedErrorPct);
    point["frames"] = p.frames;
    point["predicted"] = p.predicted;
    point["matched"] = p.matched;
    point["missed"] = p.missed;
    point["spurious"] = p.spurious;
    j["points"].push_back(point);
  }
  j["presets"] = Json::object();
  for (const char* name : {"fast", "balanced", "exact"})
    if (const auto it = t.presets.find(name); it != t.presets.end()) j["presets"][name] = it->second;
  j["chosen"] = t.chosen ? Json(*t.chosen) : Json();
  j["reason"] = t.reason;
  j["measurement"] = t.measurement;
  j["trials"] = t.trials;
  j["pruned"] = Json::array();
  for (const PrunedPoint& p : t.pruned) {
    Json pruned;
    addSettings(pruned, t, p.model, p.settings);
    pruned["kind"] = p.kind;
    pruned["reason"] = p.reason;
    pruned["ranked_error_pct"] = numberOrNull(p.rankedErrorPct);
    pruned["predict_us"] = numberOrNull(p.predictUs);
    j["pruned"].push_back(pruned);
  }
  return j;
}

std::string tradeoffJson(const Tradeoff& t) { return json_dom::pretty(toJson(t)) + "\n"; }

Tradeoff readTradeoff(const JsonNode& node) {
  Tradeoff t;
  if (node.at("glint_tradeoff").integer() != 1) node.at("glint_tradeoff").fail("only version 1 is supported");
  t.input = node.at("input").text();
  for (std::size_t i = 0; i < node.at("train").size(); ++i) t.train.push_back(node.at("train").at(i).integer());
  if (const auto ids = node.find("train_ids"))  // files before it name frames by position alone
    for (std::size_t i = 0; i < ids->size(); ++i) t.trainIds.push_back(ids->at(i).text());
  t.trainSpec = node.at("train_spec").text();
  for (std::size_t i = 0; i < node.at("knobs").size(); ++i) {
    t.knobs.push_back(node.at("knobs").at(i).text());
    try {
      paramSpec(t.knobs.back());
    } catch (const InputError&) {
      node.at("knobs").at(i).fail("unknown setting");
    }
  }
  const JsonNode points = node.at("points");
  for (std::size_t i = 0; i < points.size(); ++i) {
    const JsonNode n = points.at(i);
    TradeoffPoint p;
    p.model = n.at("settings").at("model").text();
    p.settings = readSettings(n.at("set"));
    if (const auto reason = n.find("reason")) p.poor = reason->text();
    p.contourErrorPct = optionalNumber(n.at("contour_error_pct"));
    p.iou = optionalNumber(n.at("iou"));
    p.coverage = optionalNumber(n.at("coverage"));
    p.predictUs = optionalNumber(n.at("predict_us"));
    p.fitUs = optionalNumber(n.at("fit_us"));
    p.peakMb = optionalNumber(n.at("peak_mb"));
    p.pareto = n.at("pareto").boolean();
    p.rankedErrorPct = optionalNumber(n.at("ranked_error_pct"));
    p.frames = n.at("frames").integer();
    p.predicted = n.at("predicted").integer();
    p.matched = n.at("matched").integer();
    p.missed = n.at("missed").integer();
    p.spurious = n.at("spurious").integer();
    t.points.push_back(std::move(p));
  }
  const auto index = [&](const JsonNode& n) {
    const int i = n.integer();
    if (i < 0 || i >= static_cast<int>(t.points.size())) n.fail("is not an index into points");
    return i;
  };
  const JsonNode presets = node.at("presets");
  for (const std::string& name : presets.keys()) t.presets[name] = index(presets.at(name));
  if (!node.at("chosen").isNull()) t.chosen = index(node.at("chosen"));
  t.reason = node.at("reason").text();
  t.measurement = node.at("measurement").text();
  t.trials = node.at("trials").integer();
  const JsonNode pruned = node.at("pruned");
  for (std::size_t i = 0; i < pruned.size(); ++i) {
    const JsonNode n = pruned.at(i);
    t.pruned.push_back({n.at("settings").at("model").text(), readSettings(n.at("set")), n.at("kind").text(),
                        n.at("reason").text(), optionalNumber(n.at("ranked_error_pct")), optionalNumber(n.at("predict_us"))});
  }
  return t;
}

std::string describe(const Tradeoff& t, const TradeoffPoint& p) {
  std::string text = p.model;
  for (const std::string& key : t.knobs)
    if (const auto it = p.settings.values().find(key); it != p.settings.values().end())
      text += ", " + knobName(key) + " " + textOf(it->second);
  return text;
}

}  // namespace glint
