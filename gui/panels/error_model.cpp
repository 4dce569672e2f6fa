// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/error_model.h"

#include <QGuiApplication>
#include <QPalette>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/draw/frame_overlay.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/document/frame_roles.h"

namespace glint::gui {

namespace {
struct ColumnInfo {
  const char* title;
  const char* tip;
};
const ColumnInfo kColumns[] = {
    {QT_TRANSLATE_NOOP("ErrorModel", "Frame"), QT_TRANSLATE_NOOP("ErrorModel", "Frame id")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Role"),
     QT_TRANSLATE_NOOP("ErrorModel", "Training, held out or excluded; summaries count held-out frames")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Model"), QT_TRANSLATE_NOOP("ErrorModel", "Predicting model")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Light"),
     QT_TRANSLATE_NOOP("ErrorModel", "Light id; with several highlights of one light, which highlight")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Status"),
     QT_TRANSLATE_NOOP("ErrorModel",
                       "ok; missed: observed, not predicted; spurious: predicted, not observed; failed: no prediction")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Error %"),
     QT_TRANSLATE_NOOP("ErrorModel", "Mean contour distance (symmetric) in % of the observed region's equivalent diameter")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Error px"),
     QT_TRANSLATE_NOOP("ErrorModel",
                       "Mean contour distance, px: symmetric, over the length of both contours, without sign. "
                       "(The residual dial shows the signed distance by direction.)")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Ellipse %"),
     QT_TRANSLATE_NOOP("ErrorModel", "As Error %, between the fitted and the predicted ellipse")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Hausd. px"), QT_TRANSLATE_NOOP("ErrorModel", "Hausdorff distance, pixels")},
    {QT_TRANSLATE_NOOP("ErrorModel", "IoU"), QT_TRANSLATE_NOOP("ErrorModel", "Intersection over union of the filled contours")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Coverage"),
     QT_TRANSLATE_NOOP("ErrorModel", "Share of directions that gave a contour point")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Centre px"), QT_TRANSLATE_NOOP("ErrorModel", "Distance of the area centroids, pixels")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Peak px"), QT_TRANSLATE_NOOP("ErrorModel", "Distance of the peaks, pixels")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Time µs"), QT_TRANSLATE_NOOP("ErrorModel", "Prediction time, microseconds")},
    {QT_TRANSLATE_NOOP("ErrorModel", "Reason"), QT_TRANSLATE_NOOP("ErrorModel", "Reason for a missing value")}};
static_assert(std::size(kColumns) == ErrorModel::ColumnCount);

constexpr double kManyDigits = 1000;  // from here on decimals say nothing

int digitsOf(int column) { return column == ErrorModel::Time ? 0 : column == ErrorModel::Iou ? 4 : 3; }
bool isNumber(int column) { return column >= ErrorModel::ErrorPct && column <= ErrorModel::Time; }
}  // namespace

ErrorModel::ErrorModel(Document& document, QObject* parent) : QAbstractTableModel(parent), document_(document) {
  connect(&document_, &Document::inspectionChanged, this, &ErrorModel::rebuild);
  connect(&document_, &Document::sceneOpened, this, &ErrorModel::rebuild);
}

int ErrorModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(rows_.size()); }
int ErrorModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(ColumnCount); }

void ErrorModel::rebuild() {
  beginResetModel();
  rows_.clear();
  if (const std::shared_ptr<const Inspection> inspection = document_.inspection()) {
    const std::vector<std::string> models = modelsInOrder(*inspection);
    for (int frame = 0; frame < int(inspection->evidence.size()); ++frame)
      for (const std::string& model : models)
        for (const FrameComparison& c : inspection->models.at(model).frames)
          if (c.frame == frame) addComparison(*inspection, model, c);
  }
  endResetModel();
}

void ErrorModel::addComparison(const Inspection& inspection, const std::string& model, const FrameComparison& c) {
  Row base;
  base.frame = c.frame;
  base.role = document_.role(c.frame);
  base.model = model;
  base.frameId = nameText(inspection.scene->frames[std::size_t(c.frame)].id);
  base.light = nameText(c.light);
  base.lightId = c.light;
  std::fill(std::begin(base.values), std::end(base.values), std::numeric_limits<double>::quiet_NaN());
  base.values[Frame] = c.frame;
  if (c.rows.empty()) {
    if (!c.prediction.failure()) return;
    base.status = tr("failed");
    base.reason = toQString(c.prediction.failure()->message());
    base.problem = true;
    rows_.push_back(base);
    return;
  }
  const auto several = [&](int FrameComparison::Row::*index) {
    return std::count_if(c.rows.begin(), c.rows.end(), [&](const FrameComparison::Row& r) { return r.*index >= 0; }) > 1;
  };
  const bool manyObserved = several(&FrameComparison::Row::observed), manyPredicted = several(&FrameComparison::Row::predicted);
  for (const FrameComparison::Row& r : c.rows) {
    Row row = base;
    row.highlight = r.observed;
    row.predicted = r.observed < 0 ? r.predicted : -1;
    // Numbered as everywhere, from 1.
    if (r.observed >= 0 && manyObserved)
      row.light = tr("%1, highlight %2").arg(base.light).arg(r.observed + 1);
    else if (r.observed < 0 && manyPredicted)
      row.light = tr("%1, predicted %2").arg(base.light).arg(r.predicted + 1);
    const bool compared = r.observed >= 0 || r.predicted >= 0;  // else the frame cannot be read
    row.status = r.metrics                ? tr("ok")
                 : !compared              ? tr("not compared")
                 : r.observed < 0         ? tr("spurious")
                 : c.prediction.failure() ? tr("failed")
                                          : tr("missed");
    row.problem = !r.metrics;
    if (r.failure)
      row.reason = toQString(r.failure->message());
    else if (c.prediction.failure())
      row.reason = toQString(c.prediction.failure()->message());
    else if (!r.metrics)
      row.reason = r.observed < 0 ? tr("no observed highlight overlaps it") : tr("no prediction overlaps it");
    if (r.metrics) {
      row.values[ErrorPct] = r.metrics->contourErrorPct;
      row.values[ErrorPx] = r.metrics->contourErrorPx;
      row.values[EllipsePct] = r.metrics->ellipseErrorPct;
      row.values[Hausdorff] = r.metrics->hausdorffPx;
      row.values[Iou] = r.metrics->iou;
      row.values[CentreOffset] = r.metrics->centreOffsetPx;
      row.values[PeakOffset] = r.metrics->peakOffsetPx;
    }
    if (r.predicted >= 0 && r.predicted < int(c.prediction.highlights().size())) {
      row.values[Coverage] = c.prediction.highlights()[std::size_t(r.predicted)].coverage;
      row.values[Time] = c.prediction.timeUs;
    }
    rows_.push_back(row);
  }
}

draw::Selection ErrorModel::selectionOf(int index) const {
  const Row& row = rows_[std::size_t(index)];
  draw::Selection s{row.frame, row.model, row.highlight};
  s.predicted = row.predicted;
  if (row.predicted >= 0 || row.problem) s.light = row.lightId;
  return s;
}

QVariant ErrorModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const Row& row = rows_[std::size_t(index.row())];
  const int column = index.column();
  const double number = row.values[column];
  switch (role) {
    case Qt::DisplayRole:
    case kSortRole:
      switch (column) {
        case Frame: return role == kSortRole ? QVariant(row.frame) : QVariant(row.frameId);
        case Role: return roleName(row.role);
        case Model: return toQString(row.model);
        case Light: return row.light;
        case Status: return row.status;
        case ReasonText: return row.reason;
        default: break;
      }
      // Rows without a number come last in ascending order.
      if (role == kSortRole) return std::isfinite(number) ? number : std::numeric_limits<double>::max();
      if (!std::isfinite(number)) return QStringLiteral("–");
      return QString::number(number, 'f', std::abs(number) < kManyDigits ? digitsOf(column) : 0);
    case Qt::DecorationRole:
      if (column == Model) return colourSwatch(toQColor(draw::modelColour(row.model)));
      return {};
    case Qt::ForegroundRole:
      if (row.role == FrameRole::Excluded)  // shown, but nothing of it counts
        return QGuiApplication::palette().brush(QPalette::Disabled, QPalette::Text);
      if (row.problem && (column == Status || column == ReasonText)) return warningColour();
      return {};
    case Qt::ToolTipRole:
      if (row.role == FrameRole::Excluded && column != ReasonText && column != Light)
        return tr("Excluded frame: used neither for training nor in any summary");
      return column == ReasonText ? QVariant(plainTip(row.reason)) : column == Light ? QVariant(plainTip(row.light)) : QVariant();
    case Qt::TextAlignmentRole: return int((isNumber(column) ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
    case kProblemRole: return row.problem && row.role != FrameRole::Excluded;
    case kFrameRoleRole: return int(row.role);
    default: return {};
  }
}

QVariant ErrorModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || section < 0 || section >= ColumnCount) return {};
  if (role == Qt::DisplayRole) return tr(kColumns[section].title);
  if (role == Qt::ToolTipRole) return tr(kColumns[section].tip);
  if (role == Qt::TextAlignmentRole) return int((isNumber(section) ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
  return {};
}

}  // namespace glint::gui
