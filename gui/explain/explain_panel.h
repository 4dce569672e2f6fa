// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <map>
#include <memory>
#include <optional>

#include "core/explain/explain.h"
#include "gui/base/actions.h"
#include "gui/base/latest_job.h"
#include "gui/document/document.h"

class QLabel;
class QListWidget;
class QTextBrowser;
class QToolButton;

namespace glint::gui {

/// The guided way from the photograph to the prediction, on whatever is open: one step at a time, with its equation, its numbers
/// of the selected highlight, and what breaks here. A step shows its layers alone; leaving gives back those that were shown
/// before.
class ExplainPanel : public QWidget {
  Q_OBJECT
 public:
  explicit ExplainPanel(Document& document, QWidget* parent = nullptr);
  void addActions(Actions& actions, QMenu* menu);
  int step() const;  ///< -1 = not explaining
  const Explanation* explanation() const { return explanation_.get(); }
  bool busy() const { return job_.busy(); }

 public slots:
  void start();
  void leave();
  void next();
  void back();
  void goTo(int step);

 signals:
  void started();
  /// A step is on screen; `tangent` = it happens on the tangent plane of the selected highlight.
  void shown(int step);

 private:
  void compute();
  void refresh();
  QString html() const;

  Document& document_;
  LatestJob job_;
  std::shared_ptr<const Explanation> explanation_;
  std::map<std::string, bool> layersBefore_;  ///< what was shown before the first step
  QListWidget* steps_;
  QTextBrowser* text_;
  QLabel* place_;
  QToolButton *back_, *next_, *leave_;
};

}  // namespace glint::gui
