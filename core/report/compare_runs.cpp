// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/compare_runs.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/number_text.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/summary.h"

namespace glint {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr double kSame = 1e-9;  // relative: as `glint replay`, nine digits

bool same(double a, double b) { return a == b || std::abs(a - b) <= kSame * std::max(std::abs(a), std::abs(b)); }

std::string sixDigits(double v) {
  if (!std::isfinite(v)) return "none";
  return formatted("%.6g", v);
}

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& w : words) out += (out.empty() ? "" : ", ") + w;
  return out;
}

std::string vectorText(const Eigen::Vector3d& v) { return sixDigits(v.x()) + " " + sixDigits(v.y()) + " " + sixDigits(v.z()); }

std::vector<std::string> idsWhere(const Inspection& run, const std::function<bool(int)>& wanted) {
  std::vector<std::string> ids;
  for (int i = 0; i < static_cast<int>(run.scene->frames.size()); ++i)
    if (wanted(i)) ids.push_back(run.scene->frames[static_cast<std::size_t>(i)].id);
  return ids;
}

bool isExcluded(const Inspection& run, int frame) {
  const std::vector<int>& x = run.request.excluded;
  return std::find(x.begin(), x.end(), frame) != x.end();
}

class Values {
 public:
  explicit Values(std::vector<ComparedValue>& out) : out_(out) {}
  void add(const std::string& group, const std::string& name, const std::string& a, const std::string& b,
           const std::string& unit = "") {
    out_.push_back({group, name, a, b, unit, a != b, {}});
  }

 private:
  std::vector<ComparedValue>& out_;
};

/// Input files by their path in the scene's folder, so that two copies of a scene are compared file by file.
std::map<std::string, std::string> hashes(const Session& session, const Scene& scene) {
  std::map<std::string, std::string> all;
  for (const SessionFile& f : session.files) {
    const fs::path relative = f.path.lexically_relative(scene.folder);
    const bool inside = !relative.empty() && *relative.begin() != "..";
    all[f.path == session.input ? "scene file" : inside ? relative.generic_string() : f.path.filename().string()] = f.sha256;
  }
  return all;
}

void addInputs(Values& out, const Session& sa, const Inspection& a, const Session& sb, const Inspection& b) {
  out.add("input", "scene", a.given->name, b.given->name);
  out.add("input", "frames", std::to_string(a.given->frames.size()), std::to_string(b.given->frames.size()));
  const std::map<std::string, std::string> ha = hashes(sa, *a.given), hb = hashes(sb, *b.given);
  const auto short_ = [](const std::map<std::string, std::string>& all, const std::string& name) -> std::string {
    const auto found = all.find(name);
    if (found == all.end()) return "";
    return found->second.empty() ? "unreadable" : "sha256 " + found->second.substr(0, 12);
  };
  std::set<std::string> names;
  for (const auto* all : {&ha, &hb})
    for (const auto& [name, hash] : *all) names.insert(name);
  for (const std::string& name : names) out.add("input", name, short_(ha, name), short_(hb, name));
}

void addRequest(Values& out, const Inspection& a, const Inspection& b) {
  const InspectionRequest &qa = a.request, &qb = b.request;
  out.add("request", "models", joined(qa.models), joined(qb.models));
  out.add("request", "training", qa.train, qb.train);
  const auto training = [](const Inspection& r) { return joined(idsWhere(r, [&](int i) { return r.isTraining(i); })); };
  const auto excluded = [](const Inspection& r) { return joined(idsWhere(r, [&](int i) { return isExcluded(r, i); })); };
  out.add("request", "training frames", training(a), training(b));
  out.add("request", "excluded frames", excluded(a), excluded(b));
  const auto source = [](const InspectionRequest& q) {
    return std::string(q.source == FrameSource::Image ? "image" : "radiance");
  };
  out.add("request", "highlights from", source(qa), source(qb));
  out.add("request", "noise on training contours", sixDigits(qa.noisePx), sixDigits(qb.noisePx), "px");
  if (qa.noisePx > 0 || qb.noisePx > 0) out.add("request", "noise seed", std::to_string(qa.seed), std::to_string(qb.seed));
  out.add("request", "truth", fs::path(qa.truthFolder).filename().string(), fs::path(qb.truthFolder).filename().string());
  for (const ParamSpec& p : allParams())
    out.add("settings", p.key, settingText(qa.settings.value(p.key)), settingText(qb.settings.value(p.key)), p.unit);
}

/// One text for each change, by what it changes.
std::map<std::string, std::string> changes(const Inspection& run) {
  const WhatIf& w = run.request.whatIf;
  std::map<std::string, std::string> all;
  const auto id = [&](int frame) {
    return frame >= 0 && frame < static_cast<int>(run.given->frames.size())
               ? run.given->frames[static_cast<std::size_t>(frame)].id
               : std::to_string(frame);
  };
  for (const auto& [frame, pose] : w.poses)
    all["camera of " + id(frame)] = "turned " + vectorText(pose.rotation) + " rad, moved " + vectorText(pose.translation) + " m";
  for (const auto& [at, h] : w.highlights)
    all["highlight " + std::to_string(at.second + 1) + " of " + id(at.first)] =
        "contour by " + sixDigits(h.contourBy.x()) + " " + sixDigits(h.contourBy.y()) + " px, times " +
        sixDigits(h.contourScale) + "; peak by " + sixDigits(h.peakBy.x()) + " " + sixDigits(h.peakBy.y()) + " px";
  for (std::size_t i = 0; i < w.edits.size(); ++i) {
    const HighlightEdit& e = w.edits[i];
    std::string places;
    for (const Pixel& p : e.places) places += " " + sixDigits(p.x()) + " " + sixDigits(p.y());
    all["edit " + std::to_string(i + 1)] = std::string(pastOf(e.kind)) + " in " + id(e.frame) + " at" + places + " px";
  }
  for (const auto& [at, on] : w.lightsSwitched) all["light " + at.second + " in " + id(at.first)] = on ? "on" : "off";
  if (!w.synthesise) return all;
  all["contours"] = "synthesised";
  all["roughness"] = sixDigits(w.roughness);
  all["lobe"] = nameOf(w.lobe);
  for (const auto& [light, by] : w.lightsBy) all["light " + light] = "by " + vectorText(by) + " m";
  for (const auto& [surface, value] : w.surfaces) all["surface " + surface] = sixDigits(value);
  return all;
}

void addWhatIf(Values& out, const Inspection& a, const Inspection& b) {
  const std::map<std::string, std::string> ca = changes(a), cb = changes(b);
  std::set<std::string> names;
  for (const auto* all : {&ca, &cb})
    for (const auto& [name, value] : *all) names.insert(name);
  const auto of = [](const std::map<std::string, std::string>& all, const std::string& name) {
    const auto found = all.find(name);
    return found == all.end() ? std::string() : found->second;
  };
  for (const std::string& name : names) out.add("what-if", name, of(ca, name), of(cb, name));
}

std::string unitOf(const std::string& result) {
  for (const auto& [part, unit] : {std::pair<const char*, const char*>{"_pct", "%"},
                                   {"_px", "px"},
                                   {"_rad", "rad"},
                                   {"semi_axis", "m"},
                                   {" position ", "m"}})
    if (result.find(part) != std::string::npos) return unit;
  return "";
}

/// The key results that mean something in both runs: lights as positions in metres (directions at infinity), models that both
/// have.
KeyResults resultsOf(const Inspection& run, const Inspection& other) {
  KeyResults all;
  for (const auto& [key, estimate] : run.lights) {
    if (!estimate) continue;
    const Light& light = estimate->light;
    const std::string name = "light " + textOf(key);
    const Eigen::Vector3d at = light.atInfinity() ? light.homogeneous().head<3>().eval() : light.position();
    for (int i = 0; i < 3; ++i) all.emplace_back(name + (light.atInfinity() ? " direction " : " position ") + "xyz"[i], at[i]);
    all.emplace_back(name + " limit_angle_rad", estimate->limitAngle);
  }
  for (const auto& [name, value] : keyResultsOf(run)) {
    if (name.rfind("light.", 0) == 0) continue;
    const auto shared = [&, key = name](const auto& m) { return key.rfind(m.first + ".", 0) == 0; };
    if (std::any_of(other.models.begin(), other.models.end(), shared)) all.emplace_back(name, value);
  }
  return all;
}

void addResults(std::vector<ComparedValue>& out, const Inspection& a, const Inspection& b) {
  const KeyResults ra = resultsOf(a, b), rb = resultsOf(b, a);
  const std::map<std::string, double> inA(ra.begin(), ra.end()), inB(rb.begin(), rb.end());
  const auto row = [&](const std::string& name) {
    const auto va = inA.find(name), vb = inB.find(name);
    ComparedValue v{"results", name, "", "", unitOf(name), true, {}};
    if (va != inA.end()) v.a = sixDigits(va->second);
    if (vb != inB.end()) v.b = sixDigits(vb->second);
    if (va != inA.end() && vb != inB.end()) {
      const bool finite = std::isfinite(va->second) && std::isfinite(vb->second);
      v.differs = finite ? !same(va->second, vb->second) : std::isfinite(va->second) != std::isfinite(vb->second);
      if (finite && va->second != 0) v.ratio = vb->second / va->second;
    }
    out.push_back(std::move(v));
  };
  for (const auto& [name, value] : ra) row(name);
  for (const auto& [name, value] : rb)
    if (!inA.count(name)) row(name);
}

struct Side {
  std::optional<double> error;
  std::string reason;
};

Side sideOf(const FrameComparison& c) {
  const FrameScore score = scoreOf(c);
  if (const std::optional<double> pct = wholeErrorPct(score)) return {pct, ""};
  if (score.matched > 0)
    return {{}, "missed " + std::to_string(score.missed) + " of " + std::to_string(score.missed + score.matched) + " highlights"};
  if (!score.reason.empty()) return {{}, score.reason};
  return {{}, c.prediction.failure() ? "nothing predicted" : "nothing observed"};
}

std::string roleOf(const Inspection& run, int frame) {
  if (isExcluded(run, frame)) return "excluded";
  return run.isTraining(frame) ? "training" : "held out";
}

/// Frame, light -> answer of one model, frames by id.
using Answers = std::map<std::pair<std::string, std::string>, Side>;

Answers answersOf(const Inspection& run, const std::string& model) {
  Answers all;
  const auto found = run.models.find(model);
  if (found == run.models.end()) return all;
  for (const FrameComparison& c : found->second.frames)
    all[{run.scene->frames[static_cast<std::size_t>(c.frame)].id, c.light}] = sideOf(c);
  return all;
}

std::map<std::string, int> indices(const Scene& scene) {
  std::map<std::string, int> all;
  for (int i = 0; i < static_cast<int>(scene.frames.size()); ++i) all.emplace(scene.frames[static_cast<std::size_t>(i)].id, i);
  return all;
}

void addErrors(RunComparison& out, const Inspection& a, const Inspection& b) {
  const std::map<std::string, int> inA = indices(*a.scene), inB = indices(*b.scene);
  std::vector<std::string> ids;
  for (const Frame& f : a.scene->frames) {
    ids.push_back(f.id);
    out.framesCommon += inB.count(f.id) > 0;
  }
  for (const Frame& f : b.scene->frames)
    if (!inA.count(f.id)) ids.push_back(f.id);
  out.framesA = static_cast<int>(a.scene->frames.size());
  out.framesB = static_cast<int>(b.scene->frames.size());
  for (const std::string& model : a.request.models) {
    if (!b.models.count(model)) continue;
    const Answers fromA = answersOf(a, model), fromB = answersOf(b, model);
    std::map<std::string, std::set<std::string>> lights;
    for (const Answers* all : {&fromA, &fromB})
      for (const auto& [at, side] : *all) lights[at.first].insert(at.second);
    RunComparison::Summary summary{model, 0, 0, 0, 0, 0};
    for (const std::string& id : ids)
      for (const std::string& light : lights[id]) {
        ComparedError e;
        e.id = id;
        e.model = model;
        e.light = light;
        const auto fill = [&](const Inspection& run, const std::map<std::string, int>& in, const Answers& answers, int& frame,
                              std::optional<double>& error, std::string& role, std::string& reason) {
          if (const auto at = in.find(id); at != in.end()) {
            frame = at->second;
            role = roleOf(run, frame);
          }
          const auto found = answers.find({id, light});
          if (found != answers.end()) {
            error = found->second.error;
            reason = found->second.reason;
          } else {
            reason = frame < 0 ? "no such frame" : "not predicted";
          }
        };
        fill(a, inA, fromA, e.frameA, e.errorA, e.roleA, e.reasonA);
        fill(b, inB, fromB, e.frameB, e.errorB, e.roleB, e.reasonB);
        if (e.errorA && e.errorB && *e.errorA > 0) e.ratio = *e.errorB / *e.errorA;
        const bool both = e.errorA && e.errorB;
        e.differs = e.roleA != e.roleB || e.reasonA != e.reasonB ||
                    (both ? !same(*e.errorA, *e.errorB) : e.errorA.has_value() != e.errorB.has_value());
        if (both && e.roleA == "held out" && e.roleB == "held out") {
          ++summary.common;
          summary.meanA += *e.errorA;
          summary.meanB += *e.errorB;
          if (!same(*e.errorA, *e.errorB)) ++(*e.errorA < *e.errorB ? summary.betterA : summary.betterB);
        }
        out.errors.push_back(std::move(e));
      }
    summary.meanA = summary.common ? summary.meanA / summary.common : std::nan("");
    summary.meanB = summary.common ? summary.meanB / summary.common : std::nan("");
    out.summaries.push_back(summary);
  }
}

std::string padded(std::string s, std::size_t width) {
  if (s.size() < width) s.append(width - s.size(), ' ');
  return s;
}

std::string percent(const std::optional<double>& v) {
  if (!v) return "-";
  return formatted("%.3f", *v);
}

}  // namespace

int RunComparison::differences() const {
  return static_cast<int>(std::count_if(values.begin(), values.end(), [](const ComparedValue& v) { return v.differs; }) +
                          std::count_if(errors.begin(), errors.end(), [](const ComparedError& e) { return e.differs; }));
}

RunComparison compareRuns(const Session& sessionA, const Inspection& a, const Session& sessionB, const Inspection& b) {
  require(a.scene && b.scene, "compareRuns: a run has no scene");
  RunComparison out;
  Values values(out.values);
  addInputs(values, sessionA, a, sessionB, b);
  addRequest(values, a, b);
  addWhatIf(values, a, b);
  addResults(out.values, a, b);
  addErrors(out, a, b);
  return out;
}

std::string comparisonText(const RunComparison& c, bool all) {
  std::string out = std::to_string(c.framesCommon) + " frames in common (A has " + std::to_string(c.framesA) + ", B has " +
                    std::to_string(c.framesB) + "); " + std::to_string(c.differences()) + " differences\n";
  std::string group;
  for (const ComparedValue& v : c.values) {
    if (!all && !v.differs) continue;
    if (v.group != group) out += "\n" + padded(v.group, 46) + " " + padded("A", 24) + " " + padded("B", 24) + " B/A\n";
    group = v.group;
    const std::string name = v.name + (v.unit.empty() ? "" : " [" + v.unit + "]");
    const auto shown = [](const std::string& s) { return padded(s.empty() ? "-" : s, 24); };
    out += "  " + padded(name, 44) + " " + shown(v.a) + " " + shown(v.b) + (v.ratio ? " " + sixDigits(*v.ratio) : "") + "\n";
  }
  bool head = false;
  for (const ComparedError& e : c.errors) {
    if (!all && !e.differs) continue;
    if (!head)
      out += "\n" + padded("frame", 14) + padded("model", 14) + padded("light", 10) + padded("A %", 12) + padded("B %", 12) +
             padded("B/A", 10) + "\n";
    head = true;
    out += padded(e.id, 14) + padded(e.model, 14) + padded(e.light, 10) + padded(percent(e.errorA), 12) +
           padded(percent(e.errorB), 12) + padded(e.ratio ? sixDigits(*e.ratio) : "-", 10);
    if (e.roleA != e.roleB) out += " " + (e.roleA.empty() ? "-" : e.roleA) + " -> " + (e.roleB.empty() ? "-" : e.roleB);
    if (!e.errorA && !e.reasonA.empty()) out += " A: " + e.reasonA;
    if (!e.errorB && !e.reasonB.empty()) out += " B: " + e.reasonB;
    out += "\n";
  }
  if (!c.summaries.empty())
    out += "\n" + padded("held out in both", 18) + padded("answers", 10) + padded("A mean %", 12) + padded("B mean %", 12) +
           padded("A better", 10) + padded("B better", 10) + "\n";
  for (const RunComparison::Summary& s : c.summaries)
    out += padded(s.model, 18) + padded(std::to_string(s.common), 10) + padded(s.common ? percent(s.meanA) : "-", 12) +
           padded(s.common ? percent(s.meanB) : "-", 12) + padded(std::to_string(s.betterA), 10) +
           padded(std::to_string(s.betterB), 10) + "\n";
  return out;
}

std::string comparisonJson(const RunComparison& c, const std::string& nameA, const std::string& nameB) {
  const auto finite = [](const std::optional<double>& v) {
    return v && std::isfinite(*v) ? ordered_json(*v) : ordered_json(nullptr);
  };
  ordered_json j;
  j["glint_comparison"] = 1;
  j["a"] = nameA;
  j["b"] = nameB;
  j["frames"] = {{"a", c.framesA}, {"b", c.framesB}, {"common", c.framesCommon}};
  j["values"] = ordered_json::array();
  for (const ComparedValue& v : c.values)
    j["values"].push_back({{"group", v.group},
                           {"name", v.name},
                           {"a", v.a},
                           {"b", v.b},
                           {"unit", v.unit},
                           {"differs", v.differs},
                           {"ratio", finite(v.ratio)}});
  j["errors"] = ordered_json::array();
  for (const ComparedError& e : c.errors)
    j["errors"].push_back({{"id", e.id},
                           {"model", e.model},
                           {"light", e.light},
                           {"error_pct_a", finite(e.errorA)},
                           {"error_pct_b", finite(e.errorB)},
                           {"ratio", finite(e.ratio)},
                           {"role_a", e.roleA},
                           {"role_b", e.roleB},
                           {"reason_a", e.reasonA},
                           {"reason_b", e.reasonB},
                           {"differs", e.differs}});
  j["models"] = ordered_json::object();
  for (const RunComparison::Summary& s : c.summaries)
    j["models"][s.model] = {{"common", s.common},
                            {"mean_pct_a", finite(s.meanA)},
                            {"mean_pct_b", finite(s.meanB)},
                            {"better_a", s.betterA},
                            {"better_b", s.betterB}};
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace glint
