// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "core/advise/highlight_evidence.h"
#include "core/base/csv_text.h"
#include "core/base/json_dom.h"
#include "core/base/settings_dom.h"
#include "core/model/star.h"
#include "core/pipeline/what_if_dom.h"
#include "core/report/evaluation_words.h"
#include "core/report/texts.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace evaluation {
namespace {

using json_dom::Json;

using json_dom::numberOrNull;

template <class Matrix>
Json rows(const Matrix& m) {
  Json out = Json::array();
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    Json row = Json::array();
    for (Eigen::Index c = 0; c < m.cols(); ++c) row.push_back(numberOrNull(m(r, c)));
    out.push_back(row);
  }
  return out;
}

template <class Vector>
Json list(const Vector& v) {
  Json out = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) out.push_back(numberOrNull(v[i]));
  return out;
}

Json statistic(const Statistic& s) {
  return {{"mean", numberOrNull(s.mean)},
          {"median", numberOrNull(s.median)},
          {"p95", numberOrNull(s.p95)},
          {"max", numberOrNull(s.max)}};
}

Json selectionJson(const Selection& s) {
  Json j = {{"status", s.status()},
            {"best", s.best.empty() ? Json(nullptr) : Json(s.best)},
            {"training_views", s.trainingViews},
            {"left_out", s.leftOut},
            {"views_to_predict", s.toPredict},
            {"outside", s.outside},
            {"decided_by", s.decidedBy},
            {"candidates", Json::array()}};
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

/// The shape of a lobe's lamp: every key that some shape has.
void lampJson(const std::optional<Lamp>& lamp, Json& j) {
  j["light_radius"] = 0.0;
  for (const PlacedShape& shape : placedShapes()) j["light_" + shape.name] = nullptr;
  for (const LampField& field : lamp ? fieldsOf(*lamp) : std::vector<LampField>()) {
    if (field.value.size() == 1)
      j["light_" + field.name] = numberOrNull(field.value(0));
    else if (field.value.rows() > 1)
      j["light_" + field.name] = rows(field.value);
  }
}

/// In which coordinates the light stands still, and what it would leave of the training peaks in each.
void lightFrameJson(const LightFrameChoice& choice, const std::string& light, Json& j) {
  j["frame"] = nameOf(choice.frameOf(light));
  j["frame_reason"] = choice.reason;
  const auto found = choice.byLight.find(light);
  const auto px = [](const std::optional<double>& v) { return v ? numberOrNull(*v) : Json(nullptr); };
  if (found == choice.byLight.end())
    j["residual_px_by_frame"] = nullptr;
  else
    j["residual_px_by_frame"] = {{"world", px(found->second.world)}, {"camera", px(found->second.camera)}};
}

Json fitJson(const Inspection& inspection, const ModelResult::Fit& entry) {
  Json j;
  j["light"] = entry.light;
  j["surface"] = entry.surface ? Json(*entry.surface) : Json(nullptr);
  j["status"] = fitStatus(entry);
  j["reason"] = fitReason(entry);
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
  j["q_dual"] = quadric ? rows(quadric->quadric.matrix) : Json::array();
  if (f.lightEstimate) {
    // Homogeneous with a last coordinate of 1 where the light is finite, as a reader expects.
    const Eigen::Vector4d l = f.lightEstimate->homogeneous();
    j["light_position"] = f.lightEstimate->atInfinity() ? list(l) : list(Eigen::Vector4d(l / l.w()));
  } else {
    j["light_position"] = nullptr;
  }
  lightFrameJson(inspection.lightFrame, entry.light, j);
  j["limit_angle_deg"] = f.limitAngle() ? numberOrNull(*f.limitAngle() * 180 / M_PI) : Json(nullptr);
  j["roughness"] = lobe ? numberOrNull(lobe->roughness.mean) : Json(nullptr);
  if (lobe && hasTwoWidths(lobe->lobe)) j["roughness_ratio"] = numberOrNull(lobe->roughness.ratio);
  if (contours && contours->extent) j["light_extent"] = rows(*contours->extent);
  if (lobe) {
    j["lobe"] = nameOf(lobe->lobe);
    lampJson(f.lamp(), j);
  }
  const bool isSolved = quadric && !quadric->singularValues.empty();
  j["gap_ratio"] = isSolved ? numberOrNull(quadric->gapRatio) : Json(nullptr);
  // Largest over smallest of the linear system, if any, else of the rays that fix the light (whose ratio is of squares).
  if (isSolved)
    j["condition"] = numberOrNull(f.condition);
  else
    j["condition"] = f.lightEstimate && f.condition > 0 ? numberOrNull(1 / std::sqrt(f.condition)) : Json(nullptr);
  j["solver"] = f.solver;
  if (lobe) {
    j["evidence"] = lobe->evidence;
    j["levels"] = lobe->levels;
    j["blur_px"] = lobe->blurPx ? numberOrNull(*lobe->blurPx) : Json(nullptr);
  }
  j["residual_px"] = Json::array();
  for (const double r : f.residualPx) j["residual_px"].push_back(numberOrNull(r));
  j["training_frames"] = f.frames;
  j["training_ids"] = frameIds(*inspection.scene, f.frames);
  j["warnings"] = f.remarks;
  j["time_us"] = entry.failure() ? Json(nullptr) : numberOrNull(f.timeUs);
  return j;
}

/// Every metric of a row, null if it has none: each row of `frames` has the same keys.
void metricsJson(const FrameComparison::Row* row, const FrameComparison& c, bool cut, Json& j) {
  const bool measured = row && row->metrics;
  const ContourMetrics m = measured ? *row->metrics : ContourMetrics{};
  const auto add = [&](const char* key, double v) { j[key] = measured ? numberOrNull(v) : Json(nullptr); };
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
  j["coverage"] = row && row->predicted >= 0 ? numberOrNull(c.prediction.highlights()[row->predicted].coverage) : Json(nullptr);
  // Only where walks were made on second-order patches: says whether they were good enough.
  if (row && row->predicted >= 0 && c.prediction.highlights()[row->predicted].curvatureVariation)
    j["curvature_variation"] = numberOrNull(*c.prediction.highlights()[row->predicted].curvatureVariation);
  if (cut) j["cut"] = true;
  if (row && row->band)
    j["band"] = {{"sigma_px", numberOrNull(row->band->sigmaPx)}, {"coverage_95", numberOrNull(row->band->coverage)}};
  j["time_us"] = numberOrNull(c.prediction.timeUs);
}

/// Appends one row per highlight of a comparison, or one that says why no highlight was compared.
void addRows(const Inspection& inspection, const ModelResult& result, const FrameComparison& c, Json& out) {
  const auto base = [&](int highlight) {
    Json j;
    j["index"] = c.frame;
    j["id"] = inspection.scene->frames[c.frame].id;
    j["light"] = c.light;
    j["highlight"] = highlight;
    return j;
  };
  const FrameEvidence& e = inspection.evidence[c.frame];
  if (c.rows.empty() && c.prediction.highlights().empty()) {
    Json j = base(0);
    j["status"] = e.scoringFailure() ? "nothing observed" : "failed";
    j["reason"] = e.scoringFailure()       ? e.scoringFailure()->message()
                  : c.prediction.failure() ? c.prediction.failure()->message()
                                           : "no highlight";
    metricsJson(nullptr, c, false, j);
    out.push_back(j);
    return;
  }
  for (const FrameComparison::Row& row : c.rows) {
    Json j = base(row.observed >= 0 ? row.observed : row.predicted);
    const std::string poor = poorFit(result, c);
    j["status"] = row.metrics          ? (poor.empty() ? "ok" : "poor")
                  : row.observed >= 0  ? "missed"
                  : row.predicted >= 0 ? "spurious"
                                       : "failed";
    std::string reason = whyUnmatched(inspection, c, row);
    if (const std::string general = row.failure ? row.failure->message() : ""; !row.metrics && general != reason)
      reason = general + (general.empty() ? "" : "; ") + reason;
    j["reason"] = row.metrics ? poor : reason;
    metricsJson(&row, c, row.observed >= 0 && e.scored()[static_cast<std::size_t>(row.observed)].touchesBorder, j);
    out.push_back(j);
  }
}

Json heldOutRows(const Inspection& inspection, const ModelResult& result) {
  Json out = Json::array();
  for (const FrameComparison& c : result.frames)
    if (inspection.isHeldOut(c.frame)) addRows(inspection, result, c, out);
  return out;
}

Json summaryJson(const ModelSummary& s) {
  return {{"frames", s.frames},
          {"predicted", s.predicted},
          {"contour_error_pct", statistic(s.contourErrorPct)},
          {"contour_error_px", statistic(s.contourErrorPx)},
          {"ellipse_error_pct", statistic(s.ellipseErrorPct)},
          {"hausdorff_px", statistic(s.hausdorffPx)},
          {"iou", statistic(s.iou)},
          {"matched", s.matched},
          {"missed", s.missed},
          {"spurious", s.spurious},
          {"filtered", s.filtered},
          {"peak_offset_px", statistic(s.peakOffsetPx)},
          {"coverage", statistic(s.coverage)},
          {"time_us", {{"median", numberOrNull(s.timeUs.median)}, {"p99", numberOrNull(s.timeP99Us)}}}};
}

Json bandJson(const std::optional<BandScore>& score) {
  return {{"sigma_px", score ? numberOrNull(score->sigmaPx) : Json(nullptr)},
          {"coverage_95", score ? numberOrNull(score->coverage) : Json(nullptr)}};
}

Json detectionJson(const DetectionError& d) {
  return {{"frames", d.frames},
          {"missed", d.missed},
          {"contour_error_pct", statistic(d.contourErrorPct)},
          {"contour_error_px", statistic(d.contourErrorPx)}};
}

Json modelJson(const Inspection& inspection, const ModelResult& result) {
  const ModelSummary s = summarise(inspection, result);
  Json j;
  j["status"] = s.status();
  j["reason"] = s.reason;
  j["fits"] = Json::array();
  for (const ModelResult::Fit& f : result.fits) j["fits"].push_back(fitJson(inspection, f));
  j["summary"] = summaryJson(s);
  if (inspection.request.settings.flag("predict.band")) {
    const std::optional<BandScore> band = bandSummary(inspection, result);
    j["band"] = bandJson(band);
    j["band"].update({{"scale_tolerance", inspection.request.settings.number("input.scale_tolerance")},
                      {"focal_tolerance", inspection.request.settings.number("input.focal_tolerance")},
                      {"remarks", Json::array()}});
    for (const ModelResult::Fit& f : result.fits)
      for (const std::string& remark : f.bandRemarks) j["band"]["remarks"].push_back(remark);
  }
  j["frames"] = heldOutRows(inspection, result);
  return j;
}

/// One row per highlight of every training frame: whether it could be used, and why not.
Json trainingJson(const Inspection& inspection) {
  Json out = Json::array();
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

}  // namespace

BestModel bestOf(const std::vector<std::pair<std::string, ModelSummary>>& models) {
  BestModel best;
  double smallest = 0;
  const bool anyOk = std::any_of(models.begin(), models.end(), [](const auto& m) {
    return m.second.answered && !m.second.poor && m.second.contourErrorPct.count > 0;
  });
  for (const auto& [name, s] : models) {
    if (!s.answered || s.contourErrorPct.count == 0 || (anyOk && s.poor)) continue;
    if (best.model.empty() || s.wrongPct < smallest) best.model = name, smallest = s.wrongPct;
  }
  if (!best.model.empty())
    best.why = std::string(anyOk ? "" : "Every model that answers is poor: it explains its training views badly. ") +
               "Smallest mean held-out contour error, where a missed highlight counts as 100 %; --models auto chooses from the "
               "training frames alone.";
  return best;
}

}  // namespace evaluation

std::string evaluationJson(const Inspection& inspection, const ReportContext& context) {
  using namespace evaluation;
  Json j;
  j["glint_evaluation"] = 1;
  j["input"] = context.input;
  j["train"] = inspection.train.frames;
  j["train_ids"] = frameIds(*inspection.scene, inspection.train.frames);
  j["train_spec"] = inspection.train.text;
  j["excluded"] = inspection.request.excluded;
  j["excluded_ids"] = frameIds(*inspection.scene, inspection.request.excluded);
  j["training"] = trainingJson(inspection);
  j["level"] = inspection.request.settings.number("detect.level");
  if (!context.levelReason.empty()) j["level_reason"] = context.levelReason;
  j["source"] = inspection.request.source == FrameSource::Image ? "image" : "radiance";
  j["settings"] = toJson(inspection.request.settings);
  if (!inspection.request.whatIf.none()) j["what_if"] = toJson(inspection.request.whatIf);
  j["scored_against"] = scoredAgainst(inspection);
  std::vector<std::string> warnings = warningsOf(inspection);
  if (context.selection && context.selection->poor) warnings.push_back("auto: " + context.selection->why);
  j["warnings"] = std::move(warnings);
  j["chosen_model"] = context.chosenModel.empty() ? Json(nullptr) : Json(context.chosenModel);
  j["why_chosen"] = context.whyChosen;
  if (const std::optional<DetectionError> d = detectionError(inspection)) j["detection"] = detectionJson(*d);
  if (context.selection) j["selection"] = selectionJson(*context.selection);
  j["models"] = Json::object();
  for (const std::string& name : inspection.request.models)
    if (const auto it = inspection.models.find(name); it != inspection.models.end())
      j["models"][name] = modelJson(inspection, it->second);
  return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

const char* const kEvaluationCsvHeader =
    "model,index,id,light,highlight,status,reason,contour_error_pct,contour_error_px,ellipse_error_pct,hausdorff_px,iou,"
    "centre_offset_px,axis_ratio_error,angle_error_deg,peak_offset_px,coverage,time_us\n";

std::string evaluationCsv(const Inspection& inspection) {
  std::string out = kEvaluationCsvHeader;
  for (const std::string& name : inspection.request.models) {
    const auto it = inspection.models.find(name);
    if (it == inspection.models.end()) continue;
    for (const evaluation::Json& r : evaluation::heldOutRows(inspection, it->second)) {
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

}  // namespace glint
