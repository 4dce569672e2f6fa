// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/live_json.h"

#include <nlohmann/json.hpp>

#include "core/base/json_dom.h"
#include "core/base/safe_text.h"

namespace glint {
namespace {

using json_dom::numberOrNull;
using nlohmann::ordered_json;

/// ASCII: an id comes from others, and the line may end on a terminal.
std::string asLine(const ordered_json& j) { return j.dump(-1, ' ', true, ordered_json::error_handler_t::replace) + "\n"; }

ordered_json liveHighlight(const LiveHighlights& of, const PredictedHighlight& h, const Camera& camera) {
  ordered_json j;
  j["light"] = of.light;
  j["model"] = of.model;
  j["status"] = of.poor.empty() ? "ok" : "poor";
  const auto pixel = [](const Pixel& p) { return ordered_json::array({numberOrNull(p.x()), numberOrNull(p.y())}); };
  j["peak"] = pixel(h.brightest.pixel);
  j["coverage"] = numberOrNull(h.coverage);
  j["contour"] = ordered_json::array();
  for (const Pixel& p : h.contour.points) j["contour"].push_back(pixel(p));
  if (camera.hasDistortion()) {
    j["contour_measured"] = ordered_json::array();
    for (const Pixel& p : h.contour.points) j["contour_measured"].push_back(pixel(camera.distorted(p)));
  }
  if (!h.sigmaPx.empty()) {
    j["sigma_px"] = ordered_json::array();
    for (const double sigma : h.sigmaPx) j["sigma_px"].push_back(numberOrNull(sigma));
  }
  if (!h.gaps.empty()) {
    j["gaps"] = ordered_json::array();
    for (const auto& [from, to] : h.gaps) j["gaps"].push_back({from, to});
  }
  return j;
}

}  // namespace

std::string liveLine(const LivePose& pose, const LiveAnswer& answer, double timeUs) {
  ordered_json highlights = ordered_json::array(), failures = ordered_json::array();
  std::string reason, poor;
  bool anyOk = false;
  for (const LiveHighlights& of : answer.highlights) {
    if (!of.prediction.highlights().empty()) {
      anyOk = anyOk || of.poor.empty();
      if (poor.empty() && !of.poor.empty()) poor = of.model + ": " + of.poor;
    }
    for (const PredictedHighlight& h : of.prediction.highlights()) highlights.push_back(liveHighlight(of, h, answer.camera));
    const Failure* const why = of.prediction.failure();
    if (!why) continue;
    failures.push_back({{"light", of.light}, {"model", of.model}, {"reason", why->message()}});
    if (reason.empty()) reason = why->message();
  }
  const bool found = !highlights.empty();
  if (reason.empty() && !found) reason = "no light with a fitted model is on in this frame";
  ordered_json j;
  j["id"] = pose.id;
  j["time"] = pose.time ? numberOrNull(*pose.time) : ordered_json();
  j["frame"] = answer.frame ? ordered_json(*answer.frame) : ordered_json();
  j["status"] = !found ? "failed" : anyOk ? "ok" : "poor";
  j["reason"] = !found ? reason : anyOk ? "" : poor;
  j["highlights"] = std::move(highlights);
  j["failures"] = std::move(failures);
  j["time_us"] = numberOrNull(timeUs);
  return asLine(j);
}

std::string liveRefusal(const std::string& id, std::size_t line, const std::string& status, const std::string& reason) {
  ordered_json j;
  j["id"] = id.empty() ? ordered_json() : ordered_json(id);
  j["time"] = nullptr;
  j["frame"] = nullptr;
  j["status"] = status;
  j["reason"] = messageLine(reason);
  j["line"] = line;
  j["highlights"] = ordered_json::array();
  j["failures"] = ordered_json::array();
  j["time_us"] = nullptr;
  return asLine(j);
}

}  // namespace glint
