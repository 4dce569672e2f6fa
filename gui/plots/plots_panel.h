// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <QWidget>
#include <array>
#include <optional>

#include "core/draw/scatter_plot.h"
#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/export/figure_dialog.h"
#include "gui/plots/samples_loader.h"

class QComboBox;
class QMenu;
class QSplitter;
class QToolButton;

namespace glint::gui {

class PlotCanvas;
class ScatterBar;

/// One or two plots side by side, each chosen from a list; linked with everything else by the document's selection. Which plots
/// are shown is part of the view's options ("plots/first", "plots/second", "plots/two").
class PlotsPanel : public QWidget {
  Q_OBJECT
 public:
  explicit PlotsPanel(Document& document, QWidget* parent = nullptr);
  ~PlotsPanel() override;

  /// Adds "plots.show-ID", "plots.two", "plots.show-all", "plots.copy-*", "plots.save-*" and "plots.influence".
  void addActions(Actions& actions, QMenu* menu);
  ScatterBar* scatterBar(int pane) const { return panes_[std::size_t(pane)].bar; }
  PlotCanvas* canvas(int pane) const { return panes_[std::size_t(pane)].canvas; }
  QComboBox* selector(int pane) const { return panes_[std::size_t(pane)].selector; }
  /// Nothing is being read for the plots on screen.
  bool idle() const { return !loader_.busy(); }
  /// Draws the plots on screen now, for a picture of the window.
  void renderNow();
  /// Writes the current plot, by the file's ending: .svg, .png or .csv. False, with one line in `problem`, when it cannot be
  /// written. @param look  none: as on screen, a PNG twice as fine
  bool saveTo(const QString& file, QString* problem = nullptr, const std::optional<FigureLook>& look = std::nullopt);
  void copyPicture();
  void copyNumbers();
  void copySvg();

 signals:
  void influenceRequested();  ///< for the document's inspection, which is not stale
  void shown();               ///< an action asked for a plot: the dock should be raised
  void problem(const QString& oneLine);

 protected:
  void showEvent(QShowEvent* e) override;

 private:
  struct Pane {
    QWidget* widget = nullptr;
    QComboBox* selector = nullptr;
    PlotCanvas* canvas = nullptr;
    ScatterBar* bar = nullptr;
    draw::ScatterPlot scatter;  ///< what the canvas shows where it is one
    bool dirty = true;
  };
  void buildPane(int index);
  std::string kind(int pane) const;
  void setKind(int pane, const std::string& id);
  void showOptions();
  void setDirty(std::initializer_list<const char*> kinds);   ///< none = all
  void markDirty(std::initializer_list<const char*> kinds);  ///< those plots are drawn again; none named = all
  void refresh();
  draw::PlotData data(const std::string& id, Pane& pane);
  /// The highlights of these samples.
  void brush(const Pane& pane, const std::vector<draw::PlotSample>& samples);
  void wantSamples();
  void followSelection();
  void clicked(const draw::PlotTarget& target);
  void askForInfluence();
  void saveAs(const char* ending);

  Document& document_;
  std::array<Pane, 2> panes_;
  QSplitter* splitter_;
  SamplesLoader loader_;
  FrameSamplesPtr samples_;
  draw::Selection shown_;  ///< selection of the last followSelection
  int current_ = 0;        ///< pane that actions are about
  bool wantsInfluence_ = false;
  QAction* two_ = nullptr;
};

}  // namespace glint::gui
