// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/app/session.h"
#include "core/base/number_text.h"
#include "core/base/sha256.h"
#include "core/pipeline/summary.h"

namespace glint {
namespace {

/// Feeds values to a hash by their exact bits. A NaN counts as one value whatever its payload, and -0 as 0.
class Digest {
 public:
  void add(double v) {
    if (std::isnan(v)) v = std::numeric_limits<double>::quiet_NaN();
    if (v == 0) v = 0;
    char bytes[sizeof v];
    std::memcpy(bytes, &v, sizeof v);
    hash_.add({bytes, sizeof bytes});
  }
  void add(const std::string& text) {
    add(static_cast<double>(text.size()));
    hash_.add(text);
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index i = 0; i < m.rows(); ++i)
      for (Eigen::Index j = 0; j < m.cols(); ++j) add(static_cast<double>(m(i, j)));
  }
  void add(const Polyline& line) {
    add(static_cast<double>(line.points.size()));
    for (const Pixel& p : line.points) add(p);
  }
  void add(const Failure* failure) { add(failure ? std::string(nameOf(failure->reason)) : std::string()); }
  std::string hex() { return hash_.hex(); }

 private:
  Sha256 hash_;
};

void addStatistic(KeyResults& results, const std::string& name, const Statistic& s) {
  results.emplace_back(name + ".mean", s.mean);
  results.emplace_back(name + ".median", s.median);
  results.emplace_back(name + ".p95", s.p95);
  results.emplace_back(name + ".max", s.max);
}

std::string shortest(double v) { return formatted("%.12g", v); }

/// What was detected, over all frames; with `detect.` before the names.
void addDetection(KeyResults& results, const Inspection& inspection) {
  std::vector<double> areas, peaks;
  for (const FrameEvidence& e : inspection.evidence)
    for (const Highlight& h : e.highlights) {
      areas.push_back(h.areaPx2);
      peaks.push_back(h.peak.norm());
    }
  results.emplace_back("detect.highlights", static_cast<double>(areas.size()));
  addStatistic(results, "detect.area_px2", statisticOf(std::move(areas)));
  addStatistic(results, "detect.peak_from_origin_px", statisticOf(std::move(peaks)));
}

/// Stages in the order of computation. Each uses those before it.
enum class ResultStage { Detection, Light, Fit, Prediction };

ResultStage stageOf(const std::string& keyResult) {
  if (keyResult.rfind("detect.", 0) == 0) return ResultStage::Detection;
  if (keyResult.rfind("light.", 0) == 0) return ResultStage::Light;
  return keyResult.find(".fit.") != std::string::npos ? ResultStage::Fit : ResultStage::Prediction;
}

std::string wordsFor(ResultStage stage, bool detectionKnown) {
  // A session of an older program knows nothing of the contours that it detected, on which all the rest depends.
  if (!detectionKnown) return "detection or a later stage: the session is older and has no detection results";
  switch (stage) {
    case ResultStage::Detection: return "detection";
    case ResultStage::Light: return "light";
    case ResultStage::Fit: return "fit";
    case ResultStage::Prediction: return "prediction";
  }
  return "";
}

/// Errors are distances between curves: 1e-9 of an error of 0.005 px would be less than the round-off of the coordinates that it
/// is a difference of (up to thousands of pixels, with errors of 1e-13 each after the arithmetic of a whole prediction).
bool isDistance(const std::string& keyResult) {
  return keyResult.find(".contour_error_") != std::string::npos || keyResult.find(".peak_offset_px") != std::string::npos;
}

constexpr double kAgree = 1e-9;  // docs/commands.md, "replay": nine digits

}  // namespace

double keyResultDifference(const std::string& keyResult, double was, double is) {
  if (std::isnan(was) || std::isnan(is)) return std::isnan(was) && std::isnan(is) ? 0 : std::numeric_limits<double>::infinity();
  if (was == is) return 0;
  const double small = isDistance(keyResult) ? 1 : 1e-3;  // 1e-9 of 1e-3 is the round-off of numbers of order one
  return std::abs(was - is) / (std::max(std::abs(was), std::abs(is)) + small);
}

KeyResults keyResultsOf(const Inspection& inspection) {
  KeyResults results;
  addDetection(results, inspection);
  for (const auto& [key, light] : inspection.lights) {
    if (!light) continue;
    const std::string name = "light." + textOf(key);
    const Eigen::Vector4d& l = light->light.homogeneous();
    for (int i = 0; i < 4; ++i) results.emplace_back(name + "." + "xyzw"[i], l[i]);
    results.emplace_back(name + ".limit_angle_rad", light->limitAngle);
  }
  for (const auto& [name, result] : inspection.models) {
    for (const ModelResult::Fit& f : result.fits) {
      if (!f.fit) continue;
      const std::string fit = name + ".fit." + textOf(f.key());
      if (f.fit->ellipsoid()) {
        const Eigen::Vector3d axes = f.fit->ellipsoid()->semiAxes();
        for (int i = 0; i < 3; ++i) results.emplace_back(fit + ".semi_axis_" + std::to_string(i), axes[i]);
      }
      if (f.fit->limitAngle()) results.emplace_back(fit + ".limit_angle_rad", *f.fit->limitAngle());
      if (const auto* const lobe = f.fit->as<ReflectanceFit>()) results.emplace_back(fit + ".roughness", lobe->roughness.mean);
    }
    const ModelSummary s = summarise(inspection, result);
    for (const auto& [what, count] : {std::pair<const char*, int>{"frames", s.frames},
                                      {"predicted", s.predicted},
                                      {"matched", s.matched},
                                      {"missed", s.missed},
                                      {"spurious", s.spurious}})
      results.emplace_back(name + "." + what, count);
    addStatistic(results, name + ".contour_error_pct", s.contourErrorPct);
    addStatistic(results, name + ".contour_error_px", s.contourErrorPx);
    addStatistic(results, name + ".iou", s.iou);
    addStatistic(results, name + ".peak_offset_px", s.peakOffsetPx);
    addStatistic(results, name + ".coverage", s.coverage);
  }
  return results;
}

std::string digestOf(const Inspection& inspection) {
  Digest d;
  for (const FrameEvidence& e : inspection.evidence) {
    d.add(e.failure ? &*e.failure : nullptr);
    for (const Highlight& h : e.highlights) {
      d.add(h.light);
      d.add(h.peak);
      d.add(h.contour);
    }
  }
  for (const auto& [key, light] : inspection.lights) {
    if (!light) continue;
    d.add(textOf(key));
    d.add(light->light.homogeneous());
    d.add(light->limitAngle);
  }
  for (const auto& [name, result] : inspection.models) {
    d.add(name);
    for (const ModelResult::Fit& f : result.fits) {
      d.add(f.light);
      d.add(f.surface.value_or(""));
      d.add(f.failure());
      if (!f.fit) continue;
      if (const EllipsoidFit* const e = f.fit->as<EllipsoidFit>()) d.add(e->quadric.matrix);
      if (f.fit->limitAngle()) d.add(*f.fit->limitAngle());
      if (const ReflectanceFit* const lobe = f.fit->as<ReflectanceFit>()) d.add(lobe->roughness.mean);
      for (const double r : f.fit->residualPx) d.add(r);
    }
    for (const FrameComparison& c : result.frames) {
      d.add(static_cast<double>(c.frame));
      d.add(c.light);
      d.add(c.prediction.failure());
      for (const PredictedHighlight& h : c.prediction.highlights()) {
        d.add(h.contour);
        d.add(h.coverage);
        for (const double s : h.sigmaPx) d.add(s);
      }
      for (const FrameComparison::Row& row : c.rows) {
        d.add(static_cast<double>(row.observed));
        d.add(static_cast<double>(row.predicted));
        d.add(row.failure ? &*row.failure : nullptr);
        if (!row.metrics) continue;
        const ContourMetrics& m = *row.metrics;
        for (const double v : {m.contourErrorPx, m.contourErrorPct, m.ellipseErrorPct, m.hausdorffPx, m.iou, m.centreOffsetPx,
                               m.axisRatioError, m.angleErrorDeg, m.peakOffsetPx})
          d.add(v);
      }
    }
  }
  return d.hex();
}

Session sessionOf(const Inspection& inspection, const ProgressFn& progress) {
  require(inspection.scene != nullptr, "sessionOf: the inspection has no scene");
  const Scene& scene = *inspection.scene;
  Session session;
  session.input = std::filesystem::absolute(scene.file).lexically_normal();
  session.allowOutsidePaths = scene.allowOutsidePaths;
  session.folders = scene.folders;
  session.choices = scene.choices;
  session.meshes = scene.meshes;
  session.request = inspection.request;
  session.files = hashInputs(scene, inspection.request, progress);
  for (int i = 0; i < static_cast<int>(scene.frames.size()); ++i) {
    const std::string& id = scene.frames[static_cast<std::size_t>(i)].id;
    if (inspection.isTraining(i)) session.training.push_back(id);
    if (inspection.isHeldOut(i)) session.heldOut.push_back(id);
  }
  session.keyResults = keyResultsOf(inspection);
  session.digest = digestOf(inspection);
  return session;
}

Replay replay(const Session& session, const Relinked& instead, const ProgressFn& progress) {
  if (session.keyResults.empty())
    throw InputError(session.file.string(), "results", "the session was saved without results; nothing to compare");
  const std::vector<std::string> changed = changedFiles(session, instead, progress);
  if (!changed.empty())
    throw InputError(session.file.string(), "input",
                     changed.front() + (changed.size() > 1 ? " (and " + std::to_string(changed.size() - 1) + " more)" : ""));
  const Inspection inspection = inspect(openSession(session, instead).scene, session.request, progress);
  Replay result;
  const KeyResults now = keyResultsOf(inspection);
  const auto find = [](const KeyResults& all, const std::string& name) {
    return std::find_if(all.begin(), all.end(), [&](const auto& r) { return r.first == name; });
  };
  std::optional<ResultStage> first;
  const auto differs = [&](const std::string& name, const std::string& how) {
    result.differences.push_back(name + ": " + how);
    first = first ? std::min(*first, stageOf(name)) : stageOf(name);
  };
  for (const auto& [name, value] : session.keyResults) {
    ++result.compared;
    const auto it = find(now, name);
    if (it == now.end()) {
      differs(name, "was " + shortest(value) + ", is no longer computed");
      continue;
    }
    const double difference = keyResultDifference(name, value, it->second);
    result.largestDifference = std::max(result.largestDifference, difference);
    if (difference > kAgree) differs(name, "was " + shortest(value) + ", is " + shortest(it->second));
  }
  const bool detectionKnown = std::any_of(session.keyResults.begin(), session.keyResults.end(),
                                          [](const auto& r) { return stageOf(r.first) == ResultStage::Detection; });
  for (const auto& [name, value] : now)
    if ((detectionKnown || stageOf(name) != ResultStage::Detection) && find(session.keyResults, name) == session.keyResults.end())
      differs(name, "is " + shortest(value) + ", was not computed");
  if (first) result.firstChanged = wordsFor(*first, detectionKnown);
  result.digestAgrees = digestOf(inspection) == session.digest;
  return result;
}

}  // namespace glint
