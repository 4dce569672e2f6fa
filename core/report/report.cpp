// SPDX-License-Identifier: BSD-3-Clause
#include "core/report/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/json_dom.h"
#include "core/base/number_text.h"
#include "core/inspect/summary.h"
#include "core/model/star.h"
#include "core/report/band_text.h"
#include "core/report/csv_text.h"
#include "core/report/detection_error.h"
#include "core/report/warnings.h"
#include "core/what_if/json.h"

namespace glint {
namespace {

using json_dom::numberOrNull;
using nlohmann::ordered_json;

template <class Matrix>
ordered_json rows(const Matrix& m) {
  ordered_json out = ordered_json::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index c = 0; c < m.cols(); ++c) row.push_back(numberOrNull(m(r, c)));
    out.push_back(row);
  }
  return out;
}

template <class Vector>
ordered_json list(const Vector& v) {
  ordered_json out = ordered_json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) out.push_back(numberOrNull(v[i]));
  return out;
}

ordered_json statistic(const Statistic& s) {
  return {{"mean", numberOrNull(s.mean)},
          {"median", numberOrNull(s.median)},
          {"p95", numberOrNull(s.p95)},
          {"max", numberOrNull(s.max)}};
}

ordered_json settingsJson(const Settings& settings) {
  ordered_json out = ordered_json::object();
  for (const ParamSpec& p : allParams()) {
    if (std::holds_alternative<bool>(p.defaultValue))
      out[p.key] = settings.flag(p.key);
    else if (std::holds_alternative<int>(p.defaultValue))
      out[p.key] = settings.integer(p.key);
    else if (std::holds_alternative<double>(p.defaultValue))
      out[p.key] = settings.number(p.key);
    else
      out[p.key] = settings.text(p.key);
  }
  return out;
}

ordered_json selectionJson(const Selection& s) {
  ordered_json j = {{"training_views", s.trainingViews}, {"left_out", s.leftOut},
                    {"views_to_predict", s.toPredict},   {"outside", s.outside},
                    {"decided_by", s.decidedBy},         {"candidates", ordered_json::array()}};
  for (const Candidate& c : s.candidates)
    j["candidates"].push_back({{"model", c.model},
                               {"views", c.views},
                               {"tried", c.tried},
                               {"answered", c.answered},
                               {"mean_pct", numberOrNull(c.meanPct)},
                               {"standard_error_pct", numberOrNull(c.standardErrorPct)},
                               {"outlook_pct", numberOrNull(c.outlookPct)},
                               {"spread_pct", numberOrNull(c.spreadPct)},
                               {"disagreement_pct", numberOrNull(c.disagreementPct)},
                               {"expected_pct", numberOrNull(c.expectedPct)},
                               {"predict_us", numberOrNull(c.predictUs)},
                               {"time_us", numberOrNull(c.timeUs)},
                               {"remark", c.remark}});
  if (s.patches)
    j["local_quadric"] = {{"good_enough", s.patches->goodEnough},
                          {"curvature_variation", numberOrNull(s.patches->variation)},
                          {"limit", kLargestVariation},
                          {"views", s.patches->views},
                          {"other_frames", s.patches->others},
                          {"mean_pct", numberOrNull(s.patches->meanPct)},
                          {"predict_us", numberOrNull(s.patches->predictUs)},
                          {"exact_predict_us", numberOrNull(s.patches->exactUs)},
                          {"time_us", numberOrNull(s.patches->timeUs)},
                          {"reason", s.patches->why}};
  else
    j["local_quadric"] = nullptr;
  return j;
}

ordered_json fitJson(const ModelResult::Fit& entry) {
  ordered_json j;
  j["light"] = entry.light;
  j["surface"] = entry.surface ? ordered_json(*entry.surface) : ordered_json(nullptr);
  j["status"] = entry.failure() ? "failed" : "ok";
  j["reason"] = entry.failure() ? entry.failure()->message() : "";
  // A failed fit has every key too, without values: a reader need not ask which are there.
  const ModelFit f = entry.fit ? *entry.fit : ModelFit{};
  const EllipsoidFit* const quadric = f.as<EllipsoidFit>();
  const LimitAngleFit* const contours = f.as<LimitAngleFit>();
  const ReflectanceFit* const lobe = f.as<ReflectanceFit>();
  if (const Ellipsoid* const e = f.ellipsoid()) {
    j["ellipsoid"] = {{"centre", list(e->centre())},
                      {"semi_axes", list(e->semiAxes())},
                      {"world_from_ellipsoid", rows(e->worldFromBody().matrix())}};
  } else {
    j["ellipsoid"] = nullptr;
  }
  j["q_dual"] = quadric ? rows(quadric->quadric.matrix) : ordered_json::array();
  if (f.lightEstimate) {
    // Homogeneous with a last coordinate of 1 where the light is finite, as a reader expects.
    const Eigen::Vector4d l = f.lightEstimate->homogeneous();
    j["light_position"] = f.lightEstimate->atInfinity() ? list(l) : list(Eigen::Vector4d(l / l.w()));
  } else {
    j["light_position"] = nullptr;
  }
  j["limit_angle_deg"] = f.limitAngle() ? numberOrNull(*f.limitAngle() * 180 / M_PI) : ordered_json(nullptr);
  j["roughness"] = lobe ? numberOrNull(lobe->roughness) : ordered_json(nullptr);
  if (contours && contours->extent) j["light_extent"] = rows(*contours->extent);
  if (lobe) {
    j["lobe"] = nameOf(lobe->lobe);
    j["light_radius"] = numberOrNull(lobe->lightRadius);
    const auto& ends = lobe->lightSegment;
    j["light_segment"] = ends ? ordered_json{list(ends->first), list(ends->second)} : ordered_json(nullptr);
  }
  const bool isSolved = quadric && !quadric->singularValues.empty();
  j["gap_ratio"] = isSolved ? numberOrNull(quadric->gapRatio) : ordered_json(nullptr);
  // Largest over smallest: of the linear system where there is one, else of the rays that fix the light (whose ratio is of squares).
  if (isSolved)
    j["condition"] = numberOrNull(f.condition);
  else
    j["condition"] = f.lightEstimate && f.condition > 0 ? numberOrNull(1 / std::sqrt(f.condition)) : ordered_json(nullptr);
  j["solver"] = f.solver;
  if (lobe) {
    j["evidence"] = lobe->evidence;
    j["levels"] = lobe->levels;
    j["blur_px"] = lobe->blurPx ? numberOrNull(*lobe->blurPx) : ordered_json(nullptr);
  }
  j["residual_px"] = ordered_json::array();
  for (const double r : f.residualPx) j["residual_px"].push_back(numberOrNull(r));
  j["training_frames"] = f.frames;
  j["warnings"] = f.remarks;
  j["time_us"] = entry.failure() ? ordered_json(nullptr) : numberOrNull(f.timeUs);
  return j;
}

/// Every metric of a row, null where it has none: each row of `frames` has the same keys.
void metricsJson(const FrameComparison::Row* row, const FrameComparison& c, ordered_json& j) {
  const bool measured = row && row->metrics;
  const ContourMetrics m = measured ? *row->metrics : ContourMetrics{};
  const auto add = [&](const char* key, double v) { j[key] = measured ? numberOrNull(v) : ordered_json(nullptr); };
  add("contour_error_pct", m.contourErrorPct);
  add("contour_error_px", m.contourErrorPx);
  add("ellipse_error_pct", m.ellipseErrorPct);
  add("hausdorff_px", m.hausdorffPx);
  add("iou", c.iou);
  add("iou_highlight", m.iou);
  add("centre_offset_px", m.centreOffsetPx);
  add("axis_ratio_error", m.axisRatioError);
  add("angle_error_deg", m.angleErrorDeg);
  add("peak_offset_px", m.peakOffsetPx);
  j["coverage"] =
      row && row->predicted >= 0 ? numberOrNull(c.prediction.highlights()[row->predicted].coverage) : ordered_json(nullptr);
  // Only where walks were made on second-order patches: says whether they were good enough.
  if (row && row->predicted >= 0 && c.prediction.highlights()[row->predicted].curvatureVariation)
    j["curvature_variation"] = numberOrNull(*c.prediction.highlights()[row->predicted].curvatureVariation);
  if (row && row->band)
    j["band"] = {{"sigma_px", numberOrNull(row->band->sigmaPx)}, {"coverage_95", numberOrNull(row->band->coverage)}};
  j["time_us"] = numberOrNull(c.prediction.timeUs);
}

void frameRows(const Inspection& inspection, const FrameComparison& c, ordered_json& out) {
  const auto base = [&](int highlight) {
    ordered_json j;
    j["index"] = c.frame;
    j["id"] = inspection.scene->frames[c.frame].id;
    j["light"] = c.light;
    j["highlight"] = highlight;
    return j;
  };
  const FrameEvidence& e = inspection.evidence[c.frame];
  if (c.rows.empty() && c.prediction.highlights().empty()) {
    ordered_json j = base(0);
    j["status"] = e.scoringFailure() ? "nothing observed" : "failed";
    j["reason"] = e.scoringFailure()       ? e.scoringFailure()->message()
                  : c.prediction.failure() ? c.prediction.failure()->message()
                                           : "no highlight";
    metricsJson(nullptr, c, j);
    out.push_back(j);
    return;
  }
  for (const FrameComparison::Row& row : c.rows) {
    ordered_json j = base(row.observed >= 0 ? row.observed : row.predicted);
    j["status"] = row.metrics ? "ok" : row.observed >= 0 ? "missed" : row.predicted >= 0 ? "spurious" : "failed";
    j["reason"] = row.failure                              ? row.failure->message()
                  : row.observed < 0 && e.scoringFailure() ? e.scoringFailure()->message()
                                                           : "";
    metricsJson(&row, c, j);
    out.push_back(j);
  }
}

ordered_json modelJson(const Inspection& inspection, const ModelResult& result) {
  const ModelSummary s = summarise(inspection, result);
  ordered_json j;
  j["status"] = s.answered ? "ok" : "failed";
  j["reason"] = s.reason;
  j["fits"] = ordered_json::array();
  for (const ModelResult::Fit& f : result.fits) j["fits"].push_back(fitJson(f));
  j["summary"] = {{"frames", s.frames},
                  {"predicted", s.predicted},
                  {"contour_error_pct", statistic(s.contourErrorPct)},
                  {"contour_error_px", statistic(s.contourErrorPx)},
                  {"ellipse_error_pct", statistic(s.ellipseErrorPct)},
                  {"hausdorff_px", statistic(s.hausdorffPx)},
                  {"iou", statistic(s.iou)},
                  {"matched", s.matched},
                  {"missed", s.missed},
                  {"spurious", s.spurious},
                  {"peak_offset_px", statistic(s.peakOffsetPx)},
                  {"coverage", statistic(s.coverage)},
                  {"time_us", {{"median", numberOrNull(s.timeUs.median)}, {"p99", numberOrNull(s.timeP99Us)}}}};
  if (inspection.request.settings.flag("predict.band")) {
    const std::optional<BandScore> band = bandSummary(inspection, result);
    j["band"] = {{"sigma_px", band ? numberOrNull(band->sigmaPx) : ordered_json(nullptr)},
                 {"coverage_95", band ? numberOrNull(band->coverage) : ordered_json(nullptr)},
                 {"scale_tolerance", inspection.request.settings.number("input.scale_tolerance")},
                 {"focal_tolerance", inspection.request.settings.number("input.focal_tolerance")},
                 {"remarks", ordered_json::array()}};
    for (const ModelResult::Fit& f : result.fits)
      for (const std::string& remark : f.bandRemarks) j["band"]["remarks"].push_back(remark);
  }
  j["frames"] = ordered_json::array();
  for (const FrameComparison& c : result.frames)
    if (inspection.isHeldOut(c.frame)) frameRows(inspection, c, j["frames"]);
  return j;
}

/// One row per highlight of every training frame: whether it could be used, and why not.
ordered_json trainingJson(const Inspection& inspection) {
  ordered_json out = ordered_json::array();
  const auto add = [&](int frame, const std::string& light, const std::optional<Failure>& failure) {
    out.push_back({{"index", frame},
                   {"id", inspection.scene->frames[frame].id},
                   {"light", light},
                   {"status", failure ? "failed" : "ok"},
                   {"reason", failure ? failure->message() : ""}});
  };
  for (const int frame : inspection.train.frames) {
    bool any = false;
    for (const TrainingView& v : inspection.views) {
      if (v.frame != frame) continue;
      any = true;
      add(frame, v.highlight.light, v.failure());
    }
    if (!any && inspection.isTraining(frame))
      add(frame, "", inspection.evidence[frame].failure.value_or(Failure{Reason::NoHighlight, ""}));
  }
  return out;
}

std::string cell(double v, const char* format = "%.4g") {
  if (!std::isfinite(v)) return "-";
  return formatted(format, v);
}

}  // namespace

std::string bestModel(const Inspection& inspection) {
  std::string best;
  int mostPredicted = 0;
  double smallest = 0;
  for (const std::string& name : inspection.request.models) {
    const auto it = inspection.models.find(name);
    if (it == inspection.models.end()) continue;
    const ModelSummary s = summarise(inspection, it->second);
    if (!s.answered || s.contourErrorPct.count == 0) continue;
    if (best.empty() || s.predicted > mostPredicted || (s.predicted == mostPredicted && s.contourErrorPct.mean < smallest)) {
      best = name;
      mostPredicted = s.predicted;
      smallest = s.contourErrorPct.mean;
    }
  }
  return best;
}

std::string evaluationJson(const Inspection& inspection, const ReportContext& context) {
  ordered_json j;
  j["glint_evaluation"] = 1;
  j["input"] = context.input;
  j["train"] = inspection.train.frames;
  j["train_spec"] = inspection.train.text;
  j["excluded"] = inspection.request.excluded;
  j["training"] = trainingJson(inspection);
  j["level"] = inspection.request.settings.number("detect.level");
  if (!context.levelReason.empty()) j["level_reason"] = context.levelReason;
  j["source"] = inspection.request.source == FrameSource::Image ? "image" : "radiance";
  j["settings"] = settingsJson(inspection.request.settings);
  if (!inspection.request.whatIf.none()) j["what_if"] = ordered_json::parse(whatIfJson(inspection.request.whatIf));
  j["scored_against"] = scoredAgainst(inspection);
  j["warnings"] = warningsOf(inspection);
  j["chosen_model"] = context.chosenModel.empty() ? ordered_json(nullptr) : ordered_json(context.chosenModel);
  j["why_chosen"] = context.whyChosen;
  if (const std::optional<DetectionError> d = detectionError(inspection))
    j["detection"] = {{"frames", d->frames},
                      {"missed", d->missed},
                      {"contour_error_pct", statistic(d->contourErrorPct)},
                      {"contour_error_px", statistic(d->contourErrorPx)}};
  if (context.selection) j["selection"] = selectionJson(*context.selection);
  j["models"] = ordered_json::object();
  for (const std::string& name : inspection.request.models)
    if (const auto it = inspection.models.find(name); it != inspection.models.end())
      j["models"][name] = modelJson(inspection, it->second);
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

const char* const kEvaluationCsvHeader =
    "model,index,id,light,highlight,status,reason,contour_error_pct,contour_error_px,ellipse_error_pct,hausdorff_px,iou,"
    "centre_offset_px,axis_ratio_error,angle_error_deg,peak_offset_px,coverage,time_us\n";

std::string evaluationCsv(const Inspection& inspection) {
  std::string out = kEvaluationCsvHeader;
  for (const std::string& name : inspection.request.models) {
    const auto it = inspection.models.find(name);
    if (it == inspection.models.end()) continue;
    ordered_json rows = ordered_json::array();
    for (const FrameComparison& c : it->second.frames)
      if (inspection.isHeldOut(c.frame)) frameRows(inspection, c, rows);
    for (const ordered_json& r : rows) {
      out += csvText(name) + "," + r["index"].dump() + "," + csvText(r["id"]) + "," + csvText(r["light"]) + "," +
             r["highlight"].dump() + "," + csvText(r["status"]) + "," + csvText(r["reason"]);
      for (const char* key : {"contour_error_pct", "contour_error_px", "ellipse_error_pct", "hausdorff_px", "iou",
                              "centre_offset_px", "axis_ratio_error", "angle_error_deg", "peak_offset_px", "coverage", "time_us"})
        out += "," + (r.contains(key) && !r[key].is_null() ? r[key].dump() : "");
      out += "\n";
    }
  }
  return out;
}

std::string evaluationTable(const Inspection& inspection) {
  std::string out = formatted("%-12s %11s %9s %9s %9s %9s %9s %8s %8s %13s %10s\n", "model", "predicted", "mean %", "median %",
                              "p95 %", "max %", "mean px", "IoU", "coverage", "match/mis/spu", "median us");
  for (const std::string& name : inspection.request.models) {
    const auto it = inspection.models.find(name);
    if (it == inspection.models.end()) continue;
    const ModelSummary s = summarise(inspection, it->second);
    const std::string predicted = std::to_string(s.predicted) + "/" + std::to_string(s.frames);
    const std::string counts = std::to_string(s.matched) + "/" + std::to_string(s.missed) + "/" + std::to_string(s.spurious);
    out += formatted("%-12s %11s %9s %9s %9s %9s %9s %8s %8s %13s %10s", name.c_str(), predicted.c_str(),
                     cell(s.contourErrorPct.mean).c_str(), cell(s.contourErrorPct.median).c_str(),
                     cell(s.contourErrorPct.p95).c_str(), cell(s.contourErrorPct.max).c_str(),
                     cell(s.contourErrorPx.mean).c_str(), cell(s.iou.mean, "%.4f").c_str(), cell(s.coverage.mean, "%.3f").c_str(),
                     counts.c_str(), cell(s.timeUs.median, "%.0f").c_str());
    if (!s.answered) out += "  " + s.reason;
    out += "\n";
    for (const std::string& text : bandLines(inspection, it->second)) {
      out += formatted("%-12s ", "") + text + "\n";
    }
    double variation = 0;
    for (const FrameComparison& c : it->second.frames)
      for (const PredictedHighlight& h : c.prediction.highlights())
        variation = std::max(variation, h.curvatureVariation.value_or(0));
    if (variation > kLargestVariation) {
      out +=
          formatted("%-12s the local quadric is not good enough: curvature varies by up to %.3f over a highlight (limit %.2f)\n",
                    "", variation, kLargestVariation);
    }
  }
  if (const std::optional<DetectionError> d = detectionError(inspection)) {
    out += formatted("own detection against truth: %s %% mean, %s %% max; %d true highlights missed in %d frames\n",
                     cell(d->contourErrorPct.mean).c_str(), cell(d->contourErrorPct.max).c_str(), d->missed, d->frames);
  } else if (scoredAgainst(inspection) == "own detection") {
    out += "errors are relative to Glint's own detection; --truth DIR scores against known contours\n";
  }
  return out;
}

}  // namespace glint
