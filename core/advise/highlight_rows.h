// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// What became of one highlight under one model.
enum class RowStatus {
  Ok,           ///< matched, off by at most kLargestExpectedPct
  FarOff,       ///< matched, off by more
  Poor,         ///< matched, by a fit that is poor, however far off: as files and reports say it
  Missed,       ///< observed, and no prediction overlaps it
  Spurious,     ///< predicted, and no observed highlight overlaps it
  Failed,       ///< the prediction of this frame failed
  Refused,      ///< the model has no fit, so that nothing was predicted
  NotCompared,  ///< the frame cannot be read
};
const char* nameOf(RowStatus status);  ///< "ok", "far off", "poor", "missed", "spurious", "failed", "refused", "not compared"
const std::vector<RowStatus>& allRowStatuses();

enum class RowRole { Training, HeldOut, Excluded };
const char* nameOf(RowRole role);  ///< "training", "held out", "excluded"

/// The numbers of a row; places in HighlightRow::values and highlightColumns().
enum class RowValue : std::size_t {
  Frame,
  ErrorPct,
  ErrorPx,
  EllipsePct,
  HausdorffPx,
  Iou,
  Coverage,
  CentrePx,
  PeakPx,
  AreaRatio,
  AxisRatio,
  AxisAngleDeg,
  ObservedPx,
  PredictedPx,
  PeakRadiance,
  IncidentDeg,
  LimitDeg,
  ObservedLimitDeg,
  ResidualPx,
  BandPx,
  InBand,
  TimeUs,
  Count
};
inline constexpr std::size_t kRowValues = std::size_t(RowValue::Count);

/// What a number of a row is.
struct RowColumn {
  const char* id;     ///< "error-pct": stays the same between versions
  const char* title;  ///< a heading, with its unit: "Error %"
  const char* axis;   ///< a title of an axis, the unit in brackets: "contour error (%)"
  const char* help;   ///< one or two sentences
  int decimals;
  int weight;  ///< +1 = the smaller the better, -1 = the larger the better, 0 = neither
};
const std::array<RowColumn, kRowValues>& highlightColumns();  ///< in the order of RowValue
inline const RowColumn& columnOf(RowValue value) { return highlightColumns()[std::size_t(value)]; }
/// RowValue::Count when no column has this id.
RowValue rowValueOf(const std::string& id);

/// One row of an evaluation: a matched, missed or spurious highlight under one model, or a failed prediction of nothing observed.
struct HighlightRow {
  int frame = -1, observed = -1, predicted = -1;  ///< as in FrameComparison::Row
  std::string model, light;                       ///< ids
  std::string place;                              ///< the light, and which of several: "lamp, highlight 2", "lamp, predicted 1"
  RowRole role = RowRole::HeldOut;
  RowStatus status = RowStatus::NotCompared;
  std::string reason;                     ///< why there is no error; "" if there is one
  std::array<double, kRowValues> values;  ///< finite, or NaN without a value
  double value(RowValue which) const { return values[std::size_t(which)]; }
};

/// Every row of every model, by frame, then by model from simple to rich. Reads the evaluation only, no surface or image.
std::vector<HighlightRow> highlightRows(const Inspection& inspection);

/// What names a row within an inspection, also after it was computed again.
struct RowKey {
  int frame = -1, observed = -1, predicted = -1;  ///< `predicted` is -1 if something was observed
  std::string model, light;
  friend auto operator<=>(const RowKey&, const RowKey&) = default;
};
RowKey keyOf(const HighlightRow& row);

}  // namespace glint
