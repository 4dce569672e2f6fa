// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QWidget>
#include <functional>
#include <memory>
#include <optional>

#include "core/advise/diagnosis.h"
#include "gui/base/actions.h"
#include "gui/base/job_queue.h"
#include "gui/document/document.h"

namespace glint::viz {
struct DrawnRuns;
}

class QLabel;
class QProgressBar;
class QPushButton;
class QTreeWidget;
class QTreeWidgetItem;

namespace glint::gui {

/// What is wrong: models without an answer with their reasons, frames whose highlights are missed or far off; and, when asked,
/// what to do about it, as `glint diagnose` says it: one verdict for the model on screen, at most three remedies, and folded
/// below their evidence. A click on a frame or highlight selects it; "Try" makes the change as one step of undo.
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
  /// Compares models and measures what helps, off the interface thread; the verdict appears at once and improves. Twice: stops.
  void diagnose();
  void tryFirst();  ///< the first remedy
  void stop();

 signals:
  void problemsChanged(int count);  ///< models that do not answer, and frames with missed or spurious highlights or large errors
  void problem(const QString& oneLine);
  void message(const QString& oneLine);
  /// Runs of the requested fits, for the 3D view; null = unknown, or of an earlier state.
  void runsChanged(const std::shared_ptr<const std::vector<glint::viz::DrawnRuns>>& runs);

 private:
  void follow();
  void refresh();
  void fillProblems();
  /// The model that is selected, if nothing is wrong with it; else "".
  std::string goodModel() const;
  /// Says first that the selected model is good, if the list is about others.
  void fillGood();
  /// What the highlights that this model gets wrong have in common.
  void addShared(QTreeWidgetItem* top, const Inspection& inspection, const std::string& model);
  bool isOf(const Inspection& inspection) const;
  /// Takes the diagnosis so far.
  void take(Diagnosis diagnosis);
  bool advised() const;  ///< there is an answer, and nothing has changed since
  void fillAdvice();
  void fillDiagnosis(const ModelDiagnosis& model);
  void tellRuns();
  /// The line of a model below the verdict, made with this text if missing.
  QTreeWidgetItem* itemOf(const std::string& model, const QString& otherwise);
  void addRemedy(QTreeWidgetItem* top, const Remedy& remedy);
  void enableTries();
  void tryRemedy(const Change& change);
  void showState(const QString& stage = {});
  void choose(QTreeWidgetItem* item);

  Document& document_;
  QPushButton* ask_;
  QProgressBar* bar_;
  QLabel* state_;
  QTreeWidget* list_;
  std::shared_ptr<const Inspection> of_;  ///< what the diagnosis is of
  std::optional<Diagnosis> diagnosis_;    ///< as far as it is
  std::string advisedFor_;                ///< the model that was selected when the verdict was listed
  QString steps_;                         ///< "3 of 24"
  bool stopping_ = false;
  int problems_ = 0;
  std::string good_;                      ///< goodModel() when the list was filled
  bool choosing_ = false;                 ///< a line of the list is selecting
  std::vector<std::set<RowKey>> shared_;  ///< highlights of the lines "in common"
  JobQueue queue_{JobQueue::Rank::Background};
};

}  // namespace glint::gui
