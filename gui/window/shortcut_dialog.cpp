// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/shortcut_dialog.h"

#include <QAction>
#include <QDialogButtonBox>
#include <QGuiApplication>
#include <QHeaderView>
#include <QKeySequenceEdit>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QPushButton>
#include <QScreen>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <vector>

#include "gui/window/palette.h"

namespace glint::gui {

ShortcutDialog::ShortcutDialog(Actions& actions, QWidget* parent)
    : QDialog(parent), actions_(actions), search_(new QLineEdit), list_(new QTreeWidget), note_(new QLabel) {
  setWindowTitle(tr("Keyboard shortcuts"));
  const QScreen* screen = parent ? parent->screen() : QGuiApplication::primaryScreen();
  resize(QSize(620, 640).boundedTo(screen->availableSize() - QSize(20, 60)));  // less the window's own frame
  auto* column = new QVBoxLayout(this);
  search_->setPlaceholderText(tr("Find an action"));
  search_->setAccessibleName(tr("Find an action"));
  list_->setAccessibleName(tr("Actions and their keys"));
  search_->setClearButtonEnabled(true);
  column->addWidget(search_);
  list_->setObjectName(QStringLiteral("shortcuts"));
  list_->setHeaderLabels({tr("Action"), tr("Key"), tr("Default")});
  list_->setRootIsDecorated(false);
  list_->header()->setStretchLastSection(false);
  list_->header()->setSectionResizeMode(0, QHeaderView::Stretch);
  list_->header()->setSectionResizeMode(1, QHeaderView::Fixed);
  list_->header()->resizeSection(1, 170);
  list_->header()->setSectionResizeMode(2, QHeaderView::ResizeToContents);
  column->addWidget(list_, 1);
  note_->setWordWrap(true);
  column->addWidget(note_);
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
  auto* reset = buttons->addButton(tr("Reset all"), QDialogButtonBox::ResetRole);
  reset->setObjectName(QStringLiteral("allShortcuts"));
  for (QAbstractButton* button : buttons->buttons())  // Enter in the search line presses none of them
    static_cast<QPushButton*>(button)->setAutoDefault(false);
  column->addWidget(buttons);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
  connect(reset, &QPushButton::clicked, this, &ShortcutDialog::resetAll);
  connect(search_, &QLineEdit::textChanged, this, &ShortcutDialog::filter);
  fill();
}

void ShortcutDialog::resetAll() {
  int own = 0;
  for (const QAction* action : actions_.all()) own += action->shortcuts() != Actions::defaultShortcuts(action);
  if (own == 0) return note_->setText(tr("All shortcuts are already the defaults."));
  const auto answer = QMessageBox::question(
      this, tr("Keyboard shortcuts"),
      own == 1 ? tr("Reset your custom shortcut of one action?") : tr("Reset your custom shortcuts of %1 actions?").arg(own),
      QMessageBox::Yes | QMessageBox::No, QMessageBox::No);
  if (answer != QMessageBox::Yes) return;
  for (QAction* action : actions_.all()) actions_.setShortcuts(action, Actions::defaultShortcuts(action));
  note_->clear();
  fill();
}

void ShortcutDialog::fill() {
  list_->clear();
  for (QAction* action : actions_.all()) {
    const QList<QKeySequence> usual = Actions::defaultShortcuts(action);
    auto* row = new QTreeWidgetItem(
        list_, {Actions::path(action), QString(), QKeySequence::listToString(usual, QKeySequence::NativeText)});
    auto* edit = new QKeySequenceEdit(action->shortcut());
    edit->setObjectName(QStringLiteral("key:") + Actions::id(action));
    list_->setItemWidget(row, 1, edit);
    connect(edit, &QKeySequenceEdit::editingFinished, this, [this, action, edit] {
      if (edit->keySequence() != action->shortcut()) setShortcut(action, edit->keySequence());
    });
  }
  filter();
}

void ShortcutDialog::filter() {
  // As the palette: letters that lie anywhere only where nothing else is found.
  std::vector<std::optional<PaletteMatch>> matches;
  for (int i = 0; i < list_->topLevelItemCount(); ++i)
    matches.push_back(matchOf(search_->text(), {list_->topLevelItem(i)->text(0), {}, {}, true, {}}));
  const auto scattered = [](const auto& m) { return m && m->way == PaletteMatch::Way::Scattered; };
  const bool better = std::any_of(matches.begin(), matches.end(), [&](const auto& m) { return m && !scattered(m); });
  for (int i = 0; i < list_->topLevelItemCount(); ++i) {
    const auto& match = matches[std::size_t(i)];
    list_->topLevelItem(i)->setHidden(!match || (better && scattered(match)));
  }
}

void ShortcutDialog::setShortcut(QAction* action, const QKeySequence& key) {
  note_->clear();
  for (QAction* other : actions_.all()) {
    if (other == action || key.isEmpty() || !other->shortcuts().contains(key)) continue;
    QList<QKeySequence> rest = other->shortcuts();
    rest.removeAll(key);
    actions_.setShortcuts(other, rest);
    note_->setText(tr("%1 was the shortcut of “%2”, which now has %3.")
                       .arg(key.toString(QKeySequence::NativeText), Actions::title(other),
                            rest.isEmpty() ? tr("none") : QKeySequence::listToString(rest, QKeySequence::NativeText)));
    if (auto* edit = list_->findChild<QKeySequenceEdit*>(QStringLiteral("key:") + Actions::id(other)))
      edit->setKeySequence(other->shortcut());
  }
  actions_.setShortcuts(action, key.isEmpty() ? QList<QKeySequence>() : QList<QKeySequence>{key});
}

}  // namespace glint::gui
