// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/error_columns.h"

#include <QAction>
#include <QHeaderView>
#include <QMenu>
#include <QSettings>
#include <QTableView>

#include "gui/panels/error_model.h"

namespace glint::gui {

namespace {
const char* const kHiddenKey = "errors/hidden-columns";

/// What few ask for; everything else is shown.
QStringList hiddenAtFirst() {
  QStringList ids;
  for (const RowValue v : {RowValue::AxisRatio, RowValue::AxisAngleDeg, RowValue::ObservedPx, RowValue::PredictedPx,
                           RowValue::PeakRadiance, RowValue::ObservedLimitDeg, RowValue::InBand})
    ids << QLatin1String(columnOf(v).id);
  return ids;
}

bool isOfPinned(int column) { return column == ErrorModel::Pinned || column == ErrorModel::Difference; }
}  // namespace

ErrorColumns::ErrorColumns(QTableView* view) : QObject(view), view_(view), menu_(new QMenu(view)) {
  menu_->setObjectName(QStringLiteral("errorColumns"));
  menu_->setToolTipsVisible(true);
  const QVariant kept = QSettings().value(QLatin1String(kHiddenKey));
  hidden_ = kept.isValid() ? kept.toStringList() : hiddenAtFirst();
  connect(menu_, &QMenu::aboutToShow, this, &ErrorColumns::fill);
  QHeaderView* const head = view_->horizontalHeader();
  head->setContextMenuPolicy(Qt::CustomContextMenu);
  connect(head, &QWidget::customContextMenuRequested, this,
          [this, head](const QPoint& at) { menu_->popup(head->mapToGlobal(at)); });
  fill();
  apply();
}

bool ErrorColumns::shown(int column) const {
  return column == ErrorModel::Frame || (isOfPinned(column) ? pinned_ : !hidden_.contains(ErrorModel::idOf(column)));
}

void ErrorColumns::setShown(int column, bool shown) {
  hidden_.removeAll(ErrorModel::idOf(column));
  if (!shown) hidden_ << ErrorModel::idOf(column);
  keep();
  apply();
}

void ErrorColumns::setPinned(bool pinned) {
  if (pinned == pinned_) return;
  pinned_ = pinned;
  apply();
}

void ErrorColumns::fill() {
  menu_->clear();
  const QAbstractItemModel* const model = view_->model();
  for (int column = 1; column < model->columnCount(); ++column) {  // frames have names in any case
    if (isOfPinned(column)) continue;
    QAction* const action = menu_->addAction(model->headerData(column, Qt::Horizontal).toString());
    action->setToolTip(model->headerData(column, Qt::Horizontal, Qt::ToolTipRole).toString());
    action->setCheckable(true);
    action->setChecked(shown(column));
    connect(action, &QAction::toggled, this, [this, column](bool on) { setShown(column, on); });
  }
  menu_->addSeparator();
  const auto set = [this](const QStringList& hidden) {
    hidden_ = hidden;
    keep();
    apply();
  };
  connect(menu_->addAction(tr("Show all columns")), &QAction::triggered, this, [set] { set({}); });
  connect(menu_->addAction(tr("Usual columns")), &QAction::triggered, this, [set] { set(hiddenAtFirst()); });
}

void ErrorColumns::apply() {
  for (int column = 0; column < view_->model()->columnCount(); ++column) view_->setColumnHidden(column, !shown(column));
}

void ErrorColumns::keep() const { QSettings().setValue(QLatin1String(kHiddenKey), hidden_); }

}  // namespace glint::gui
