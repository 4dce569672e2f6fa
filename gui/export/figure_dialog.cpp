// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/figure_dialog.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSettings>
#include <QSignalBlocker>
#include <algorithm>
#include <cmath>

#include "gui/base/number_box.h"
#include "gui/base/tips.h"

namespace glint::gui {

namespace {
constexpr int kLeastPx = 64, kMostPx = 16384;
constexpr int kScreenDpi = 96;  // of web pages and office programs where a picture says nothing
constexpr double kMmPerInch = 25.4;
constexpr double kSameShape = 0.01;  // of width over height: as much as a splitter moves by itself between two openings

struct Preset {
  const char* title;
  int width, height;  // px; width 0 = as on screen, `height` times; -1 = whatever is typed
  int dpi;
};
const Preset kPresets[] = {{QT_TRANSLATE_NOOP("glint::gui::FigureDialog", "As on screen"), 0, 1, kScreenDpi},
                           {QT_TRANSLATE_NOOP("glint::gui::FigureDialog", "Twice the screen size"), 0, 2, 2 * kScreenDpi},
                           {QT_TRANSLATE_NOOP("glint::gui::FigureDialog", "Slide, 1920 × 1080"), 1920, 1080, kScreenDpi},
                           {QT_TRANSLATE_NOOP("glint::gui::FigureDialog", "Screen, 3840 × 2160"), 3840, 2160, 2 * kScreenDpi},
                           {QT_TRANSLATE_NOOP("glint::gui::FigureDialog", "Paper column, 85 mm at 600 dpi"), 2008, 1506, 600},
                           {QT_TRANSLATE_NOOP("glint::gui::FigureDialog", "Custom"), -1, 0, 0}};
constexpr int kOther = 5;
}  // namespace

FigureDialog::FigureDialog(const QString& title, const QString& kind, const QSize& onScreen, QWidget* parent)
    : QDialog(parent), kind_(QStringLiteral("export/%1/").arg(kind)), onScreen_(onScreen) {
  setWindowTitle(title);
  setObjectName(QStringLiteral("figureDialog"));
  auto* form = new QFormLayout(this);
  preset_ = new QComboBox;
  for (const Preset& p : kPresets) preset_->addItem(tr(p.title));
  form->addRow(tr("&Size"), preset_);
  const auto pixels = [&](const char* name) {
    auto* box = new NumberBox(wholeRange(kLeastPx, kMostPx));
    box->setObjectName(QLatin1String(name));
    box->setSuffix(tr(" px"));
    box->setStepType(QAbstractSpinBox::DefaultStepType);
    return box;
  };
  width_ = pixels("figureWidth");
  height_ = pixels("figureHeight");
  keepShape_ = new QCheckBox(tr("Keep &proportions"));
  keepShape_->setObjectName(QStringLiteral("figureKeepShape"));
  keepShape_->setChecked(true);
  form->addRow(tr("&Width"), width_);
  form->addRow(tr("&Height"), height_);
  addPrinted(form);
  form->addRow(QString(), keepShape_);
  colours_ = new QComboBox;
  colours_->setObjectName(QStringLiteral("figureColours"));
  colours_->addItems({QString(), QString()});
  colours_->setCurrentIndex(QSettings().value(kind_ + QStringLiteral("dark"), false).toBool() ? 0 : 1);
  form->addRow(tr("&Colours"), colours_);
  transparent_ = new QCheckBox(tr("&Transparent background"));
  transparent_->setObjectName(QStringLiteral("figureTransparent"));
  form->addRow(QString(), transparent_);
  addCaption(form);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  buttons->button(QDialogButtonBox::Ok)->setText(tr("Choose file…"));
  form->addRow(buttons);
  connect(buttons, &QDialogButtonBox::accepted, this, &FigureDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &FigureDialog::reject);

  const QSettings settings;
  transparent_->setChecked(settings.value(kind_ + QStringLiteral("transparent"), false).toBool());
  followBackground();
  connect(transparent_, &QCheckBox::toggled, this, &FigureDialog::followBackground);
  dpi_->setValue(settings.value(kind_ + QStringLiteral("dpi"), kScreenDpi).toInt());
  const int preset = std::clamp(settings.value(kind_ + QStringLiteral("preset"), 0).toInt(), 0, kOther);
  if (preset == kOther) setSize(typedSizeFor(onScreen));
  preset_->setCurrentIndex(preset);
  choose(preset);
  connect(preset_, QOverload<int>::of(&QComboBox::activated), this, &FigureDialog::choose);
  connect(width_, QOverload<double>::of(&NumberBox::valueChanged), this, &FigureDialog::followWidth);
  connect(height_, QOverload<double>::of(&NumberBox::valueChanged), this, &FigureDialog::followHeight);
}

void FigureDialog::addPrinted(QFormLayout* form) {
  printed_ = new NumberBox(numberRange(1, 5000, 1));
  printed_->setObjectName(QStringLiteral("figurePrinted"));
  printed_->setDecimals(1);
  printed_->setSuffix(tr(" mm"));
  printed_->setToolTip(tr("How wide it is on paper, at the resolution below"));
  dpi_ = new NumberBox(wholeRange(36, 2400));
  dpi_->setObjectName(QStringLiteral("figureDpi"));
  dpi_->setSuffix(tr(" dpi"));
  dpi_->setToolTip(tr("Pixels per inch of paper; written into PNG files. Journals ask for 300 to 600"));
  form->addRow(tr("&Printed width"), printed_);
  form->addRow(tr("&Resolution"), dpi_);
  connect(printed_, QOverload<double>::of(&NumberBox::valueChanged), this,
          [this](double mm) { width_->setValue(std::lround(mm / kMmPerInch * dpi_->whole())); });
  connect(dpi_, QOverload<double>::of(&NumberBox::valueChanged), this, &FigureDialog::showPrinted);
}

void FigureDialog::addCaption(QFormLayout* form) {
  auto* row = new QHBoxLayout;
  caption_ = new QLineEdit;
  caption_->setObjectName(QStringLiteral("figureCaption"));
  caption_->setAccessibleName(tr("Caption"));
  caption_->setToolTip(
      tr("Stands below the figure, within its size, in lines as wide as it is. SVG keeps it as text and as description"));
  propose_ = new QPushButton(tr("Propose"));
  propose_->setObjectName(QStringLiteral("figureProposeCaption"));
  propose_->setAccessibleName(tr("Propose a caption"));
  propose_->setAutoDefault(false);  // Return goes on to the file
  propose_->hide();
  row->addWidget(caption_, 1);
  row->addWidget(propose_);
  auto* label = new QLabel(tr("C&aption"));
  label->setBuddy(caption_);
  form->addRow(label, row);
  connect(propose_, &QPushButton::clicked, this, [this] { caption_->setText(caption_->placeholderText()); });
}

void FigureDialog::proposeCaption(const QString& caption) {
  caption_->setPlaceholderText(caption);
  propose_->setToolTip(plainTip(caption));
  propose_->show();
}

void FigureDialog::setOpaque() {
  transparent_->setChecked(false);
  transparent_->hide();
}

/// The same pixels on paper.
void FigureDialog::showPrinted() {
  const QSignalBlocker quiet(printed_);
  printed_->setValue(width_->whole() * kMmPerInch / dpi_->whole());
}

/// The size that was typed last; for a picture of another shape as wide as that and of the picture's own shape.
QSize FigureDialog::typedSizeFor(const QSize& picture) const {
  const QSettings settings;
  const QSize typed = settings.value(kind_ + QStringLiteral("size"), picture).toSize();
  const QSize of = settings.value(kind_ + QStringLiteral("size-of")).toSize();
  const auto shape = [](const QSize& s) { return double(s.width()) / std::max(1, s.height()); };
  if (of.isValid() && std::abs(shape(of) / shape(picture) - 1) < kSameShape) return typed;
  return {typed.width(), int(std::lround(typed.width() / shape(picture)))};
}

void FigureDialog::choose(int preset) {
  const Preset& p = kPresets[preset];
  if (p.dpi > 0) dpi_->setValue(p.dpi);
  if (p.width == 0) setSize(onScreen_ * p.height);
  if (p.width > 0) setSize({p.width, p.height});
}

void FigureDialog::setSize(const QSize& size) {
  const QSignalBlocker quiet(width_), quietToo(height_);
  width_->setValue(size.width());
  height_->setValue(size.height());
  aspect_ = double(width_->whole()) / height_->whole();
  showPrinted();
}

void FigureDialog::followWidth() {
  preset_->setCurrentIndex(kOther);
  const QSignalBlocker quiet(height_);
  if (keepShape_->isChecked())
    height_->setValue(int(std::lround(width_->whole() / aspect_)));
  else
    aspect_ = double(width_->whole()) / height_->whole();
  showPrinted();
}

void FigureDialog::followHeight() {
  preset_->setCurrentIndex(kOther);
  const QSignalBlocker quiet(width_);
  if (keepShape_->isChecked())
    width_->setValue(int(std::lround(height_->whole() * aspect_)));
  else
    aspect_ = double(width_->whole()) / height_->whole();
  showPrinted();
}

/// A transparent figure lies on a page that the program does not know.
void FigureDialog::followBackground() {
  const bool page = transparent_->isChecked();
  colours_->setItemText(0, page ? tr("For a dark page") : tr("Dark"));
  colours_->setItemText(1, page ? tr("For a light page") : tr("Light"));
  colours_->setToolTip(page ? tr("Lines and text are drawn to be legible on such a page; bright ones vanish on white paper")
                            : QString());
}

FigureLook FigureDialog::look() const {
  return {{width_->whole(), height_->whole()},
          transparent_->isChecked(),
          colours_->currentIndex() == 0,
          dpi_->whole(),
          caption_->text()};
}

void FigureDialog::accept() {
  QSettings settings;
  settings.setValue(kind_ + QStringLiteral("transparent"), look().transparent);
  settings.setValue(kind_ + QStringLiteral("dark"), look().dark);
  settings.setValue(kind_ + QStringLiteral("preset"), preset_->currentIndex());
  settings.setValue(kind_ + QStringLiteral("size"), look().size);
  settings.setValue(kind_ + QStringLiteral("size-of"), onScreen_);
  settings.setValue(kind_ + QStringLiteral("dpi"), look().dpi);
  QDialog::accept();
}

}  // namespace glint::gui
