// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/lamp_table.h"

#include <QHeaderView>
#include <QSortFilterProxyModel>
#include <algorithm>
#include <cmath>

#include "core/base/numeric.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {

constexpr int kDigits = 5;        // of a place: a thousandth of a room is a millimetre
constexpr int kSigmaDigits = 2;   // of a standard deviation
constexpr int kMostColumn = 360;  // px: longer sentences are in their tool tips

QString triple(const Eigen::Vector3d& v, int digits) {
  return QStringLiteral("%1, %2, %3").arg(numberText(v.x(), digits), numberText(v.y(), digits), numberText(v.z(), digits));
}

RowsModel::Cell number(double value, int digits) { return {numberText(value, digits), value, {}, {}, true}; }

RowsModel::Cell positionOf(const LampAnswer& lamp, const QString& unit) {
  if (lamp.failure || !lamp.position) return {QString::fromUtf8("–")};
  QString text = triple(*lamp.position, kDigits);
  if (lamp.covariance) {
    const Eigen::Vector3d sigma = lamp.covariance->diagonal().cwiseMax(0).cwiseSqrt();
    text += QString::fromUtf8(" ± ") + triple(sigma, kSigmaDigits);
  }
  RowsModel::Cell cell{text + QLatin1Char(' ') + unit};
  cell.tip = cell.text + QObject::tr("\nOne standard deviation along x, y and z. The region in the 3D view is that of 95 %.");
  return cell;
}

RowsModel::Cell directionOf(const LampAnswer& lamp) {
  if (lamp.failure) return {QString::fromUtf8("–")};
  RowsModel::Cell cell{triple(lamp.direction, kDigits) +
                       QString::fromUtf8(" ± %1°").arg(numberText(degrees(lamp.directionSigma), kSigmaDigits))};
  cell.tip = cell.text + QObject::tr("\nRoot of the mean square of the angle between this direction and the true one.");
  if (lamp.from) cell.tip += QObject::tr("\nSeen from %1.").arg(triple(*lamp.from, kDigits));
  return cell;
}

RowsModel::Cell droppedOf(const LampAnswer& lamp) {
  RowsModel::Cell cell = number(double(lamp.dropped.size()), kDigits);
  if (lamp.dropped.empty()) return cell;
  QStringList names, lines;
  for (const DroppedSighting& d : lamp.dropped) {
    // Each photograph of balls has one lamp, whose id names it.
    const QString name = d.ball ? QObject::tr("ball %1").arg(*d.ball + 1) : nameText(d.frame);
    if (!names.contains(name)) names << name;
    lines << QStringLiteral("%1: %2").arg(name, toQString(d.reason));
  }
  cell.text += QStringLiteral(" (%1)").arg(names.join(QStringLiteral("; ")));
  cell.tip = lines.join('\n');
  return cell;
}

RowsModel::Row rowOf(const LampAnswer& lamp, int tag, const QString& unit) {
  RowsModel::Row row;
  row.tag = tag;
  const QString frames = lamp.frames.size() == 1 ? QObject::tr("frame %1").arg(nameText(lamp.frames.front()))
                                                 : QObject::tr("%1 frames").arg(lamp.frames.size());
  row.cells.push_back({nameText(lamp.id), {}, {}, nameText(lamp.id) + QStringLiteral(": ") + frames});
  const QString answer = lamp.failure    ? QObject::tr("no answer")
                         : lamp.position ? QObject::tr("position")
                                         : QObject::tr("direction only");
  row.cells.push_back({answer, {}, lamp.failure ? warningColour() : QColor(), {}});
  const QString where =
      !lamp.frame ? QObject::tr("camera") : QLatin1String(nameOf(*lamp.frame));  // of balls there is one camera alone
  row.cells.push_back({where, {}, {}, toQString(lamp.frameReason)});
  row.cells.push_back(positionOf(lamp, unit));
  row.cells.push_back(directionOf(lamp));
  if (lamp.failure) {
    row.cells.push_back({QString::fromUtf8("–"), -1.0});
    row.cells.push_back({QString::fromUtf8("–"), -1.0});
  } else {
    row.cells.push_back(number(lamp.residualPx, 3));
    row.cells.push_back(number(lamp.degreesOfFreedom, 4));
    row.cells.back().tip = QObject::tr("Behind the residual; 0: nothing is redundant, so that the residual says nothing");
  }
  row.cells.push_back(number(lamp.highlights, kDigits));
  row.cells.push_back(droppedOf(lamp));
  QStringList why;
  if (const std::string reason = reasonOf(lamp); !reason.empty()) why << toQString(reason);
  for (const std::string& remark : lamp.remarks) why << toQString(remark);
  row.cells.push_back({why.join(QStringLiteral("; ")), {}, {}, why.join('\n')});
  return row;
}

}  // namespace

LampTable::LampTable(QWidget* parent)
    : QTableView(parent),
      model_(new RowsModel({tr("lamp"), tr("answer"), tr("stands still in"), tr("position"), tr("direction"), tr("residual, px"),
                            tr("d.o.f."), tr("highlights"), tr("dropped"), tr("why no more")},
                           this)),
      proxy_(new QSortFilterProxyModel(this)) {
  setObjectName(QStringLiteral("lampTable"));
  setAccessibleName(tr("Measured lamps"));
  proxy_->setSourceModel(model_);
  proxy_->setSortRole(RowsModel::kSortRole);
  setModel(proxy_);
  setSortingEnabled(true);
  sortByColumn(-1, Qt::AscendingOrder);  // as they come
  setTabKeyNavigation(false);            // arrows go about in it, Tab leaves it
  setSelectionBehavior(QAbstractItemView::SelectRows);
  setSelectionMode(QAbstractItemView::SingleSelection);
  setAlternatingRowColors(true);
  setShowGrid(false);
  setWordWrap(false);
  verticalHeader()->hide();
  verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 5);
  horizontalHeader()->setHighlightSections(false);
  horizontalHeader()->setStretchLastSection(true);
  connect(selectionModel(), &QItemSelectionModel::currentRowChanged, this, [this] {
    if (!telling_) emit lampSelected(currentLamp());
  });
}

void LampTable::show(const LampsReport* report) {
  telling_ = true;
  std::vector<RowsModel::Row> rows;
  const QString unit = report ? report->lengthUnit == "ball radius" ? tr("radii") : toQString(report->lengthUnit) : QString();
  for (int i = 0; report && i < int(report->lamps.size()); ++i) rows.push_back(rowOf(report->lamps[std::size_t(i)], i, unit));
  model_->setRows(std::move(rows));
  resizeColumnsToContents();
  for (int c = 0; c < model_->columnCount(); ++c) setColumnWidth(c, std::min(columnWidth(c), kMostColumn));
  telling_ = false;
}

void LampTable::setCurrentLamp(int lamp) {
  telling_ = true;
  int row = 0;
  while (row < proxy_->rowCount() && proxy_->index(row, 0).data(RowsModel::kTagRole).toInt() != lamp) ++row;
  if (row < proxy_->rowCount()) {
    selectionModel()->setCurrentIndex(proxy_->index(row, 0), QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    scrollTo(proxy_->index(row, 0));
  } else {
    selectionModel()->clear();
  }
  telling_ = false;
}

int LampTable::currentLamp() const {
  const QModelIndex current = selectionModel()->currentIndex();
  return current.isValid() ? current.data(RowsModel::kTagRole).toInt() : -1;
}

}  // namespace glint::gui
