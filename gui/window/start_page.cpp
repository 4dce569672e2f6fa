// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/start_page.h"

#include <QDir>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLabel>
#include <QPainter>
#include <QPushButton>
#include <QVBoxLayout>
#include <QVariant>
#include <cstdlib>
#include <utility>

#include "gui/base/flow_layout.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/explain/lessons.h"

static void initTileResource() { Q_INIT_RESOURCE(tiles); }

namespace glint::gui {

namespace {
constexpr QSize kPicture(176, 110);  // px: six in a row of a window as wide as a usual screen
constexpr int kBorder = 6;           // px around a tile's picture
constexpr int kTitleLines = 3;       // of the longest title of a lesson
}  // namespace

Tile::Tile(const QString& title, const QString& picture, QWidget* parent) : QAbstractButton(parent) {
  initTileResource();
  setText(title);
  setAccessibleName(title);
  setToolTip(title);
  setFocusPolicy(Qt::StrongFocus);
  setCursor(Qt::PointingHandCursor);
  setAttribute(Qt::WA_Hover);
  if (!picture.isEmpty()) picture_.load(QStringLiteral(":/tiles/%1.png").arg(picture));
}

QSize Tile::sizeHint() const {
  return {kPicture.width() + 2 * kBorder, kPicture.height() + 3 * kBorder + kTitleLines * fontMetrics().lineSpacing()};
}

void Tile::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  painter.setRenderHints(QPainter::Antialiasing | QPainter::SmoothPixmapTransform);
  const QRect all = rect().adjusted(1, 1, -2, -2);
  painter.setPen(hasFocus() ? QPen(focusColour(), 3) : QPen(palette().color(QPalette::Mid), 1));
  painter.setBrush(palette().color(underMouse() || isDown() ? QPalette::AlternateBase : QPalette::Base));
  painter.drawRoundedRect(all, 4, 4);
  const QRect place(kBorder, kBorder, width() - 2 * kBorder, kPicture.height());
  if (!picture_.isNull()) {
    const QSize size = picture_.size().scaled(place.size(), Qt::KeepAspectRatio);
    painter.drawPixmap(QRect(place.center() - QPoint(size.width() / 2, size.height() / 2), size), picture_);
  }
  painter.setPen(palette().color(QPalette::Text));
  const QRect words(kBorder, place.bottom() + kBorder, width() - 2 * kBorder, kTitleLines * fontMetrics().lineSpacing());
  painter.drawText(words, int(Qt::AlignLeft | Qt::AlignTop | Qt::TextWordWrap), text());
}

void Tile::keyPressEvent(QKeyEvent* e) {
  if (e->key() == Qt::Key_Return || e->key() == Qt::Key_Enter) return click();
  QAbstractButton::keyPressEvent(e);
}

StartPage::StartPage(QWidget* parent) : QWidget(parent) {
  auto* outer = new QHBoxLayout(this);
  outer->setContentsMargins(32, 16, 32, 16);
  auto* column = new QVBoxLayout;
  column->setSpacing(10);
  outer->addLayout(column, 1);
  auto* title = new QLabel(tr("Glint inspector"));
  QFont large = title->font();
  large.setPointSizeF(large.pointSizeF() * 1.8);
  title->setFont(large);
  column->addWidget(title);
  auto* what = new QLabel(tr("Finds highlights in photographs, explains them, and predicts new ones."));
  what->setObjectName(QStringLiteral("start.what"));
  column->addWidget(what);
  auto* buttons = new QHBoxLayout;
  auto* file = new QPushButton(icon(QStringLiteral("open")), tr("Open scene or session…"));
  auto* folder = new QPushButton(tr("Open folder…"));
  connect(file, &QPushButton::clicked, this, &StartPage::openFile);
  connect(folder, &QPushButton::clicked, this, &StartPage::openFolder);
  for (QPushButton* button : {file, folder}) {
    button->setAutoDefault(true);  // Enter presses it
    buttons->addWidget(button);
  }
  auto* text =
      new QLabel(tr("A scene.json, a session (*.glint), a capture of COLMAP, nerfstudio or another program, or a folder "
                    "containing one. You can also drop it on this window."));
  text->setProperty("role", "faded");
  text->setWordWrap(true);
  buttons->addWidget(text, 1);
  column->addLayout(buttons);
  for (QVBoxLayout** part : {&lessons_, &examples_, &recent_}) {
    *part = new QVBoxLayout;
    (*part)->setSpacing(4);
    column->addLayout(*part);
  }
  column->addStretch(1);
}

void StartPage::addTile(QVBoxLayout* column, FlowLayout*& row, const QString& heading, const QString& title, const QString& file,
                        const QString& picture) {
  if (!row) {
    auto* label = new QLabel(heading);
    label->setProperty("role", "group");
    column->addWidget(label);
    auto* tiles = new QWidget;
    row = new FlowLayout(8);
    tiles->setLayout(row);
    column->addWidget(tiles);
  }
  auto* tile = new Tile(title, picture);
  tile->installEventFilter(this);
  connect(tile, &Tile::clicked, this, [this, file] { emit openRecent(file); });
  row->addWidget(tile);
}

void StartPage::addLesson(const QString& title, const QString& file, const QString& picture) {
  addTile(lessons_, lessonTiles_, tr("Lessons"), title, file, picture);
}

void StartPage::addExample(const QString& title, const QString& file, const QString& picture) {
  addTile(examples_, exampleTiles_, tr("Sessions to look at"), title, file, picture);
}

void StartPage::setRecent(const QStringList& files) {
  while (QLayoutItem* item = recent_->takeAt(0)) {
    if (item->widget()) item->widget()->deleteLater();
    delete item;
  }
  if (files.isEmpty()) return;
  auto* heading = new QLabel(tr("Recent"));
  heading->setProperty("role", "group");
  recent_->addWidget(heading);
  for (const QString& file : files) {
    const QFileInfo info(file);
    const QString name = info.dir().dirName() + '/' + info.fileName();
    auto* button = new QPushButton(menuText(shownText(name + QStringLiteral("   –   ") + QDir::toNativeSeparators(info.path()))));
    button->setFlat(true);
    button->setAutoDefault(true);
    button->setStyleSheet(QStringLiteral("text-align: left"));
    button->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);  // a long path must not widen the page
    button->setToolTip(shownText(QDir::toNativeSeparators(file)));
    button->installEventFilter(this);
    connect(button, &QPushButton::clicked, this, [this, file] { emit openRecent(file); });
    recent_->addWidget(button);
  }
}

/// The arrow keys: left and right to the neighbour, up and down to what lies nearest there.
bool StartPage::eventFilter(QObject* watched, QEvent* event) {
  auto* from = qobject_cast<QWidget*>(watched);
  if (!from || event->type() != QEvent::KeyPress) return QWidget::eventFilter(watched, event);
  const int key = static_cast<QKeyEvent*>(event)->key();
  const QPoint by = key == Qt::Key_Left    ? QPoint(-1, 0)
                    : key == Qt::Key_Right ? QPoint(1, 0)
                    : key == Qt::Key_Up    ? QPoint(0, -1)
                    : key == Qt::Key_Down  ? QPoint(0, 1)
                                           : QPoint();
  if (by.isNull()) return QWidget::eventFilter(watched, event);
  const auto middle = [this](const QWidget* w) { return w->mapTo(this, w->rect().center()); };
  const QPoint here = middle(from);
  QWidget* nearest = nullptr;
  double least = 0;
  for (auto* to : findChildren<QAbstractButton*>()) {
    const QPoint way = middle(to) - here;
    const int along = QPoint::dotProduct(way, by), aside = std::abs(way.x() * by.y()) + std::abs(way.y() * by.x());
    if (to == from || along <= 0 || !to->isVisible() || (by.x() != 0 && aside > to->height() / 2)) continue;
    const double far = along + 0.5 * aside;
    if (nearest && far >= least) continue;
    nearest = to;
    least = far;
  }
  if (nearest) nearest->setFocus(Qt::TabFocusReason);
  return true;
}

void fillStartPage(StartPage& page) {
  for (const Lesson& lesson : lessons())
    if (const QString file = lessonFile(lesson.id); !file.isEmpty())
      page.addLesson(QStringLiteral("%1  %2").arg(lessons().indexOf(lesson)).arg(lesson.title), file,
                     QStringLiteral("lesson-") + lesson.id);
  for (const auto& [id, title] :
       {std::pair("plane", StartPage::tr("A flat sheet")), std::pair("plane-to-cylinder", StartPage::tr("A sheet that is bent")),
        std::pair("ellipsoid", StartPage::tr("An ellipsoid")), std::pair("two-lamps", StartPage::tr("Two lamps")),
        std::pair("vase", StartPage::tr("A vase"))})
    if (const QString file = sessionFile(QLatin1String(id)); !file.isEmpty()) page.addExample(title, file, QLatin1String(id));
}

}  // namespace glint::gui
