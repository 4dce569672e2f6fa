// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/numbers_panel.h"

#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QHeaderView>
#include <QKeyEvent>

#include "core/draw/frame_overlay.h"
#include "gui/base/number_delegate.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"
#include "gui/panels/selection_text.h"
#include "viz/scene_questions.h"

namespace glint::gui {

NumbersPanel::NumbersPanel(Document& document, QWidget* parent) : QTreeWidget(parent), document_(document) {
  setObjectName(QStringLiteral("numbers"));
  setColumnCount(2);
  setHeaderHidden(true);
  setRootIsDecorated(false);
  setIndentation(10);
  setAlternatingRowColors(true);
  setFrameShape(QFrame::NoFrame);
  setSelectionMode(QAbstractItemView::ExtendedSelection);
  header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  setItemDelegateForColumn(1, new NumberDelegate(this));
  setAccessibleName(tr("Numbers of what is selected"));
  connect(&document_, &Document::staleChanged, new StaleBadge(this), &StaleBadge::setStale);
  setContextMenuPolicy(Qt::ActionsContextMenu);
  auto* copyAction = new QAction(tr("Copy"), this);
  connect(copyAction, &QAction::triggered, this, &NumbersPanel::copy);
  addAction(copyAction);
  for (const auto signal : {&Document::sceneOpened, &Document::selectionChanged})
    connect(&document_, signal, this, [this] {
      picked_.reset();
      refresh();
    });
  connect(&document_, &Document::inspectionChanged, this, &NumbersPanel::refresh);
}

void NumbersPanel::showPicked(const viz::Picked& picked) {
  picked_ = picked;
  pickedIn_ = document_.inspection();
  refresh();
}

void NumbersPanel::addPicked() {
  const std::shared_ptr<const Inspection> now = document_.inspection();
  if (pickedIn_.lock() != now && now && picked_->layer == "cameras") {
    picked_->text = viz::cameraPicked(*now, modelsInOrder(*now), picked_->frame).text;
    pickedIn_ = now;
  }
  const bool earlier = pickedIn_.lock() != now;
  QTreeWidgetItem* group =
      addGroup((earlier ? tr("Picked (results out of date): %1") : tr("Picked: %1")).arg(toQString(picked_->layer)),
               toQString(picked_->text));
  for (int i = 0; earlier && i < group->childCount(); ++i)
    for (int column = 0; column < columnCount(); ++column)
      group->child(i)->setForeground(column, palette().brush(QPalette::Disabled, QPalette::Text));
}

void NumbersPanel::refresh() {
  clear();
  header()->setSectionResizeMode(0, QHeaderView::Interactive);  // else every line measures all others again
  if (picked_ && !picked_->text.empty()) addPicked();
  if (const std::shared_ptr<const Inspection> inspection = document_.inspection())
    for (const NumberGroup& group : describeSelection(*inspection, document_.selection(), document_.plottedModel()))
      addGroup(group.title, group.lines);
  header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
}

QTreeWidgetItem* NumbersPanel::addGroup(const QString& title, const QString& lines) {
  auto* group = new QTreeWidgetItem({title});
  QFont bold = font();
  bold.setBold(true);
  group->setFont(0, bold);
  QList<QTreeWidgetItem*> items;
  for (const QString& line : lines.split('\n')) {
    if (line.isEmpty()) continue;
    const int equals = int(line.indexOf(QStringLiteral(" = ")));
    items << new QTreeWidgetItem(equals < 0 ? QStringList{line} : QStringList{line.left(equals), line.mid(equals + 3)});
    items.last()->setToolTip(1, plainTip(line));
  }
  group->addChildren(items);
  addTopLevelItem(group);
  group->setFirstColumnSpanned(true);
  for (QTreeWidgetItem* item : items)
    if (item->text(1).isEmpty()) item->setFirstColumnSpanned(true);
  group->setExpanded(true);
  return group;
}

QString NumbersPanel::text() const {
  const bool all = selectedItems().isEmpty();
  QStringList lines;
  for (int g = 0; g < topLevelItemCount(); ++g) {
    const QTreeWidgetItem* group = topLevelItem(g);
    if (all || group->isSelected()) lines << group->text(0);
    for (int i = 0; i < group->childCount(); ++i) {
      const QTreeWidgetItem* item = group->child(i);
      if (all || group->isSelected() || item->isSelected())
        lines << (item->text(1).isEmpty() ? item->text(0) : item->text(0) + QStringLiteral(" = ") + item->text(1));
    }
  }
  return lines.join('\n') + '\n';
}

void NumbersPanel::copy() const { QApplication::clipboard()->setText(text()); }

void NumbersPanel::keyPressEvent(QKeyEvent* e) {
  if (e->matches(QKeySequence::Copy))
    copy();
  else
    QTreeWidget::keyPressEvent(e);
}

}  // namespace glint::gui
