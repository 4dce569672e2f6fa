// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/scatter_bar.h"

#include <QComboBox>
#include <QLabel>
#include <QToolButton>

#include "gui/base/flow_layout.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr RowValue kX = RowValue::IncidentDeg, kY = RowValue::ErrorPct;
}

ScatterBar::ScatterBar(Document& document, const char* prefix, QWidget* parent)
    : QWidget(parent), document_(document), prefix_(prefix) {
  auto* row = new FlowLayout(6);
  setLayout(row);
  row->setContentsMargins(4, 0, 4, 2);
  row->addWidget(y_ = column("y", tr("Vertical"), kY));
  row->addWidget(logY_ = logarithm("log-y", tr("vertical axis")));
  row->addWidget(new QLabel(tr("against")));
  row->addWidget(x_ = column("x", tr("Horizontal"), kX));
  row->addWidget(logX_ = logarithm("log-x", tr("horizontal axis")));
  row->addWidget(new QLabel(tr("colour")));
  colour_ = new QComboBox;
  colour_->setObjectName(QStringLiteral("scatterColour"));
  colour_->setAccessibleName(tr("What the colours mean"));
  colour_->setToolTip(tr("What the colours mean"));
  for (const draw::ScatterColourKind& k : draw::scatterColours()) colour_->addItem(tr(k.title), QString::fromLatin1(k.id));
  connect(colour_, QOverload<int>::of(&QComboBox::activated), this, [this](int at) {
    document_.setOption(key("colour"), colour_->itemData(at).toString().toStdString(),
                        tr("Colours by %1").arg(colour_->itemText(at)));
  });
  row->addWidget(colour_);
  showOptions();
}

QComboBox* ScatterBar::column(const char* name, const QString& title, RowValue otherwise) {
  auto* box = new QComboBox;
  box->setObjectName(QStringLiteral("scatter-") + QLatin1String(name));
  box->setAccessibleName(tr("%1 axis").arg(title));
  box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  box->setMinimumContentsLength(9);
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

QToolButton* ScatterBar::logarithm(const char* name, const QString& title) {
  auto* button = new QToolButton;
  button->setObjectName(QStringLiteral("scatter-") + QLatin1String(name));
  button->setText(tr("log"));
  button->setCheckable(true);
  button->setAutoRaise(true);
  button->setAccessibleName(tr("Logarithmic %1").arg(title));
  button->setToolTip(tr("Logarithmic %1; what is not above 0 is counted and not shown").arg(title));
  connect(button, &QToolButton::clicked, this, [this, name, title](bool on) {
    document_.setOption(key(name), on ? "on" : "off", (on ? tr("Logarithmic %1") : tr("Linear %1")).arg(title));
  });
  return button;
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
  colour_->setCurrentIndex(int(o.colour));
  logX_->setChecked(o.logX);
  logY_->setChecked(o.logY);
}

}  // namespace glint::gui
