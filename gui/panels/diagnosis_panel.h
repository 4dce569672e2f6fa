// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <functional>
#include <memory>

#include "core/diagnose/diagnosis.h"
#include "gui/base/actions.h"
#include "gui/base/job_queue.h"
#include "gui/document/document.h"

namespace glint::viz {
struct DrawnRuns;
}

class QLabel;
class QPushButton;
class QTreeWidget;
class QTreeWidgetItem;

namespace glint::gui {

using DiagnosisPtr = std::shared_ptr<const Diagnosis>;

/// What is wrong: models without an answer with their reasons, frames whose highlights are missed or far off, and, when asked, why and what
/// helps, as `glint diagnose` says it. A click on a frame or highlight selects it; "Try" makes the change as one step of undo.
class DiagnosisPanel : public QWidget {
  Q_OBJECT
 public:
  explicit DiagnosisPanel(Document& document, QWidget* parent = nullptr);
  int problems() const { return problems_; }
  bool busy() const { return queue_.busy(); }
  QTreeWidget* list() const { return list_; }
  /// @param show  brings the panel into sight
  void addActions(Actions& actions, QMenu* menu, std::function<void()> show);

 public slots:
  /// Measures what helps, off the interface thread; remedies appear as they are found. Asked again while it runs: stops.
  void diagnose();
  /// The first remedy of the selected model, else the first one of all.
  void tryFirst();
  void stop();

 signals:
  void problemsChanged(int count);  ///< models that do not answer, and frames with missed or spurious highlights or large errors
  void problem(const QString& oneLine);
  void message(const QString& oneLine);
  /// How the fits that were asked about went, for the 3D view; null = nothing is known, or of an earlier state.
  void runsChanged(const std::shared_ptr<const std::vector<glint::viz::DrawnRuns>>& runs);

 private:
  void refresh();
  void fillProblems();
  /// The model that is selected, if nothing is wrong with it; else "".
  std::string goodModel() const;
  /// Says so first, where the list has something about others.
  void fillGood();
  /// What the highlights that this model gets wrong have in common.
  void addShared(QTreeWidgetItem* top, const Inspection& inspection, const std::string& model);
  bool isOf(const Inspection& inspection) const;
  void fillDiagnosis(const ModelDiagnosis& model);
  void tellRuns();
  /// The line of a model, made with this text where there is none.
  QTreeWidgetItem* itemOf(const std::string& model, const QString& otherwise);
  void addRemedy(const std::string& model, const Remedy& remedy);
  /// The causes of a model may fill the panel: what to do about them must not be looked for.
  void bringFirstRemedyIntoSight();
  void tryRemedy(const std::string& model, const Change& change);
  void showState(const QString& stage = {});
  void choose(QTreeWidgetItem* item);

  Document& document_;
  QPushButton* ask_;
  QLabel* state_;
  QTreeWidget* list_;
  std::shared_ptr<const Inspection> of_;  ///< what the diagnosis is of
  DiagnosisPtr diagnosis_;
  std::vector<std::pair<std::string, Remedy>> found_;  ///< so far, by the model's name
  int problems_ = 0;
  std::string good_;                      ///< goodModel() when the list was filled
  bool choosing_ = false;                 ///< a line of the list is selecting
  std::vector<std::set<RowKey>> shared_;  ///< highlights of the lines "in common"
  JobQueue queue_{JobQueue::Rank::Background};
};

}  // namespace glint::gui
