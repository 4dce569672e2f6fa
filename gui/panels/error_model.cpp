// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/error_model.h"

#include <QGuiApplication>
#include <QPalette>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/advise/row_changes.h"
#include "core/draw/frame_overlay.h"
#include "core/pipeline/summary.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/document/frame_roles.h"

namespace glint::gui {

namespace {
struct ColumnInfo {
  const char* id;
  const char* title;
  const char* tip;
};
const ColumnInfo kTexts[] = {
    {"frame", QT_TRANSLATE_NOOP("ErrorModel", "Frame"), QT_TRANSLATE_NOOP("ErrorModel", "Frame id")},
    {"role", QT_TRANSLATE_NOOP("ErrorModel", "Role"),
     QT_TRANSLATE_NOOP("ErrorModel", "Training, held out or excluded; summaries count held-out frames")},
    {"model", QT_TRANSLATE_NOOP("ErrorModel", "Model"), QT_TRANSLATE_NOOP("ErrorModel", "Predicting model")},
    {"light", QT_TRANSLATE_NOOP("ErrorModel", "Light"),
     QT_TRANSLATE_NOOP("ErrorModel", "Light id; with several highlights of one light, which highlight")},
    {"status", QT_TRANSLATE_NOOP("ErrorModel", "Status"),
     QT_TRANSLATE_NOOP("ErrorModel",
                       "ok; far off: by more than 5 %; poor: the model explains its training views badly; missed: observed, not "
                       "predicted; spurious: predicted, not observed; "
                       "failed: no prediction in this frame; refused: the model has no fit")}};
const ColumnInfo kLast[] = {
    {"pinned", QT_TRANSLATE_NOOP("ErrorModel", "Pinned %"),
     QT_TRANSLATE_NOOP("ErrorModel", "Error % in the pinned results, or its status there")},
    {"difference", QT_TRANSLATE_NOOP("ErrorModel", "Change"),
     QT_TRANSLATE_NOOP("ErrorModel", "Error now minus pinned error, in percentage points")},
    {"reason", QT_TRANSLATE_NOOP("ErrorModel", "Reason"), QT_TRANSLATE_NOOP("ErrorModel", "Reason for a missing value")}};
static_assert(std::size(kTexts) == ErrorModel::ErrorPct);
static_assert(std::size(kLast) == ErrorModel::ColumnCount - ErrorModel::Pinned);

constexpr double kManyDigits = 1000;  // from here on decimals say nothing

bool isNumber(int column) { return column >= ErrorModel::ErrorPct && column <= ErrorModel::LastNumber; }
RowValue valueOf(int column) { return RowValue(column - ErrorModel::ErrorPct + 1); }
bool hasError(const HighlightRow& row) { return std::isfinite(row.value(RowValue::ErrorPct)); }
FrameRole frameRole(RowRole role) {
  return role == RowRole::Training ? FrameRole::Training : role == RowRole::HeldOut ? FrameRole::HeldOut : FrameRole::Excluded;
}
QString fixed(double value, int decimals) {
  if (!std::isfinite(value)) return QStringLiteral("–");
  return QString::number(value, 'f', std::abs(value) < kManyDigits ? decimals : 0);
}
}  // namespace

ErrorModel::ErrorModel(Document& document, QObject* parent) : QAbstractTableModel(parent), document_(document) {
  rows_ = pinnedRows_ = std::make_shared<const std::vector<HighlightRow>>();
  connect(&document_, &Document::inspectionChanged, this, &ErrorModel::rebuild);
  connect(&document_, &Document::sceneOpened, this, &ErrorModel::rebuild);
  connect(&document_, &Document::pinnedChanged, this, &ErrorModel::rebuild);
  rebuild();
}

int ErrorModel::rowCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(rows_->size()); }
int ErrorModel::columnCount(const QModelIndex& parent) const { return parent.isValid() ? 0 : int(ColumnCount); }

void ErrorModel::rebuild() {
  beginResetModel();
  rows_ = document_.rows();
  texts_.assign(rows_->size(), QString());
  counterparts_.clear();
  poor_.clear();
  const std::shared_ptr<const Inspection> now = document_.inspection(), pinned = document_.pinned();
  if (now)
    for (const auto& [name, result] : now->models)
      if (const std::string why = reasonsOf(result).poor; !why.empty()) poor_[name] = toQString(why);
  if (now && pinned && now != pinned) {
    pinnedRows_ = document_.pinnedRows();
    counterparts_ = counterparts(*pinned, *pinnedRows_, *now, *rows_);
  }
  endResetModel();
}

void ErrorModel::setEarlier(bool earlier) {
  if (std::exchange(earlier_, earlier) == earlier || rows_->empty()) return;
  emit dataChanged(index(0, 0), index(rowCount() - 1, ColumnCount - 1), {Qt::ForegroundRole});
}

const HighlightRow* ErrorModel::pinnedOf(int row) const {
  if (counterparts_.empty() || counterparts_[std::size_t(row)] < 0) return nullptr;
  return &(*pinnedRows_)[std::size_t(counterparts_[std::size_t(row)])];
}

QStringList ErrorModel::models() const {
  QStringList all;
  for (const HighlightRow& row : *rows_)
    if (const QString model = toQString(row.model); !all.contains(model)) all << model;
  return all;
}

const QString& ErrorModel::textOf(int row) const {
  QString& text = texts_[std::size_t(row)];
  if (text.isNull()) {
    QStringList cells;
    for (int column = 0; column < ColumnCount; ++column)
      if (const QString words = cell(row, column); !words.isEmpty()) cells << words;
    text = cells.join(QLatin1Char('\n')).toLower();  // no text of two cells is found
  }
  return text;
}

QString ErrorModel::differenceText(int row) const {
  const HighlightRow* const before = pinnedOf(row);
  const HighlightRow& now = at(row);
  if (!before) return counterparts_.empty() ? QString() : tr("new");
  if (!hasError(now) || !hasError(*before)) {
    if (hasError(now)) return tr("gained");
    if (hasError(*before)) return tr("lost");
    return QStringLiteral("–");
  }
  const double a = before->value(RowValue::ErrorPct), b = now.value(RowValue::ErrorPct);
  if (sameError(a, b)) return tr("= same");
  // Sign, arrow and word say the same, so that no colour is needed.
  return (b < a ? tr("▼ %1 better") : tr("▲ +%1 worse")).arg(QString::number(b - a, 'f', std::abs(b - a) < kManyDigits ? 3 : 0));
}

QString ErrorModel::cell(int row, int column) const {
  const HighlightRow& r = at(row);
  switch (column) {
    case Frame: return nameText(document_.scene()->frames[std::size_t(r.frame)].id);
    case Role: return roleName(frameRole(r.role));
    case Model: return toQString(r.model);
    case Light: return nameText(r.place);
    case Status: return tr(nameOf(r.status));
    case ReasonText:
      return r.reason.empty() && poor_.count(r.model) ? tr("poor fit: %1").arg(poor_.at(r.model)) : toQString(r.reason);
    case Difference: return differenceText(row);
    case Pinned: {
      const HighlightRow* const before = pinnedOf(row);
      if (!before) return QString();
      return hasError(*before) ? fixed(before->value(RowValue::ErrorPct), 3) : tr(nameOf(before->status));
    }
    default: return fixed(r.value(valueOf(column)), columnOf(valueOf(column)).decimals);
  }
}

QVariant ErrorModel::sorted(int row, int column) const {
  // Rows without a number come last in ascending order.
  const auto number = [](double v) { return std::isfinite(v) ? v : std::numeric_limits<double>::max(); };
  const HighlightRow* const before = pinnedOf(row);
  if (column == Frame) return at(row).frame;
  if (column == Pinned) return number(before ? before->value(RowValue::ErrorPct) : NAN);
  if (column == Difference) return number(before ? at(row).value(RowValue::ErrorPct) - before->value(RowValue::ErrorPct) : NAN);
  return isNumber(column) ? QVariant(number(at(row).value(valueOf(column)))) : QVariant(cell(row, column));
}

QVariant ErrorModel::colour(int row, int column) const {
  const HighlightRow& r = at(row);
  if (r.role == RowRole::Excluded || earlier_)  // shown, but nothing of it counts
    return QGuiApplication::palette().brush(QPalette::Disabled, QPalette::Text);
  if (column == Difference) {
    const HighlightRow* const before = pinnedOf(row);
    const bool worse = before && hasError(*before) && !(r.value(RowValue::ErrorPct) <= before->value(RowValue::ErrorPct));
    return worse && !(hasError(r) && sameError(r.value(RowValue::ErrorPct), before->value(RowValue::ErrorPct)))
               ? QVariant(warningColour())
               : QVariant();
  }
  if (!hasError(r) && (column == Status || column == ReasonText)) return warningColour();
  return {};
}

QVariant ErrorModel::tip(int row, int column) const {
  if (at(row).role == RowRole::Excluded && column != ReasonText && column != Light)
    return tr("Excluded frame: used neither for training nor in any summary");
  if (const auto poor = poor_.find(at(row).model); column == Model && poor != poor_.end())
    return plainTip(tr("%1, poor fit: %2").arg(toQString(poor->first), poor->second));
  if (column == ReasonText || column == Light) return plainTip(cell(row, column));
  if (column == Difference && differenceText(row) == tr("new")) return tr("Nothing pinned is about this highlight");
  return {};
}

draw::Selection ErrorModel::selectionOf(int index) const {
  const HighlightRow& row = at(index);
  draw::Selection s{row.frame, row.model, row.observed};
  s.predicted = row.observed < 0 ? row.predicted : -1;
  if (!hasError(row)) s.light = row.light;
  return s;
}

QVariant ErrorModel::data(const QModelIndex& index, int role) const {
  if (!index.isValid()) return {};
  const HighlightRow& row = at(index.row());
  const int column = index.column();
  switch (role) {
    case Qt::DisplayRole: return cell(index.row(), column);
    case kSortRole: return sorted(index.row(), column);
    case Qt::DecorationRole:
      if (column == Model) return colourSwatch(toQColor(draw::modelColour(row.model, poor_.count(row.model) > 0)));
      return {};
    case Qt::ForegroundRole: return colour(index.row(), column);
    case Qt::ToolTipRole: return tip(index.row(), column);
    case Qt::TextAlignmentRole:
      return int((isNumber(column) || column == Pinned ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
    case kProblemRole: return !hasError(row) && row.role != RowRole::Excluded;
    case kFrameRoleRole: return int(frameRole(row.role));
    default: return {};
  }
}

QString ErrorModel::idOf(int column) {
  if (column < ErrorPct) return QLatin1String(kTexts[column].id);
  return QLatin1String(column <= LastNumber ? columnOf(valueOf(column)).id : kLast[column - Pinned].id);
}

QVariant ErrorModel::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || section < 0 || section >= ColumnCount) return {};
  if (role == Qt::TextAlignmentRole)
    return int((isNumber(section) || section == Pinned ? Qt::AlignRight : Qt::AlignLeft) | Qt::AlignVCenter);
  if (role != Qt::DisplayRole && role != Qt::ToolTipRole) return {};
  const bool title = role == Qt::DisplayRole;
  if (isNumber(section)) return tr(title ? columnOf(valueOf(section)).title : columnOf(valueOf(section)).help);
  const ColumnInfo& info = section < ErrorPct ? kTexts[section] : kLast[section - Pinned];
  return tr(title ? info.title : info.tip);
}

}  // namespace glint::gui
