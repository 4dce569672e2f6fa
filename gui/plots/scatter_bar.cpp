// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/scatter_bar.h"

#include <QAction>
#include <QActionGroup>
#include <QComboBox>
#include <QHBoxLayout>
#include <QMenu>
#include <QToolButton>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr RowValue kX = RowValue::IncidentDeg, kY = RowValue::ErrorPct;
}

ScatterBar::ScatterBar(Document& document, const char* prefix, QWidget* parent)
    : QWidget(parent), document_(document), prefix_(prefix) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(4, 0, 4, 2);
  row->setSpacing(4);
  row->addWidget(y_ = column("y", tr("Vertical"), kY), 1);
  row->addWidget(x_ = column("x", tr("Horizontal"), kX), 1);
  auto* more = new QToolButton;
  more->setObjectName(QStringLiteral("scatterOptions"));
  more->setText(tr("Options"));
  more->setToolTip(tr("Logarithmic axes, and what the colours mean"));
  more->setAutoRaise(true);
  more->setPopupMode(QToolButton::InstantPopup);
  auto* menu = new QMenu(more);
  menu->setToolTipsVisible(true);
  logY_ = logarithm(menu, "log-y", tr("vertical axis"));
  logX_ = logarithm(menu, "log-x", tr("horizontal axis"));
  menu->addSeparator();
  auto* group = new QActionGroup(menu);
  for (const draw::ScatterColourKind& k : draw::scatterColours()) {
    QAction* const action = menu->addAction(tr("Colours by %1").arg(tr(k.title)));
    action->setCheckable(true);
    group->addAction(action);
    colours_ << action;
    connect(action, &QAction::triggered, this, [this, k, action] { document_.setOption(key("colour"), k.id, action->text()); });
  }
  more->setMenu(menu);
  row->addWidget(more);
  showOptions();
}

QComboBox* ScatterBar::column(const char* name, const QString& title, RowValue otherwise) {
  auto* box = new QComboBox;
  box->setObjectName(QStringLiteral("scatter-") + QLatin1String(name));
  box->setAccessibleName(tr("%1 axis").arg(title));
  box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  box->setMinimumContentsLength(6);
  for (const RowColumn& c : highlightColumns()) {
    box->addItem(tr(c.title), QString::fromLatin1(c.id));
    box->setItemData(box->count() - 1, tr(c.help), Qt::ToolTipRole);
  }
  connect(box, QOverload<int>::of(&QComboBox::activated), this, [this, box, name, title, otherwise](int at) {
    const std::string id = box->itemData(at).toString().toStdString();
    if (rowValueOf(id) != value(name, otherwise)) document_.setOption(key(name), id, tr("%1: %2").arg(title, box->itemText(at)));
  });
  return box;
}

QAction* ScatterBar::logarithm(QMenu* menu, const char* name, const QString& title) {
  QAction* const action = menu->addAction(tr("Logarithmic %1").arg(title));
  action->setToolTip(tr("What is not above 0 is counted and not shown"));
  action->setCheckable(true);
  connect(action, &QAction::triggered, this, [this, name, title](bool on) {
    document_.setOption(key(name), on ? "on" : "off", (on ? tr("Logarithmic %1") : tr("Linear %1")).arg(title));
  });
  return action;
}

RowValue ScatterBar::value(const char* name, RowValue otherwise) const {
  const RowValue found = rowValueOf(document_.option(key(name), std::string(columnOf(otherwise).id)));
  return found == RowValue::Count ? otherwise : found;
}

draw::ScatterOptions ScatterBar::options() const {
  draw::ScatterOptions o;
  o.x = value("x", kX);
  o.y = value("y", kY);
  const std::string colour = document_.option(key("colour"), std::string("model"));
  for (const draw::ScatterColourKind& k : draw::scatterColours())
    if (colour == k.id) o.colour = k.colour;
  o.logX = isLog("log-x");
  o.logY = isLog("log-y");
  o.brushed = document_.brushed();
  return o;
}

void ScatterBar::showOptions() {
  const draw::ScatterOptions o = options();
  for (const auto& [box, which] : {std::pair(x_, o.x), std::pair(y_, o.y)}) {
    box->setCurrentIndex(int(which));
    box->setToolTip(box->itemData(int(which), Qt::ToolTipRole).toString());
  }
  colours_[int(o.colour)]->setChecked(true);
  logX_->setChecked(o.logX);
  logY_->setChecked(o.logY);
}

}  // namespace glint::gui
