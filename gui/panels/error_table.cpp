// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/error_table.h"

#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QResizeEvent>
#include <QScrollBar>
#include <QSignalBlocker>
#include <QTableView>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>
#include <QWidgetAction>
#include <algorithm>
#include <cmath>

#include "core/base/csv_text.h"
#include "core/draw/frame_overlay.h"
#include "core/pipeline/summary.h"
#include "core/report/texts.h"
#include "gui/base/flow_layout.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/panels/error_columns.h"
#include "gui/panels/error_model.h"
#include "gui/panels/pinned_summary.h"
#include "gui/panels/row_filter.h"

namespace glint::gui {

namespace {
constexpr int kSearchWidth = 90, kChangeWidth = 110;  // px
constexpr int kHeadGapPx = 6;                         // between the texts above the table
constexpr int kLeastLetters = 6;                      // of a choice of rows; its list shows the rest
constexpr int kColumnGapPx = 5;                       // of the summary
constexpr double kWorstPct = 1000;                    // ten times the highlight's size: how wrong beyond that says nothing
constexpr int kIou = 4, kMissed = 6, kSpurious = 7;   // columns of its values
// What the errors leave out comes before their tails: without it, a mean over few matched highlights looks too good. The last
// ones are left out first.
constexpr int kColumnOrder[] = {0, 1, kMissed, kSpurious, 2, 3, kIou, 5};
}  // namespace

ErrorTable::ErrorTable(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  auto* head = new FlowLayout(kHeadGapPx);  // a narrow dock puts the choice of rows below the summary
  buildHead(*head);
  column->addLayout(head);
  column->addWidget(new PinnedSummary(document));
  buildTable();
  column->addWidget(view_, 1);
  connectTable();
  showWarnings();
  showSummary();
}

void ErrorTable::buildHead(QLayout& head) {
  head.setContentsMargins(8, 2, 6, 2);
  summary_ = new QLabel;
  summary_->setObjectName(QStringLiteral("errorSummary"));
  summary_->setTextFormat(Qt::RichText);
  summary_->setMinimumWidth(1);  // a dock narrower than its first column cuts it rather than growing
  summary_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  head.addWidget(summary_);
  buildWarnings(head);  // beside the summary: a line of their own would cost the table a row
  filter_ = new QComboBox;
  filter_->setObjectName(QStringLiteral("errorFilter"));
  filter_->addItems({tr("all frames"), tr("held-out frames"), tr("training frames"), tr("problems only"), tr("brushed only")});
  filter_->setAccessibleName(tr("Rows by frame"));
  filter_->setToolTip(
      tr("Which rows are shown. Problems have no error; brushed is what a rectangle in the plot \"Any two columns\" chose"));
  head.addWidget(filter_);
  buildFilters(head);
  count_ = new QLabel;
  count_->setObjectName(QStringLiteral("errorCount"));
  count_->setProperty("role", "faded");
  head.addWidget(count_);
}

void ErrorTable::buildTable() {
  model_ = new ErrorModel(document_, this);
  proxy_ = new RowFilter(*model_, this);
  view_ = new QTableView;
  view_->setObjectName(QStringLiteral("errorTable"));
  view_->setAccessibleName(tr("Errors of every highlight"));
  view_->setTabKeyNavigation(false);  // arrows go about in it, Tab leaves it
  view_->setModel(proxy_);
  view_->setSortingEnabled(true);
  view_->sortByColumn(ErrorModel::Frame, Qt::AscendingOrder);
  view_->setAlternatingRowColors(true);
  view_->setSelectionBehavior(QAbstractItemView::SelectRows);
  view_->setIconSize({10, 10});
  view_->setShowGrid(false);
  view_->setWordWrap(false);
  view_->verticalHeader()->hide();
  view_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 3);
  view_->horizontalHeader()->setHighlightSections(false);
  view_->horizontalHeader()->setStretchLastSection(false);
  constexpr int kTextWidths[] = {54, 66, 98, 50, 64}, kNumberWidth = 62;  // px, least
  constexpr int kArrow = 34;                                              // px, of a heading's edges and the arrow of sorting
  for (int i = 0; i < ErrorModel::ReasonText; ++i)
    view_->setColumnWidth(
        i, std::max(i < int(std::size(kTextWidths)) ? kTextWidths[i]
                    : i == ErrorModel::Difference   ? kChangeWidth
                                                    : kNumberWidth,
                    fontMetrics().horizontalAdvance(model_->headerData(i, Qt::Horizontal, Qt::DisplayRole).toString()) + kArrow));
  // The reason for a missing number is beside "failed", not out of sight behind a row of dashes.
  view_->horizontalHeader()->moveSection(ErrorModel::ReasonText, ErrorModel::Status + 1);
  // The errors themselves are in sight without scrolling.
  for (const int column : {ErrorModel::Difference, ErrorModel::Pinned, ErrorModel::ErrorPx, ErrorModel::ErrorPct})
    view_->horizontalHeader()->moveSection(view_->horizontalHeader()->visualIndex(column), ErrorModel::Model + 1);
  columns_ = new ErrorColumns(view_);
  columnsButton_->setMenu(columns_->menu());
  view_->installEventFilter(this);
  view_->viewport()->installEventFilter(this);
}

void ErrorTable::connectTable() {
  connect(view_->horizontalHeader(), &QHeaderView::sortIndicatorChanged, view_, &QTableView::scrollToTop);  // what one sorts for
  connect(filter_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this](int i) {
    proxy_->setFrames(RowFilter::Frames(i));
    showFiltered();
  });
  connect(&document_, &Document::brushedChanged, this, &ErrorTable::followBrush);
  connect(&document_, &Document::pinnedChanged, this, &ErrorTable::followPinned);
  connect(model_, &QAbstractItemModel::modelReset, this, [this] {
    showWarnings();  // the summary leaves them their room
    showSummary();
    showCount();
    listModels();
    fitReason();
    followPinned();
    selectFromDocument();
  });
  badge_ = new StaleBadge(view_, Qt::BottomRightCorner);
  connect(&document_, &Document::staleChanged, badge_, &StaleBadge::setStale);
  connect(badge_, &StaleBadge::marked, this, [this](bool stale) {
    model_->setEarlier(stale);
    fitSummary();
  });
  connect(&document_, &Document::selectionChanged, this, &ErrorTable::selectFromDocument);
  connect(view_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, &ErrorTable::selectFromTable);
}

void ErrorTable::buildWarnings(QLayout& row) {
  warnings_ = new QToolButton;
  warnings_->setObjectName(QStringLiteral("errorWarnings"));
  warnings_->setAutoRaise(true);
  warnings_->setProperty("role", "warning");
  constexpr int kTextWidth = 520;  // px, about 80 characters a line
  warningTexts_ = new QLabel;
  warningTexts_->setObjectName(QStringLiteral("warningTexts"));
  warningTexts_->setTextFormat(Qt::RichText);
  warningTexts_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  warningTexts_->setWordWrap(true);
  warningTexts_->setFixedWidth(kTextWidth);
  warningTexts_->setMargin(6);
  auto* menu = new QMenu(warnings_);
  auto* texts = new QWidgetAction(menu);
  texts->setDefaultWidget(warningTexts_);
  menu->addAction(texts);
  connect(warnings_, &QToolButton::clicked, menu,
          [this, menu] { menu->popup(warnings_->mapToGlobal(warnings_->rect().bottomLeft())); });
  row.addWidget(warnings_);
}

void ErrorTable::buildFilters(QLayout& row) {
  models_ = new QComboBox;
  models_->setObjectName(QStringLiteral("errorModelFilter"));
  models_->setAccessibleName(tr("Rows by model"));
  models_->setToolTip(tr("Rows of one model alone"));
  models_->addItem(tr("all models"));
  statuses_ = new QComboBox;
  statuses_->setObjectName(QStringLiteral("errorStatusFilter"));
  statuses_->setAccessibleName(tr("Rows by status"));
  statuses_->setToolTip(tr("Rows of one status alone"));
  statuses_->addItem(tr("any status"));
  for (const RowStatus status : allRowStatuses()) statuses_->addItem(tr(nameOf(status)), int(status));
  search_ = new QLineEdit;
  search_->setObjectName(QStringLiteral("errorSearch"));
  search_->setAccessibleName(tr("Search in errors"));
  search_->setPlaceholderText(tr("Search…"));
  search_->setToolTip(tr("Rows with all of these words in any column. Esc clears"));
  search_->setClearButtonEnabled(true);
  search_->setFixedWidth(kSearchWidth);
  search_->installEventFilter(this);
  columnsButton_ = new QToolButton;
  columnsButton_->setObjectName(QStringLiteral("errorColumnsButton"));
  columnsButton_->setIcon(icon(QStringLiteral("more")));
  columnsButton_->setAccessibleName(tr("Columns of the table"));
  columnsButton_->setToolTip(tr("Which columns are shown; a right click on a heading opens the same list"));
  columnsButton_->setAutoRaise(true);
  columnsButton_->setPopupMode(QToolButton::InstantPopup);
  for (QComboBox* box : {filter_, models_, statuses_}) {  // one line of a dock that shares the window's width
    box->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
    box->setMinimumContentsLength(kLeastLetters);
  }
  for (QWidget* widget : {static_cast<QWidget*>(models_), static_cast<QWidget*>(statuses_), static_cast<QWidget*>(search_),
                          static_cast<QWidget*>(columnsButton_)})
    row.addWidget(widget);
  connect(models_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this](int i) {
    proxy_->setModel(i > 0 ? models_->itemText(i) : QString());
    showFiltered();
  });
  connect(statuses_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this](int i) {
    proxy_->setStatus(i > 0 ? std::optional(RowStatus(statuses_->itemData(i).toInt())) : std::nullopt);
    showFiltered();
  });
  connect(search_, &QLineEdit::textChanged, this, [this](const QString& words) {
    proxy_->setSearch(words);
    showFiltered();
  });
}

void ErrorTable::showFiltered() {
  showCount();
  selectFromDocument();
}

void ErrorTable::listModels() {
  const QStringList names = model_->models();
  QStringList known;
  for (int i = 1; i < models_->count(); ++i) known << models_->itemText(i);
  if (known == names) return;  // a slider moves
  const QString chosen = models_->currentIndex() > 0 ? models_->currentText() : QString();
  const QSignalBlocker quiet(models_);
  while (models_->count() > 1) models_->removeItem(1);
  models_->addItems(names);
  models_->setCurrentIndex(chosen.isEmpty() ? 0 : std::max(0, models_->findText(chosen)));
  proxy_->setModel(models_->currentIndex() > 0 ? chosen : QString());
}

void ErrorTable::followBrush() {
  const bool any = !document_.brushed().empty(), was = filter_->currentIndex() == int(RowFilter::Frames::Brushed);
  proxy_->setBrushed(document_.brushed());
  if (any && !was) beforeBrush_ = filter_->currentIndex();
  if (any != was) filter_->setCurrentIndex(any ? int(RowFilter::Frames::Brushed) : beforeBrush_);
  showFiltered();
}

void ErrorTable::followPinned() {
  columns_->setPinned(document_.pinned() && !document_.pinnedShown() && document_.pinned() != document_.computed());
}

void ErrorTable::showWarnings() {
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  QString tip;  // rich, so that long sentences are wrapped
  const std::vector<std::string> texts = inspection ? warningsOf(*inspection) : std::vector<std::string>();
  for (const std::string& text : texts) tip += QStringLiteral("<p>%1</p>").arg(nameText(text).toHtmlEscaped());
  warnings_->setVisible(!texts.empty());
  warnings_->setText(texts.size() == 1 ? tr("1 warning") : tr("%1 warnings").arg(texts.size()));
  setRichTip(warnings_, tip);
  warningTexts_->setText(tip);
}

void ErrorTable::showCount() {
  const int shown = proxy_->rowCount(), all = model_->rowCount();
  count_->setText(all == 0 ? QString() : shown == all ? tr("%1 rows").arg(all) : tr("%1 of %2 rows").arg(shown).arg(all));
}

void ErrorTable::fitReason() {
  int width = 60;
  for (int row = 0; row < model_->rowCount(); ++row)
    width = std::max(width,
                     view_->fontMetrics().horizontalAdvance(model_->index(row, ErrorModel::ReasonText).data().toString()) + 16);
  view_->setColumnWidth(ErrorModel::ReasonText, std::min(width, 300));
}

void ErrorTable::showSummary() {
  summaryRows_.clear();
  const std::shared_ptr<const Inspection> inspection = document_.inspection();
  if (!inspection) return fitSummary();
  summaryRows_.push_back(
      {{},
       tr("Held out, % vs %1").arg(toQString(scoredAgainst(*inspection))),
       {tr("mean"), tr("median"), tr("p95"), tr("max"), tr("IoU"), tr("predicted"), tr("missed"), tr("spurious")},
       {}});
  for (const std::string& name : modelsInOrder(*inspection)) {
    const ModelSummary s = summarise(*inspection, inspection->models.at(name));
    SummaryRow row{toQColor(draw::modelColour(name, s.poor)).name(),
                   toQString(name) + (s.poor ? tr(", poor") : QString()),
                   {},
                   {},
                   toQString(name),
                   s.poor ? toQString(s.reason) : QString()};
    if (s.answered) {
      const Statistic& e = s.contourErrorPct;
      // As many decimals as the table below, so that points are under points.
      const auto fixed = [](double v, int decimals) {
        return !std::isfinite(v) ? QStringLiteral("–")
               : v > kWorstPct   ? QStringLiteral("> 1000")
                                 : QString::number(v, 'f', decimals);
      };
      row.values = QStringList{fixed(e.mean, 3),          fixed(e.median, 3),
                               fixed(e.p95, 3),           fixed(e.max, 3),
                               fixed(s.iou.mean, 4),      QStringLiteral("%1/%2").arg(s.predicted).arg(s.frames),
                               QString::number(s.missed), QString::number(s.spurious)};
    } else {
      row.problem = toQString(s.reason);
    }
    summaryRows_.push_back(row);
  }
  fitSummary();
}

QString ErrorTable::summaryHtml(const std::vector<int>& columns, int problemWidth) const {
  const QString faded = palette().color(QPalette::PlaceholderText).name();
  const bool earlier = badge_ && badge_->marks();
  QString html = QStringLiteral("<table cellspacing='0' cellpadding='0'>");
  for (const SummaryRow& row : summaryRows_) {
    const bool heading = row.colour.isEmpty();
    html += heading || earlier ? QStringLiteral("<tr style='color:%1'>").arg(faded) : QStringLiteral("<tr>");
    html += QStringLiteral("<td width='%1' style='padding-right:%2px'>%3%4</td>")
                .arg(nameWidth())
                .arg(kColumnGapPx)
                .arg(heading ? QString() : QStringLiteral("<span style='color:%1'>■</span>&nbsp;").arg(row.colour), row.name);
    for (const int c : columns)
      if (c < row.values.size()) {
        // What the errors beside them leave out is seen before they are.
        const bool leftOut = !heading && !earlier && (c == kMissed || c == kSpurious) && row.values[c] != QLatin1String("0");
        html += QStringLiteral("<td align='right' width='%1' style='padding-right:%2px%3'>%4</td>")
                    .arg(columnWidth(c) + kColumnGapPx)
                    .arg(kColumnGapPx)
                    .arg(leftOut ? QStringLiteral(";color:") + warningColour().name() : QString())
                    .arg(row.values[c].toHtmlEscaped());
      }
    if (!row.problem.isEmpty())
      html += QStringLiteral("<td colspan='%1' style='color:%2'>%3</td>")
                  .arg(std::max<std::size_t>(1, columns.size()))
                  .arg(earlier ? faded : warningColour().name(),
                       summary_->fontMetrics().elidedText(row.problem, Qt::ElideRight, problemWidth).toHtmlEscaped());
    if (heading && int(columns.size()) < row.values.size()) html += QStringLiteral("<td>…</td>");
    html += QStringLiteral("</tr>");
  }
  return html + QStringLiteral("</table>");
}

/// Also with what a recomputation may put behind a model's name: columns stay where they are.
int ErrorTable::nameWidth() const {
  int width = 0;
  for (const SummaryRow& row : summaryRows_) {
    const QString name = row.colour.isEmpty() ? row.name : QStringLiteral("■ ") + row.model + tr(", poor");
    width = std::max(width, summary_->fontMetrics().horizontalAdvance(name));
  }
  return width + kColumnGapPx;
}

int ErrorTable::columnWidth(int column) const {
  // Width of the largest error, share or count that this column can have: it stays while a slider moves.
  const QString widest = column < 4 ? QStringLiteral("999.999") : column == kIou ? QStringLiteral("0.9999") : QString();
  int width = summary_->fontMetrics().horizontalAdvance(widest);
  for (const SummaryRow& row : summaryRows_)
    if (column < row.values.size()) width = std::max(width, summary_->fontMetrics().horizontalAdvance(row.values[column]));
  return width;
}

void ErrorTable::fitSummary() {
  summary_->setToolTip({});
  if (summaryRows_.empty()) {
    summary_->setText(tr("<span style='color:%1'>No results yet</span>").arg(palette().color(QPalette::PlaceholderText).name()));
    return;
  }
  const int all = int(std::size(kColumnOrder));
  const QMargins margins = layout()->itemAt(0)->layout()->contentsMargins();
  // Room for warnings even without any: they come and go with each recomputation.
  const int beside = warnings_->fontMetrics().horizontalAdvance(tr("%1 warnings").arg(99)) + 3 * kHeadGapPx;
  const int room = width() - margins.left() - margins.right() - beside;
  const int first = nameWidth() + 20;
  int problems = 0;
  for (const SummaryRow& row : summaryRows_)
    problems = std::max(problems, summary_->fontMetrics().horizontalAdvance(row.problem));
  const int forProblems = std::max(40, room - first);
  // Widths are estimated first: laying out a table of rich text takes milliseconds, and this follows a slider.
  int columns = 0;
  for (int used = first; columns < all; ++columns) {
    const int column = kColumnOrder[columns];
    used += columnWidth(column) + kColumnGapPx;
    if (columns > 0 && used > room) break;
  }
  const auto html = [&](int count, int problemWidth) {
    std::vector<int> shown(kColumnOrder, kColumnOrder + count);
    std::sort(shown.begin(), shown.end());
    return summaryHtml(shown, problemWidth);
  };
  summary_->setText(html(columns, forProblems));
  while (columns > 1 && summary_->sizeHint().width() > room) summary_->setText(html(--columns, forProblems));
  QString tip;
  if (columns < all || problems > forProblems)
    tip = QStringLiteral("<div style='white-space:nowrap'>") + html(all, problems + 1) + QStringLiteral("</div>");
  for (const SummaryRow& row : summaryRows_)
    if (!row.poor.isEmpty()) tip += QStringLiteral("<p>%1: %2</p>").arg(row.name, row.poor.toHtmlEscaped());
  if (!tip.isEmpty()) setRichTip(summary_, tip);
}

void ErrorTable::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange && summary_) fitSummary();  // the summary has colours of the theme
}

void ErrorTable::resizeEvent(QResizeEvent* event) {
  QWidget::resizeEvent(event);
  if (event->size().width() != event->oldSize().width()) fitSummary();
}

void ErrorTable::selectFromDocument() {
  if (selecting_) return;
  const draw::Selection& s = document_.selection();
  int best = -1, bestScore = 0;
  for (int row = 0; row < proxy_->rowCount(); ++row) {
    const int source = proxy_->mapToSource(proxy_->index(row, 0)).row();
    if (model_->frameOf(source) != s.frame) continue;
    const int score = 1 + 2 * (model_->modelOf(source) == document_.plottedModel()) +
                      (s.highlight >= 0 && model_->highlightOf(source) == s.highlight) +
                      4 * (s.highlight < 0 && s.predicted >= 0 && model_->selectionOf(source) == s);
    if (score > bestScore) best = row, bestScore = score;
  }
  selecting_ = true;
  if (best < 0)
    view_->clearSelection();
  else {
    const int x = view_->horizontalScrollBar()->value();
    const bool visible = view_->viewport()->rect().contains(view_->visualRect(proxy_->index(best, 0)));
    // Not selectRow(): that one looks at the keyboard, and Ctrl is down during Ctrl+Z.
    view_->selectionModel()->setCurrentIndex(proxy_->index(best, 0),
                                             QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
    view_->scrollTo(proxy_->index(best, 0), visible ? QAbstractItemView::EnsureVisible : QAbstractItemView::PositionAtCenter);
    view_->horizontalScrollBar()->setValue(x);
  }
  selecting_ = false;
}

void ErrorTable::selectFromTable() {
  const QModelIndex current = view_->currentIndex();
  if (selecting_ || !current.isValid()) return;
  const int row = proxy_->mapToSource(current).row();
  selecting_ = true;
  document_.selectExactly(model_->selectionOf(row), steps_.gesture(document_));
  selecting_ = false;
}

QString ErrorTable::selectedText(QChar separator) const {
  QModelIndexList rows = view_->selectionModel()->selectedRows();
  std::sort(rows.begin(), rows.end(), [](const QModelIndex& a, const QModelIndex& b) { return a.row() < b.row(); });
  // As on screen: the columns that are shown, in their order.
  std::vector<int> columns;
  const QHeaderView* const head = view_->horizontalHeader();
  for (int place = 0; place < head->count(); ++place)
    if (const int column = head->logicalIndex(place); !view_->isColumnHidden(column)) columns.push_back(column);
  const auto field = [separator](QString text) {
    if (separator == QLatin1Char('\t'))  // for a spreadsheet, too
      return exactQString(withoutFormula(text.replace(QLatin1Char('\t'), QLatin1Char(' ')).toStdString()));
    return exactQString(csvText(text.toStdString()));
  };
  QStringList lines, cells;
  for (const int c : columns) cells << field(proxy_->headerData(c, Qt::Horizontal).toString());
  lines << cells.join(separator);
  for (const QModelIndex& row : rows) {
    cells.clear();
    for (const int c : columns) cells << field(row.sibling(row.row(), c).data().toString());
    lines << cells.join(separator);
  }
  return lines.join('\n') + '\n';
}

void ErrorTable::copySelection(QChar separator) const { QApplication::clipboard()->setText(selectedText(separator)); }

void ErrorTable::addActions(Actions& actions, QMenu* menu) {
  actions.add("edit.copy-error-rows", menu, tr("Copy &error rows"), [this] { copySelection(); },
              {{}, {}, tr("The selected rows of the error table, columns as shown, separated by tabs")});
  actions.add("edit.copy-error-rows-csv", menu, tr("Copy error rows as &CSV"), [this] { copySelection(QLatin1Char(',')); },
              {{}, {}, tr("The selected rows of the error table, columns as shown, as comma-separated values")});
  actions.add("edit.search-errors", menu, tr("Search in e&rrors"),
              [this] {
                emit shown();
                search_->setFocus(Qt::ShortcutFocusReason);
                search_->selectAll();
              },
              {{QKeySequence::Find}, {}, tr("Shows only the rows of the error table that have all typed words")});
  actions.add("edit.error-columns", menu, tr("Choose error c&olumns"),
              [this] {
                emit shown();
                columnsButton_->showMenu();
              },
              {{}, {}, tr("Which columns the error table shows")});
  actions.add("edit.brush-clear", menu, tr("Clear &brush"), [this] { document_.brush({}); },
              {{}, {}, tr("No highlight is brushed in the plot \"Any two columns\" any more")});
}

void ErrorTable::uncutCurrent() {
  const QModelIndex current = view_->currentIndex();
  const QRect row = view_->visualRect(current), seen = view_->viewport()->rect();
  if (!current.isValid() || row.top() > seen.bottom() || row.bottom() <= seen.bottom()) return;
  const int x = view_->horizontalScrollBar()->value();
  view_->scrollTo(current, QAbstractItemView::EnsureVisible);
  view_->horizontalScrollBar()->setValue(x);
}

bool ErrorTable::eventFilter(QObject* watched, QEvent* event) {
  if (view_ && watched == view_->viewport() && event->type() == QEvent::Resize)  // as by a scroll bar below it
    QTimer::singleShot(0, this, &ErrorTable::uncutCurrent);
  if (watched == view_ && event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->matches(QKeySequence::Copy)) {
    copySelection();
    return true;
  }
  // Esc stops computations elsewhere.
  if (watched == search_ && !search_->text().isEmpty() &&
      (event->type() == QEvent::ShortcutOverride || event->type() == QEvent::KeyPress) &&
      static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) {
    event->accept();
    if (event->type() == QEvent::KeyPress) search_->clear();
    return true;
  }
  return QWidget::eventFilter(watched, event);
}

}  // namespace glint::gui
