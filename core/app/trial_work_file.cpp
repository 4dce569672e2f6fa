// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/trial_work_file.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/base/json_text.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using json_dom::numberOrNull;

constexpr int kVersion = 2;  // 1 held reasons as numbers, whose meaning the next program changed

double numberOrNan(const JsonNode& j) { return j.isNull() ? std::nan("") : j.number(); }

// Settings are not stored: the id of a trial holds them, and the caller puts them back.
Json toJson(const TrialResult& r) {
  return {{"error_pct", numberOrNull(r.errorPct)}, {"us", numberOrNull(r.us)}, {"predictions", r.predictions}, {"poor", r.poor}};
}
Json toJson(const TradeoffPoint& p) {
  return {{"frames", p.frames},
          {"predicted", p.predicted},
          {"matched", p.matched},
          {"missed", p.missed},
          {"spurious", p.spurious},
          {"contour_error_pct", numberOrNull(p.contourErrorPct)},
          {"iou", numberOrNull(p.iou)},
          {"coverage", numberOrNull(p.coverage)},
          {"predict_us", numberOrNull(p.predictUs)},
          {"fit_us", numberOrNull(p.fitUs)},
          {"peak_mb", numberOrNull(p.peakMb)},
          {"poor", p.poor}};
}

void fromJson(const JsonNode& j, TrialResult& r) {
  r.errorPct = numberOrNan(j.at("error_pct"));
  r.us = numberOrNan(j.at("us"));
  r.predictions = j.at("predictions").text();
  r.poor = j.has("poor") ? j.at("poor").text() : "";
}
void fromJson(const JsonNode& j, TradeoffPoint& p) {
  p.frames = j.at("frames").integer();
  p.predicted = j.at("predicted").integer();
  p.matched = j.at("matched").integer();
  p.missed = j.at("missed").integer();
  p.spurious = j.at("spurious").integer();
  p.contourErrorPct = numberOrNan(j.at("contour_error_pct"));
  p.iou = numberOrNan(j.at("iou"));
  p.coverage = numberOrNan(j.at("coverage"));
  p.predictUs = numberOrNan(j.at("predict_us"));
  p.fitUs = numberOrNan(j.at("fit_us"));
  p.peakMb = numberOrNan(j.at("peak_mb"));
  p.rankedErrorPct = rankedErrorPct(p);
  p.poor = j.has("poor") ? j.at("poor").text() : "";
}

template <class T>
Json outcomes(const std::map<std::string, Outcome<T>>& all) {
  Json j = Json::object();
  for (const auto& [id, outcome] : all) {
    if (outcome)
      j[id] = toJson(*outcome);
    else
      j[id] = {{"reason", nameOf(outcome.failure().reason)}, {"detail", outcome.failure().detail}};
  }
  return j;
}

template <class T>
void readOutcomes(const JsonNode& j, std::map<std::string, Outcome<T>>& all) {
  for (const std::string& id : j.keys()) {
    const JsonNode item = j.at(id);
    if (const auto reason = item.find("reason")) {
      const std::optional<Reason> named = reasonNamed(reason->text());
      if (!named) reason->fail("unknown reason");
      all.insert_or_assign(id, Failure{*named, item.at("detail").text()});
      continue;
    }
    T value{};
    fromJson(item, value);
    all.insert_or_assign(id, std::move(value));
  }
}

}  // namespace

WorkFile::WorkFile(std::filesystem::path file, std::string key) : file_(std::move(file)), key_(std::move(key)) {
  std::error_code error;
  if (file_.empty() || !std::filesystem::is_regular_file(file_, error)) return;
  try {
    const JsonNode j = JsonNode::parse(readFile(file_, Limit::JsonMegabytes), file_.string());
    if (j.at("glint_tradeoff_work").integer() != kVersion || j.at("key").text() != key_) return;
    readOutcomes(j.at("coarse"), coarse_);
    readOutcomes(j.at("full"), full_);
  } catch (const std::exception&) {
    // Whatever it is, it holds nothing of this run: it will be overwritten.
    coarse_.clear();
    full_.clear();
  }
}

std::optional<Outcome<TrialResult>> WorkFile::coarse(const std::string& id) const {
  const auto it = coarse_.find(id);
  return it == coarse_.end() ? std::nullopt : std::optional(it->second);
}

std::optional<Outcome<TradeoffPoint>> WorkFile::full(const std::string& id) const {
  const auto it = full_.find(id);
  return it == full_.end() ? std::nullopt : std::optional(it->second);
}

void WorkFile::add(const std::string& id, const Outcome<TrialResult>& result) {
  coarse_.insert_or_assign(id, result);
  write();
}

void WorkFile::add(const std::string& id, const Outcome<TradeoffPoint>& result) {
  full_.insert_or_assign(id, result);
  write();
}

void WorkFile::write() const {
  if (file_.empty()) return;
  const Json j = {{"glint_tradeoff_work", kVersion}, {"key", key_}, {"coarse", outcomes(coarse_)}, {"full", outcomes(full_)}};
  atomicWrite(file_, j.dump(1));
}

}  // namespace glint
