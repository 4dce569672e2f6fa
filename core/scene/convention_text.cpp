// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/scene/convention_report.h"

namespace glint {
namespace {
using json_dom::Json;

/// How the pixels became linear: a line for each way, with the number of its frames.
std::string lightLines(const ConventionReport& r) {
  std::vector<std::pair<std::string, int>> ways;
  for (const auto& f : r.frames) {
    if (f.linear.empty()) continue;
    const std::string way = (f.source == "radiance" ? "radiance, " : "") + f.linear;
    const auto known = std::find_if(ways.begin(), ways.end(), [&](const auto& w) { return w.first == way; });
    if (known == ways.end())
      ways.emplace_back(way, 1);
    else
      ++known->second;
  }
  std::string out;
  for (const auto& [way, n] : ways)
    out += "  light     " + way + (ways.size() > 1 ? formatted(": %d frames", n) : std::string()) + "\n";
  return out;
}
/// What the highlights say about the cameras.
std::string cameraLines(const CameraCheck& check) {
  if (check.hypotheses.empty()) return "\n  cameras   not checked with highlights: " + check.whyNot + "\n";
  if (check.hypotheses.front().change == std::string(CameraCheck::kAsStated))
    return formatted("\n  lamps     %s: the highlights of %d frames lie %.2g degrees from where they mirror\n",
                     check.lightFrame.c_str(), check.views, check.missDeg.value_or(0));
  std::string out = check.lightFrame.empty() ? "" : "\n  lamp      " + check.lightFrame;
  out += formatted("\n  cameras   from the highlights of %d frames: mirrored rays pass one lamp by %s; contours fit one light ",
                   check.views, check.missDeg ? formatted("%.2g degrees", *check.missDeg).c_str() : "more than can be measured");
  std::string separator;
  constexpr std::size_t kAlwaysListed = 4;  // as given, and mirrored images
  std::size_t listed = 0, others = 0;
  for (const CameraCheck::Hypothesis& h : check.hypotheses) {
    if (!h.rmsPx && listed >= kAlwaysListed) {
      ++others;
      continue;
    }
    ++listed;
    out += separator + (h.rmsPx ? formatted("to %.2g px ", *h.rmsPx) : std::string("not at all ")) + "(" + h.change + ")";
    separator = ", ";
  }
  if (others) out += formatted(", not at all (%zu other changes)", others);
  out += "\n";
  return out;
}
}  // namespace

std::string toText(const ConventionReport& r) {
  std::string out = r.file + ": " + r.recognisedAs + "\n";
  out += "  name      " + r.name + "\n";
  out += formatted("  frames    %zu\n", r.frames.size());
  out += formatted("  lights    %d (for comparison only, unless they are known)\n", r.lights);
  out += "  axes      cameras x right, y down, z forward; right-handed world, metres\n";
  for (const auto& s : r.surfaces)
    out += "  surface   " + s.id +
           formatted(": %s, %d vertices, %d triangles, %s normals, box %.4g %.4g %.4g .. %.4g %.4g %.4g\n", s.kind.c_str(),
                     s.vertices, s.triangles, s.hasNormals ? "with" : "without", s.lower.x(), s.lower.y(), s.lower.z(),
                     s.upper.x(), s.upper.y(), s.upper.z());
  out += lightLines(r);
  out += "\n  frame       surface     inside image      depth - surface: median, 95 %     values: NaN, negative\n";
  for (const auto& f : r.frames) {
    std::string line = formatted("  %-11s %-11s ", f.id.c_str(), f.surface.empty() ? "(depth)" : f.surface.c_str());
    line += f.vertices > 0 ? formatted("%7d of %-7d", f.verticesInImage, f.vertices)
                           : std::string(f.seesSurface ? "  depth map       " : "  nothing         ");
    line += f.depthSamples > 0 ? formatted(" %10.3g mm %10.3g mm          ", 1e3 * f.depthMedian, 1e3 * f.depthP95)
                               : std::string("          -             -          ");
    line += f.pixels > 0 ? formatted("%8lld %8lld (%s)", f.notFinite, f.negative, f.source.c_str())
                         : std::string("       -        -");
    out += line + "\n";
  }
  if (r.tracks) {
    out += formatted("\n  points    %d sparse points", r.tracks->points);
    out += r.tracks->withTracks
               ? formatted(", seen %d times: projected %.2g px (median), %.2g px (95 %%) from where they were seen\n",
                           r.tracks->observations, r.tracks->medianPx, r.tracks->p95Px)
               : formatted("; which images show them is not said: %d of %d lie inside of one\n", r.tracks->inView,
                           r.tracks->sampled);
    if (r.tracks->met > 0)
      out += formatted("            %d of %d in front of the surface lie on it (depth within 1 %%)\n", r.tracks->onSurface,
                       r.tracks->met);
  }
  if (r.cameras) out += cameraLines(*r.cameras);
  for (const std::string& f : r.facts) out += "fact: " + f + "\n";
  for (const std::string& w : r.warnings) out += "warning: " + w + "\n";
  out += r.findings.empty() ? r.cleanBill() + "\n" : findingsText(r);
  return out;
}

std::string findingsText(const ConventionReport& r) {
  std::string out;
  for (std::size_t i = 0; i < r.findings.size(); ++i) {
    out += "finding: " + r.findings[i] + "\n";
    for (const auto& c : r.corrections)
      if (c.finding == i) out += "  fix:   glint convert INPUT --fix " + c.correction.fix + " --out corrected.json\n";
  }
  return out;
}

namespace {
void addFindings(const ConventionReport& r, Json& j) {
  j["findings"] = r.findings;
  j["fixes"] = Json::array();
  for (const auto& c : r.corrections)
    j["fixes"].push_back({{"finding", c.finding}, {"fix", c.correction.fix}, {"words", c.correction.words}});
}

void addConclusions(const ConventionReport& r, Json& j) {
  j["facts"] = r.facts;
  j["warnings"] = r.warnings;
  addFindings(r, j);
}
}  // namespace

namespace {
Json camerasJson(const CameraCheck& c) {
  const auto text = [](const std::string& words) { return words.empty() ? Json() : Json(words); };
  const auto number = [](const std::optional<double>& v) { return v ? Json(*v) : Json(); };
  Json hypotheses = Json::array();
  for (const CameraCheck::Hypothesis& h : c.hypotheses) hypotheses.push_back({{"change", h.change}, {"rms_px", number(h.rmsPx)}});
  return {{"views", c.views},
          {"miss_deg", number(c.missDeg)},
          {"light_frame", text(c.lightFrame)},
          {"why_not", text(c.whyNot)},
          {"hypotheses", std::move(hypotheses)},
          {"focal_pct", number(c.focalPct)},
          {"shift_px", number(c.shiftPx)}};
}
}  // namespace

std::string toJson(const ConventionReport& r) {
  const auto vector = [](const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); };
  const auto vector2 = [](const Eigen::Vector2d& v) { return Json::array({v.x(), v.y()}); };
  Json j = {{"glint_info", 1}, {"input", r.file}, {"recognised_as", r.recognisedAs}, {"name", r.name}, {"lights", r.lights}};
  j["surfaces"] = Json::array();
  for (const auto& s : r.surfaces)
    j["surfaces"].push_back({{"id", s.id},
                             {"kind", s.kind},
                             {"vertices", s.vertices},
                             {"triangles", s.triangles},
                             {"normals", s.hasNormals},
                             {"box", Json::array({vector(s.lower), vector(s.upper)})},
                             {"grid_m", s.grid ? Json(s.grid->spacing) : Json()}});
  j["frames"] = Json::array();
  for (const auto& f : r.frames) {
    Json one = {{"index", f.frame},
                {"id", f.id},
                {"surface", f.surface.empty() ? Json() : Json(f.surface)},
                {"sees_surface", f.seesSurface},
                {"vertices", f.vertices},
                {"vertices_in_front", f.verticesInFront},
                {"vertices_in_image", f.verticesInImage},
                {"distance_m", f.distance}};
    one["depth_difference_m"] =
        f.depthSamples > 0 ? Json{{"samples", f.depthSamples}, {"median", f.depthMedian}, {"p95", f.depthP95}} : Json();
    one["source"] = f.source.empty() ? Json() : Json(f.source);
    one["linear"] = f.linear.empty() ? Json() : Json(f.linear);
    one["not_finite"] = f.notFinite;
    one["negative"] = f.negative;
    one["problems"] = f.problems;
    j["frames"].push_back(std::move(one));
  }
  j["cameras"] = r.cameras ? camerasJson(*r.cameras) : Json();
  j["points"] = Json();
  if (r.tracks)
    j["points"] = {{"points", r.tracks->points},
                   {"observations", r.tracks->observations},
                   {"behind", r.tracks->behind},
                   {"median_px", r.tracks->withTracks ? Json(r.tracks->medianPx) : Json()},
                   {"p95_px", r.tracks->withTracks ? Json(r.tracks->p95Px) : Json()},
                   {"shift_px", r.tracks->withTracks ? vector2(r.tracks->shiftPx) : Json()},
                   {"in_view", r.tracks->withTracks ? Json() : Json(r.tracks->inView)},
                   {"met", r.tracks->met},
                   {"on_surface", r.tracks->onSurface},
                   {"depth_ratio", r.tracks->depthRatio}};
  addConclusions(r, j);
  return json_dom::pretty(j);
}

std::string withFindings(const std::string& json, const ConventionReport& report) {
  Json j = Json::parse(json);
  addFindings(report, j);
  return json_dom::pretty(j);
}

}  // namespace glint
