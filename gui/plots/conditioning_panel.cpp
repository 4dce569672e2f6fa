// SPDX-License-Identifier: BSD-3-Clause
#include "gui/plots/conditioning_panel.h"

#include <QGridLayout>
#include <QLabel>
#include <QPainter>
#include <QRegularExpression>
#include <QTabBar>
#include <QVBoxLayout>
#include <QVariant>
#include <algorithm>

#include "core/base/words.h"
#include "core/pipeline/summary.h"
#include "core/report/texts.h"
#include "gui/base/elided_label.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"

namespace glint::gui {

namespace {

/// Dark enough for white text in both themes.
QColor colourOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::Green: return QColor(0x2c, 0x7a, 0x4b);
    case Verdict::Amber: return QColor(0x9a, 0x68, 0x00);
    case Verdict::Red: return QColor(0xb0, 0x2e, 0x24);
    case Verdict::Unknown: return QColor(0x6a, 0x70, 0x76);
  }
  return {};
}

QString signOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::Green: return QStringLiteral("✓");
    case Verdict::Amber: return QStringLiteral("!");
    case Verdict::Red: return QStringLiteral("✕");
    case Verdict::Unknown: return {};
  }
  return {};
}

/// Rows in a fixed order, so that a slider does not make them jump.
struct Row {
  const char* id;
  const char* title;
  const char* tip;
};
constexpr Row kRows[] = {
    {"fit", QT_TRANSLATE_NOOP("ConditioningPanel", "Fit"), QT_TRANSLATE_NOOP("ConditioningPanel", "Reason for a missing fit")},
    {"peaks", QT_TRANSLATE_NOOP("ConditioningPanel", "Peaks"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Training peaks that lie outside their own contour")},
    {"signature", QT_TRANSLATE_NOOP("ConditioningPanel", "Q* alone"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Kind of quadric that the contours alone give, by the signature of Q*")},
    {"rank", QT_TRANSLATE_NOOP("ConditioningPanel", "Singular values"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Second-last over first singular value")},
    {"gap", QT_TRANSLATE_NOOP("ConditioningPanel", "Gap"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Last over second-last singular value")},
    {"angle", QT_TRANSLATE_NOOP("ConditioningPanel", "Triangulation"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Widest angle between the rays of two views")},
    {"views", QT_TRANSLATE_NOOP("ConditioningPanel", "Effective views"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Training highlights, counting those seen from nearly the same side once")},
    {"light", QT_TRANSLATE_NOOP("ConditioningPanel", "Light ±"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "Standard deviation of the light (or the ellipsoid's centre) over its distance")},
    {"residual", QT_TRANSLATE_NOOP("ConditioningPanel", "Residual"),
     QT_TRANSLATE_NOOP("ConditioningPanel", "RMS distance of the training contours from the model")}};

/// "hyperboloid of two sheets" does not fit a chip.
QString shortText(const Finding& f) {
  static const std::pair<const char*, const char*> shorter[] = {{"hyperboloid of one sheet", "1-sheet"},
                                                                {"hyperboloid of two sheets", "2-sheet"},
                                                                {"imaginary ellipsoid", "imaginary"},
                                                                {"flat imaginary ellipsoid", "imaginary"},
                                                                {"flat ellipsoid", "flat"},
                                                                {"flat hyperboloid", "flat hyp."},
                                                                {"undetermined", "open"},
                                                                {"ellipsoid", "ellips."}};
  for (const auto& [full, brief] : shorter)
    if (f.text == full) return QLatin1String(brief);
  return toQString(f.text);
}

/// Still shorter forms of shortText(), for columns as narrow as five of them are; the tool tip has the whole name.
QStringList narrowTexts(const QString& text) {
  static const std::pair<const char*, QStringList> narrow[] = {
      {"1-sheet", {"hyp. 1", "hyp."}}, {"2-sheet", {"hyp. 2", "hyp."}}, {"imaginary", {"imag.", "imag", "im."}},
      {"flat hyp.", {"flat"}},         {"ellips.", {"ell."}},           {"open", {"open"}}};
  for (const auto& [full, shorter] : narrow)
    if (text == QLatin1String(full)) return shorter;
  return {};
}

/// A number that is too wide, shorter and shorter: "1.23e-05" as "1.23e-5", "1.2e-5", "1e-5". What follows it stays ("°").
QStringList fewerDigits(const QString& text) {
  static const QRegularExpression number(QStringLiteral("^[0-9.]+(?:e[-+]?[0-9]+)?")), zeros(QStringLiteral("e([-+]?)0*"));
  const QRegularExpressionMatch found = number.match(text);
  const QString digits = found.captured();
  QStringList shorter;
  for (const int most : {3, 2, 1, 0}) {  // 0: "0.00012" as "1e-4"
    QString less = (most > 0 ? QString::number(digits.toDouble(), 'g', most) : QString::number(digits.toDouble(), 'e', 0))
                       .replace(QLatin1String("e+"), QLatin1String("e"));
    less.replace(zeros, QStringLiteral("e\\1"));
    shorter << less + text.mid(found.capturedEnd());
  }
  return shorter;
}

}  // namespace

Chip::Chip(Verdict verdict, const QString& text, QWidget* parent) : QAbstractButton(parent), verdict_(verdict) {
  setText(text);
  setCursor(Qt::PointingHandCursor);
  QFont small = font();
  small.setPointSizeF(0.85 * small.pointSizeF());
  setFont(small);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
}

QSize Chip::sizeHint() const {
  return {fontMetrics().horizontalAdvance(signOf(verdict_) + QChar(0x2009) + text()) + 12, fontMetrics().height() + 6};
}
QSize Chip::minimumSizeHint() const {
  // A number has digits to give; the shortest form of a word has nothing.
  const QStringList words = narrowTexts(text());
  const int word = words.isEmpty() ? 0 : fontMetrics().horizontalAdvance(signOf(verdict_) + words.back()) + 4;
  return {std::max(40, word), fontMetrics().height() + 6};
}

void Chip::show(Verdict verdict, const QString& text) {
  verdict_ = verdict;
  if (text == this->text()) return update();
  setText(text);
  updateGeometry();
}

QString Chip::unit() const {
  const QString last = text().section(QLatin1Char(' '), 1);
  return last == QLatin1String("%") || last == QLatin1String("px") ? last : QString();
}

void Chip::setUnitShown(bool shown) {
  if (shown == unitShown_) return;
  unitShown_ = shown;
  update();
}

QString Chip::shown() const {
  const QString sign = signOf(verdict_), value = text().section(QLatin1Char(' '), 0, 0);
  const QString after = unit().isEmpty() || !unitShown_ ? QString() : QLatin1Char(' ') + unit();
  QStringList words{unit().isEmpty() ? text() : value + after};
  static const QRegularExpression number(QStringLiteral("^[0-9.]+(e[-+]?[0-9]+)?°?$"));
  if (number.match(value).hasMatch()) {
    words << value + after;
    for (const QString& less : fewerDigits(value)) words << less + after;
  }
  words << narrowTexts(text());
  // The sign is what tells the verdict without its colour: the blank beside it and digits go before it.
  for (const QString& w : words)
    for (const QString& between : {QString(QChar(0x2009)), QString()})
      if (const QString all = sign + between + w; fontMetrics().horizontalAdvance(all) <= width() - 4) return all;
  return fontMetrics().elidedText(sign + words.back(), Qt::ElideRight, width() - 4);
}

void Chip::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(hasFocus() ? QPen(palette().color(QPalette::Text), 1.5) : QPen(Qt::NoPen));
  painter.setBrush(underMouse() ? colourOf(verdict_).darker(115) : colourOf(verdict_));
  painter.drawRoundedRect(QRectF(rect()).adjusted(0.75, 0.75, -0.75, -0.75), 4, 4);
  painter.setPen(Qt::white);
  painter.drawText(rect(), Qt::AlignCenter, shown());
}

void Chip::enterEvent(QEvent* e) {
  QAbstractButton::enterEvent(e);
  update();
  emit entered();
}

ConditioningPanel::ConditioningPanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  setObjectName(QStringLiteral("conditioning"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 4, 6, 4);
  column->setSpacing(4);
  empty_ = new QLabel(tr("No results yet"));
  empty_->setProperty("role", "faded");
  column->addWidget(empty_);
  lights_ = new QTabBar;
  lights_->setObjectName(QStringLiteral("conditioningLights"));
  lights_->setExpanding(false);
  lights_->setDrawBase(false);
  lights_->setElideMode(Qt::ElideMiddle);
  lights_->setAccessibleName(tr("Light"));
  lights_->hide();
  column->addWidget(lights_);
  connect(lights_, &QTabBar::currentChanged, this, [this](int tab) {
    if (tab < 0 || filling_) return;
    draw::Selection s = document_.selection();
    s.light = lights_->tabData(tab).toString().toStdString();
    if (s.light != document_.selection().light) document_.select(s);
    follow(s.light);
  });
  reason_ = new QLabel;
  reason_->setObjectName(QStringLiteral("conditioningReason"));
  reason_->setTextFormat(Qt::RichText);
  reason_->setWordWrap(true);
  reason_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  reason_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  column->addWidget(reason_, 1);
  connect(&document_, &Document::staleChanged, new StaleBadge(this, Qt::BottomRightCorner), &StaleBadge::setStale);
  const auto again = [this] {
    dirty_ = true;
    refresh();
  };
  connect(&document_, &Document::inspectionChanged, this, again);
  connect(&document_, &Document::sceneOpened, this, again);
  connect(&document_, &Document::selectionChanged, this, [this] {
    showPrediction();
    const std::shared_ptr<const Inspection> inspection = document_.inspection();
    if (surfaceKey(inspection.get()) != surface_) {
      dirty_ = true;
      refresh();
    } else {
      const draw::Selection& s = document_.selection();
      std::string light = s.light;
      if (light.empty() && s.highlight >= 0 && inspection && s.frame < int(inspection->evidence.size())) {
        const auto& highlights = inspection->evidence[std::size_t(s.frame)].highlights;
        if (s.highlight < int(highlights.size())) light = highlights[std::size_t(s.highlight)].light;
      }
      follow(light);
    }
  });
}

void ConditioningPanel::showEvent(QShowEvent* e) {
  QWidget::showEvent(e);
  refresh();
}

Chip* ConditioningPanel::chip(const std::string& model, const std::string& finding) const {
  for (const Shown& s : chips_) {
    const Conditioning& c = conditioning_[std::size_t(s.conditioning)];
    if (c.model == model && c.findings[std::size_t(s.finding)].id == finding) return s.chip;
  }
  return nullptr;
}

QString ConditioningPanel::reason() const { return reason_->text(); }

std::string ConditioningPanel::surfaceKey(const Inspection* inspection) const {
  const bool each = inspection && inspection->train.perSurface && inspection->surfaces;
  return each ? inspection->surfaces->keyOf(document_.selection().frame) : "";
}

void ConditioningPanel::refresh() {
  if (!dirty_ || !isVisible()) return;
  dirty_ = false;
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  conditioning_ = inspection ? conditioningOf(*inspection) : std::vector<Conditioning>{};
  surface_ = surfaceKey(inspection.get());
  if (!surface_.empty())
    std::erase_if(conditioning_, [this](const Conditioning& c) { return c.surface && *c.surface != surface_; });
  showLights();
  // New numbers go into the same chips: a table built anew would be blank for a moment in every step of a drag.
  std::string key = light_ + '|';
  for (const Conditioning& c : conditioning_) {
    key += c.model + '/' + c.light + '/' + c.surface.value_or("") + ':';
    for (const Finding& f : c.findings) key += f.id + ' ';
  }
  if (key != tableKey_) {
    tableKey_ = key;
    build();
  }
  for (const Shown& s : chips_) {
    const Conditioning& c = conditioning_[std::size_t(s.conditioning)];
    const Finding& finding = c.findings[std::size_t(s.finding)];
    s.chip->show(finding.verdict, shortText(finding));
    setRichTip(s.chip, QStringLiteral("<b>%1, %2: %3</b> (%4)<br>%5")
                           .arg(toQString(c.model), toQString(finding.title), toQString(finding.text).toHtmlEscaped(),
                                QLatin1String(nameOf(finding.verdict)), toQString(finding.reason).toHtmlEscaped()));
    s.chip->setAccessibleName(toQString(c.model + " " + finding.title + " " + finding.text + ": " + nameOf(finding.verdict)));
  }
  for (const auto& [row, title] : titles_) placeUnit(row);
  showPrediction();
  empty_->setVisible(conditioning_.empty());
  if (conditioning_.empty()) return reason_->clear();
  explainWorst();
}

Chip* ConditioningPanel::newChip(int conditioning, int finding) {
  const Conditioning& c = conditioning_[std::size_t(conditioning)];
  const Finding& f = c.findings[std::size_t(finding)];
  auto* chip = new Chip(f.verdict, shortText(f));
  chip->setObjectName(toQString("chip_" + c.model + "_" + f.id));
  connect(chip, &Chip::entered, this, [this, conditioning, finding] {
    const Conditioning& now = conditioning_[std::size_t(conditioning)];
    explain(now, now.findings[std::size_t(finding)]);
  });
  connect(chip, &Chip::clicked, this, [this, conditioning] {
    draw::Selection s = document_.selection();
    s.model = conditioning_[std::size_t(conditioning)].model;
    s.light = conditioning_[std::size_t(conditioning)].light;
    document_.select(s);
  });
  return chip;
}

namespace {
/// The model's name over its column; broken where columns are narrow.
QLabel* columnHeading(const Conditioning& c, bool narrow) {
  QString name = toQString(c.model);
  constexpr int kLongName = 8;  // letters: a longer word does not fit into a narrow column
  if (narrow && name.contains('-'))
    name.replace("-", "-\n");
  else if (narrow && name.size() > kLongName)
    name.insert((name.size() + 1) / 2, "-\n");
  auto* head = new QLabel(name);
  head->setToolTip(toQString(c.model + ", " + lightName(c.light) + (c.surface ? ", surface " + *c.surface : std::string())));
  head->setStyleSheet(
      QStringLiteral("border-bottom: 2px solid %1; font-size: 8pt;").arg(toQColor(draw::modelColour(c.model, c.poor)).name()));
  head->setAlignment(Qt::AlignHCenter | Qt::AlignBottom);
  head->setMinimumWidth(40);
  return head;
}
}  // namespace

void ConditioningPanel::build() {
  chips_.clear();
  titles_.clear();
  delete table_;
  table_ = nullptr;
  prediction_ = nullptr;
  if (conditioning_.empty()) return;
  std::vector<int> columns;  // those of the light that is shown
  for (int k = 0; k < int(conditioning_.size()); ++k)
    if (conditioning_[std::size_t(k)].light == light_) columns.push_back(k);
  table_ = new QWidget;
  auto* grid = new QGridLayout(table_);
  grid->setContentsMargins(0, 0, 0, 0);
  grid->setSpacing(3);
  int row = 1;
  for (int r = 0; r < int(std::size(kRows)); ++r) {
    bool any = false;
    for (int at = 0; at < int(columns.size()); ++at) {
      const int k = columns[std::size_t(at)];
      const Conditioning& c = conditioning_[std::size_t(k)];
      for (int f = 0; f < int(c.findings.size()); ++f) {
        if (c.findings[std::size_t(f)].id != kRows[r].id) continue;
        any = true;
        chips_.push_back({newChip(k, f), k, f, r});
        grid->addWidget(chips_.back().chip, row, at + 1);
      }
    }
    if (!any) continue;
    auto* title = new ElidedLabel(tr(kRows[r].title));
    title->setToolTip(tr(kRows[r].tip));
    title->setProperty("role", "faded");
    grid->addWidget(title, row++, 0);
    titles_[r] = title;
  }
  addPrediction(*grid, row, int(columns.size()));
  for (int at = 0; at < int(columns.size()); ++at) {
    grid->addWidget(columnHeading(conditioning_[std::size_t(columns[std::size_t(at)])], columns.size() > 4), 0, at + 1);
    grid->setColumnStretch(at + 1, 1);
  }
  auto* column = static_cast<QVBoxLayout*>(layout());
  column->insertWidget(column->indexOf(lights_) + 1, table_);
}

void ConditioningPanel::addPrediction(QGridLayout& grid, int row, int columns) {
  auto* title = new ElidedLabel(tr("Prediction (%)"));
  title->setToolTip(
      tr("Contour error in held-out frames of the model that is selected, in % of a highlight's diameter; "
         "highlights that it missed; frames predicted of those that have a highlight"));
  title->setProperty("role", "faded");
  grid.addWidget(title, row, 0);
  prediction_ = new ElidedLabel;
  prediction_->setObjectName(QStringLiteral("conditioningPrediction"));
  grid.addWidget(prediction_, row, 1, 1, columns);
}

/// The words and numbers of the summary above the table of errors.
void ConditioningPanel::showPrediction() {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!prediction_ || !inspection) return;
  const auto result = inspection->models.find(document_.plottedModel());
  if (result == inspection->models.end()) return prediction_->clear();
  const ModelSummary s = summarise(*inspection, result->second);
  const QString model = toQString(result->first);
  if (!s.answered) {
    prediction_->setText(toQString(s.reason));
    return prediction_->setToolTip(plainTip(tr("%1 in held-out frames: %2").arg(model, toQString(s.reason))));
  }
  const Statistic& error = s.contourErrorPct;
  prediction_->setText(tr("median %1, max %2, missed %3, %4/%5")
                           .arg(numberText(error.median, 2), numberText(error.max, 2))
                           .arg(s.missed)
                           .arg(s.predicted)
                           .arg(s.frames));
  prediction_->setToolTip(
      plainTip(tr("%1 in held-out frames, against %2: median error %3 %, max %4 %; missed highlights: %5; "
                  "predicted in %6 of %7 frames (those of each light)")
                   .arg(model, toQString(scoredAgainst(*inspection)), numberText(error.median), numberText(error.max))
                   .arg(s.missed)
                   .arg(s.predicted)
                   .arg(s.frames)));
}

void ConditioningPanel::showLights() {
  std::vector<std::string> ids;
  for (const Conditioning& c : conditioning_)
    if (std::find(ids.begin(), ids.end(), c.light) == ids.end()) ids.push_back(c.light);
  const auto has = [&](const std::string& id) { return std::find(ids.begin(), ids.end(), id) != ids.end(); };
  if (has(document_.selection().light)) light_ = document_.selection().light;
  if (!has(light_)) light_ = ids.empty() ? "" : ids.front();
  filling_ = true;
  while (lights_->count() > int(ids.size())) lights_->removeTab(lights_->count() - 1);
  while (lights_->count() < int(ids.size())) lights_->addTab(QString());
  for (int i = 0; i < int(ids.size()); ++i) {
    const std::string& id = ids[std::size_t(i)];
    Verdict worst = Verdict::Unknown;
    for (const Conditioning& c : conditioning_)
      if (c.light == id && c.worst() != Verdict::Unknown)
        worst = worst == Verdict::Unknown ? c.worst() : std::max(worst, c.worst());
    lights_->setTabText(i, menuText(QStringLiteral("%1 %2").arg(signOf(worst), nameText(id)).trimmed()));
    lights_->setTabToolTip(i, plainTip(tr("Models of %1; worst value: %2").arg(lightText(id), QLatin1String(nameOf(worst)))));
    lights_->setTabData(i, exactQString(id));
    if (id == light_) lights_->setCurrentIndex(i);
  }
  filling_ = false;
  lights_->setVisible(ids.size() > 1);
}

void ConditioningPanel::follow(const std::string& light) {
  const bool other = light != light_ && std::any_of(conditioning_.begin(), conditioning_.end(),
                                                    [&](const Conditioning& c) { return c.light == light; });
  if (!other) return explainWorst();
  light_ = light;
  dirty_ = true;
  refresh();
}

void ConditioningPanel::placeUnit(int row) {
  const auto title = titles_.find(row);
  if (title == titles_.end()) return;  // not built yet
  QString unit;
  bool same = true;
  for (const Shown& s : chips_) {
    if (s.row != row || s.chip->unit().isEmpty()) continue;
    same = same && (unit.isEmpty() || unit == s.chip->unit());
    unit = s.chip->unit();
  }
  const bool inChips = unit.isEmpty() || !same;
  for (const Shown& s : chips_)
    if (s.row == row) s.chip->setUnitShown(inChips);
  const QString name = tr(kRows[row].title);
  title->second->setText(inChips ? name : QStringLiteral("%1 (%2)").arg(name, unit));
}

void ConditioningPanel::explain(const Conditioning& c, const Finding& f) {
  const QString whose = toQString(lights_->count() > 1 ? c.model + ", " + c.light : c.model);
  reason_->setText(QStringLiteral("<b>%1, %2: %3</b><br>%4")
                       .arg(whose.toHtmlEscaped(), toQString(f.title), toQString(f.text).toHtmlEscaped(),
                            toQString(f.reason).toHtmlEscaped()));
}

void ConditioningPanel::explainWorst() {
  const std::string model = document_.plottedModel();
  const Conditioning* chosen = nullptr;
  for (const Conditioning& c : conditioning_)
    if (c.model == model && c.light == light_) chosen = &c;
  if (!chosen || chosen->findings.empty()) return;
  const Finding* worst = &chosen->findings.front();
  const auto rank = [](Verdict v) { return v == Verdict::Unknown ? -1 : int(v); };
  for (const Finding& f : chosen->findings)
    if (rank(f.verdict) > rank(worst->verdict)) worst = &f;
  explain(*chosen, *worst);
}

}  // namespace glint::gui
