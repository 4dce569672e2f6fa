// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/start_page.h"

#include <QDir>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>
#include <QVariant>

#include "gui/base/text.h"
#include "gui/base/theme.h"

namespace glint::gui {

StartPage::StartPage(QWidget* parent) : QWidget(parent) {
  auto* outer = new QHBoxLayout(this);
  outer->addStretch(1);
  auto* column = new QVBoxLayout;
  column->setSpacing(10);
  outer->addLayout(column);
  outer->addStretch(1);
  column->addStretch(2);
  auto* title = new QLabel(tr("Glint inspector"));
  QFont large = title->font();
  large.setPointSizeF(large.pointSizeF() * 1.8);
  title->setFont(large);
  column->addWidget(title);
  auto* text =
      new QLabel(tr("Open a scene to see its surface, cameras and highlights, the ellipsoids reconstructed from them,\n"
                    "and the predicted and observed highlights in every frame.\n\n"
                    "A scene is a scene.json, a session (*.glint), a capture of COLMAP, nerfstudio or another program,\n"
                    "or a folder containing one. You can also drop it on this window."));
  text->setProperty("role", "faded");
  column->addWidget(text);
  auto* buttons = new QHBoxLayout;
  auto* file = new QPushButton(icon(QStringLiteral("open")), tr("Open scene or session…"));
  auto* folder = new QPushButton(tr("Open folder…"));
  connect(file, &QPushButton::clicked, this, &StartPage::openFile);
  connect(folder, &QPushButton::clicked, this, &StartPage::openFolder);
  buttons->addWidget(file);
  buttons->addWidget(folder);
  buttons->addStretch(1);
  column->addLayout(buttons);
  column->addSpacing(12);
  lessons_ = new QVBoxLayout;
  lessons_->setSpacing(2);
  column->addLayout(lessons_);
  column->addSpacing(6);
  recent_ = new QVBoxLayout;
  recent_->setSpacing(2);
  column->addLayout(recent_);
  column->addStretch(3);
}

void StartPage::addLesson(const QString& title, const QString& file) {
  if (lessons_->isEmpty()) {
    auto* heading = new QLabel(tr("Lessons"));
    heading->setProperty("role", "group");
    lessons_->addWidget(heading);
  }
  auto* link = new QLabel(
      QStringLiteral("%1 &nbsp;<a href='%2'>%3</a>").arg(lessons_->count()).arg(file.toHtmlEscaped(), title.toHtmlEscaped()));
  link->setTextFormat(Qt::RichText);
  connect(link, &QLabel::linkActivated, this, &StartPage::openRecent);
  lessons_->addWidget(link);
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
  for (int i = 0; i < files.size(); ++i) {
    const QString& file = files[i];
    const QFileInfo info(file);
    auto* link = new QLabel(QStringLiteral("<a href='%1'>%2</a> &nbsp;<span style='color:%3'>%4</span>")
                                .arg(QString::number(i), shownText(info.dir().dirName() + '/' + info.fileName()).toHtmlEscaped(),
                                     palette().color(QPalette::PlaceholderText).name(),
                                     shownText(QDir::toNativeSeparators(info.path())).toHtmlEscaped()));
    link->setTextFormat(Qt::RichText);
    connect(link, &QLabel::linkActivated, this,
            [this, file] { emit openRecent(file); });  // a link's target is decoded: not as it was
    recent_->addWidget(link);
  }
}

}  // namespace glint::gui
