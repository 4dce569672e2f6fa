// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/ball_results.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QTableView>

#include "core/draw/lamp_drawings.h"
#include "gui/base/rows_model.h"
#include "gui/base/text.h"
#include "gui/lamps/lamp_table.h"
#include "gui/lamps/lamps_panel.h"
#include "gui/plots/plot_canvas.h"

namespace glint::gui {

namespace {

RowsModel::Cell cell(double value, int digits = 4) { return {numberText(value, digits), value, {}, {}, true}; }

RowsModel::Row ballRow(const FittedBall& ball, int k) {
  RowsModel::Row row;
  row.tag = k;
  row.cells.push_back({QObject::tr("ball %1").arg(k + 1)});
  row.cells.push_back(cell(ball.edgeResidualPx, 3));
  row.cells.push_back(cell(ball.edgeDegreesOfFreedom));
  row.cells.push_back(cell(ball.highlightResidualPx, 3));
  row.cells.push_back(cell(ball.highlightDegreesOfFreedom, 3));
  row.cells.push_back(cell(ball.highlights));
  row.cells.push_back(cell(ball.shiftPx.norm(), 3));
  row.cells.push_back(cell(ball.sigmaPx.norm(), 3));
  row.cells[1].tip =
      QObject::tr("Root mean square of the edge's points along the outline's normal, px; 0 with no degree of freedom: as drawn");
  row.cells[3].tip = QObject::tr("Root mean square of the highlights on this ball: seen less predicted");
  row.cells[4].tip = QObject::tr("What the fit leaves free of their coordinates; 0: the residual says nothing");
  row.cells[6].tip = QObject::tr("By how much the highlights moved the outline (centre and radius together)");
  return row;
}

}  // namespace

BallResults::BallResults(QWidget* parent)
    : QTabWidget(parent),
      lamps_(new LampsPanel),
      balls_(new QTableView),
      ballRows_(new RowsModel({tr("ball"), tr("edges, px"), tr("edges, d.o.f."), tr("highlights, px"), tr("highlights, d.o.f."),
                               tr("highlights"), tr("moved, px"), tr("sigma, px")},
                              this)),
      residuals_(new PlotCanvas),
      shares_(new PlotCanvas) {
  setAccessibleName(tr("What was measured"));
  balls_->setObjectName(QStringLiteral("ballTable"));
  balls_->setAccessibleName(tr("Residuals of each ball"));
  balls_->setModel(ballRows_);
  balls_->setTabKeyNavigation(false);
  balls_->setSelectionBehavior(QAbstractItemView::SelectRows);
  balls_->setShowGrid(false);
  balls_->verticalHeader()->hide();
  balls_->horizontalHeader()->setHighlightSections(false);
  residuals_->setObjectName(QStringLiteral("ballResidualPlot"));
  residuals_->setAccessibleName(tr("Residual of every highlight, by photograph and ball"));
  shares_->setObjectName(QStringLiteral("outlineSharePlot"));
  shares_->setAccessibleName(tr("What each photograph says of the outlines"));
  auto* plots = new QWidget;
  auto* row = new QHBoxLayout(plots);
  row->setContentsMargins(0, 0, 0, 0);
  row->addWidget(residuals_, 1);
  row->addWidget(shares_, 1);
  addTab(lamps_, tr("Lamps"));
  addTab(balls_, tr("Balls"));
  addTab(plots, tr("What each photograph contributes"));
  connect(lamps_->table(), &LampTable::lampSelected, this, &BallResults::lampSelected);
  for (PlotCanvas* plot : {residuals_, shares_})
    connect(plot, &PlotCanvas::clicked, this, [this](const draw::PlotTarget& target) { emit lampSelected(target.frame); });
}

void BallResults::show(const LampsReport* report, const QString& why) {
  lamps_->show(report, why);
  const bool known = report && report->balls;
  std::vector<RowsModel::Row> rows;
  for (std::size_t k = 0; known && k < report->balls->balls.size(); ++k) rows.push_back(ballRow(report->balls->balls[k], int(k)));
  ballRows_->setRows(std::move(rows));
  balls_->resizeColumnsToContents();
  residuals_->show(
      draw::ballResidualPlot(known ? report->lamps : std::vector<LampAnswer>(), known ? report->balls->balls.size() : 0));
  shares_->show(draw::outlineSharePlot(known ? report->lamps : std::vector<LampAnswer>()));
}

void BallResults::select(int lamp) {
  lamps_->table()->setCurrentLamp(lamp);
  draw::Selection selection;
  selection.frame = lamp;
  for (PlotCanvas* plot : {residuals_, shares_}) plot->setSelection(selection);
}

}  // namespace glint::gui
