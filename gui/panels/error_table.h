// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>

#include "gui/base/actions.h"
#include "gui/document/step_run.h"

class QComboBox;
class QLabel;
class QLayout;
class QLineEdit;
class QMenu;
class QTableView;
class QToolButton;

namespace glint::gui {

class ErrorColumns;
class ErrorModel;
class StaleBadge;
class RowFilter;

/// Sortable table of errors with a summary line per model above it. Frame, model, status, words and brush choose rows, a menu
/// columns. Selecting a row selects its frame, model and highlight everywhere. Ctrl+C copies selected rows as tab-separated text
/// with a header.
class ErrorTable : public QWidget {
  Q_OBJECT
 public:
  explicit ErrorTable(Document& document, QWidget* parent = nullptr);
  QTableView* view() const { return view_; }
  ErrorColumns* columns() const { return columns_; }
  void copySelection(QChar separator = QLatin1Char('\t')) const;
  /// Adds "edit.copy-error-rows", "edit.copy-error-rows-csv", "edit.search-errors", "edit.error-columns" and "edit.brush-clear".
  void addActions(Actions& actions, QMenu* menu);

 signals:
  void shown();  ///< an action asked for the table: the dock should be raised

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void changeEvent(QEvent* event) override;
  void resizeEvent(QResizeEvent* event) override;

 private:
  void showSummary();
  /// The summary with as many of its columns as the dock has room for; the others are in its tooltip.
  void fitSummary();
  QString summaryHtml(const std::vector<int>& columns, int problemWidth) const;
  int columnWidth(int column) const;  ///< px
  int nameWidth() const;              ///< px, of the first column
  void showCount();
  void buildHead(QLayout& head);  ///< summary, warnings and choice of rows
  void buildTable();
  void connectTable();
  void buildWarnings(QLayout& row);
  void buildFilters(QLayout& row);
  void showFiltered();  ///< other rows are shown
  void listModels();
  void followBrush();
  void followPinned();
  QString selectedText(QChar separator) const;
  /// How many warnings the results have; a click opens their texts, which are the tool tip, too.
  void showWarnings();
  void fitReason();
  void selectFromDocument();
  /// Scrolls so that the lower edge does not cut the current row.
  void uncutCurrent();
  void selectFromTable();

  Document& document_;
  ErrorModel* model_;
  RowFilter* proxy_;
  QTableView* view_ = nullptr;
  ErrorColumns* columns_ = nullptr;
  StaleBadge* badge_ = nullptr;
  QLabel* summary_ = nullptr;
  struct SummaryRow {
    QString colour, name;  ///< no colour = the heading
    QStringList values;
    QString problem;          ///< in place of values
    QString model{}, poor{};  ///< why its fit is poor, if it is
  };
  std::vector<SummaryRow> summaryRows_;
  QComboBox* filter_;
  QComboBox *models_ = nullptr, *statuses_ = nullptr;
  QLineEdit* search_ = nullptr;
  QToolButton* columnsButton_ = nullptr;
  int beforeBrush_ = 0;  ///< which rows were shown before something was brushed
  QLabel* count_;
  QToolButton* warnings_ = nullptr;
  QLabel* warningTexts_ = nullptr;
  StepRun steps_;           ///< from row to row
  bool selecting_ = false;  ///< the table itself caused the change that it hears of
};

}  // namespace glint::gui
