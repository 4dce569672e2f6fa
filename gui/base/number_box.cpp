// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/number_box.h"

#include <QHelpEvent>
#include <QLineEdit>
#include <QLocale>
#include <QSignalBlocker>
#include <QStyle>
#include <QStyleOptionSpinBox>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

#include "gui/base/complaint.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"
#include "gui/base/unit_text.h"

namespace glint::gui {

namespace {
constexpr double kManySteps = 2000;  // beyond this a linear slider cannot reach small values

constexpr int kMostCharacters = 8, kDigits = 5, kFewestDigits = 3, kAllDigits = 12;

QString fullText(double value) { return QString::number(value, 'g', kAllDigits); }

QString shortText(double value) {
  int digits = kDigits;
  QString text = QString::number(value, 'g', digits);
  while (text.size() > kMostCharacters && digits > kFewestDigits) text = QString::number(value, 'g', --digits);
  return text;
}

QString bare(QString text, const QString& suffix) {
  if (!suffix.isEmpty() && text.endsWith(suffix)) text.chop(suffix.size());
  return text.trimmed();
}
}  // namespace

NumberBox::NumberBox(const ParamSpec& spec, QWidget* parent) : QDoubleSpinBox(parent) {
  lineEdit()->installEventFilter(this);
  setLocale(QLocale::c());
  setKeyboardTracking(false);
  setFocusPolicy(Qt::StrongFocus);
  setDecimals(15);
  setRange(spec.min, spec.max);
  setSingleStep(spec.step);
  if ((spec.max - spec.min) / spec.step > kManySteps) setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
  setSuffix(unitAfter(spec.unit));
  whole_ = std::holds_alternative<int>(spec.defaultValue);
}

QString NumberBox::textFromValue(double value) const { return full_ ? fullText(value) : shortText(value); }

double NumberBox::valueFromText(const QString& text) const {
  const QString given = bare(text, suffix());
  if (given == specialValueText()) return minimum();
  return given == textFromValue(value()) ? value() : numberFromText(given).value_or(value());
}

QString NumberBox::problemOf(const QString& text) const {
  const QString given = bare(text, suffix());
  if (!specialValueText().isEmpty() && given == specialValueText()) return {};
  QString why;
  const std::optional<double> value = numberFromText(given, &why);
  if (!value) return given.isEmpty() ? tr("Enter a number") : why;
  if (!(*value >= minimum() && *value <= maximum()))
    return tr("%1 is outside %2 … %3").arg(given, fullText(minimum()), fullText(maximum()) + suffix());
  if (whole_ && *value != std::round(*value)) return tr("%1 is not a whole number").arg(given);
  return {};
}

QSize NumberBox::sizeHint() const {
  QSize size = QDoubleSpinBox::sizeHint();
  QStyleOptionSpinBox option;
  initStyleOption(&option);
  const int text = fontMetrics().horizontalAdvance(QString(kMostCharacters, QLatin1Char('8')) + suffix()) + 6;
  size.setWidth(style()->sizeFromContents(QStyle::CT_SpinBox, &option, {text, size.height()}, this).width());
  return size;
}

void NumberBox::setFull(bool full) {
  if (full == full_) return;
  full_ = full;
  const QSignalBlocker quiet(this);
  setSuffix(suffix());  // writes the text anew
}

bool NumberBox::event(QEvent* e) {
  if (e->type() != QEvent::ToolTip || shortText(value()) == fullText(value())) return QDoubleSpinBox::event(e);
  const QString exact = fullText(value()) + suffix();
  const QString more = hasRichTip(this) ? QStringLiteral("<br>") : QStringLiteral("\n");
  const QString all = toolTip().isEmpty() ? exact : toolTip() + more + exact;
  QToolTip::showText(static_cast<QHelpEvent*>(e)->globalPos(), hasRichTip(this) ? all : plainTip(all), this);
  return true;
}

/// A double click is to replace the number: Qt would mark the digits on one side of the point.
bool NumberBox::eventFilter(QObject* watched, QEvent* e) {
  if (watched != lineEdit() || e->type() != QEvent::MouseButtonDblClick) return QDoubleSpinBox::eventFilter(watched, e);
  selectAll();
  return true;
}

void NumberBox::focusInEvent(QFocusEvent* e) {
  setFull(true);
  QDoubleSpinBox::focusInEvent(e);
}

void NumberBox::focusOutEvent(QFocusEvent* e) {
  QDoubleSpinBox::focusOutEvent(e);  // takes what was typed
  setFull(false);
}

QValidator::State NumberBox::validate(QString& text, int&) const {
  // What is wrong may be on its way to a number ("1e-").
  return problemOf(text).isEmpty() ? QValidator::Acceptable : QValidator::Intermediate;
}

/// Qt asks for this when typing is finished and the text is not acceptable; it then puts the old value back.
void NumberBox::fixup(QString& text) const {
  if (const QString problem = problemOf(text); !problem.isEmpty())
    complain(const_cast<NumberBox*>(this), tr("%1; keeping %2").arg(problem, fullText(value()) + suffix()));
}

ParamSpec numberRange(double min, double max, double step) {
  ParamSpec spec;
  spec.defaultValue = min;
  spec.min = min;
  spec.max = max;
  spec.step = step;
  return spec;
}

ParamSpec wholeRange(int min, int max) {
  ParamSpec spec = numberRange(min, max, 1);
  spec.defaultValue = min;
  return spec;
}

SliderScale::SliderScale(const ParamSpec& spec)
    : min_(spec.min), max_(spec.max), step_(spec.step), logarithmic_((spec.max - spec.min) / spec.step > kManySteps) {}

int SliderScale::position(double value) const {
  const double t =
      logarithmic_ ? std::log1p((value - min_) / step_) / std::log1p((max_ - min_) / step_) : (value - min_) / (max_ - min_);
  return std::clamp(int(std::lround(t * kPositions)), 0, kPositions);
}

double SliderScale::value(int position) const {
  if (position <= 0) return min_;
  if (position >= kPositions) return max_;
  const double t = double(position) / kPositions;
  const double steps = logarithmic_ ? std::expm1(t * std::log1p((max_ - min_) / step_)) : t * (max_ - min_) / step_;
  return std::clamp(min_ + std::round(steps) * step_, min_, max_);
}

}  // namespace glint::gui
