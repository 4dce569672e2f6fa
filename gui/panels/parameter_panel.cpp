// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/parameter_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVariant>
#include <cmath>
#include <memory>
#include <utility>

#include "gui/base/elided_label.h"
#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/base/unit_text.h"

namespace glint::gui {

namespace {
QString nameFor(const char* kind, const ParamSpec& spec) {
  return QLatin1String(kind) + QStringLiteral(":") + toQString(spec.key);
}

QString toolTipOf(const ParamSpec& spec) {
  const QString symbol =
      spec.symbol.empty() ? QString() : QStringLiteral(", <i>%1</i>").arg(toQString(spec.symbol).toHtmlEscaped());
  QString text =
      QStringLiteral("<b>%1</b>%2<br>%3<br><tt>%4</tt>")
          .arg(toQString(spec.title).toHtmlEscaped(), symbol, toQString(spec.help).toHtmlEscaped(), toQString(spec.key));
  if (spec.max > spec.min)
    text += QStringLiteral(" &nbsp;%1 … %2%3")
                .arg(numberText(spec.min, 6), numberText(spec.max, 6), unitAfter(spec.unit).toHtmlEscaped());
  return text + QStringLiteral("<br>default %1").arg(valueText(spec.defaultValue, spec).toHtmlEscaped());
}

bool isInteger(const ParamSpec& spec) { return std::holds_alternative<int>(spec.defaultValue); }
SettingValue settingOf(const ParamSpec& spec, double value) {
  if (isInteger(spec)) return int(value);
  return value;
}
QString stageTitle(const std::string& key) {
  QString stage = toQString(key.substr(0, key.find('.')));
  if (!stage.isEmpty()) stage[0] = stage[0].toUpper();
  return stage;
}
}  // namespace

ParameterPanel::ParameterPanel(Document& document, QWidget* parent) : QScrollArea(parent), document_(document) {
  auto* content = new QWidget;
  auto* grid = new QGridLayout(content);
  grid->setContentsMargins(10, 2, 6, 8);
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(2);
  grid->setColumnStretch(1, 1);
  int row = 0;
  hint_ = new QLabel(tr("Open a scene to change its settings"));
  hint_->setObjectName(QStringLiteral("parametersHint"));
  hint_->setWordWrap(true);
  hint_->setProperty("role", "faded");
  grid->addWidget(hint_, row++, 0, 1, 4);
  QString group;
  for (const ParamSpec& spec : allParams()) {
    if (const QString next = stageTitle(spec.key); next != group) {
      group = next;
      auto* heading = new QLabel(group);
      heading->setProperty("role", "group");
      grid->addWidget(heading, row++, 0, 1, 4);
    }
    if (std::holds_alternative<bool>(spec.defaultValue))
      addFlag(spec, grid, row++);
    else if (std::holds_alternative<std::string>(spec.defaultValue))
      addChoice(spec, grid, row++);
    else
      addNumber(spec, grid, row++);
  }
  grid->setRowStretch(row, 1);
  setWidget(content);
  setWidgetResizable(true);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  setMinimumWidth(content->minimumSizeHint().width() + 20);
  connect(&document_, &Document::requestChanged, this, &ParameterPanel::refresh);
  connect(&document_, &Document::sceneOpened, this, &ParameterPanel::refresh);
  refresh();
}

void ParameterPanel::addNumber(const ParamSpec& spec, QGridLayout* grid, int row) {
  auto* slider = new QSlider(Qt::Horizontal);
  slider->setObjectName(nameFor("slider", spec));
  slider->setRange(0, SliderScale::kPositions);
  slider->setPageStep(SliderScale::kPositions / 20);
  slider->setMinimumWidth(24);
  slider->setAccessibleName(toQString(spec.title));
  setRichTip(slider, toolTipOf(spec));
  auto* box = new NumberBox(spec);
  box->setObjectName(nameFor("value", spec));
  box->setAccessibleName(toQString(spec.title));
  setRichTip(box, toolTipOf(spec));
  box->setMinimumWidth(70);
  box->setMaximumWidth(92);
  grid->addWidget(slider, row, 1);
  grid->addWidget(box, row, 2);

  const SliderScale scale(spec);
  const auto gesture = std::make_shared<int>(0);
  connect(slider, &QSlider::sliderPressed, this, [this, gesture] { *gesture = document_.newGesture(); });
  connect(slider, &QSlider::valueChanged, this, [this, spec, scale, slider, gesture](int position) {
    // One drag is one step of undo; a key or a click beside the handle is a step of its own.
    document_.setSetting(spec.key, settingOf(spec, scale.value(position)), slider->isSliderDown() ? *gesture : 0);
  });
  connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, [this, spec, box](double value) {
    if (isInteger(spec)) value = std::round(value);
    document_.setSetting(spec.key, settingOf(spec, value));
    const QSignalBlocker blocker(box);
    box->setValue(value);
  });
  addRow(spec, grid, row, [this, spec, slider, box, scale] {
    const double value = document_.request().settings.number(spec.key);
    const QSignalBlocker quietSlider(slider), quietBox(box);
    if (!slider->isSliderDown()) slider->setValue(scale.position(value));
    box->setValue(value);
  });
}

void ParameterPanel::addChoice(const ParamSpec& spec, QGridLayout* grid, int row) {
  auto* combo = new QComboBox;
  combo->setObjectName(nameFor("value", spec));
  combo->setAccessibleName(toQString(spec.title));
  setRichTip(combo, toolTipOf(spec));
  combo->setFocusPolicy(Qt::StrongFocus);
  for (const std::string& choice : spec.choices) combo->addItem(toQString(choice));
  grid->addWidget(combo, row, 1, 1, 2);
  connect(combo, QOverload<int>::of(&QComboBox::activated), this,
          [this, key = spec.key, combo](int index) { document_.setSetting(key, combo->itemText(index).toStdString()); });
  addRow(spec, grid, row, [this, spec, combo] {
    combo->setCurrentIndex(combo->findText(toQString(document_.request().settings.text(spec.key))));
  });
}

void ParameterPanel::addFlag(const ParamSpec& spec, QGridLayout* grid, int row) {
  auto* check = new QCheckBox;
  check->setObjectName(nameFor("value", spec));
  check->setAccessibleName(toQString(spec.title));
  setRichTip(check, toolTipOf(spec));
  grid->addWidget(check, row, 1, 1, 2);
  connect(check, &QCheckBox::clicked, this, [this, key = spec.key](bool on) { document_.setSetting(key, on); });
  addRow(spec, grid, row, [this, spec, check] { check->setChecked(document_.request().settings.flag(spec.key)); });
}

void ParameterPanel::addRow(const ParamSpec& spec, QGridLayout* grid, int row, std::function<void()> refresh) {
  auto* title = new ElidedLabel(toQString(spec.title), 12);
  setRichTip(title, toolTipOf(spec));
  grid->addWidget(title, row, 0);
  auto* reset = new QToolButton;
  reset->setObjectName(nameFor("reset", spec));
  reset->setIcon(icon(QStringLiteral("reset")));
  reset->setIconSize({13, 13});
  reset->setAutoRaise(true);
  reset->setAccessibleName(tr("Reset %1").arg(toQString(spec.title)));
  reset->setToolTip(tr("Reset to %1").arg(valueText(spec.defaultValue, spec)));
  grid->addWidget(reset, row, 3);
  connect(reset, &QToolButton::clicked, this, [this, key = spec.key] { document_.resetSetting(key); });
  rows_.push_back({spec.key, std::move(refresh), reset});
}

bool ParameterPanel::showParameter(const std::string& key) {
  for (const char* kind : {"slider:", "value:"}) {
    auto* control = findChild<QWidget*>(QLatin1String(kind) + toQString(key));
    if (!control) continue;
    ensureWidgetVisible(control, 0, height() / 3);
    control->setFocus(Qt::ShortcutFocusReason);
    return true;
  }
  return false;
}

void ParameterPanel::refresh() {
  hint_->setVisible(!document_.scene());
  widget()->setEnabled(document_.scene() != nullptr);
  const auto& changed = document_.request().settings.values();
  for (const Row& row : rows_) {
    row.refresh();
    row.reset->setEnabled(changed.count(row.key) > 0);
  }
}

}  // namespace glint::gui
