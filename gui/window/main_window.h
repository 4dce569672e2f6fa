// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMainWindow>
#include <optional>

#include "gui/base/actions.h"
#include "gui/base/theme.h"
#include "gui/document/document.h"
#include "gui/document/observer.h"
#include "gui/document/runner.h"
#include "gui/window/docks.h"

class QLabel;
class QSplitter;
class QStackedWidget;

namespace glint::gui {

class ComparisonPanel;
class ErrorTable;
class ExportActions;
class ExplainPanel;
class FileActions;
class FramePanel;
class InputReport;
class LampsInWindow;
class LadderPanel;
class LogPanel;
class MessageBar;
class NumbersPanel;
class Palette;
class ParameterPanel;
class PlotsPanel;
class ScenePanel;
class SceneTree;
class ScriptedActions;
class StartPage;
class Teaching;
class SetupPanel;
class Timeline;
class DiagnosisPanel;
class TradeoffPanel;
class UnreadableFiles;
class WhatIfPanel;
class WindowLayout;

/// The window: puts the panels together and wires them; everything else is in their own classes.
class MainWindow : public QMainWindow {
  Q_OBJECT
 public:
  explicit MainWindow(Engine engine, QWidget* parent = nullptr);
  ~MainWindow() override;

  /// @param choices  how a capture of another program is read
  void open(const QString& input, const QString& frame = {}, const InputChoices& choices = {});
  void applyLayout(const QString& name);
  /// Runs actions by their ids, one after the other, each when everything is computed and shown; idle() is false meanwhile.
  /// InputError for an unknown id.
  void runActions(const QStringList& ids);
  void setTheme(Theme theme);
  /// Nothing runs and every panel shows the newest state.
  bool idle() const;
  /// Renders the 3D view and returns the picture of the window, of that of balls where it is shown.
  QPixmap picture();

  Document& document() { return document_; }
  Runner& runner() { return runner_; }
  FramePanel* framePanel() { return frame_; }
  Actions& actions() { return actions_; }
  Palette* commandPalette() const { return palette_; }
  FileActions* files() { return files_; }
  ExportActions* exports() { return exports_; }
  ComparisonPanel* comparison() { return comparison_; }
  InputReport* report() { return report_; }
  LampsInWindow* lamps() { return lamps_; }
  QString lastError() const { return lastError_; }

 signals:
  void problem(const QString& oneLine);

 protected:
  void closeEvent(QCloseEvent* e) override;
  /// As Qt's, but skips what lies behind another tab.
  bool focusNextPrevChild(bool next) override;
  void resizeEvent(QResizeEvent* e) override;
  bool event(QEvent* e) override;
  void dragEnterEvent(QDragEnterEvent* e) override;
  void dropEvent(QDropEvent* e) override;

 private:
  void buildCentre();
  void buildDocks();
  void buildLeftDocks();
  void buildRightDocks();
  void buildResultDocks();
  void buildWorkDocks();
  void buildMenus();
  void fillFileMenu(QMenu* file);
  void fillEditMenu(QMenu* edit);
  void fillViewMenu(QMenu* view);
  void buildPalette();
  void press(const char* button);  ///< by its object name
  void buildStatusLine();
  void connectFiles();
  void connectRunner();
  void connectDocument();
  void offerRecovery();
  void takeChoice(const SelectionPtr& selection, const OpenedPtr& computedFor);
  void takeTradeoff(const TradeoffPtr& tradeoff, const OpenedPtr& computedFor);
  void measureInfluence();
  void takeInfluence(const InfluencePtr& influence, const InspectionPtr& inspection);
  void recompute();
  void showProblem(const QString& oneLine);
  void offerToLocate(const QString& oneLine, const MissingPtr& missing);
  void log(const QString& line);
  void tell(const QString& line);
  void showTitle();
  bool quiet() const;
  void addView(Opened& opened) const;
  Opened snapshot() const;

  Engine engine_;
  Document document_;
  Runner runner_;
  Observer observer_;
  Actions actions_;
  FileActions* files_;
  ExportActions* exports_;
  Docks docks_{this};
  QStackedWidget* centre_ = nullptr;
  StartPage* start_ = nullptr;
  QSplitter* views_ = nullptr;
  WindowLayout* layout_ = nullptr;
  ScenePanel* scene_ = nullptr;
  SceneTree* tree_ = nullptr;
  FramePanel* frame_ = nullptr;
  Timeline* timeline_ = nullptr;
  ComparisonPanel* comparison_ = nullptr;
  DiagnosisPanel* diagnosis_ = nullptr;
  ErrorTable* errors_ = nullptr;
  ExplainPanel* explain_ = nullptr;
  Teaching* teaching_ = nullptr;
  NumbersPanel* numbers_ = nullptr;
  ParameterPanel* parameters_ = nullptr;
  WhatIfPanel* whatIf_ = nullptr;
  Palette* palette_ = nullptr;
  PlotsPanel* plots_ = nullptr;
  SetupPanel* setup_ = nullptr;
  LadderPanel* ladder_ = nullptr;
  TradeoffPanel* tradeoff_ = nullptr;
  LogPanel* log_ = nullptr;
  InputReport* report_ = nullptr;
  LampsInWindow* lamps_ = nullptr;
  MessageBar* messageBar_ = nullptr;
  QLabel* probe_ = nullptr;
  QString lastError_;
  ScriptedActions* script_ = nullptr;
  UnreadableFiles* unreadable_ = nullptr;
  MissingPtr located_;  ///< was pointed at, and is being opened
  OutsidePtr outside_;  ///< a folder that the opening that failed last may not name; null = for another reason, or already said
  /// What the opening that failed last would have to be told; null = for another reason, or already said.
  UndecidedPtr undecided_;
  MissingPtr missing_;      ///< why the opening that failed last did; null = for another reason, or already said
  bool runFailed_ = false;  ///< the message bar shows why the last run failed
};

}  // namespace glint::gui
