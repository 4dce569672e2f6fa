// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/palette.h"

#include <QAction>
#include <QApplication>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLineEdit>
#include <QRegularExpression>
#include <QScrollBar>
#include <QTreeWidget>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

namespace glint::gui {

namespace {
constexpr int kWidth = 700, kRows = 14, kMost = 200;
constexpr int kCellEdges = 12;  // px, left and right of a cell's text

/// 3 at the start of a word, 2 inside one, 1 for letters in order with others between, 0 for none.
int wordScore(const QString& word, const QString& text) {
  for (int at = text.indexOf(word); at >= 0; at = text.indexOf(word, at + 1))
    if (at == 0 || !text[at - 1].isLetterOrNumber()) return 3;
  if (text.contains(word)) return 2;
  int from = 0;
  for (const QChar c : word) {
    from = text.indexOf(c, from) + 1;
    if (from == 0) return 0;
  }
  return word.size() > 2 ? 1 : 0;  // one or two letters are in everything
}

/// Words that people type for ours.
QString ours(const QString& word) {
  static const std::pair<const char*, const char*> kSpellings[] = {{"color", "colour"},     {"gray", "grey"},
                                                                   {"center", "centre"},    {"image", "picture"},
                                                                   {"photo", "photograph"}, {"axis", "axes"}};
  for (const auto& [theirs, us] : kSpellings)
    if (word.startsWith(QLatin1String(theirs))) return QLatin1String(us) + word.mid(int(qstrlen(theirs)));
  return word;
}

QStringList wordsOf(const QString& typed) {
  static const QRegularExpression blanks(QStringLiteral("\\s+"));
  return typed.toLower().split(blanks, Qt::SkipEmptyParts);
}
}  // namespace

std::optional<int> matchScore(const QString& typed, const QString& text) {
  const QString lower = text.toLower();
  int sum = 0;
  for (const QString& word : wordsOf(typed)) {
    const int score = wordScore(word, lower);
    if (score == 0) return std::nullopt;
    sum += score;
  }
  return sum;
}

std::optional<int> matchScore(const QString& typed, const PaletteItem& item) {
  const QString shown = (item.title + QLatin1Char(' ') + item.place).toLower(), others = item.words.toLower();
  int sum = 0;
  for (const QString& word : wordsOf(typed)) {
    // Twice the usual score, so that another word has a place between letters in order and the inside of a word.
    int best = 2 * std::max(wordScore(word, shown), wordScore(ours(word), shown) > 1 ? 2 : 0);
    if (best < 3 && (wordScore(word, others) == 3 || wordScore(ours(word), others) == 3)) best = 3;
    if (best == 0) return std::nullopt;
    sum += best;
  }
  // The title alone counts double, so that "level" finds the contour level before what lies in a folder of that name.
  return sum + 2 * matchScore(typed, item.title).value_or(0);
}

Palette::Palette(std::function<QList<PaletteItem>(const QString&)> items, QWidget* window)
    : QFrame(window, Qt::Popup), source_(std::move(items)), line_(new QLineEdit), list_(new QTreeWidget) {
  setObjectName(QStringLiteral("palette"));
  setFrameShape(QFrame::StyledPanel);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 6);
  column->setSpacing(4);
  line_->setPlaceholderText(tr("Action, parameter (name = value sets it), frame number"));
  line_->setClearButtonEnabled(true);
  line_->installEventFilter(this);
  column->addWidget(line_);
  list_->setColumnCount(3);
  list_->setHeaderHidden(true);
  list_->setRootIsDecorated(false);
  list_->setUniformRowHeights(true);
  list_->setFocusPolicy(Qt::NoFocus);
  list_->setTextElideMode(Qt::ElideMiddle);
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  list_->header()->setStretchLastSection(false);
  list_->header()->setMinimumSectionSize(0);
  list_->header()->setSectionResizeMode(QHeaderView::Fixed);
  column->addWidget(list_);
  connect(line_, &QLineEdit::textChanged, this, &Palette::search);
  connect(list_, &QTreeWidget::itemClicked, this, &Palette::runCurrent);
}

void Palette::popUp() {
  const QWidget* window = parentWidget();
  const int width = std::min(kWidth, window->width() - 20);
  resize(width, line_->sizeHint().height() + kRows * (fontMetrics().height() + 7) + 24);
  move(window->mapToGlobal(QPoint((window->width() - width) / 2, 60)));
  line_->clear();
  layout()->activate();  // the columns share the list's width
  search();
  show();
  line_->setFocus(Qt::PopupFocusReason);
}

void Palette::search() {
  const QString typed = line_->text().trimmed();
  const QList<PaletteItem> all = source_(typed);
  // Of a line "name = value" the name is what is looked for.
  const QString wanted = typed.section(QLatin1Char('='), 0, 0).trimmed();
  std::vector<std::pair<int, int>> found;  // minus the score, place in `all`
  for (int i = 0; i < all.size(); ++i) {
    if (const std::optional<int> score = matchScore(wanted, all[i])) found.push_back({-*score, i});
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (found.size() > std::size_t(kMost)) found.resize(kMost);
  shown_.clear();
  list_->clear();
  for (const auto& [score, i] : found) {
    const PaletteItem& item = all[i];
    shown_.append(item);
    auto* row = new QTreeWidgetItem(list_, {item.title, item.place, item.detail});
    row->setForeground(1, palette().color(QPalette::PlaceholderText));
    row->setForeground(2, palette().color(QPalette::PlaceholderText));
    row->setTextAlignment(2, Qt::AlignRight | Qt::AlignVCenter);
    row->setDisabled(!item.enabled);
  }
  if (!shown_.isEmpty()) {
    fitColumns();
    return list_->setCurrentItem(list_->topLevelItem(0));
  }
  auto* none = new QTreeWidgetItem(list_, {tr("No action or parameter matches")});
  none->setFirstColumnSpanned(true);
  none->setDisabled(true);
}

void Palette::fitColumns() {
  const QFontMetrics metrics(list_->font());
  int title = 0, detail = 0;
  for (const PaletteItem& item : std::as_const(shown_)) {
    title = std::max(title, metrics.horizontalAdvance(item.title) + kCellEdges);
    detail = std::max(detail, metrics.horizontalAdvance(item.detail) + kCellEdges);
  }
  // A key is short and useless when cut; of long titles and values (a value's problem) both give way.
  const int room = list_->width() - 2 * list_->frameWidth() - list_->verticalScrollBar()->sizeHint().width();
  detail = std::min(detail, room * 2 / 5);
  title = std::min(title, (room - detail) * 7 / 10);
  list_->setColumnWidth(0, title);
  list_->setColumnWidth(1, room - title - detail);
  list_->setColumnWidth(2, detail);
}

void Palette::runCurrent() {
  const int row = list_->indexOfTopLevelItem(list_->currentItem());
  if (row < 0 || row >= shown_.size() || !shown_[row].enabled) return;
  const std::function<void()> run = shown_[row].run;
  hide();  // first: what runs may open a dialog
  run();
}

bool Palette::eventFilter(QObject* watched, QEvent* event) {
  if (watched == line_ && event->type() == QEvent::KeyPress) {
    const auto* pressed = static_cast<QKeyEvent*>(event);
    const int key = pressed->key();
    if (opener_ && opener_->shortcuts().contains(QKeySequence(int(pressed->modifiers()) | key))) {
      line_->selectAll();
      return true;
    }
    if (key == Qt::Key_Up || key == Qt::Key_Down || key == Qt::Key_PageUp || key == Qt::Key_PageDown) {
      QApplication::sendEvent(list_, event);
      return true;
    }
    if (key == Qt::Key_Return || key == Qt::Key_Enter) {
      runCurrent();
      return true;
    }
  }
  return QFrame::eventFilter(watched, event);
}

}  // namespace glint::gui
