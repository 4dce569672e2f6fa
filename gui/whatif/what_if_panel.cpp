// SPDX-License-Identifier: BSD-3-Clause
#include "gui/whatif/what_if_panel.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <QVariant>
#include <algorithm>
#include <memory>
#include <utility>

#include "core/pipeline/hand_edits.h"
#include "core/reflectance/added_lobe.h"
#include "core/reflectance/lobe.h"
#include "gui/base/draw_turns.h"
#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

namespace {
constexpr int kDigits = 3;

QString named(const char* kind, const WhatIfKnob& knob) { return QLatin1String(kind) + toQString(knob.spec.key); }
}  // namespace

WhatIfPanel::WhatIfPanel(Document& document, QWidget* parent)
    : QScrollArea(parent),
      document_(document),
      synthesise_(new QCheckBox(tr("Synthesise contours"))),
      lobe_(new QComboBox),
      summary_(new QLabel),
      origin_(new QLabel),
      resetAll_(new QToolButton) {
  auto* content = new QWidget;
  auto* column = new QVBoxLayout(content);
  column->setContentsMargins(10, 4, 6, 8);
  column->setSpacing(4);
  auto* head = new QHBoxLayout;
  summary_->setObjectName(QStringLiteral("whatif.summary"));
  summary_->setWordWrap(true);
  summary_->setMinimumHeight(2 * summary_->fontMetrics().lineSpacing());  // its rows stay where they are under the mouse
  head->addWidget(summary_, 1);
  resetAll_->setObjectName(QStringLiteral("whatif.reset"));
  resetAll_->setText(tr("Reset what-if"));
  head->addWidget(resetAll_, 0, Qt::AlignTop);
  column->addLayout(head);
  auto* synthetic = new QHBoxLayout;
  synthesise_->setObjectName(QStringLiteral("whatif.synthesise"));
  synthetic->addWidget(synthesise_, 1);
  lobe_->setObjectName(QStringLiteral("whatif.lobe"));
  lobe_->setToolTip(tr("Lobe of the synthesised contours"));
  for (const Lobe lobe : allLobes()) lobe_->addItem(QString::fromStdString(nameOf(lobe)));
  synthetic->addWidget(lobe_);
  column->addLayout(synthetic);
  origin_->setObjectName(QStringLiteral("whatif.origin"));
  origin_->setWordWrap(true);
  origin_->setMinimumHeight(3 * origin_->fontMetrics().lineSpacing());
  origin_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
  column->addWidget(origin_);
  column->addStretch(1);
  setWidget(content);
  setWidgetResizable(true);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);

  connect(synthesise_, &QCheckBox::clicked, this, [this](bool on) {
    document_.setWhatIf(started(document_.request().whatIf, on),
                        on ? tr("What-if: contours synthesised") : tr("What-if: contours as captured"));
  });
  connect(lobe_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    WhatIf w = document_.request().whatIf;
    w.lobe = *lobeOf(lobe_->itemText(index).toStdString());
    document_.setWhatIf(w, tr("What-if: lobe %1").arg(lobe_->itemText(index)));
  });
  connect(resetAll_, &QToolButton::clicked, this, [this] { document_.setWhatIf(WhatIf(), tr("What-if: reset")); });
  connect(&document_, &Document::sceneOpened, this, [this] {
    fitted_.reset();
    whyNotFitted_.clear();
  });
  connect(&document_, &Document::selectionChanged, this, &WhatIfPanel::rebuild);
  for (const auto signal : {&Document::sceneOpened, &Document::inspectionChanged})  // when much else has to be shown
    connect(&document_, signal, this, [this] { drawInTurn(this, [this] { rebuild(); }); });
  connect(&document_, &Document::requestChanged, this, &WhatIfPanel::refresh);
  rebuild();
}

QStringList highlightsToMove(const Document& document) {
  const auto inspection = document.inspection();
  const std::size_t frame = std::size_t(document.selection().frame);
  if (!inspection || frame >= inspection->evidence.size()) return {};
  const FrameEvidence& now = inspection->evidence[frame];
  const auto before = inspection->evidenceBefore.find(int(frame));
  const std::size_t found = (before == inspection->evidenceBefore.end() ? now : before->second).highlights.size();
  QStringList notes;
  for (std::size_t i = 0; i < found; ++i)
    notes << (hasEdits(inspection->request.whatIf, int(frame)) ? QObject::tr("not there now") : QString());
  for (std::size_t i = 0; i < now.highlights.size(); ++i) {
    const int number = now.asFound(int(i));
    while (notes.size() <= number) notes << QObject::tr("not there now");
    notes[number] = toQString(now.highlights[i].byHand).section(QLatin1Char(':'), 0, 0);  // the rest says what it leaves in doubt
  }
  return notes;
}

/// While contours are synthesised a fit gives back the lobe that made them: that of the scene as captured stays.
void WhatIfPanel::rememberLobe() {
  const auto inspection = document_.inspection();
  if (!inspection || (inspection->request.whatIf.synthesise && !(whyNotFitted_.empty() && !fitted_))) return;
  const int last = int(inspection->scene->frames.size()) - 1;
  if (last < 0) return;
  const Outcome<FittedLobe> found = fittedLobe(*inspection, std::clamp(document_.selection().frame, 0, last));
  fitted_ = found ? std::optional(*found) : std::nullopt;
  if (found)
    whyNotFitted_.clear();
  else  // "not supported" is the program's word for what was not asked for
    whyNotFitted_ = found.failure().reason == Reason::NotSupported ? found.failure().detail : found.failure().message();
}

WhatIf WhatIfPanel::started(WhatIf w, bool synthesise) const {
  const WhatIf plain;
  const auto set = [&](Lobe lobe, double roughness) {
    w.lobe = lobe;
    w.roughness = roughness;
  };
  w.synthesise = synthesise;
  if (fitted_) {
    if (synthesise && w.lobe == plain.lobe && w.roughness == plain.roughness) set(fitted_->lobe, fitted_->roughness);
    // What was started from is no change of the user's: without a synthesis nothing of it is left.
    if (!synthesise && w.lobe == fitted_->lobe && w.roughness == fitted_->roughness) set(plain.lobe, plain.roughness);
  }
  return w;
}

QString WhatIfPanel::origin(const WhatIf& w) const {
  if (!fitted_) {
    if (whyNotFitted_.empty()) return {};
    const QString why = toQString(whyNotFitted_);
    if (w.synthesise) return tr("No fitted lobe to compare with: %1").arg(why);
    return tr("Starts from the default lobe, %1 with m = %2: %3")
        .arg(QString::fromStdString(nameOf(w.lobe)), numberText(w.roughness, kDigits), why);
  }
  const QString lobe =
      tr("%1 with m = %2 (%3)")
          .arg(QLatin1String(nameOf(fitted_->lobe)), numberText(fitted_->roughness, kDigits), toQString(fitted_->origin));
  if (!w.synthesise) return tr("Starts from the lobe of this scene: %1").arg(lobe);
  const bool own = w.lobe == fitted_->lobe && w.roughness == fitted_->roughness;
  return (own ? tr("Same lobe as captured: %1") : tr("Lobe as captured: %1")).arg(lobe);
}

void WhatIfPanel::rebuild() {
  const Scene* scene = document_.scene();
  rememberLobe();
  const int frame = document_.selection().frame;
  const QStringList highlights = highlightsToMove(document_);
  const double roughness = fitted_ ? fitted_->roughness : WhatIf{}.roughness;
  if (scene == builtFor_ && frame == builtFrame_ && highlights == builtHighlights_ && roughness == builtRoughness_ && knobs_)
    return refresh();
  builtFor_ = scene;
  builtFrame_ = frame;
  builtHighlights_ = highlights;
  builtRoughness_ = roughness;
  rows_.clear();
  if (knobs_) {
    knobs_->hide();
    knobs_->deleteLater();  // one of its sliders may be what called
    knobs_ = nullptr;
  }
  if (scene && document_.frameCount() > 0) {
    knobs_ = new QWidget;
    auto* grid = new QGridLayout(knobs_);
    grid->setContentsMargins(0, 0, 0, 0);
    grid->setHorizontalSpacing(6);
    grid->setVerticalSpacing(2);
    grid->setColumnStretch(1, 1);
    int row = 0;
    std::string group;
    for (const WhatIfKnob& knob : whatIfKnobs(*scene, frame, int(highlights.size()), roughness)) {
      if (knob.group != group) {
        group = knob.group;
        const QString note = knob.highlight < 0 ? QString() : highlights[knob.highlight];
        auto* heading = new QLabel(note.isEmpty() ? toQString(group) : tr("%1 (%2)").arg(toQString(group), note));
        heading->setWordWrap(true);
        heading->setProperty("role", "group");
        grid->addWidget(heading, row++, 0, 1, 4);
      }
      addRow(knob, grid, row++);
    }
    auto* column = static_cast<QVBoxLayout*>(widget()->layout());
    column->insertWidget(column->count() - 1, knobs_);
  }
  refresh();
}

void WhatIfPanel::addRow(const WhatIfKnob& knob, QGridLayout* grid, int row) {
  const ParamSpec& spec = knob.spec;
  const QString tip = toQString(spec.help);
  auto* title = new QLabel(toQString(spec.title));
  auto* slider = new QSlider(Qt::Horizontal);
  slider->setObjectName(named("slider:", knob));
  slider->setRange(0, SliderScale::kPositions);
  slider->setMinimumWidth(60);
  auto* box = new NumberBox(spec);
  box->setObjectName(named("value:", knob));
  box->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Fixed);  // all as wide as the longest unit needs
  auto* reset = new QToolButton;
  reset->setObjectName(named("reset:", knob));
  reset->setIcon(icon(QStringLiteral("reset")));
  reset->setIconSize({13, 13});
  reset->setAutoRaise(true);
  for (QWidget* w : std::initializer_list<QWidget*>{slider, box}) w->setAccessibleName(toQString(spec.title));
  reset->setAccessibleName(tr("Reset %1").arg(toQString(spec.title)));
  reset->setToolTip(tr("Reset to %1").arg(valueText(spec.defaultValue, spec)));
  for (QWidget* w : std::initializer_list<QWidget*>{title, slider, box}) w->setToolTip(tip);
  grid->addWidget(title, row, 0);
  grid->addWidget(slider, row, 1);
  grid->addWidget(box, row, 2);
  grid->addWidget(reset, row, 3);
  const SliderScale scale(spec);
  const auto gesture = std::make_shared<int>(0);
  connect(slider, &QSlider::sliderPressed, this, [this, gesture] { *gesture = document_.newGesture(); });
  connect(slider, &QSlider::valueChanged, this, [this, knob, scale, slider, gesture](int position) {
    turnKnob(document_, knob, scale.value(position), slider->isSliderDown() ? *gesture : 0);
  });
  connect(box, QOverload<double>::of(&QDoubleSpinBox::valueChanged), this,
          [this, knob](double value) { turnKnob(document_, knob, value); });
  connect(reset, &QToolButton::clicked, this,
          [this, knob] { turnKnob(document_, knob, std::get<double>(knob.spec.defaultValue)); });
  rows_.push_back({knob,
                   [slider, box, scale](double value) {
                     const QSignalBlocker quietSlider(slider), quietBox(box);
                     if (!slider->isSliderDown()) slider->setValue(scale.position(value));
                     box->setValue(value);
                   },
                   {title, slider, box},
                   reset});
}

void turnKnob(Document& document, const WhatIfKnob& knob, double value, int gesture) {
  WhatIf w = document.request().whatIf;
  knob.set(w, value);
  document.setWhatIf(w,
                     QObject::tr("What-if: %1, %2 %3")
                         .arg(toQString(knob.group), toQString(knob.spec.title).toLower(), valueText(value, knob.spec)),
                     gesture > 0 ? QStringLiteral("%1#%2").arg(toQString(knob.spec.key)).arg(gesture) : QString());
}

bool WhatIfPanel::showKnob(const std::string& key) {
  rebuild();  // it may wait for its turn
  QWidget* control = knobs_ ? knobs_->findChild<QWidget*>(QLatin1String("slider:") + toQString(key)) : nullptr;
  if (!control) control = findChild<QWidget*>(QLatin1String("whatif.") + toQString(key));
  if (!control) return false;
  if (!control->isEnabled()) control = synthesise_;
  ensureWidgetVisible(control, 0, height() / 3);
  control->setFocus(Qt::ShortcutFocusReason);
  return true;
}

void WhatIfPanel::refresh() {
  const WhatIf& w = document_.request().whatIf;
  const Scene* scene = document_.scene();
  const std::optional<Failure> whyNot = scene ? whyNotSynthesised(*scene) : std::nullopt;
  synthesise_->setEnabled(scene && !whyNot);
  synthesise_->setToolTip(
      whyNot ? tr("Not available: %1").arg(toQString(whyNot->detail))
             : tr("Computes observed contours from the exact radiance of the lights below instead of the images"));
  synthesise_->setChecked(w.synthesise);
  lobe_->setEnabled(w.synthesise);
  const WhatIf shown = started(w, true);  // also before it is switched on: what it starts from
  lobe_->setCurrentIndex(lobe_->findText(QString::fromStdString(nameOf(shown.lobe))));
  origin_->setText(scene && !whyNot ? origin(w) : QString());
  const std::string summary = summaryOf(w);
  summary_->setText(summary.empty() ? tr("No changes: scene as captured") : toQString(summary));
  resetAll_->setEnabled(!w.none());
  for (const Row& row : rows_) {
    const double value = row.knob.get(w.synthesise ? w : shown);
    row.show(value);
    const bool usable = !row.knob.synthetic || w.synthesise;
    const QString why = usable ? QString() : tr("\nRequires synthesised contours; tick that box first.");
    for (QWidget* widget : row.widgets) {
      if (widget->isEnabledTo(knobs_) == usable && widget->toolTip().endsWith(why))
        continue;  // every step of a slider comes here
      widget->setEnabled(usable);
      widget->setToolTip(toQString(row.knob.spec.help) + why);
    }
    row.reset->setEnabled(usable && value != std::get<double>(row.knob.spec.defaultValue));
  }
}

}  // namespace glint::gui
