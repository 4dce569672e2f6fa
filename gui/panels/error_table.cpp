// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/error_table.h"

#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QKeyEvent>
#include <QLabel>
#include <QMenu>
#include <QResizeEvent>
#include <QScrollBar>
#include <QSortFilterProxyModel>
#include <QTableView>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>
#include <QWidgetAction>
#include <algorithm>
#include <cmath>

#include "core/draw/frame_overlay.h"
#include "core/inspect/summary.h"
#include "core/report/warnings.h"
#include "gui/base/flow_layout.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/tips.h"
#include "gui/panels/error_model.h"

namespace glint::gui {

namespace {
constexpr int kColumnGapPx = 12;                     // of the summary
constexpr double kWorstPct = 1000;                   // ten times the highlight's size: how far astray beyond that says nothing
constexpr int kIou = 4, kMissed = 6, kSpurious = 7;  // columns of its values

enum class Shown { All, HeldOut, Training, Problems };

class RowFilter : public QSortFilterProxyModel {
 public:
  using QSortFilterProxyModel::QSortFilterProxyModel;
  void show(Shown shown) {
    shown_ = shown;
    invalidateFilter();
  }

 protected:
  bool filterAcceptsRow(int row, const QModelIndex& parent) const override {
    const QModelIndex index = sourceModel()->index(row, 0, parent);
    const auto role = FrameRole(sourceModel()->data(index, ErrorModel::kFrameRoleRole).toInt());
    switch (shown_) {
      case Shown::HeldOut: return role == FrameRole::HeldOut;
      case Shown::Training: return role == FrameRole::Training;
      case Shown::Problems: return sourceModel()->data(index, ErrorModel::kProblemRole).toBool();
      case Shown::All: break;
    }
    return true;
  }

 private:
  Shown shown_ = Shown::All;
};
}  // namespace

ErrorTable::ErrorTable(Document& document, QWidget* parent) : QWidget(parent), document_(document) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  auto* head = new FlowLayout(16);  // a narrow dock puts the choice of rows below the summary
  head->setContentsMargins(8, 4, 6, 4);
  summary_ = new QLabel;
  summary_->setObjectName(QStringLiteral("errorSummary"));
  summary_->setTextFormat(Qt::RichText);
  summary_->setMinimumWidth(1);  // a dock narrower than its first column cuts it rather than growing
  summary_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  head->addWidget(summary_);
  filter_ = new QComboBox;
  filter_->setObjectName(QStringLiteral("errorFilter"));
  filter_->addItems({tr("all frames"), tr("held-out frames"), tr("training frames"), tr("problems only")});
  auto* choices = new QWidget;
  auto* choice = new QHBoxLayout(choices);
  choice->setContentsMargins(0, 0, 0, 0);
  choice->setSpacing(6);
  choice->addWidget(new QLabel(tr("Show")));
  choice->addWidget(filter_);
  count_ = new QLabel;
  count_->setObjectName(QStringLiteral("errorCount"));
  count_->setProperty("role", "faded");
  choice->addWidget(count_);
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
  choice->addWidget(warnings_);
  head->addWidget(choices);
  column->addLayout(head);

  model_ = new ErrorModel(document, this);
  auto* proxy = new RowFilter(this);
  proxy_ = proxy;
  proxy_->setSourceModel(model_);
  proxy_->setSortRole(ErrorModel::kSortRole);
  view_ = new QTableView;
  view_->setObjectName(QStringLiteral("errorTable"));
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
  view_->verticalHeader()->setDefaultSectionSize(fontMetrics().height() + 5);
  view_->horizontalHeader()->setHighlightSections(false);
  view_->horizontalHeader()->setStretchLastSection(false);
  const int widths[] = {54, 66, 98, 50, 64, 66, 68, 74, 80, 62, 78, 76, 68, 72};
  constexpr int kArrow = 34;  // px, of a heading's edges and the arrow of sorting
  for (int i = 0; i < int(std::size(widths)); ++i)
    view_->setColumnWidth(
        i, std::max(widths[i],
                    fontMetrics().horizontalAdvance(model_->headerData(i, Qt::Horizontal, Qt::DisplayRole).toString()) + kArrow));
  // Why there is no number stands beside "failed", not out of sight behind a row of dashes.
  view_->horizontalHeader()->moveSection(ErrorModel::ReasonText, ErrorModel::Status + 1);
  // The errors themselves are in sight without scrolling.
  for (const int column : {ErrorModel::ErrorPx, ErrorModel::ErrorPct})
    view_->horizontalHeader()->moveSection(view_->horizontalHeader()->visualIndex(column), ErrorModel::Model + 1);
  view_->installEventFilter(this);
  view_->viewport()->installEventFilter(this);
  column->addWidget(view_, 1);

  connect(filter_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, [this, proxy](int i) {
    proxy->show(Shown(i));
    showCount();
    selectFromDocument();
  });
  connect(model_, &QAbstractItemModel::modelReset, this, [this] {
    showSummary();
    showCount();
    showWarnings();
    fitReason();
    selectFromDocument();
  });
  connect(&document_, &Document::staleChanged, this, &ErrorTable::showSummary);
  connect(&document_, &Document::selectionChanged, this, &ErrorTable::selectFromDocument);
  connect(view_->selectionModel(), &QItemSelectionModel::currentRowChanged, this, &ErrorTable::selectFromTable);
  showSummary();
  showWarnings();
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
  // In place of the heading: a line of its own would make the table jump under the mouse.
  summaryRows_.push_back(
      {{},
       document_.stale() ? tr("out of date…") : tr("Held out, % vs %1").arg(toQString(scoredAgainst(*inspection))),
       {tr("mean"), tr("median"), tr("p95"), tr("max"), tr("IoU"), tr("predicted"), tr("missed"), tr("spurious")},
       {}});
  int missed = 0, spurious = 0;
  for (const std::string& name : modelsInOrder(*inspection)) {
    const ModelSummary s = summarise(*inspection, inspection->models.at(name));
    SummaryRow row{toQColor(draw::modelColour(name)).name(), toQString(name), {}, {}};
    if (s.answered) {
      missed += s.missed;
      spurious += s.spurious;
      const Statistic& e = s.contourErrorPct;
      // As many decimals as the table below, so that points stand under points.
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
  // What the errors leave out comes before their tails: without it, a mean over few matched highlights looks too good.
  columnOrder_ = {0, 1};
  if (missed > 0) columnOrder_.push_back(kMissed);
  if (spurious > 0) columnOrder_.push_back(kSpurious);
  for (int c = 2; c < int(summaryRows_.front().values.size()); ++c)
    if (std::find(columnOrder_.begin(), columnOrder_.end(), c) == columnOrder_.end()) columnOrder_.push_back(c);
  fitSummary();
}

QString ErrorTable::summaryHtml(const std::vector<int>& columns, int problemWidth) const {
  const QString faded = (document_.stale() ? warningColour() : palette().color(QPalette::PlaceholderText)).name();
  QString html = QStringLiteral("<table cellspacing='0' cellpadding='0'>");
  for (const SummaryRow& row : summaryRows_) {
    const bool heading = row.colour.isEmpty();
    html += heading ? QStringLiteral("<tr style='color:%1'>").arg(faded) : QStringLiteral("<tr>");
    html += QStringLiteral("<td style='padding-right:%1px'>%2%3</td>")
                .arg(kColumnGapPx)
                .arg(heading ? QString() : QStringLiteral("<span style='color:%1'>■</span>&nbsp;").arg(row.colour), row.name);
    for (const int c : columns)
      if (c < row.values.size()) {
        // What the errors beside them leave out is seen before they are.
        const bool leftOut = !heading && (c == kMissed || c == kSpurious) && row.values[c] != QLatin1String("0");
        html += QStringLiteral("<td align='right' width='%1' style='padding-right:%2px%3'>%4</td>")
                    .arg(columnWidth(c) + kColumnGapPx)
                    .arg(kColumnGapPx)
                    .arg(leftOut ? QStringLiteral(";color:") + warningColour().name() : QString())
                    .arg(row.values[c].toHtmlEscaped());
      }
    if (!row.problem.isEmpty())
      html += QStringLiteral("<td colspan='%1' style='color:%2'>%3</td>")
                  .arg(std::max<std::size_t>(1, columns.size()))
                  .arg(warningColour().name(),
                       summary_->fontMetrics().elidedText(row.problem, Qt::ElideRight, problemWidth).toHtmlEscaped());
    if (heading && int(columns.size()) < row.values.size()) html += QStringLiteral("<td>…</td>");
    html += QStringLiteral("</tr>");
  }
  return html + QStringLiteral("</table>");
}

int ErrorTable::columnWidth(int column) const {
  // Of the widest number that an error, a share or a count of this column's frames can be: it stays while a slider moves.
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
  const int all = summaryRows_.front().values.size();
  const QMargins margins = layout()->itemAt(0)->layout()->contentsMargins();
  const int room = width() - margins.left() - margins.right();
  int first = 0, problems = 0;
  for (const SummaryRow& row : summaryRows_) {
    first = std::max(first, summary_->fontMetrics().horizontalAdvance(QStringLiteral("■ ") + row.name) + 20);
    problems = std::max(problems, summary_->fontMetrics().horizontalAdvance(row.problem));
  }
  const int forProblems = std::max(40, room - first);
  // Widths are estimated first: laying out a table of rich text takes milliseconds, and this follows a slider.
  int columns = 0;
  for (int used = first; columns < all; ++columns) {
    const int column = columnOrder_[std::size_t(columns)];
    used += columnWidth(column) + kColumnGapPx;
    if (columns > 0 && used > room) break;
  }
  const auto html = [&](int count, int problemWidth) {
    std::vector<int> shown(columnOrder_.begin(), columnOrder_.begin() + count);
    std::sort(shown.begin(), shown.end());
    return summaryHtml(shown, problemWidth);
  };
  summary_->setText(html(columns, forProblems));
  while (columns > 1 && summary_->sizeHint().width() > room) summary_->setText(html(--columns, forProblems));
  if (columns < all || problems > forProblems)
    setRichTip(summary_, QStringLiteral("<div style='white-space:nowrap'>") + html(all, problems + 1) + QStringLiteral("</div>"));
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

void ErrorTable::copySelection() const {
  QModelIndexList rows = view_->selectionModel()->selectedRows();
  std::sort(rows.begin(), rows.end(), [](const QModelIndex& a, const QModelIndex& b) { return a.row() < b.row(); });
  QStringList lines, cells;
  for (int c = 0; c < proxy_->columnCount(); ++c) cells << proxy_->headerData(c, Qt::Horizontal).toString();
  lines << cells.join('\t');
  for (const QModelIndex& row : rows) {
    cells.clear();
    for (int c = 0; c < proxy_->columnCount(); ++c) cells << row.sibling(row.row(), c).data().toString();
    lines << cells.join('\t');
  }
  QApplication::clipboard()->setText(lines.join('\n') + '\n');
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
  if (watched == view_->viewport() && event->type() == QEvent::Resize)  // as by a scroll bar below it
    QTimer::singleShot(0, this, &ErrorTable::uncutCurrent);
  if (watched == view_ && event->type() == QEvent::KeyPress && static_cast<QKeyEvent*>(event)->matches(QKeySequence::Copy)) {
    copySelection();
    return true;
  }
  return QWidget::eventFilter(watched, event);
}

}  // namespace glint::gui
