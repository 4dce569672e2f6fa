// SPDX-License-Identifier: BSD-3-Clause
#include "gui/lamps/ball_controls.h"

#include <QComboBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QKeySequence>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QPushButton>
#include <QVBoxLayout>

#include "core/base/number_text.h"
#include "core/scene/input_choices.h"
#include "gui/base/complaint.h"
#include "gui/base/number_box.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {

constexpr double kFarthestPx = 1e6;  // an outline may begin beside its photograph
constexpr double kStepPx = 0.5;      // of a field's arrows: what a person can see
constexpr int kListLines = 4;        // of the list of balls; two are usual

NumberBox* pixelBox(double least, const QString& name, const QString& accessible) {
  ParamSpec spec = numberRange(least, kFarthestPx, kStepPx);
  spec.unit = "px";
  auto* box = new NumberBox(spec);
  box->setObjectName(name);
  box->setAccessibleName(accessible);
  return box;
}

QString keyText(QKeySequence::StandardKey key) { return QKeySequence(key).toString(QKeySequence::NativeText); }

QPushButton* toggle(const QString& text, const char* name, const QString& tip) {
  auto* b = new QPushButton(text);
  b->setObjectName(QLatin1String(name));
  b->setCheckable(true);
  b->setToolTip(tip);
  return b;
}

}  // namespace

BallControls::BallControls(BallOutlines& outlines, QWidget* parent) : QWidget(parent), outlines_(outlines) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 4, 6, 4);
  auto* form = new QFormLayout;
  form->setRowWrapPolicy(QFormLayout::WrapLongRows);
  buildBalls(form);
  buildCamera(form);
  column->addLayout(form);
  auto* copy = new QPushButton(tr("Copy as command"));
  copy->setObjectName(QStringLiteral("copyLightsCommand"));
  copy->setToolTip(tr("The command line that measures the same"));
  connect(copy, &QPushButton::clicked, this, &BallControls::copyRequested);
  column->addWidget(copy);
  column->addStretch(1);
  connect(&outlines_, &BallOutlines::changed, this, &BallControls::refresh);
  refresh();
}

void BallControls::buildBalls(QFormLayout* form) {
  middle_ = toggle(tr("From the middle"), "drawFromMiddle", tr("Draw an outline: press on the ball's middle, drag to its rim"));
  rim_ = toggle(tr("Through the rim"), "drawThroughRim",
                tr("Draw an outline: click three points of the ball's rim, far apart from each other"));
  auto* add = new QPushButton(tr("Add"));
  add->setObjectName(QStringLiteral("addBall"));
  add->setToolTip(tr("Adds an outline in the middle of the photograph, to be placed by the numbers below or the mouse"));
  remove_ = new QPushButton(tr("Remove"));
  remove_->setObjectName(QStringLiteral("removeBall"));
  undo_ = new QPushButton(tr("Undo"));
  undo_->setObjectName(QStringLiteral("undoOutline"));
  undo_->setToolTip(tr("Takes back the last change of an outline (%1)").arg(keyText(QKeySequence::Undo)));
  redo_ = new QPushButton(tr("Redo"));
  redo_->setObjectName(QStringLiteral("redoOutline"));
  redo_->setToolTip(tr("Makes the change again (%1)").arg(keyText(QKeySequence::Redo)));
  connect(undo_, &QPushButton::clicked, &outlines_, &BallOutlines::undo);
  connect(redo_, &QPushButton::clicked, &outlines_, &BallOutlines::redo);
  for (const auto& [button, drawing] :
       {std::pair(middle_, BallOutlines::Drawing::FromMiddle), std::pair(rim_, BallOutlines::Drawing::ThroughRim)})
    connect(button, &QPushButton::clicked, this, [this, drawing = drawing](bool on) {
      outlines_.setDrawing(on ? drawing : BallOutlines::Drawing::Nothing);
      refresh();
    });
  connect(add, &QPushButton::clicked, this, [this] {
    outlines_.setDrawing(BallOutlines::Drawing::Nothing);
    outlines_.add({0.5 * Eigen::Vector2d(size_.width() - 1, size_.height() - 1), 0.25 * std::min(size_.width(), size_.height())});
  });
  connect(remove_, &QPushButton::clicked, this, [this] { outlines_.remove(outlines_.selected()); });
  auto* draw = new QHBoxLayout;
  for (QWidget* w : std::initializer_list<QWidget*>{middle_, rim_}) draw->addWidget(w);
  form->addRow(tr("Draw"), draw);
  hint_ = new QLabel;
  hint_->setObjectName(QStringLiteral("drawHint"));
  hint_->setProperty("role", "faded");
  hint_->setWordWrap(true);
  form->addRow(hint_);
  list_ = new QListWidget;
  list_->setObjectName(QStringLiteral("ballList"));
  list_->setAccessibleName(tr("Balls"));
  list_->setFixedHeight(kListLines * (fontMetrics().height() + 4));
  connect(list_, &QListWidget::currentRowChanged, this, [this](int row) {
    if (!refreshing_) outlines_.select(row);
  });
  form->addRow(tr("Balls"), list_);
  auto* change = new QHBoxLayout;
  for (QWidget* w : std::initializer_list<QWidget*>{add, remove_}) change->addWidget(w);
  form->addRow(QString(), change);
  auto* steps = new QHBoxLayout;  // a row of their own: four in one are wider than the column
  for (QWidget* w : std::initializer_list<QWidget*>{undo_, redo_}) steps->addWidget(w);
  form->addRow(QString(), steps);
  const QString names[] = {tr("Centre x"), tr("Centre y"), tr("Radius")};
  const char* const ids[] = {"ballX", "ballY", "ballRadiusPx"};
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    numbers_[i] = pixelBox(i == 2 ? BallOutlines::kLeastRadius : -kFarthestPx, QLatin1String(ids[i]), names[i]);
    connect(numbers_[i], QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, &BallControls::takeNumbers);
    form->addRow(names[i], numbers_[i]);
  }
  buildCutOuts(form);
}

void BallControls::buildCutOuts(QFormLayout* form) {
  folder_ = new QComboBox;
  folder_->setObjectName(QStringLiteral("ballFolder"));
  folder_->setAccessibleName(tr("Photographs"));
  folder_->setToolTip(
      tr("Shots that were cut into one folder for each ball: which cut-outs are shown, and get the next outline"));
  connect(folder_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this] {
    if (!refreshing_) outlines_.setFolder(folder_->currentData().toString());
  });
  cutOuts_ = new QWidget;
  auto* cut = new QFormLayout(cutOuts_);
  cut->setContentsMargins(0, 0, 0, 0);
  cut->addRow(tr("Photographs"), folder_);
  const QString corners[] = {tr("Corner x in the shot"), tr("Corner y in the shot")};
  for (std::size_t i = 0; i < corner_.size(); ++i) {
    corner_[i] = pixelBox(-kFarthestPx, QLatin1String(i == 0 ? "cornerX" : "cornerY"), corners[i]);
    corner_[i]->setToolTip(tr("Where the first pixel of these cut-outs lies in the whole shot"));
    connect(corner_[i], QOverload<double>::of(&QDoubleSpinBox::valueChanged), this, &BallControls::takeNumbers);
    cut->addRow(corners[i], corner_[i]);
  }
  form->addRow(cutOuts_);
}

void BallControls::buildCamera(QFormLayout* form) {
  camera_ = new QLineEdit;
  camera_->setObjectName(QStringLiteral("ballCamera"));
  camera_->setPlaceholderText(tr("not known"));
  camera_->setToolTip(tr(
      "fx,fy,cx,cy[,k1,k2,p1,p2[,k3]] in pixels of the shot, (0, 0) the centre of its first pixel.\nEmpty: the focal length that "
      "EXIF data of whole shots say, else a distant camera; directions only"));
  radius_ = new QLineEdit;
  radius_->setObjectName(QStringLiteral("ballRadius"));
  radius_->setPlaceholderText(tr("not known: lengths in radii"));
  radius_->setToolTip(tr("Radius of every ball in metres, for positions in metres"));
  outlineChoice_ = new QComboBox;
  outlineChoice_->setObjectName(QStringLiteral("ballOutlines"));
  for (const auto& [words, id] : {std::pair(tr("refined: edges and highlights"), "fitted"),
                                  std::pair(tr("refined: edges alone"), "edges"), std::pair(tr("as drawn"), "given")})
    outlineChoice_->addItem(words, QLatin1String(id));
  for (QLineEdit* line : {camera_, radius_}) connect(line, &QLineEdit::textChanged, this, &BallControls::questionChanged);
  connect(outlineChoice_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &BallControls::questionChanged);
  form->addRow(tr("Camera (px)"), camera_);
  form->addRow(tr("Ball radius (m)"), radius_);
  form->addRow(tr("Outlines"), outlineChoice_);
  for (const auto& [widget, name] : {std::pair<QWidget*, QString>(camera_, tr("Camera, pixels")),
                                     std::pair<QWidget*, QString>(radius_, tr("Ball radius, metres")),
                                     std::pair<QWidget*, QString>(outlineChoice_, tr("Outlines"))})
    widget->setAccessibleName(name);
}

void BallControls::setFolders(const QStringList& folders) {
  refreshing_ = true;
  folder_->clear();
  for (const QString& folder : folders) folder_->addItem(folder.isEmpty() ? tr("(whole shots)") : shownText(folder), folder);
  refreshing_ = false;
  cutOuts_->setVisible(folders.size() > 1 || !folders.value(0).isEmpty());
  refresh();
}

void BallControls::refresh() {
  refreshing_ = true;
  using Drawing = BallOutlines::Drawing;
  middle_->setChecked(outlines_.drawing() == Drawing::FromMiddle);
  rim_->setChecked(outlines_.drawing() == Drawing::ThroughRim);
  hint_->setText(outlines_.drawing() == Drawing::FromMiddle ? tr("Press on a ball's middle and drag to its rim.")
                 : outlines_.drawing() == Drawing::ThroughRim
                     ? tr("Click three points of a ball's rim: %1 of 3.").arg(outlines_.rim().size())
                     : tr("Drag an outline's middle or rim. Photographs are refined from there."));
  const auto& balls = outlines_.balls();
  while (list_->count() > int(balls.size())) delete list_->takeItem(list_->count() - 1);
  while (list_->count() < int(balls.size())) list_->addItem(QString());
  for (int k = 0; k < int(balls.size()); ++k) {
    const BallOutlines::Ball& ball = balls[std::size_t(k)];
    QString text = tr("%1: %2, %3, r %4")
                       .arg(k + 1)
                       .arg(numberText(ball.outline.centre.x(), 5), numberText(ball.outline.centre.y(), 5),
                            numberText(ball.outline.radius, 5));
    list_->item(k)->setToolTip(ball.folder.isEmpty() ? text : tr("%1 in %2").arg(text, shownText(ball.folder)));
    list_->item(k)->setText(text);
  }
  const int at = outlines_.selected();
  list_->setCurrentRow(at);
  remove_->setEnabled(at >= 0);
  undo_->setEnabled(outlines_.canUndo());
  redo_->setEnabled(outlines_.canRedo());
  const BallOutline shown = at >= 0 ? balls[std::size_t(at)].outline : BallOutline{};
  const double values[] = {shown.centre.x(), shown.centre.y(), shown.radius};
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    numbers_[i]->setEnabled(at >= 0);
    if (at >= 0) numbers_[i]->setValue(values[i]);
  }
  folder_->setCurrentIndex(std::max(0, folder_->findData(outlines_.folder())));
  const Eigen::Vector2d corner = outlines_.cornerOf(outlines_.folder());
  for (std::size_t i = 0; i < corner_.size(); ++i) corner_[i]->setValue(corner(Eigen::Index(i)));
  refreshing_ = false;
}

void BallControls::takeNumbers() {
  if (refreshing_) return;
  if (outlines_.selected() >= 0)
    outlines_.set(outlines_.selected(), {{numbers_[0]->value(), numbers_[1]->value()}, numbers_[2]->value()});
  outlines_.setCorner(outlines_.folder(), {corner_[0]->value(), corner_[1]->value()});
}

void BallControls::show(const BallQuestion& q) {
  camera_->setText(q.camera ? toQString(cameraText(*q.camera)) : QString());
  radius_->setText(q.ballRadius ? toQString(shortestText(*q.ballRadius)) : QString());
  outlineChoice_->setCurrentIndex(outlineChoice_->findData(QLatin1String(toText(q.outlines))));
}

/// A user who reads why the field is wrong can correct it at once. @return the whole sentence
QString BallControls::refused(QLineEdit* field, const QString& why) {
  complain(field, why);
  field->setFocus();
  field->selectAll();
  return tr("%1: %2").arg(field->accessibleName(), why);
}

QString BallControls::fill(BallQuestion& question) {
  question.camera.reset();
  question.ballRadius.reset();
  question.outlines = glint::outlinesOf(outlineChoice_->currentData().toString().toStdString());
  if (const QString text = camera_->text().trimmed(); !text.isEmpty()) {
    try {
      question.camera = cameraOfNumbers(cameraNumbers(QString(text).remove(QLatin1Char(' ')).toStdString(), ""));
    } catch (const InputError& e) {
      return refused(camera_, toQString(e.what()));
    }
  }
  if (const QString text = radius_->text().trimmed(); !text.isEmpty()) {
    QString why;
    const std::optional<double> radius = numberFromText(text, &why);
    if (!radius || !(*radius > 0)) {
      return refused(radius_, radius ? tr("must be above 0") : why);
    }
    question.ballRadius = radius;
  }
  return {};
}

}  // namespace glint::gui
