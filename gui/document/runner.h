// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <memory>
#include <string>
#include <vector>

#include "core/base/stage_times.h"
#include "core/scene/capture.h"
#include "gui/base/job_queue.h"
#include "gui/document/engine.h"

namespace glint::gui {

using InspectionPtr = std::shared_ptr<const Inspection>;
using OpenedPtr = std::shared_ptr<const Opened>;
using SelectionPtr = std::shared_ptr<const glint::Selection>;
using TradeoffPtr = std::shared_ptr<const Tradeoff>;
using InfluencePtr = std::shared_ptr<const Influence>;

/// A file without which an input cannot be opened, and what was tried.
struct Missing {
  QString path;       ///< that was to be opened
  QString file;       ///< absolute, where it was looked for
  std::string named;  ///< of a mesh, as the scene file writes it; "" = it is the scene of a session
  Relinked instead;   ///< that it was opened with
};
using MissingPtr = std::shared_ptr<const Missing>;

/// A folder that a session or scene names, and may not without a person's word.
struct Outside {
  QString path;        ///< that was to be opened
  std::string folder;  ///< absolute; to be put into Relinked::folders
  Relinked instead;    ///< that it was opened with
};
using OutsidePtr = std::shared_ptr<const Outside>;

/// What the files of an input leave open, for a person to say.
struct Undecided {
  QString path;  ///< that was to be opened
  UndecidedInput::Question question;
  std::string option;  ///< of the command line, that answers; "" = the answer is the path to open instead
  std::vector<UndecidedInput::Answer> answers;  ///< the possible ones; none = any
  Relinked instead;                             ///< that it was opened with
};
using UndecidedPtr = std::shared_ptr<const Undecided>;

/// The only place that knows both Qt and the pipeline: opens inputs and computes inspections in jobs of its own.
/// The newest request wins. A run that a newer request overtakes is stopped, except in its first `kGraceMs`: quick runs
/// finish, so that a slider shows results while it is dragged; the run after one that was stopped has `kLongGraceMs`, or a slider
/// whose runs take longer would show none. Once the frame that the user looks at is shown, that grace is
/// `kRestGraceMs`, for the rest to be finished. cancel() stops at the pipeline's next progress report.
/// Signals arrive on the thread of this object; only the newest request reports failures.
class Runner : public QObject {
  Q_OBJECT
 public:
  static constexpr int kGraceMs = 250, kLongGraceMs = 1500, kRestGraceMs = 40;
  /// While requests follow one another within `kPauseMs`, each computes its frame; the rest is done in a pause or every
  /// `kRestEveryMs`.
  static constexpr int kPauseMs = 150, kRestEveryMs = 500;

  explicit Runner(Engine engine, QObject* parent = nullptr);

  /// @param instead  where inputs are now that are not where the session or scene says.
  void open(const std::string& path, const Relinked& instead = {});
  /// Answers with finished(), and before it, where the engine can, with frameFinished(): twice where the first look at quick
  /// models is worth a step.
  /// @param frame  what the user looks at: computed first; -1 = none.
  void inspect(std::shared_ptr<Pipeline> pipeline, const InspectionRequest& request, int frame = -1);
  /// Writes a session without stopping what runs; nothing but cancel() stops it. Answers with saved().
  /// @param results  finished results of exactly `opened.request`, or null.
  void save(OpenedPtr opened, InspectionPtr results, const std::string& path);
  /// The automatic choice of the model; answers with chosen(). @param goodEnoughPct  0 = no tolerance.
  void choose(std::shared_ptr<const Scene> scene, const InspectionRequest& request, double goodEnoughPct, InspectionPtr previous);
  /// Speed against accuracy of all settings; answers with measured().
  void measure(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const std::string& file);
  /// What every training frame does; answers with influenceMeasured().
  void influence(InspectionPtr inspection);
  void cancel() { jobs_.stop(); }
  /// No request is needed any longer, except saving: results exist already.
  void drop() { jobs_.drop(); }
  bool busy() const { return jobs_.busy(); }

 signals:
  void busyChanged(bool busy);
  void progressed(const QString& stage, int done, int total);
  void opened(const glint::gui::OpenedPtr& opened);
  void finished(const glint::gui::InspectionPtr& inspection, const glint::gui::OpenedPtr& computedFor);
  /// Results for one frame, the others' are still being computed.
  void frameFinished(const glint::gui::InspectionPtr& inspection, int frame);
  void chosen(const glint::gui::SelectionPtr& selection, const glint::gui::OpenedPtr& computedFor);
  void measured(const glint::gui::TradeoffPtr& tradeoff, const glint::gui::OpenedPtr& computedFor);
  void influenceMeasured(const glint::gui::InfluencePtr& influence, const glint::gui::InspectionPtr& inspection);
  void failed(const QString& oneLine);
  /// An inspection ended: each stage with its time, or the stage in which it ended early. Comes before finished() or failed().
  void timed(const QString& oneLine);
  /// With failed() after it: opening can be tried again with the place of what is missing.
  void inputMissing(const glint::gui::MissingPtr& missing);
  /// With failed() after it: opening can be tried again when a person allows the folder.
  void outsideNamed(const glint::gui::OutsidePtr& outside);
  /// With failed() after it: opening can be tried again with an answer.
  void inputUndecided(const glint::gui::UndecidedPtr& undecided);
  void openFailed();  ///< after failed(): what ran for the scene on screen was stopped for nothing
  void stopped();     ///< by cancel()
  void saved(const QString& path, const QString& problem);  ///< `problem` is one line, "" = the file is written

 private:
  /// @param about  comes with the result in the signal.
  template <class Work, class About, class Result>
  void compute(About about, Work work, void (Runner::*tell)(const std::shared_ptr<const Result>&, const About&));
  ProgressFn progressOf(const JobToken& token, int graceMs = kGraceMs, std::shared_ptr<StageTimes> times = {});
  void end(const JobEnd& end);

  Engine engine_;
  QElapsedTimer sinceRest_;  ///< since all frames were finished last; jobs only
  bool cutOff_ = false;      ///< the last frame that was computed ahead did not come to its end; jobs only
  JobQueue jobs_;
};

}  // namespace glint::gui

Q_DECLARE_METATYPE(glint::gui::InspectionPtr)
Q_DECLARE_METATYPE(glint::gui::OpenedPtr)
Q_DECLARE_METATYPE(glint::gui::SelectionPtr)
Q_DECLARE_METATYPE(glint::gui::TradeoffPtr)
Q_DECLARE_METATYPE(glint::gui::InfluencePtr)
Q_DECLARE_METATYPE(glint::gui::MissingPtr)
Q_DECLARE_METATYPE(glint::gui::OutsidePtr)
Q_DECLARE_METATYPE(glint::gui::UndecidedPtr)
