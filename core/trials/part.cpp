// SPDX-License-Identifier: BSD-3-Clause
#include "core/trials/part.h"

#include <algorithm>
#include <cmath>

#include "core/base/json_dom.h"
#include "core/base/part_file.h"
#include "core/session/input_digests.h"
#include "core/trials/measure.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTradeoffKind = "glint_tradeoff";

/// Places in the list of settings, one for every point and one for every setting that has none.
struct Places {
  std::vector<int> points, pruned;
};

Json settingsJson(const Settings& settings) {
  Json j = Json::object();
  for (const ParamSpec& spec : allParams()) j[spec.key] = textOf(valueOf(settings, spec));
  return j;
}

std::vector<int> placesAt(const JsonNode& list, std::size_t count) {
  if (!list.isArray() || list.size() != count) list.fail("must have one place for each setting");
  std::vector<int> places;
  for (std::size_t i = 0; i < count; ++i) places.push_back(list.at(i).integer());
  return places;
}

std::optional<double> optionalPositive(const JsonNode& node) {
  if (node.isNull()) return std::nullopt;
  if (!(node.number() > 0)) node.fail("must be positive");
  return node.number();
}

/// What one part adds, by place in the list.
struct Measured {
  int place;
  bool isPoint;
  std::size_t index;
  const PartFile* part;
  const Tradeoff* from;
};

void requireEachOnce(std::vector<Measured>& all, int count) {
  std::stable_sort(all.begin(), all.end(), [](const Measured& a, const Measured& b) { return a.place < b.place; });
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].place == static_cast<int>(i) && all[i].place < count) continue;
    throw InputError(all[i].part->file, "shard",
                     all[i].place < static_cast<int>(i) ? "setting " + std::to_string(all[i].place) + " is in another part, too"
                                                        : "no part has setting " + std::to_string(i));
  }
  if (static_cast<int>(all.size()) != count)
    throw InputError(all.empty() ? "" : all.back().part->file, "shard", "no part has setting " + std::to_string(all.size()));
}

}  // namespace

std::vector<Trial> fixedTrials(const InspectionRequest& request, const std::vector<std::string>& models) {
  std::vector<Trial> trials;
  for (const std::string& model : models) trials.push_back({model, request.settings});
  for (const Knob& knob : knobsOf(request.settings))
    for (const SettingValue& value : knob.values)
      for (const std::string& model : models) {
        if (!knob.onlyModel.empty() && knob.onlyModel != model) continue;
        if (valueOf(request.settings, paramSpec(knob.key)) == value) continue;
        trials.push_back({model, request.settings});
        trials.back().settings.set(knob.key, value);
      }
  return trials;
}

std::string tradeoffPart(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const TradeoffOptions& options,
                         const Shard& shard, const ProgressFn& progress) {
  require(scene != nullptr, "tradeoffPart: no scene");
  Tradeoff t = emptyTradeoff(*scene, request, options);
  const std::vector<Trial> trials = fixedTrials(request, namedModels(request.models));
  StageEvent now{"tradeoff: highlights", 0, 0};
  const ProgressFn outer = [&](const StageEvent&) { return report(progress, now); };
  TradeoffBench bench(scene, request, options.repeats, outer);
  Places places;
  const int count = static_cast<int>(trials.size());
  for (int k = shard.index - 1; k < count; k += shard.of) {
    const Trial& trial = trials[static_cast<std::size_t>(k)];
    now = {"tradeoff: measure, " + trial.model, k / shard.of + 1, count / shard.of + 1};
    if (!report(progress, now)) throw Stopped{};
    const auto leaveOut = [&](const std::string& kind, const std::string& reason) {
      t.pruned.push_back({trial.model, trial.settings, kind, reason, std::nan(""), std::nan("")});
      places.pruned.push_back(k);
    };
    if (k >= options.search.maxTrials) {
      leaveOut("limit", "the limit of " + std::to_string(options.search.maxTrials) + " settings was reached");
      continue;
    }
    Outcome<TradeoffPoint> point = bench.full(trial);
    if (!point) {
      leaveOut("failed", point.failure().message());
      continue;
    }
    point->model = trial.model;
    point->settings = trial.settings;
    t.points.push_back(std::move(*point));
    places.points.push_back(k);
  }
  t.measurement = measurementText(bench, options.repeats);
  t.reason = "A part: the choice is made when all parts are merged.";
  Json document = json_dom::parse(tradeoffJson(t), "");
  Json inputs = Json::object();
  for (const auto& [path, sha256] : inputDigests(*scene, progress)) json_dom::append(inputs, path, sha256);
  const auto bound = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
  document["shard"] = {{"settings", count},
                       {"points", places.points},
                       {"pruned", places.pruned},
                       {"budget_us", bound(options.bound.budgetUs)},
                       {"max_error_pct", bound(options.bound.maxErrorPct)},
                       {"repeats", options.repeats},
                       {"most", options.search.maxTrials},
                       {"models", namedModels(request.models)},
                       {"base", settingsJson(request.settings)},
                       {"excluded", request.excluded},
                       {"source", request.source == FrameSource::Image ? "image" : "radiance"},
                       {"noise_px", request.noisePx},
                       {"seed", request.seed},
                       {"truth", !request.truthFolder.empty()},
                       {"inputs", std::move(inputs)}};
  return partText(document.dump(-1, ' ', false, Json::error_handler_t::replace), shard, "glint " + options.program);
}

Tradeoff mergedTradeoff(const std::vector<std::string>& files) {
  const std::vector<PartFile> parts = readParts(files);
  const PartFile& first = parts.front();
  if (first.kind != kTradeoffKind) throw InputError(first.file, "", "is no part of a trade-off");
  std::vector<Tradeoff> read;
  for (const PartFile& part : parts) read.push_back(readTradeoff(part.checked));
  std::vector<Measured> all;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const char* key : {"train", "train_spec", "knobs", "shard.settings", "shard.budget_us", "shard.max_error_pct",
                            "shard.repeats", "shard.most", "shard.models", "shard.base", "shard.excluded", "shard.source",
                            "shard.noise_px", "shard.seed", "shard.truth", "shard.inputs"})
      requireSame(first, parts[p], key);
    const JsonNode about = parts[p].checked.at("shard");
    const std::vector<int> points = placesAt(about.at("points"), read[p].points.size()),
                           pruned = placesAt(about.at("pruned"), read[p].pruned.size());
    for (std::size_t i = 0; i < points.size(); ++i) all.push_back({points[i], true, i, &parts[p], &read[p]});
    for (std::size_t i = 0; i < pruned.size(); ++i) all.push_back({pruned[i], false, i, &parts[p], &read[p]});
  }
  const JsonNode about = first.checked.at("shard");
  requireEachOnce(all, about.at("settings").integer());
  Tradeoff t = read.front();
  t.points.clear();
  t.pruned.clear();
  for (const Measured& m : all) {
    if (m.isPoint)
      t.points.push_back(m.from->points[m.index]);
    else
      t.pruned.push_back(m.from->pruned[m.index]);
  }
  choosePoint(t, {optionalPositive(about.at("budget_us")), optionalPositive(about.at("max_error_pct"))});
  return t;
}

}  // namespace glint
