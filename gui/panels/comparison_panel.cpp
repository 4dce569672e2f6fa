// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/comparison_panel.h"

#include <QCheckBox>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QLabel>
#include <QPushButton>
#include <QSortFilterProxyModel>
#include <QTabWidget>
#include <QTableView>
#include <QVBoxLayout>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "gui/base/elided_label.h"
#include "gui/base/rows_model.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/unit_text.h"
#include "gui/document/allowed_folders.h"
#include "gui/export/long_job.h"

namespace glint::gui {

namespace {
const QString kNone = QStringLiteral("–");

RowsModel::Cell text(const QString& s, const QString& tip = {}) { return {s.isEmpty() ? kNone : s, {}, {}, tip, false}; }

/// What has no value goes to the end, whichever way the table is sorted by size.
RowsModel::Cell number(const std::optional<double>& v, int digits = 4) {
  RowsModel::Cell cell;
  cell.text = v ? numberText(*v, digits) : kNone;
  cell.sort = v ? *v : std::numeric_limits<double>::max();
  cell.number = true;
  return cell;
}

QTableView* table(RowsModel* model, const char* name, const QString& what) {
  auto* view = new QTableView;
  view->setObjectName(QLatin1String(name));
  view->setAccessibleName(what);
  view->setTabKeyNavigation(false);  // arrows go about in it, Tab leaves it
  auto* sorted = new QSortFilterProxyModel(view);
  sorted->setSourceModel(model);
  sorted->setSortRole(RowsModel::kSortRole);
  view->setModel(sorted);
  view->setSortingEnabled(true);
  sorted->sort(-1);  // as they come, until a header is clicked
  view->horizontalHeader()->setSortIndicator(-1, Qt::AscendingOrder);
  view->setSelectionBehavior(QAbstractItemView::SelectRows);
  view->setSelectionMode(QAbstractItemView::SingleSelection);
  view->setEditTriggers(QAbstractItemView::NoEditTriggers);
  view->setAlternatingRowColors(true);
  view->setShowGrid(false);
  view->setWordWrap(false);
  view->verticalHeader()->hide();
  view->verticalHeader()->setDefaultSectionSize(view->fontMetrics().height() + 6);
  view->horizontalHeader()->setHighlightSections(false);
  view->horizontalHeader()->setStretchLastSection(true);
  return view;
}

/// Opens the file with the folders that a person allowed it to name.
Opened openedFor(const Engine& engine, const QString& file) {
  Relinked instead;
  for (const QString& folder : allowedFolders(file)) instead.folders.emplace_back(folder.toStdString());
  try {
    return engine.open(file.toStdString(), instead);
  } catch (const OutsidePath& e) {
    throw std::runtime_error(withoutFlags(e) + "; to allow this, first open that session itself");
  }
}
}  // namespace

std::pair<QString, QString> shortestNames(const QString& fileA, const QString& fileB) {
  const QStringList a = QDir::cleanPath(QFileInfo(fileA).absoluteFilePath()).split(QLatin1Char('/')),
                    b = QDir::cleanPath(QFileInfo(fileB).absoluteFilePath()).split(QLatin1Char('/'));
  int parts = 1;
  while (a != b && parts < std::max(a.size(), b.size()) &&
         a.mid(std::max(0, int(a.size()) - parts)) == b.mid(std::max(0, int(b.size()) - parts)))
    ++parts;
  const auto end = [parts](const QStringList& all) {
    return all.mid(std::max(0, int(all.size()) - parts)).join(QLatin1Char('/'));
  };
  return {end(a), end(b)};
}

ComparisonPanel::ComparisonPanel(const Engine& engine, Document& document, LongJob& job, QWidget* parent)
    : QWidget(parent), engine_(engine), document_(document), job_(job) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 4, 6, 4);
  column->setSpacing(4);
  auto* row = new QHBoxLayout;
  title_ = new ElidedLabel;
  title_->setObjectName(QStringLiteral("comparisonTitle"));
  title_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);  // a long line would make the dock wider than its place
  row->addWidget(title_, 1);
  onlyDifferences_ = new QCheckBox(tr("Differences only"));
  onlyDifferences_->setObjectName(QStringLiteral("onlyDifferences"));
  onlyDifferences_->setChecked(true);
  row->addWidget(onlyDifferences_);
  auto* button = new QPushButton(tr("Compare with…"));
  row->addWidget(button);
  column->addLayout(row);
  values_ = new RowsModel({tr("Group"), tr("Item"), tr("A"), tr("B"), tr("B / A")}, this);
  errors_ = new RowsModel({tr("Frame"), tr("Model"), tr("Light"), tr("A, %"), tr("B, %"), tr("B / A"), tr("Note")}, this);
  models_ = new RowsModel(
      {tr("Held out in both"), tr("Answers"), tr("A, mean %"), tr("B, mean %"), tr("B / A"), tr("A better"), tr("B better")},
      this);
  valueTable_ = table(values_, "comparedValues", tr("Changed settings"));
  errorTable_ = table(errors_, "comparedErrors", tr("Changed errors"));
  modelTable_ = table(models_, "comparedModels", tr("Compared models"));
  auto* tabs = new QTabWidget;
  tabs->setDocumentMode(true);
  tabs->addTab(valueTable_, tr("Changes"));
  tabs->addTab(modelTable_, tr("Models"));
  tabs->addTab(errorTable_, tr("Frames"));
  tabs->setTabToolTip(2, tr("Click to select frame, model and light"));
  column->addWidget(tabs, 1);
  connect(button, &QPushButton::clicked, this, &ComparisonPanel::choose);
  connect(onlyDifferences_, &QCheckBox::toggled, this, &ComparisonPanel::fill);
  connect(errorTable_, &QTableView::clicked, this, &ComparisonPanel::selectRow);
  connect(errorTable_, &QTableView::activated, this, &ComparisonPanel::selectRow);
  connect(&document_, &Document::inspectionChanged, this, &ComparisonPanel::showState);
  connect(&document_, &Document::sceneOpened, this, [this] {
    comparison_.reset();
    of_.reset();
    fill();
  });
  fill();
}

void ComparisonPanel::addActions(Actions& actions, QMenu* menu) {
  actions.add("file.compare", menu, tr("&Compare with session…"), [this] { choose(); },
              {{}, {}, tr("Changes of inputs, settings and results, and the error of every frame in both")});
}

void ComparisonPanel::choose() {
  if (!document_.inspection()) return;
  const QString file = QFileDialog::getOpenFileName(this, tr("Compare with session"), document_.inputFile(),
                                                    tr("Sessions, figures and scenes (*.glint *.png *.json);;All files (*)"));
  if (!file.isEmpty()) compareWith(file);
}

void ComparisonPanel::compareWith(const QString& file) {
  if (!document_.inspection()) return;
  if (document_.stale()) return void(emit problem(tr("Computation is not finished; compare when results are up to date")));
  const QString fileA = document_.sessionFile().isEmpty() ? document_.inputFile() : document_.sessionFile();
  job_.start(tr("Comparing with %1").arg(shownText(QFileInfo(file).fileName())),
             [this, file, fileA, a = document_.inspection()](const ProgressFn& progress) {
               const Opened opened = openedFor(engine_, file);
               Pipeline pipeline(opened.scene);
               const Pipeline::Answer other = engine_.ask(pipeline, {opened.request}, progress);
               const Inspection& b = *other;
               const auto result =
                   std::make_shared<const RunComparison>(compareRuns(sessionOf(*a, progress), *a, sessionOf(b, progress), b));
               return [this, result, a, fileA, file] {
                 of_ = a;
                 show(result, fileA, file);
               };
             });
}

void ComparisonPanel::show(std::shared_ptr<const RunComparison> comparison, const QString& fileA, const QString& fileB) {
  comparison_ = std::move(comparison);
  const auto [nameA, nameB] = shortestNames(fileA, fileB);
  const bool same = QFileInfo(fileA).absoluteFilePath() == QFileInfo(fileB).absoluteFilePath();
  names_ = (same ? tr("A: %1 (on screen)   B: %2 (the file)") : tr("A: %1 (on screen)   B: %2"))
               .arg(shownText(nameA), shownText(nameB));
  paths_ = tr("A: %1\nB: %2")
               .arg(QDir::toNativeSeparators(QFileInfo(fileA).absoluteFilePath()),
                    QDir::toNativeSeparators(QFileInfo(fileB).absoluteFilePath()));
  fill();
  for (QTableView* view : {valueTable_, errorTable_, modelTable_}) {
    view->resizeColumnsToContents();
    for (int c = 0; c < view->model()->columnCount(); ++c) view->setColumnWidth(c, std::clamp(view->columnWidth(c), 46, 150));
  }
  emit shown();
}

void ComparisonPanel::fill() {
  std::vector<RowsModel::Row> values, errors, models;
  const bool all = !onlyDifferences_->isChecked();
  if (comparison_) {
    const QColor faded = palette().color(QPalette::PlaceholderText);
    for (const ComparedValue& v : comparison_->values) {
      if (!all && !v.differs) continue;
      const QString unit = unitAfter(v.unit);
      const auto side = [&](const std::string& s) { return text(s.empty() ? QString() : toQString(s) + unit); };
      RowsModel::Row row{{text(toQString(v.group)), text(toQString(v.name)), side(v.a), side(v.b), number(v.ratio)}, -1};
      row.cells[0].colour = faded;
      if (!v.differs)
        for (RowsModel::Cell& cell : row.cells) cell.colour = faded;
      values.push_back(std::move(row));
    }
    for (std::size_t i = 0; i < comparison_->errors.size(); ++i) {
      const ComparedError& e = comparison_->errors[i];
      if (!all && !e.differs) continue;
      QStringList notes;
      if (e.roleA != e.roleB)
        notes << tr("%1 → %2").arg(e.roleA.empty() ? kNone : toQString(e.roleA), e.roleB.empty() ? kNone : toQString(e.roleB));
      if (!e.errorA) notes << tr("A: %1").arg(toQString(e.reasonA));
      if (!e.errorB && (e.errorA || e.reasonB != e.reasonA)) notes << tr("B: %1").arg(toQString(e.reasonB));
      const QString note = notes.join(QStringLiteral("; "));
      RowsModel::Row row{{text(nameText(e.id)),
                          text(toQString(e.model)),
                          text(nameText(e.light)),
                          number(e.errorA),
                          number(e.errorB),
                          number(e.ratio, 3),
                          {note, {}, {}, note, false}},
                         int(i)};
      if (!e.differs)
        for (RowsModel::Cell& cell : row.cells) cell.colour = faded;
      errors.push_back(std::move(row));
    }
    const auto count = [](int n) { return RowsModel::Cell{QString::number(n), n, {}, {}, true}; };
    for (const RunComparison::Summary& s : comparison_->summaries) {
      const auto mean = [&](double v) { return number(s.common ? std::optional(v) : std::nullopt); };
      models.push_back({{text(toQString(s.model)), count(s.common), mean(s.meanA), mean(s.meanB), mean(s.meanB / s.meanA),
                         count(s.betterA), count(s.betterB)},
                        -1});
    }
  }
  values_->setRows(std::move(values));
  errors_->setRows(std::move(errors));
  models_->setRows(std::move(models));
  showState();
}

void ComparisonPanel::showState() {
  if (!comparison_) return title_->setText(tr("Nothing compared yet."));
  QString line = tr("%1 differences   %2").arg(comparison_->differences()).arg(names_);
  if (of_ != document_.inspection()) line += tr("   (results have changed since; compare again)");
  title_->setText(line);
  title_->setToolTip(paths_ + QLatin1Char('\n') + line);
}

void ComparisonPanel::selectRow(const QModelIndex& row) {
  const int at = row.data(RowsModel::kTagRole).toInt();
  if (!comparison_ || at < 0 || std::size_t(at) >= comparison_->errors.size()) return;
  const ComparedError& e = comparison_->errors[std::size_t(at)];
  if (e.frameA < 0 || e.frameA >= document_.frameCount()) return;
  draw::Selection s = document_.selection();
  s.frame = e.frameA;
  s.model = e.model;
  s.light = e.light;
  s.highlight = -1;
  s.direction.reset();
  document_.select(s);
}

}  // namespace glint::gui
