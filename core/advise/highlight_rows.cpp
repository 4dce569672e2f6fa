// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/highlight_rows.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "core/base/numeric.h"
#include "core/choice/selection.h"
#include "core/geometry/polyline.h"
#include "core/model/plausible.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/summary.h"

namespace glint {
namespace {

constexpr std::array<RowColumn, kRowValues> kColumns{{
    {"frame", "Position", "frame, by position in the sequence", "Position of the frame in the sequence, from 0", 0, 0},
    {"error-pct", "Error %", "contour error (%)",
     "Mean contour distance (symmetric) in % of the observed region's equivalent diameter", 3, 1},
    {"error-px", "Error px", "mean contour distance (px)",
     "Mean contour distance, px: symmetric, over the length of both contours, without sign. (The residual dial shows the signed "
     "distance by direction.)",
     3, 1},
    {"ellipse-pct", "Ellipse %", "error between ellipses (%)", "As Error %, between the fitted and the predicted ellipse", 3, 1},
    {"hausdorff-px", "Hausd. px", "Hausdorff distance (px)", "Hausdorff distance, pixels", 3, 1},
    {"iou", "IoU", "intersection over union", "Intersection over union of the filled contours", 4, -1},
    {"coverage", "Coverage", "coverage", "Share of directions that gave a contour point", 3, -1},
    {"centre-px", "Centre px", "distance of the centres (px)", "Distance of the area centroids, pixels", 3, 1},
    {"peak-px", "Peak px", "distance of the peaks (px)", "Distance of the peaks, pixels", 3, 1},
    {"area-ratio", "Area ratio", "area, predicted over observed",
     "Area of the predicted contour over that of the observed one. None where the image's border cuts the highlight", 3, 0},
    {"axis-ratio", "Axis ratio", "difference of the axis ratios",
     "Axis ratio of the predicted minus that of the observed ellipse: 0 = the same shape", 3, 0},
    {"axis-angle", "Angle \u00b0", "angle between the major axes (\u00b0)",
     "Angle between the major axes of both ellipses, 0\u00b0 to 90\u00b0; 0 where one is a circle within 1 %", 2, 1},
    {"observed-px", "Observed px", "observed diameter (px)", "Diameter of the disc with the area of the observed contour, pixels",
     2, 0},
    {"predicted-px", "Predicted px", "predicted diameter (px)",
     "Diameter of the disc with the area of the predicted contour, pixels. It may reach beyond the image", 2, 0},
    {"radiance", "Radiance", "radiance at the observed peak",
     "Fitted radiance at the observed peak, background removed, in the units of the image. None where the peak is unknown", 4, 0},
    {"incident", "Incident \u00b0", "incident angle at the brightest point (\u00b0)",
     "Angle between the normal and the view ray at the brightest point of the prediction; without a prediction, at the observed "
     "peak of "
     "a training frame. Models that do not look at the surface have no such angle",
     2, 0},
    {"limit", "Limit \u00b0", "limit angle of the prediction (\u00b0)",
     "Limit angle of the predicted contour: median over its directions, else that of the fit", 3, 0},
    {"observed-limit", "Obs. limit \u00b0", "limit angle of the observation (\u00b0)",
     "Limit angle of the observed contour under the estimated light: median over its directions. Training frames only", 3, 0},
    {"residual-px", "Residual px", "residual of the fit (px)",
     "What the fit leaves of this training contour, px. Training frames only: how it was explained, not how it is predicted", 3,
     1},
    {"band-px", "Band px", "standard deviation of the prediction (px)",
     "Standard deviation of the predicted contour, pixels, mean over its vertices (setting predict.band)", 3, 0},
    {"in-band", "In band", "share of the contour within its band",
     "Share of the predicted vertices that lie within 1.96 standard deviations of the observed contour; 0.95 is expected", 3, 0},
    {"time", "Time \u00b5s", "prediction time (\u00b5s)", "Prediction time, microseconds", 0, 1},
}};
static_assert(kColumns.back().id != nullptr, "a column for every RowValue");

double medianDegrees(const CanonicalContour& contour) {
  std::vector<double> angles;
  for (const DirectionResult& d : contour.directions)
    if (d.limitAngle && std::isfinite(*d.limitAngle)) angles.push_back(*d.limitAngle);
  return angles.empty() ? std::nan("") : degrees(upperMedian(std::move(angles)));
}

double incidentDegrees(const BrightestPoint& at, const Eigen::Vector3d& eye) {
  const double cosine = at.point.normal.dot((eye - at.point.position).normalized());
  return std::isfinite(cosine) && at.point.normal.norm() > 0.5 ? degrees(std::acos(std::clamp(cosine, -1.0, 1.0))) : std::nan("");
}

class Rows {
 public:
  explicit Rows(const Inspection& inspection) : in_(inspection) {
    for (std::size_t i = 0; i < in_.views.size(); ++i) views_[in_.views[i].frame].push_back(static_cast<int>(i));
  }

  void startModel(const ModelResult& result) {
    result_ = &result;
    model_ = findModel(result.model);
    residuals_.clear();
    for (const ModelResult::Fit& fit : result.fits)
      if (fit.fit) addResiduals(*fit.fit, fit.key());
  }
  void add(const FrameComparison& c, std::vector<HighlightRow>& rows) const;

 private:
  /// Adds residuals by the view's place in Inspection::views: ModelFit lists them in the order of the views it used.
  void addResiduals(const ModelFit& fit, const FitKey& key) {
    std::size_t next = 0;
    for (std::size_t i = 0; i < in_.views.size() && next < fit.frames.size() && next < fit.residualPx.size(); ++i) {
      const TrainingView& v = in_.views[i];
      if (in_.keyFor(v.frame, v.highlight.light) != key || fit.frames[next] != v.frame) continue;
      if (!v.seen && !(model_ && !model_->needsLight())) continue;
      residuals_[static_cast<int>(i)] = fit.residualPx[next++];
    }
  }
  /// The training view of an observed highlight, by its peak, which noise may have moved a little; -1 if it did not train.
  int viewOf(int frame, const Highlight& seen) const {
    const auto here = views_.find(frame);
    if (here == views_.end()) return -1;
    int nearest = -1;
    double reach = radiusPx(seen.contour);
    for (const int i : here->second) {
      const Highlight& h = in_.views[std::size_t(i)].highlight;
      const double distance = (h.peak - seen.peak).norm();
      if (h.light == seen.light && distance <= reach) nearest = i, reach = distance;
    }
    return nearest;
  }
  const ModelFit* fitOf(const FrameComparison& c) const {
    if (c.fit < 0 || c.fit >= static_cast<int>(result_->fits.size())) return nullptr;
    const Outcome<ModelFit>& fit = result_->fits[std::size_t(c.fit)].fit;
    return fit ? &*fit : nullptr;
  }
  RowStatus statusOf(const FrameComparison& c, const FrameComparison::Row& r) const;
  void measure(const FrameComparison& c, const FrameComparison::Row& r, HighlightRow& row) const;
  void measureObserved(const Highlight& seen, HighlightRow& row) const;
  void measurePredicted(const FrameComparison& c, const PredictedHighlight& h, HighlightRow& row) const;

  const Inspection& in_;
  const ModelResult* result_ = nullptr;
  const HighlightModel* model_ = nullptr;
  std::map<int, std::vector<int>> views_;  // by frame
  std::map<int, double> residuals_;        // by view
};

RowStatus Rows::statusOf(const FrameComparison& c, const FrameComparison::Row& r) const {
  if (r.metrics && !poorFit(*result_, c).empty()) return RowStatus::Poor;
  if (r.metrics) return r.metrics->contourErrorPct > kLargestExpectedPct ? RowStatus::FarOff : RowStatus::Ok;
  if (r.observed < 0 && r.predicted < 0 && !c.rows.empty()) return RowStatus::NotCompared;
  if (r.predicted >= 0 && r.observed < 0) return RowStatus::Spurious;
  if (!c.prediction.failure()) return RowStatus::Missed;
  const bool noFit = c.fit >= 0 && c.fit < static_cast<int>(result_->fits.size()) && result_->fits[std::size_t(c.fit)].failure();
  return noFit ? RowStatus::Refused : RowStatus::Failed;
}

void Rows::measureObserved(const Highlight& seen, HighlightRow& row) const {
  const auto set = [&row](RowValue which, double value) { row.values[std::size_t(which)] = value; };
  set(RowValue::ObservedPx, 2 * radiusPx(seen.contour));
  if (seen.peakValue > 0) set(RowValue::PeakRadiance, seen.peakValue);
  const int view = viewOf(row.frame, seen);
  if (view < 0) return;
  const TrainingView& v = in_.views[std::size_t(view)];
  if (v.canonical) set(RowValue::ObservedLimitDeg, medianDegrees(*v.canonical));
  if (v.seen && model_ && model_->traits().mirrored)
    set(RowValue::IncidentDeg, incidentDegrees(v.seen->brightest, v.camera.centreInWorld()));
  if (const auto residual = residuals_.find(view); residual != residuals_.end()) set(RowValue::ResidualPx, residual->second);
}

void Rows::measurePredicted(const FrameComparison& c, const PredictedHighlight& h, HighlightRow& row) const {
  const auto set = [&row](RowValue which, double value) { row.values[std::size_t(which)] = value; };
  set(RowValue::Coverage, h.coverage);
  set(RowValue::TimeUs, c.prediction.timeUs);
  set(RowValue::PredictedPx, 2 * radiusPx(h.contour));
  if (model_ && model_->traits().mirrored && in_.scene)
    set(RowValue::IncidentDeg, incidentDegrees(h.brightest, in_.cameraFor(row.frame, row.light).centreInWorld()));
  double limit = h.canonical ? medianDegrees(*h.canonical) : std::nan("");
  if (const ModelFit* const fit = fitOf(c); fit && std::isnan(limit))
    if (const std::optional<double> alpha = fit->limitAngle()) limit = degrees(*alpha);
  set(RowValue::LimitDeg, limit);
  if (!h.sigmaPx.empty())
    set(RowValue::BandPx, std::accumulate(h.sigmaPx.begin(), h.sigmaPx.end(), 0.0) / double(h.sigmaPx.size()));
}

void Rows::measure(const FrameComparison& c, const FrameComparison::Row& r, HighlightRow& row) const {
  const auto set = [&row](RowValue which, double value) { row.values[std::size_t(which)] = value; };
  const std::vector<Highlight>& scored = in_.evidence[std::size_t(c.frame)].scored();
  const Highlight* const seen =
      r.observed >= 0 && r.observed < static_cast<int>(scored.size()) ? &scored[std::size_t(r.observed)] : nullptr;
  const std::vector<PredictedHighlight>& found = c.prediction.highlights();
  const PredictedHighlight* const predicted =
      r.predicted >= 0 && r.predicted < static_cast<int>(found.size()) ? &found[std::size_t(r.predicted)] : nullptr;
  if (seen) measureObserved(*seen, row);
  if (predicted) measurePredicted(c, *predicted, row);
  if (r.band) set(RowValue::BandPx, r.band->sigmaPx), set(RowValue::InBand, r.band->coverage);
  if (seen && predicted && !seen->touchesBorder) {
    const double area = std::abs(signedArea(seen->contour));
    if (area > 0) set(RowValue::AreaRatio, std::abs(signedArea(predicted->contour)) / area);
  }
  if (!r.metrics) return;
  const ContourMetrics& m = *r.metrics;
  set(RowValue::ErrorPct, m.contourErrorPct);
  set(RowValue::ErrorPx, m.contourErrorPx);
  set(RowValue::EllipsePct, m.ellipseErrorPct);
  set(RowValue::HausdorffPx, m.hausdorffPx);
  set(RowValue::Iou, m.iou);
  set(RowValue::CentrePx, m.centreOffsetPx);
  set(RowValue::PeakPx, m.peakOffsetPx);
  set(RowValue::AxisRatio, m.axisRatioError);
  set(RowValue::AxisAngleDeg, m.angleErrorDeg);
}

void Rows::add(const FrameComparison& c, std::vector<HighlightRow>& rows) const {
  HighlightRow base;
  base.frame = c.frame;
  base.model = result_->model;
  base.light = base.place = c.light;
  base.role = in_.isTraining(c.frame) ? RowRole::Training : in_.isHeldOut(c.frame) ? RowRole::HeldOut : RowRole::Excluded;
  base.values.fill(std::numeric_limits<double>::quiet_NaN());
  base.values[std::size_t(RowValue::Frame)] = c.frame;
  const Failure* const failure = c.prediction.failure();
  if (c.rows.empty()) {
    if (!failure) return;
    base.status = statusOf(c, {});
    base.reason = failure->message();
    rows.push_back(std::move(base));
    return;
  }
  const auto several = [&](int FrameComparison::Row::*index) {
    return std::count_if(c.rows.begin(), c.rows.end(), [&](const FrameComparison::Row& r) { return r.*index >= 0; }) > 1;
  };
  const bool manyObserved = several(&FrameComparison::Row::observed), manyPredicted = several(&FrameComparison::Row::predicted);
  for (const FrameComparison::Row& r : c.rows) {
    HighlightRow row = base;
    row.observed = r.observed;
    row.predicted = r.predicted;
    // Numbered as everywhere, from 1.
    if (r.observed >= 0 && manyObserved)
      row.place += ", highlight " + std::to_string(r.observed + 1);
    else if (r.observed < 0 && manyPredicted)
      row.place += ", predicted " + std::to_string(r.predicted + 1);
    row.status = statusOf(c, r);
    if (r.failure)
      row.reason = r.failure->message();
    else if (failure)
      row.reason = failure->message();
    else if (r.metrics)
      row.reason = poorFit(*result_, c);
    else
      row.reason = r.observed < 0 ? "no observed highlight overlaps it" : "no prediction overlaps it";
    measure(c, r, row);
    for (double& v : row.values)
      if (!std::isfinite(v)) v = std::numeric_limits<double>::quiet_NaN();
    rows.push_back(std::move(row));
  }
}

}  // namespace

const char* nameOf(RowStatus status) {
  switch (status) {
    case RowStatus::Ok: return "ok";
    case RowStatus::FarOff: return "far off";
    case RowStatus::Poor: return "poor";
    case RowStatus::Missed: return "missed";
    case RowStatus::Spurious: return "spurious";
    case RowStatus::Failed: return "failed";
    case RowStatus::Refused: return "refused";
    case RowStatus::NotCompared: return "not compared";
  }
  return "";
}

const std::vector<RowStatus>& allRowStatuses() {
  static const std::vector<RowStatus> all{RowStatus::Ok,       RowStatus::FarOff, RowStatus::Poor,    RowStatus::Missed,
                                          RowStatus::Spurious, RowStatus::Failed, RowStatus::Refused, RowStatus::NotCompared};
  return all;
}

const char* nameOf(RowRole role) {
  return role == RowRole::Training ? "training" : role == RowRole::HeldOut ? "held out" : "excluded";
}

const std::array<RowColumn, kRowValues>& highlightColumns() { return kColumns; }

RowValue rowValueOf(const std::string& id) {
  const auto at = std::find_if(kColumns.begin(), kColumns.end(), [&](const RowColumn& c) { return id == c.id; });
  return RowValue(at - kColumns.begin());
}

std::vector<HighlightRow> highlightRows(const Inspection& inspection) {
  std::vector<std::vector<HighlightRow>> byFrame(inspection.evidence.size());
  Rows maker(inspection);
  for (const std::string& model : modelsInOrder(inspection)) {
    maker.startModel(inspection.models.at(model));
    for (const FrameComparison& c : inspection.models.at(model).frames)
      if (c.frame >= 0 && c.frame < static_cast<int>(byFrame.size())) maker.add(c, byFrame[std::size_t(c.frame)]);
  }
  std::vector<HighlightRow> rows;
  for (std::vector<HighlightRow>& frame : byFrame) std::move(frame.begin(), frame.end(), std::back_inserter(rows));
  return rows;
}

RowKey keyOf(const HighlightRow& row) {
  return {row.frame, row.observed, row.observed >= 0 ? -1 : row.predicted, row.model, row.light};
}

}  // namespace glint
