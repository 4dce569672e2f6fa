// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>

#include "core/base/json_dom.h"
#include "core/base/outcome.h"
#include "core/base/part_file.h"
#include "core/report/band_text.h"
#include "core/report/evaluation_json.h"
#include "core/report/evaluation_part.h"
#include "core/report/part_records.h"
#include "core/report/warnings.h"

namespace glint {
namespace {

using evaluation::ComparisonRecord;
using evaluation::FitOrder;
using evaluation::FrameRecord;
using json_dom::Json;

/// A model's share of all parts, in the order of one run.
struct MergedModel {
  std::string name;
  Json fits = Json::array(), rows = Json::array(), remarks = Json::array();
  Json band;  ///< of the first part; null = none
  std::vector<ComparisonTally> tallies;
  std::vector<std::string> warnings;
  FitReasons reasons;
};

/// A list of a document, checked.
JsonNode listAt(const JsonNode& object, const std::string& key) {
  const JsonNode list = object.at(key);
  if (!list.isArray()) list.fail("must be an array");
  return list;
}

void requireSameRequest(const std::vector<PartFile>& parts) {
  const PartFile& first = parts.front();
  for (const PartFile& part : parts) {
    for (const char* key : {"glint_evaluation", "train", "train_spec", "excluded", "level", "level_reason", "source", "settings",
                            "what_if", "shard.scene_frames", "shard.per_surface", "shard.noise_px", "shard.seed", "shard.truth"})
      requireSame(first, part, key);
    if (!part.checked.at("shard").at("per_surface").boolean()) requireSame(first, part, "training");
    if (part.checked.at("models").keys() != first.checked.at("models").keys())
      throw InputError(part.file, "models", "are others than those of " + first.file);
    const JsonNode inputs = part.checked.at("shard").at("inputs"), others = first.checked.at("shard").at("inputs");
    for (const std::string& path : inputs.keys()) {
      const std::optional<JsonNode> other = others.find(path);
      if (other && other->text() != inputs.at(path).text())
        throw InputError(part.file, "shard.inputs", "the input " + path + " is another one than for " + first.file);
    }
  }
}

/// What all parts say about frames; each frame of the scene exactly once.
std::vector<FrameRecord> frameRecords(const std::vector<PartFile>& parts) {
  std::vector<std::pair<FrameRecord, const PartFile*>> found;
  for (const PartFile& part : parts) {
    const JsonNode about = part.checked.at("shard");
    const JsonNode frames = listAt(about, "frames"), records = listAt(about, "records");
    if (records.size() != frames.size()) records.fail("must have as many entries as `frames`");
    for (std::size_t i = 0; i < records.size(); ++i) {
      found.emplace_back(evaluation::readFrameRecord(records.at(i)), &part);
      if (found.back().first.note.frame != frames.at(i).integer()) records.at(i).fail("is of another frame than `frames` says");
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto& a, const auto& b) { return a.first.note.frame < b.first.note.frame; });
  const int n = parts.front().checked.at("shard").at("scene_frames").integer();
  std::vector<FrameRecord> all;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const int frame = found[i].first.note.frame;
    if (frame == static_cast<int>(i) && frame < n) {
      all.push_back(std::move(found[i].first));
      continue;
    }
    if (frame < static_cast<int>(i))
      throw InputError(found[i].second->file, "shard.frames", "frame " + found[i].first.note.id + " is in another part, too");
    throw InputError(found[i].second->file, "shard.frames",
                     frame >= n ? "frame " + found[i].first.note.id + " is at position " + std::to_string(frame) +
                                      ", and the scene has " + std::to_string(n) + " frames"
                                : "no part has the frame at position " + std::to_string(i));
  }
  if (static_cast<int>(all.size()) != n)
    throw InputError(parts.back().file, "shard.frames", "no part has the frame at position " + std::to_string(all.size()));
  return all;
}

Json withoutTimes(Json fit) {
  fit.erase("time_us");
  return fit;
}

struct OrderedFit {
  FitOrder order;
  Json fit;
  std::vector<std::string> bandRemarks;
};

/// The remarks of a model's band, in the order of its fits.
std::vector<std::string> bandRemarks(const JsonNode& model) {
  std::vector<std::string> remarks;
  if (const std::optional<JsonNode> band = model.find("band")) {
    const JsonNode list = listAt(*band, "remarks");
    for (std::size_t i = 0; i < list.size(); ++i) remarks.push_back(list.at(i).text());
  }
  return remarks;
}

std::vector<OrderedFit> fitsOf(const PartFile& part, const std::string& name) {
  const JsonNode fits = listAt(part.checked.at("models").at(name), "fits");
  const JsonNode orders = listAt(part.checked.at("shard").at("models").at(name), "fits");
  if (orders.size() != fits.size()) orders.fail("must have as many entries as the model's `fits`");
  const std::vector<std::string> remarks = bandRemarks(part.checked.at("models").at(name));
  std::vector<OrderedFit> found;
  auto next = remarks.begin();
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!fits.at(i).isObject()) fits.at(i).fail("must be an object");
    const FitOrder order = evaluation::readFitOrder(orders.at(i));
    if (order.bandRemarks > remarks.end() - next) orders.at(i).fail("has more remarks than the band are left");
    found.push_back({order, json_dom::parse(fits.at(i).dump(), part.file), {next, next + order.bandRemarks}});
    next += order.bandRemarks;
  }
  return found;
}

/// Every shard makes the fits of its frames: the same ones, or those of its own surfaces.
void mergeFits(const std::vector<PartFile>& parts, bool perSurface, MergedModel& model) {
  std::vector<OrderedFit> fits = fitsOf(parts.front(), model.name);
  for (std::size_t p = 1; p < parts.size(); ++p) {
    const std::vector<OrderedFit> others = fitsOf(parts[p], model.name);
    if (perSurface) {
      fits.insert(fits.end(), others.begin(), others.end());
      continue;
    }
    bool same = others.size() == fits.size();
    for (std::size_t i = 0; same && i < fits.size(); ++i) same = withoutTimes(fits[i].fit) == withoutTimes(others[i].fit);
    if (!same)
      throw InputError(parts[p].file, "models." + model.name + ".fits",
                       "differ from those of " + parts.front().file +
                           ": the shards ran with other inputs, or on machines or builds that round differently");
  }
  if (perSurface)
    std::stable_sort(fits.begin(), fits.end(), [](const OrderedFit& a, const OrderedFit& b) { return a.order.before(b.order); });
  for (const OrderedFit& f : fits) {
    model.fits.push_back(f.fit);
    for (const std::string& remark : f.bandRemarks) model.remarks.push_back(remark);
  }
}

/// Remarks and failures of the merged fits, as sentences.
void readFits(const std::string& file, MergedModel& model) {
  const JsonNode fits = JsonNode::parse(model.fits.dump(), file);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const JsonNode fit = fits.at(i), surface = fit.at("surface"), remarks = listAt(fit, "warnings");
    model.reasons.add(fit.at("status").text(), fit.at("reason").text());
    if (fit.at("status").text() == "poor")
      model.warnings.push_back(fitWarning(model.name, fit.at("light").text(),
                                          surface.isNull() ? std::nullopt : std::optional(surface.text()),
                                          poorWarning(fit.at("reason").text())));
    for (std::size_t r = 0; r < remarks.size(); ++r)
      model.warnings.push_back(fitWarning(model.name, fit.at("light").text(),
                                          surface.isNull() ? std::nullopt : std::optional(surface.text()), remarks.at(r).text()));
  }
}

void mergeComparisons(const std::vector<PartFile>& parts, const std::vector<FrameRecord>& records, MergedModel& model) {
  struct Found {
    ComparisonTally tally;
    std::shared_ptr<const Json> rows;  ///< of the part
    std::size_t first, count;
  };
  std::vector<Found> found;
  for (const PartFile& part : parts) {
    const JsonNode comparisons = listAt(part.checked.at("shard").at("models").at(model.name), "comparisons");
    const JsonNode rows = listAt(part.checked.at("models").at(model.name), "frames");
    const auto raw = std::make_shared<const Json>(json_dom::parse(rows.dump(), part.file));
    std::size_t at = 0;
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
      ComparisonRecord r = evaluation::readComparisonRecord(comparisons.at(i));
      if (r.tally.frame >= static_cast<int>(records.size()) || !records[static_cast<std::size_t>(r.tally.frame)].note.heldOut)
        comparisons.at(i).fail("is of a frame that is not held out");
      if (r.tally.matched + r.tally.missed + r.tally.spurious > r.rows)
        comparisons.at(i).fail("counts more highlights than rows");
      const std::size_t count = static_cast<std::size_t>(r.rows);
      if (count > rows.size() - at) comparisons.at(i).fail("has more rows than the model's `frames` are left");
      found.push_back({std::move(r.tally), raw, at, count});
      at += count;
    }
    if (at != rows.size()) rows.fail("has rows of no comparison");
  }
  std::stable_sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.tally.frame < b.tally.frame; });
  for (Found& f : found) {
    for (std::size_t i = 0; i < f.count; ++i) model.rows.push_back((*f.rows)[f.first + i]);
    model.tallies.push_back(std::move(f.tally));
  }
}

/// The band's tolerances are settings, the same in every part.
void mergeBand(const PartFile& first, MergedModel& model) {
  const JsonNode of = first.checked.at("models").at(model.name);
  if (!of.has("band")) return;
  if (!of.at("band").isObject()) of.at("band").fail("must be an object");
  model.band = json_dom::parse(of.at("band").dump(), first.file);
  model.band.update(Json::parse(evaluation::bandJson(bandSummary(model.tallies))));
  model.band["remarks"] = model.remarks;
}

Json trainingOf(const std::vector<PartFile>& parts, bool perSurface) {
  Json all = Json::array();
  for (const PartFile& part : parts) {
    const JsonNode rows = listAt(part.checked, "training");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      rows.at(i).at("index").integer();
      all.push_back(json_dom::parse(rows.at(i).dump(), part.file));
    }
    if (!perSurface) return all;
  }
  std::stable_sort(all.begin(), all.end(), [](const Json& a, const Json& b) { return a.at("index") < b.at("index"); });
  return all;
}

/// Why nothing was answered, as `evaluate` says it.
std::string reasonOf(const std::vector<std::pair<std::string, ModelSummary>>& models) {
  std::string reasons;
  for (const auto& [name, s] : models) {
    if (s.answered) return "";
    reasons += (reasons.empty() ? "" : "; ") + name + ": " + s.reason;
  }
  return "no model answered; " + reasons;
}

/// The keys of one run, in its order.
Json documentOf(const std::vector<PartFile>& parts, const std::vector<FrameNote>& notes,
                const std::vector<FrameDetection>& detections, std::vector<std::string> warnings, const BestModel& best,
                Json models) {
  const PartFile& first = parts.front();
  const bool perSurface = first.checked.at("shard").at("per_surface").boolean();
  Json whole = Json::object();
  const Json document = json_dom::parse(first.checked.dump(), first.file);
  for (const auto& item : document.items())
    if (item.key() != "shard" && item.key() != "detection" && item.key() != "models")
      json_dom::append(whole, item.key(), item.value());
  whole["training"] = trainingOf(parts, perSurface);
  whole["scored_against"] = first.checked.at("shard").at("truth").boolean() ? "truth" : scoredAgainst(notes);
  whole["warnings"] = std::move(warnings);
  whole["chosen_model"] = best.model.empty() ? Json(nullptr) : Json(best.model);
  whole["why_chosen"] = best.why;
  if (const std::optional<DetectionError> d = detectionError(detections))
    whole["detection"] = Json::parse(evaluation::detectionJson(*d));
  whole["models"] = std::move(models);
  return whole;
}

}  // namespace

MergedEvaluation mergedEvaluation(const std::vector<std::string>& files) {
  const std::vector<PartFile> parts = readParts(files);
  const PartFile& first = parts.front();
  if (first.kind != "glint_evaluation") throw InputError(first.file, "", "is no part of an evaluation");
  if (first.checked.at("glint_evaluation").integer() != 1)
    first.checked.at("glint_evaluation").fail("only version 1 is supported");
  requireSameRequest(parts);
  const bool perSurface = first.checked.at("shard").at("per_surface").boolean();
  const std::vector<FrameRecord> records = frameRecords(parts);
  std::vector<FrameNote> notes;
  std::vector<FrameDetection> detections;
  HeldOutFrames heldOut;
  std::int64_t missed = 0;
  for (const FrameRecord& r : records) {
    notes.push_back(r.note);
    if (r.detection) {
      missed += r.detection->missed;
      if (missed > std::numeric_limits<int>::max())
        throw InputError(first.file, "shard.records", "count too many missed highlights");
      detections.push_back(*r.detection);
    }
    heldOut.all += r.note.heldOut;
    heldOut.unreadable += r.note.heldOut && r.note.unreadable;
  }

  std::vector<std::string> warnings = evidenceWarnings(notes);
  std::vector<std::pair<std::string, ModelSummary>> summaries;
  Json models = Json::object();
  for (const std::string& name : first.checked.at("models").keys()) {
    MergedModel m;
    m.name = name;
    mergeFits(parts, perSurface, m);
    readFits(first.file, m);
    mergeComparisons(parts, records, m);
    mergeBand(first, m);
    warnings.insert(warnings.end(), m.warnings.begin(), m.warnings.end());
    summaries.emplace_back(name, summaryOf(m.tallies, m.reasons, heldOut));
    const ModelSummary& s = summaries.back().second;
    Json j = {{"status", s.status()}, {"reason", s.reason}, {"fits", std::move(m.fits)}};
    j["summary"] = Json::parse(evaluation::summaryJson(s));
    if (!m.band.is_null()) j["band"] = std::move(m.band);
    j["frames"] = std::move(m.rows);
    json_dom::append(models, name, std::move(j));
  }
  const Json whole = documentOf(parts, notes, detections, std::move(warnings), evaluation::bestOf(summaries), std::move(models));
  return {whole.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", static_cast<int>(records.size()),
          reasonOf(summaries)};
}

}  // namespace glint
