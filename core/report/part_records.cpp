// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/part_records.h"

#include <cmath>

#include "core/base/json_dom.h"
#include "core/base/outcome.h"

namespace glint::evaluation {
namespace {

using json_dom::Json;
using json_dom::numberOrNull;

Json numbersJson(const std::vector<double>& numbers) {
  Json j = Json::array();
  for (const double v : numbers) j.push_back(numberOrNull(v));
  return j;
}

double numberOrNan(const JsonNode& node) { return node.isNull() ? std::nan("") : node.number(); }

std::vector<double> readNumbers(const JsonNode& node) {
  std::vector<double> numbers;
  for (std::size_t i = 0; i < node.size(); ++i) numbers.push_back(numberOrNan(node.at(i)));
  return numbers;
}

std::vector<double> readNumbers(const JsonNode& node, std::size_t count) {
  if (node.size() != count) node.fail("must have " + std::to_string(count) + " numbers");
  return readNumbers(node);
}

int countIn(const JsonNode& node) {
  const int count = node.integer();
  constexpr int kMost = 100000000;  // frames and highlights of any scene are fewer; three of them add up within an int
  if (count < 0 || count > kMost) node.fail("must be between 0 and " + std::to_string(kMost));
  return count;
}

}  // namespace

std::string jsonOf(const FrameRecord& r) {
  Json j = {{"frame", r.note.frame},          {"id", r.note.id},
            {"training", r.note.training},    {"held_out", r.note.heldOut},
            {"clipped", r.note.clipped},      {"level_known", r.note.levelKnown},
            {"given", r.note.given},          {"detected", r.note.detected},
            {"unreadable", r.note.unreadable}};
  if (!r.note.notParted.empty()) j["not_parted"] = r.note.notParted;
  if (r.detection)
    j["detection"] = {{"missed", r.detection->missed},
                      {"contour_error_pct", numbersJson(r.detection->percent)},
                      {"contour_error_px", numbersJson(r.detection->pixels)}};
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

FrameRecord readFrameRecord(const JsonNode& j) {
  FrameRecord r;
  r.note.frame = countIn(j.at("frame"));
  r.note.id = j.at("id").text();
  r.note.training = j.at("training").boolean();
  r.note.heldOut = j.at("held_out").boolean();
  r.note.clipped = j.at("clipped").boolean();
  r.note.levelKnown = j.at("level_known").boolean();
  r.note.given = j.at("given").boolean();
  r.note.detected = j.at("detected").boolean();
  r.note.unreadable = j.at("unreadable").boolean();
  if (const std::optional<JsonNode> reason = j.find("not_parted")) r.note.notParted = reason->text();
  if (const std::optional<JsonNode> d = j.find("detection")) {
    r.detection = FrameDetection{};
    r.detection->missed = countIn(d->at("missed"));
    r.detection->percent = readNumbers(d->at("contour_error_pct"));
    r.detection->pixels = readNumbers(d->at("contour_error_px"), r.detection->percent.size());
  }
  return r;
}

std::string jsonOf(const ComparisonRecord& r) {
  const ComparisonTally& t = r.tally;
  Json j = {{"frame", t.frame},           {"rows", r.rows},
            {"predicted", t.predicted},   {"observed", t.observed},
            {"unreadable", t.unreadable}, {"matched", t.matched},
            {"missed", t.missed},         {"spurious", t.spurious},
            {"iou", numberOrNull(t.iou)}, {"time_us", numberOrNull(t.timeUs)},
            {"failure", t.failure}};
  j["measured"] = Json::array();
  for (const ComparisonTally::Measured& m : t.measured)
    j["measured"].push_back(
        numbersJson({m.contourErrorPct, m.contourErrorPx, m.ellipseErrorPct, m.hausdorffPx, m.peakOffsetPx, m.coverage}));
  if (t.filtered > 0) j["filtered"] = t.filtered;
  if (!t.bands.empty()) j["bands"] = Json::array();
  for (const BandScore& b : t.bands) j["bands"].push_back(numbersJson({b.sigmaPx, b.coverage}));
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ComparisonRecord readComparisonRecord(const JsonNode& j) {
  ComparisonRecord r;
  ComparisonTally& t = r.tally;
  t.frame = countIn(j.at("frame"));
  r.rows = countIn(j.at("rows"));
  t.predicted = j.at("predicted").boolean();
  t.observed = j.at("observed").boolean();
  t.unreadable = j.at("unreadable").boolean();
  t.matched = countIn(j.at("matched"));
  t.missed = countIn(j.at("missed"));
  t.spurious = countIn(j.at("spurious"));
  if (const std::optional<JsonNode> filtered = j.find("filtered")) t.filtered = countIn(*filtered);
  t.iou = numberOrNan(j.at("iou"));
  t.timeUs = numberOrNan(j.at("time_us"));
  t.failure = j.at("failure").text();
  const JsonNode measured = j.at("measured");
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const std::vector<double> m = readNumbers(measured.at(i), 6);
    t.measured.push_back({m[0], m[1], m[2], m[3], m[4], m[5]});
  }
  if (const std::optional<JsonNode> bands = j.find("bands"))
    for (std::size_t i = 0; i < bands->size(); ++i) {
      const std::vector<double> b = readNumbers(bands->at(i), 2);
      t.bands.push_back({b[0], b[1]});
    }
  return r;
}

std::string jsonOf(const FitOrder& order) { return Json{order.seenBy, order.frame, order.bandRemarks}.dump(); }

FitOrder readFitOrder(const JsonNode& node) {
  if (node.size() != 3) node.fail("must have 3 numbers");
  return {countIn(node.at(0)), countIn(node.at(1)), countIn(node.at(2))};
}

}  // namespace glint::evaluation
