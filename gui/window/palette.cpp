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

#include "gui/base/complaint.h"
#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kWidth = 700, kRows = 14, kMost = 200;
constexpr int kCellEdges = 12;  // px, left and right of a cell's text
constexpr int kFewestLetters = 3;
// An occurrence in the title counts before any in the place, one in the place before any elsewhere.
constexpr int kInPlace = 2, kInTitle = 7;
constexpr int kOccurrence = 3;  // of two that are equal the title that is nothing else comes first, then one that begins so

/// How a word occurs in a text.
enum class Occurs { Not, Inside, AtStart, Whole };

Occurs occurs(const QString& word, const QString& text) {
  Occurs best = Occurs::Not;
  const auto edge = [&text](int at) { return at < 0 || at >= text.size() || !text[at].isLetterOrNumber(); };
  for (int at = text.indexOf(word); at >= 0; at = text.indexOf(word, at + 1)) {
    const Occurs here = !edge(at - 1) ? Occurs::Inside : edge(at + word.size()) ? Occurs::Whole : Occurs::AtStart;
    best = std::max(best, here);
  }
  return best;
}

/// The first letter begins a word; each other one comes next, or after one that was left out, or begins a word after it.
bool lettersOf(const QString& word, const QString& text) {
  const auto begins = [&text](int at) { return text[at].isLetterOrNumber() && (at == 0 || !text[at - 1].isLetterOrNumber()); };
  std::vector<int> ends;  // where the letters so far may end
  for (int at = 0; at < text.size(); ++at)
    if (begins(at) && text[at] == word[0]) ends.push_back(at);
  for (int i = 1; i < word.size(); ++i) {
    std::vector<int> next;
    for (int at = ends.empty() ? text.size() : ends.front() + 1; at < text.size(); ++at) {
      const bool near = std::any_of(ends.begin(), ends.end(), [&](int end) { return at == end + 1 || at == end + 2; });
      if (text[at] == word[i] && (near || begins(at))) next.push_back(at);
    }
    ends = std::move(next);
  }
  return !ends.empty();
}

bool scatteredIn(const QString& word, const QString& text) {
  int from = 0;
  for (const QChar c : word) {
    from = text.indexOf(c, from) + 1;
    if (from == 0) return false;
  }
  return true;
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

std::optional<PaletteMatch> matchOf(const QString& typed, const PaletteItem& item) {
  const QString title = item.title.toLower(), place = item.place.toLower(), others = item.words.toLower();
  PaletteMatch match;
  const QString all = wordsOf(typed).join(QLatin1Char(' '));
  if (!all.isEmpty()) match.score = title == all ? 2 : title.startsWith(all) ? 1 : 0;
  for (const QString& word : wordsOf(typed)) {
    int best = 0;
    for (const QString& spelt : {word, ours(word)}) {
      // A part of another word may be chance there: "ring" of "string".
      const bool other = occurs(spelt, others) >= Occurs::AtStart;
      best = std::max({best, kInTitle * int(occurs(spelt, title)), kInPlace * int(occurs(spelt, place)), int(other)});
    }
    match.score += kOccurrence * best;
    if (best > 0) continue;
    if (word.size() < kFewestLetters) return std::nullopt;  // one or two letters are in everything
    if (lettersOf(word, title) || lettersOf(word, place))
      match.way = std::min(match.way, PaletteMatch::Way::Letters);
    else if (scatteredIn(word, title + QLatin1Char(' ') + place))
      match.way = PaletteMatch::Way::Scattered;
    else
      return std::nullopt;
  }
  return match;
}

Palette::Palette(std::function<QList<PaletteItem>(const QString&)> items, QWidget* window)
    : QFrame(window, Qt::Popup), source_(std::move(items)), line_(new QLineEdit), list_(new QTreeWidget) {
  setObjectName(QStringLiteral("palette"));
  setFrameShape(QFrame::StyledPanel);
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 6);
  column->setSpacing(4);
  line_->setPlaceholderText(tr("Action, setting (name = value sets it) or frame"));
  line_->setClearButtonEnabled(true);
  line_->installEventFilter(this);
  column->addWidget(line_);
  list_->setColumnCount(3);
  list_->setHeaderHidden(true);
  line_->setAccessibleName(tr("Find action, setting or frame"));
  list_->setAccessibleName(tr("What was found"));
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
  // In a line "name = value", only the name is looked for.
  const QString wanted = typed.section(QLatin1Char('='), 0, 0).trimmed();
  std::vector<std::pair<PaletteMatch, int>> found;  // place in `all`
  for (int i = 0; i < all.size(); ++i) {
    if (const std::optional<PaletteMatch> match = matchOf(wanted, all[i])) found.push_back({*match, i});
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  // Letters that lie anywhere are a last resort.
  if (!found.empty() && found.front().first.way > PaletteMatch::Way::Scattered)
    found.erase(
        std::find_if(found.begin(), found.end(), [](const auto& f) { return f.first.way == PaletteMatch::Way::Scattered; }),
        found.end());
  // A value is for what can take it: of the titles that hold the words, those that cannot come last and say why not.
  if (typed.contains(QLatin1Char('='))) {
    const auto named = [&](const auto& f) {
      const std::optional<PaletteMatch> match = matchOf(wanted, {all[f.second].title, {}, {}, true, {}, {}});
      return match && match->way == PaletteMatch::Way::Text;
    };
    const auto end = std::stable_partition(found.begin(), found.end(), named);
    std::stable_partition(found.begin(), end, [&](const auto& f) { return all[f.second].enabled; });
  }
  if (found.size() > std::size_t(kMost)) found.resize(kMost);
  shown_.clear();
  list_->clear();
  for (const auto& [match, i] : found) {
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
  auto* none = new QTreeWidgetItem(list_, {tr("No matching action or setting")});
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
  int row = list_->indexOfTopLevelItem(list_->currentItem());
  if (row < 0 && !shown_.isEmpty()) row = 0;  // one that cannot be done is never the current one
  if (row < 0 || row >= shown_.size()) {
    if (!line_->text().trimmed().isEmpty()) complain(line_, tr("Nothing matches \"%1\"").arg(shownText(line_->text().trimmed())));
    return;
  }
  if (!shown_[row].enabled) {
    const QString& detail = shown_[row].detail;
    // The detail of a value is its problem, that of an action its keys.
    const bool isValue = line_->text().contains(QLatin1Char('='));
    complain(line_, isValue && !detail.isEmpty() ? QStringLiteral("%1: %2").arg(shown_[row].title, detail)
                                                 : tr("%1 is not available now").arg(shown_[row].title));
    return;
  }
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
