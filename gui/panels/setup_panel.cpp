// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/setup_panel.h"

#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPushButton>
#include <QSignalBlocker>
#include <QVariant>
#include <algorithm>

#include "core/model/model.h"
#include "gui/base/complaint.h"
#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"

namespace glint::gui {

SetupPanel::SetupPanel(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* grid = new QGridLayout(this);
  grid->setContentsMargins(10, 3, 8, 3);
  grid->setVerticalSpacing(3);  // all of it is in sight in a window of 1500 x 940
  grid->setColumnStretch(1, 1);
  const auto label = [](const QString& text) {
    auto* l = new QLabel(text);
    l->setProperty("role", "group");
    return l;
  };
  models_ = new QListWidget;
  models_->setAccessibleName(tr("Models"));
  models_->setToolTip(tr("Models that are computed"));
  models_->setObjectName(QStringLiteral("models"));
  models_->setIconSize({11, 11});
  models_->setSelectionMode(QAbstractItemView::NoSelection);
  for (const auto& model : allModels()) {
    auto* item = new QListWidgetItem(colourSwatch(toQColor(draw::modelColour(model->id()))), toQString(model->id()), models_);
    item->setToolTip(QStringLiteral("<b>%1</b><br>%2<br>%3")
                         .arg(toQString(model->title()).toHtmlEscaped(), toQString(model->assumption()).toHtmlEscaped(),
                              toQString(model->reference()).toHtmlEscaped()));
    item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsUserCheckable);
    item->setCheckState(Qt::Checked);
  }
  models_->setVerticalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  models_->setFixedHeight(models_->sizeHintForRow(0) * models_->count() + 2 * models_->frameWidth() + 2);
  grid->addWidget(models_, 3, 0, 1, 2);

  auto* choose = new QPushButton(tr("Auto"));
  choose->setObjectName(QStringLiteral("autoModel"));
  choose->setToolTip(
      tr("Chooses the simplest model that predicts left-out training frames as well as the best one,\nor stops at the first "
         "model below the error entered beside"));
  auto* goodEnough = new NumberBox(numberRange(0, 100, 0.1));
  goodEnough->setObjectName(QStringLiteral("goodEnough"));
  goodEnough->setDecimals(2);
  goodEnough->setSuffix(tr(" % or less"));
  goodEnough->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);  // the panel is narrow
  goodEnough->setSpecialValueText(tr("best accuracy"));
  goodEnough->setAccessibleName(tr("Error that is good enough"));
  goodEnough->setToolTip(
      tr("Stop at the first model below this contour error; richer models are not tried. 0 = as accurate as the best model"));
  auto* row = new QHBoxLayout;
  row->setSpacing(4);
  row->addWidget(choose);
  row->addWidget(goodEnough, 1);
  grid->addLayout(row, 4, 0, 1, 2);
  choice_ = new QLabel;
  choice_->setObjectName(QStringLiteral("choice"));
  choice_->setProperty("role", "faded");
  choice_->setWordWrap(true);
  choice_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  choice_->hide();
  grid->addWidget(choice_, 5, 0, 1, 2);
  connect(choose, &QPushButton::clicked, this, [this, goodEnough] { emit autoRequested(goodEnough->value()); });

  train_ = new QComboBox;
  train_->setObjectName(QStringLiteral("train"));
  train_->setEditable(true);
  train_->setInsertPolicy(QComboBox::NoInsert);
  train_->addItems({QStringLiteral("first:6"), QStringLiteral("spread:6"), QStringLiteral("per-surface")});
  train_->setAccessibleName(tr("Frames to train on"));
  train_->setToolTip(
      tr("Frame numbers or ranges (0-5, or 0,14,28), first:N, spread:N, or per-surface: a separate model for each surface, "
         "trained on all of its frames"));
  auto* trainLabel = label(tr("Train on"));
  trainLabel->setBuddy(train_);
  grid->addWidget(trainLabel, 0, 0);  // what trains is in sight in a low dock, too
  grid->addWidget(train_, 0, 1);
  source_ = new QComboBox;
  source_->setObjectName(QStringLiteral("source"));
  source_->addItems({tr("radiance (float)"), tr("photographs")});
  source_->setAccessibleName(tr("Detect in"));
  source_->setToolTip(tr("Images in which highlights are detected, where a frame has both"));
  auto* sourceLabel = new QLabel(tr("Detect in"));
  sourceLabel->setBuddy(source_);
  grid->addWidget(sourceLabel, 6, 0);
  grid->addWidget(source_, 6, 1);
  counts_ = new QLabel;
  counts_->setProperty("role", "faded");
  counts_->setWordWrap(true);
  counts_->setObjectName(QStringLiteral("trainingCounts"));
  counts_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  grid->addWidget(counts_, 1, 0, 1, 2);
  grid->setRowStretch(7, 1);

  connect(models_, &QListWidget::itemChanged, this, [this] {
    std::vector<std::string> chosen;
    for (int i = 0; i < models_->count(); ++i)
      if (models_->item(i)->checkState() == Qt::Checked) chosen.push_back(models_->item(i)->text().toStdString());
    document_.setModels(chosen);
  });
  connect(train_, QOverload<int>::of(&QComboBox::activated), this, [this] { setTrain(); });
  connect(train_->lineEdit(), &QLineEdit::editingFinished, this, &SetupPanel::setTrain);
  connect(source_, QOverload<int>::of(&QComboBox::activated), this,
          [this](int i) { document_.setSource(i == 0 ? FrameSource::Radiance : FrameSource::Image); });
  connect(&document_, &Document::requestChanged, this, &SetupPanel::refresh);
  connect(&document_, &Document::sceneOpened, this, &SetupPanel::refresh);
  connect(&document_, &Document::sceneOpened, this, [this] { showChoice({}, {}); });
  refresh();
}

void SetupPanel::showChoice(const QString& sentence, const QString& details) {
  choice_->setText(sentence);
  setRichTip(choice_, details.isEmpty() ? QString() : QStringLiteral("<pre>%1</pre>").arg(details.toHtmlEscaped()));
  choice_->setVisible(!sentence.isEmpty());
}

void SetupPanel::setTrain() {
  const std::string text = train_->currentText().trimmed().toStdString();
  if (text == document_.request().train || !document_.scene()) return;
  QString error;
  const bool taken = document_.setTrain(text, &error);
  refresh();
  if (error.startsWith(QLatin1String("--train "))) error.remove(0, int(qstrlen("--train ")));  // here it is a box, not a flag
  if (!taken) complain(train_, tr("%1; keeping %2").arg(error, nameText(document_.request().train)));
}

void SetupPanel::refresh() {
  const InspectionRequest& request = document_.request();
  const QSignalBlocker quietModels(models_), quietTrain(train_), quietSource(source_);
  for (int i = 0; i < models_->count(); ++i) {
    const bool on = std::count(request.models.begin(), request.models.end(), models_->item(i)->text().toStdString()) > 0;
    models_->item(i)->setCheckState(on ? Qt::Checked : Qt::Unchecked);
  }
  train_->setEditText(toQString(request.train));
  source_->setCurrentIndex(request.source == FrameSource::Radiance ? 0 : 1);
  int count[3] = {0, 0, 0};
  for (int i = 0; i < document_.frameCount(); ++i) ++count[int(document_.role(i))];
  counts_->setText(document_.scene() ? tr("%1 training, %2 held out").arg(count[0]).arg(count[1]) +
                                           (count[2] ? tr(", %1 excluded").arg(count[2]) : QString())
                                     : QString());
  setEnabled(document_.scene() != nullptr);
}

}  // namespace glint::gui
