// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/develop_bar.h"

#include <QAction>
#include <QComboBox>
#include <QEvent>
#include <QLabel>
#include <QMenu>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "gui/base/flow_layout.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
constexpr double kExposureStep = 0.25, kGammaStep = 0.05;
constexpr double kMinStops = -6, kMaxStops = 8, kMinGamma = 0.4, kMaxGamma = 3;
const char* const kExposure = "frame/exposure";
const char* const kGamma = "frame/gamma";

bool isOn(const Document& document, const char* option) { return document.option(option, std::string("off")) == "on"; }
}  // namespace

FrameSource DevelopBar::source(const Document& document) {
  return document.option("frame/source", std::string("photograph")) == "radiance" ? FrameSource::Radiance : FrameSource::Image;
}

viz::Development DevelopBar::development(const Document& document) {
  viz::Development d;
  d.stops = std::clamp(document.option(kExposure, 0.0), kMinStops, kMaxStops);
  d.gamma = std::clamp(document.option(kGamma, 1.0), kMinGamma, kMaxGamma);
  d.falseColour = isOn(document, "frame/false-colour");
  d.markClipped = isOn(document, "frame/clipped");
  return d;
}

DevelopBar::DevelopBar(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* row = new FlowLayout(4);
  row->setContentsMargins(8, 0, 4, 2);
  setLayout(row);
  source_ = new QComboBox;
  source_->setObjectName(QStringLiteral("frameSource"));
  source_->addItem(tr("Photograph"), QStringLiteral("photograph"));
  source_->addItem(tr("Radiance"), QStringLiteral("radiance"));
  source_->setToolTip(tr("Image to show; the probe measures both. Frames that lack one show the other."));
  source_->setFocusPolicy(Qt::NoFocus);  // arrow keys step through the frames
  row->addWidget(source_);
  connect(source_, QOverload<int>::of(&QComboBox::activated), this, [this](int i) {
    document_.setOption("frame/source", source_->itemData(i).toString().toStdString(), tr("Show %1").arg(source_->itemText(i)));
  });
  exposure_ = addSlider(kExposure, tr("Exposure"), tr("Display brightness in stops (factors of two); does not affect results"),
                        int(kMinStops / kExposureStep), int(kMaxStops / kExposureStep), kExposureStep, 0, &exposureLabel_);
  gamma_ =
      addSlider(kGamma, tr("Gamma"), tr("Above 1, brightens dark areas on screen; does not affect results"),
                int(std::lround(kMinGamma / kGammaStep)), int(std::lround(kMaxGamma / kGammaStep)), kGammaStep, 1, &gammaLabel_);
  falseColour_ = addToggle("frame/false-colour", QStringLiteral("false-colour"), tr("False colour"),
                           tr("Linear radiance on a perceptually uniform colour map, with scale"));
  clipped_ =
      addToggle("frame/clipped", QStringLiteral("clipped"), tr("Clipped pixels"),
                tr("Pink: clipped in the photograph; in the radiance, brighter than white at this exposure. Red: not a number"));
  connect(&document_, &Document::optionsChanged, this, &DevelopBar::refresh);
  connect(&document_, &Document::sceneOpened, this, &DevelopBar::refresh);
  fitLabels();
  refresh();
}

/// As wide as the longest text that they may show, so that the sliders stand still while one is dragged.
void DevelopBar::fitLabels() {
  if (!gammaLabel_) return;
  const QFontMetrics metrics = fontMetrics();
  const int title = std::max(metrics.horizontalAdvance(tr("Exposure")), metrics.horizontalAdvance(tr("Gamma")));
  const int width = std::max(title, metrics.horizontalAdvance(tr("Exp. %1%2").arg("+").arg(kExposureStep)));
  for (QLabel* label : {exposureLabel_, gammaLabel_}) label->setFixedWidth(width);
}

void DevelopBar::changeEvent(QEvent* e) {
  QWidget::changeEvent(e);
  if (e->type() == QEvent::FontChange || e->type() == QEvent::StyleChange) fitLabels();  // larger texts in a presentation
}

QSlider* DevelopBar::addSlider(const char* option, const QString& title, const QString& tip, int low, int high, double step,
                               double usual, QLabel** label) {
  *label = new QLabel(title);
  (*label)->setProperty("role", "faded");
  layout()->addWidget(*label);
  auto* slider = new QSlider(Qt::Horizontal);
  slider->setObjectName(QLatin1String(option));
  slider->setRange(low, high);
  slider->setPageStep(4);
  slider->setFixedWidth(44);  // all tools of the bar on one line at the usual width of the view
  slider->setFocusPolicy(Qt::NoFocus);
  slider->setAccessibleName(title);
  slider->setToolTip(tip + tr("; double-click to reset"));
  slider->installEventFilter(this);
  layout()->addWidget(slider);
  slider->setValue(int(std::lround(usual / step)));
  connect(slider, &QSlider::sliderPressed, this, [this] { gesture_ = document_.newGesture(); });
  connect(slider, &QSlider::sliderReleased, this, [this] { gesture_ = 0; });
  connect(slider, &QSlider::valueChanged, this, [this, option, title, step](int v) {
    document_.setOption(option, v * step, QStringLiteral("%1: %2").arg(title).arg(v * step), gesture_);
  });
  return slider;
}

bool DevelopBar::eventFilter(QObject* watched, QEvent* event) {
  if (event->type() != QEvent::MouseButtonDblClick) return QWidget::eventFilter(watched, event);
  if (watched == exposure_) exposure_->setValue(0);
  if (watched == gamma_) gamma_->setValue(int(std::lround(1 / kGammaStep)));
  return true;
}

QToolButton* DevelopBar::addToggle(const char* option, const QString& iconName, const QString& title, const QString& tip) {
  auto* button = new QToolButton;
  button->setObjectName(QLatin1String(option));
  button->setIcon(icon(iconName));
  button->setToolTip(title + QStringLiteral(". ") + tip);
  button->setCheckable(true);
  button->setAutoRaise(true);
  layout()->addWidget(button);
  connect(button, &QToolButton::clicked, this, [this, option, title](bool on) {
    document_.setOption(option, on ? "on" : "off", title + (on ? tr(": on") : tr(": off")));
  });
  return button;
}

void DevelopBar::refresh() {
  const viz::Development d = development(document_);
  const bool radiance = source(document_) == FrameSource::Radiance;
  const QSignalBlocker a(source_), b(exposure_), c(gamma_);
  source_->setCurrentIndex(radiance ? 1 : 0);
  exposure_->setValue(int(std::lround(d.stops / kExposureStep)));
  gamma_->setValue(int(std::lround(d.gamma / kGammaStep)));
  exposureLabel_->setText(d.stops == 0 ? tr("Exposure") : tr("Exp. %1%2").arg(d.stops > 0 ? "+" : "").arg(d.stops));
  gammaLabel_->setText(d.gamma == 1 ? tr("Gamma") : tr("γ %1").arg(d.gamma));
  falseColour_->setChecked(d.falseColour);
  clipped_->setChecked(d.markClipped);
  if (checks_.size() == 3) {
    checks_[0]->setChecked(radiance);
    checks_[1]->setChecked(d.falseColour);
    checks_[2]->setChecked(d.markClipped);
  }
}

void DevelopBar::addActions(Actions& actions, QMenu* menu) {
  const auto toggle = [&](const char* id, const QString& title, const char* option, const char* on, const char* off) {
    checks_ << actions.addToggle(QLatin1String(id), menu, title,
                                 [this, option, on, off, title](bool wanted) {
                                   document_.setOption(option, wanted ? on : off,
                                                       QString(title).remove('&') + (wanted ? tr(": on") : tr(": off")));
                                 },
                                 {});
  };
  toggle("frame.radiance", tr("Show &radiance"), "frame/source", "radiance", "photograph");
  toggle("frame.false-colour", tr("&False colour"), "frame/false-colour", "on", "off");
  toggle("frame.clipped", tr("Mark &clipped pixels"), "frame/clipped", "on", "off");
  const auto nudge = [&](const char* id, const QString& title, QSlider* slider, int by, const char* key) {
    actions.add(QLatin1String(id), menu, title, [slider, by] { slider->setValue(slider->value() + by); },
                {{QKeySequence(QLatin1String(key))}});
  };
  nudge("frame.brighter", tr("&Brighter"), exposure_, 2, "+");
  nudge("frame.darker", tr("&Darker"), exposure_, -2, "-");
  nudge("frame.gamma-up", tr("Gamma up"), gamma_, 2, "Ctrl+Alt+G");
  nudge("frame.gamma-down", tr("Gamma down"), gamma_, -2, "Ctrl+Alt+Shift+G");
  actions.add("frame.reset-look", menu, tr("Reset e&xposure and gamma"), [this] {
    const viz::Development d = development(document_);
    if (d.stops == 0 && d.gamma == 1) return;
    document_.undoStack()->beginMacro(tr("Reset exposure and gamma"));
    document_.setOption(kExposure, 0.0, tr("Reset exposure"));
    document_.setOption(kGamma, 1.0, tr("Reset gamma"));
    document_.undoStack()->endMacro();
  });
  refresh();
}

}  // namespace glint::gui
