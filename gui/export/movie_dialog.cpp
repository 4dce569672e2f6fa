// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/movie_dialog.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>
#include <QSettings>
#include <algorithm>
#include <cmath>

#include "gui/base/number_box.h"

namespace glint::gui {

namespace {
constexpr double kFramesASecond = 5, kTurnPicturesASecond = 25;  // as `glint movie`
const QSize kSizes[] = {{1280, 720}, {1920, 1080}, {1024, 768}, {720, 720}};
constexpr int kOther = 4;
}  // namespace

MovieDialog::MovieDialog(MovieOf of, int frames, bool dark, QWidget* parent) : QDialog(parent), sceneFrames_(frames) {
  setWindowTitle(tr("Movie"));
  setObjectName(QStringLiteral("movieDialog"));
  auto* form = new QFormLayout(this);
  of_ = new QComboBox;
  of_->setObjectName(QStringLiteral("movieOf"));
  of_->addItems({tr("Timeline: frames with contours and errors"), tr("Timeline: scene through each frame's camera"),
                 tr("Turntable: one turn of the 3D view")});
  of_->setCurrentIndex(int(of));
  form->addRow(tr("&Shows"), of_);
  size_ = new QComboBox;
  for (const QSize& s : kSizes) size_->addItem(QStringLiteral("%1 × %2").arg(s.width()).arg(s.height()));
  size_->addItem(tr("Custom"));
  form->addRow(tr("S&ize"), size_);
  const auto pixels = [&](const char* name) {
    auto* box = new NumberBox(wholeRange(64, 8192));
    box->setObjectName(QLatin1String(name));
    box->setStepType(QAbstractSpinBox::DefaultStepType);
    box->setSingleStep(2);
    box->setSuffix(tr(" px"));
    return box;
  };
  width_ = pixels("movieWidth");
  height_ = pixels("movieHeight");
  form->addRow(tr("&Width"), width_);
  form->addRow(tr("&Height"), height_);
  rate_ = new NumberBox(numberRange(0.1, 120, 1));
  rate_->setObjectName(QStringLiteral("movieRate"));
  form->addRow(tr("&Pictures per second"), rate_);
  seconds_ = new NumberBox(numberRange(0.2, 600, 1));
  seconds_->setObjectName(QStringLiteral("movieSeconds"));
  seconds_->setSuffix(tr(" s"));
  form->addRow(tr("Time per &turn"), seconds_);
  colours_ = new QComboBox;
  colours_->addItems({tr("Dark"), tr("Light")});
  colours_->setCurrentIndex(dark ? 0 : 1);
  form->addRow(tr("&Colours"), colours_);
  length_ = new QLabel;
  length_->setProperty("role", "faded");
  form->addRow(QString(), length_);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  buttons->button(QDialogButtonBox::Ok)->setText(tr("Choose file…"));
  form->addRow(buttons);
  connect(buttons, &QDialogButtonBox::accepted, this, &MovieDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &MovieDialog::reject);

  const QSettings settings;
  const QSize size = settings.value(QStringLiteral("export/movie/size"), kSizes[0]).toSize();
  width_->setValue(size.width());
  height_->setValue(size.height());
  seconds_->setValue(settings.value(QStringLiteral("export/movie/seconds"), 8.0).toDouble());
  const auto showSize = [this] {
    int at = kOther;
    for (int i = 0; i < kOther; ++i)
      if (kSizes[i] == QSize(width_->whole(), height_->whole())) at = i;
    size_->setCurrentIndex(at);
  };
  showSize();
  connect(size_, QOverload<int>::of(&QComboBox::activated), this, [this](int at) {
    if (at == kOther) return;
    width_->setValue(kSizes[at].width());
    height_->setValue(kSizes[at].height());
  });
  for (NumberBox* box : {width_, height_}) connect(box, QOverload<double>::of(&NumberBox::valueChanged), this, showSize);
  for (NumberBox* box : {rate_, seconds_})
    connect(box, QOverload<double>::of(&NumberBox::valueChanged), this, &MovieDialog::showLength);
  connect(of_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &MovieDialog::showKind);
  showKind();
}

void MovieDialog::showKind() {
  const bool turning = of_->currentIndex() == int(MovieOf::Turntable);
  rate_->setValue(turning ? kTurnPicturesASecond : kFramesASecond);
  seconds_->setEnabled(turning);
  showLength();
}

void MovieDialog::showLength() {
  const MovieLook l = look();
  length_->setText(tr("%1 pictures, %2 s").arg(l.frames).arg(l.frames / l.format.framesPerSecond, 0, 'f', 1));
}

MovieLook MovieDialog::look() const {
  MovieLook look;
  look.of = MovieOf(of_->currentIndex());
  look.format = {width_->whole(), height_->whole(), rate_->value()};
  look.frames = look.of == MovieOf::Turntable ? std::max(2, int(std::lround(seconds_->value() * rate_->value()))) : sceneFrames_;
  look.dark = colours_->currentIndex() == 0;
  return look;
}

void MovieDialog::accept() {
  QSettings settings;
  settings.setValue(QStringLiteral("export/movie/size"), QSize(width_->whole(), height_->whole()));
  settings.setValue(QStringLiteral("export/movie/seconds"), seconds_->value());
  QDialog::accept();
}

}  // namespace glint::gui
