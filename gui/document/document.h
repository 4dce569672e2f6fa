// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QString>
#include <QUndoStack>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/advise/highlight_rows.h"
#include "gui/document/engine.h"
#include "gui/document/results.h"

namespace glint::gui {

using RowsPtr = std::shared_ptr<const std::vector<HighlightRow>>;

enum class FrameRole { Training, HeldOut, Excluded };

/// Everything that undo restores: plain data, compared and copied as a whole.
struct ViewState {
  InspectionRequest request;
  draw::Selection selection;
  std::map<std::string, bool> layers;  ///< scene layers by their name, frame overlays as "frame/NAME"
  /// How views show things, as "VIEW/NAME": "frame/gamma", "scene/colour-by"; absent = default.
  std::map<std::string, std::string> options;
};

/// What is on screen: the undoable state, the scene that it belongs to and the newest results.
/// Widgets read it, listen to its signals and change it through the actions below; each action is one step of
/// undo, and steps of one gesture (a slider drag, scrubbing) merge; playing and actions without a change leave no step.
class Document : public QObject {
  Q_OBJECT
 public:
  using ParseTrain = std::function<TrainSpec(const std::string&, const Scene&)>;
  explicit Document(ParseTrain parseTrain, QObject* parent = nullptr);

  const Scene* scene() const { return scene_.get(); }
  std::shared_ptr<const Scene> sharedScene() const { return scene_; }
  int frameCount() const { return scene_ ? int(scene_->frames.size()) : 0; }
  const ViewState& state() const { return state_; }
  const InspectionRequest& request() const { return state_.request; }
  const draw::Selection& selection() const { return state_.selection; }
  bool layerVisible(const std::string& name) const;
  /// How a view shows something: see ViewState::options.
  std::string option(const std::string& name, const std::string& otherwise) const;
  double option(const std::string& name, double otherwise) const;
  FrameRole role(int frame) const;
  /// The model that plots show: the selected one, else the last (richest) of those computed.
  std::string plottedModel() const;
  QUndoStack* undoStack() { return &undo_; }
  /// A number that no gesture had before.
  int newGesture() { return ++gesture_; }

  /// What every view shows: the newest results, or the pinned ones while those are flipped to; null before the first. They may
  /// belong to an older request: see stale().
  std::shared_ptr<const Inspection> inspection() const { return pinnedShown_ ? pinned_ : results_.complete(); }
  /// The newest results, whatever is shown: what files are written from.
  std::shared_ptr<const Inspection> computed() const { return results_.complete(); }
  /// Whom to ask for results; null without a scene.
  std::shared_ptr<Pipeline> pipeline() const { return results_.pipeline(); }
  /// highlightRows() of inspection(), made once; never null.
  RowsPtr rows() const { return rowsOf(inspection()); }

  /// Results kept beside the newest ones to compare them with; null = none. Held in memory, neither stored nor a step of undo.
  std::shared_ptr<const Inspection> pinned() const { return pinned_; }
  RowsPtr pinnedRows() const { return rowsOf(pinned_); }
  /// Views show the pinned results. A change of the request ends that.
  bool pinnedShown() const { return pinnedShown_; }
  /// Pins the newest results; false before any exist.
  bool pin();
  void unpin();
  void showPinned(bool shown);

  /// Highlights chosen together, as by a rectangle in a plot; empty = none. No step of undo, and not stored.
  const std::set<RowKey>& brushed() const { return brushed_; }
  void brush(std::set<RowKey> rows);
  bool stale() const { return stale_; }
  /// inspection() is not what the request asks for, nor pinned on purpose: nothing is written of it.
  bool shownStale() const { return stale_ && !pinnedShown_; }
  /// Newest results for the selected frame: inspection(), or those that came before it was complete.
  std::shared_ptr<const Inspection> results() const { return pinnedShown_ ? pinned_ : results_.newest(); }
  /// results(), beside what was observed in the frame since then.
  std::shared_ptr<const Inspection> frameInspection() const { return pinnedShown_ ? pinned_ : results_.ofFrame(); }
  /// results() are not what the request asks for.
  bool frameStale() const { return stale_ && !results_.isAhead(state_.request); }
  /// Results for one frame while the others' are being computed. Ignored when another frame is selected by now.
  void setFrameInspection(std::shared_ptr<const Inspection> inspection, int frame);
  /// What the selected frame shows under the request, before there are results for it; null = what results() say. Ignored when it
  /// is no longer asked for.
  void setObservation(std::shared_ptr<const Observation> observation);
  /// New results. Kept, but not shown, where those on screen are what the request asks for and these are of another one: a run
  /// that was overtaken has come to its end.
  void setInspection(std::shared_ptr<const Inspection> inspection, const InspectionRequest& computedFor);

  /// Measured speed against accuracy of this scene; null = none. Stored in the session.
  std::shared_ptr<const Tradeoff> tradeoff() const { return tradeoff_; }
  void setTradeoff(std::shared_ptr<const Tradeoff> tradeoff);
  /// What every training frame does for the models; null = not asked for. Not stored. See influenceStale().
  std::shared_ptr<const Influence> influence() const { return influence_; }
  /// It was measured with another request than that on screen.
  bool influenceStale() const;
  void setInfluence(std::shared_ptr<const Influence> influence, const InspectionRequest& computedFor);
  /// The request is the model and the settings of this point, and no other model.
  bool isLoaded(const TradeoffPoint& point) const;

  /// Replaces everything; the undo history starts anew. A training specification that does not fit the scene throws InputError.
  void open(const Opened& opened);
  /// Path of the session file, "" without a file.
  const QString& sessionFile() const { return sessionFile_; }
  const QString& inputFile() const { return inputFile_; }
  Opened toSave() const;
  /// @param saved, tradeoff  what was written, which may be older than what is on screen.
  void markSaved(const QString& sessionFile, const ViewState& saved, std::shared_ptr<const Tradeoff> tradeoff = nullptr);
  /// What was made differs from what was opened or saved last: the request, measurements, views kept under a name. How things are
  /// looked at (selection, layers, options, layout) does not count; it is saved along.
  bool hasUnsavedChanges() const;
  /// Layers and options are those that were opened or saved last.
  bool looksAsSaved() const;

 public slots:
  /// @param gesture  equal positive numbers merge into one step of undo; 0 never merges.
  void setSetting(const std::string& key, const SettingValue& value, int gesture = 0);
  void resetSetting(const std::string& key);
  void setModels(const std::vector<std::string>& models);
  /// False, with one line in `error`, when the specification does not parse.
  bool setTrain(const std::string& specification, QString* error = nullptr);
  void setSource(FrameSource source);
  /// Models and settings changed in one step of undo. @param text  what the step is called.
  void setRequest(const glint::InspectionRequest& request, const QString& text);
  /// Model and settings of a measured point, as one step of undo. @param text  what the step is called.
  void load(const glint::TradeoffPoint& point, const QString& text);
  /// @param mergeKey  equal texts that are not empty merge into one step.
  void setWhatIf(const glint::WhatIf& whatIf, const QString& text, const QString& mergeKey = {});
  void setRole(int frame, FrameRole role);
  /// For a selection that was changed, not made: a spurious highlight stays selected only while its frame, model and light do.
  void select(draw::Selection selection, int gesture = 0);
  /// As it is: what was clicked names its spurious highlight itself.
  void selectExactly(const draw::Selection& selection, int gesture = 0);
  void selectFrame(int frame, int gesture = 0);
  /// Selects it without a step of undo: playing.
  void showFrame(int frame);
  void setLayerVisible(const std::string& name, const std::string& title, bool visible);
  /// @param text  what the step of undo is called; @param gesture as setSetting.
  void setOption(const std::string& name, const std::string& value, const QString& text, int gesture = 0);
  void setOption(const std::string& name, double value, const QString& text, int gesture = 0);
  /// Sets it without a step of undo: playing.
  void showOption(const std::string& name, double value);
  /// Layers and options changed together in one step.
  void setView(const std::map<std::string, bool>& layers, const std::map<std::string, std::string>& options, const QString& text);

 signals:
  void sceneOpened();  ///< another scene
  /// Results are stale until the next setInspection, unless those of this request were kept: then inspectionChanged() follows.
  void requestChanged();
  void selectionChanged();
  void layersChanged();
  void optionsChanged();  ///< ViewState::options
  void inspectionChanged();
  /// Other results are pinned, or none, or views flipped to them or back; inspectionChanged() follows a flip.
  void pinnedChanged();
  void brushedChanged();
  void frameInspectionChanged();  ///< results for the selected frame came first; inspectionChanged() follows later
  void staleChanged(bool stale);
  void savedStateChanged();
  void tradeoffChanged();
  void influenceChanged();

 private:
  friend class StateCommand;
  void push(ViewState after, const QString& text, const QString& mergeKey = {});
  void apply(const ViewState& state);
  void followRequest();
  bool historyLeadsTo(const InspectionRequest& request) const;
  void updateTraining();
  void setStale(bool stale);
  RowsPtr rowsOf(const std::shared_ptr<const Inspection>& inspection) const;
  FrameRole requestedRole(int frame) const;

  ParseTrain parseTrain_;
  std::shared_ptr<const Scene> scene_;
  ViewState state_, saved_;
  std::set<int> training_;
  QString sessionFile_, inputFile_;
  std::shared_ptr<const Session> session_;
  Results results_;
  std::shared_ptr<const Inspection> pinned_;
  bool pinnedShown_ = false;
  std::set<RowKey> brushed_;
  mutable std::map<std::shared_ptr<const Inspection>, RowsPtr> rows_;  ///< of the complete ones and pinned_ alone
  std::shared_ptr<const Tradeoff> tradeoff_, savedTradeoff_;
  std::shared_ptr<const Influence> influence_;
  InspectionRequest influenceFor_;
  bool stale_ = false;
  bool unsaved_ = false;  ///< opened in a state that no file holds: recovered, or with its scene moved
  int gesture_ = 0;
  QUndoStack undo_;
};

}  // namespace glint::gui
