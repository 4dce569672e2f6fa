// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QStringList>
#include <functional>
#include <utility>

#include "gui/base/actions.h"
#include "gui/document/document.h"
#include "gui/document/runner.h"
#include "gui/window/save_rules.h"

class QMenu;
class QMimeData;
class QWidget;

namespace glint::gui {

/// Opening, saving, recent files, and the question about unsaved changes.
class FileActions : public QObject {
  Q_OBJECT
 public:
  FileActions(const Engine& engine, Document& document, Runner& runner, QWidget* window);
  void addActions(Actions& actions, QMenu* menu);
  QStringList recent() const;
  /// The path of the first local file of a drop; "" without one.
  static QString dropped(const QMimeData* data);
  /// True when nothing is lost, or the user says so. Waits for a save that is under way.
  bool mayDiscard();
  /// Selects this frame once the next input is open: its id, else its number.
  void setFrameToSelect(const QString& frame) { frameToSelect_ = frame; }
  /// Adds what only the window knows (layout, 3D camera) to what is saved.
  void setViewSource(std::function<void(Opened&)> addView) { addView_ = std::move(addView); }

 public slots:
  /// A scene file that was just written from what is on screen: it may name files where those of the open scene are.
  void openWritten(const QString& file);
  void openDialog();
  void openFolderDialog();
  /// What was dropped on the window: a folder, scene, session or figure is opened; a photograph selects its frame, in the open
  /// scene or in the one that lies above it.
  void drop(const QString& path);
  void open(const QString& path);
  /// Opens what a program left behind that died. @param of  the session or scene that it is about.
  void openRecovered(const QString& file, const QString& of);
  /// Opens what was refused, because the user allows its folder. Remembers the permission, for this file and this
  /// folder; a file cannot give it to itself.
  void allow(const glint::gui::OutsidePtr& outside);
  /// Opens a session or scene of which a file lies elsewhere now. False if the user gave up.
  bool openRelinked(const QString& path, const glint::Relinked& instead);
  /// Keeps what is on screen, with another scene; layout and 3D camera stay.
  void reopen(const glint::gui::OpenedPtr& opened);
  /// Asks where a scene or mesh is, starting in `folder`; "" if the user gave up.
  static QString whereIs(const QString& file, bool mesh, const QString& folder, QWidget* window);
  /// Asks where a missing scene or mesh is, then opens what needs it with it. Other meshes that are missing are looked for
  /// beside it. False if the user gave up.
  bool locate(const glint::gui::MissingPtr& missing);
  /// Save in the background; false if there was nothing to save or the user gave up. Message or problem tells how it ended.
  bool save();
  bool saveAs();
  /// Save as, to a file that was chosen; ".glint" is appended to a name without an ending. Asks before it replaces a session, and
  /// replaces nothing else.
  bool saveAsTo(QString path);

 signals:
  void problem(const QString& oneLine);
  void message(const QString& oneLine);
  void notice(const QString& oneLine);  ///< worth knowing now, asks for nothing
  void saveEnded();
  void recentChanged();
  void viewOpened(const glint::gui::OpenedPtr& opened);  ///< after the document took it: layout and 3D camera

 private:
  void finishOpen(const OpenedPtr& opened);
  bool saveTo(const QString& path);
  void finishSave(const QString& path, const QString& problem);
  bool waitForSave();
  void remember(const QString& path);
  void run(const QString& path, Relinked instead);
  void rememberFoldersOf(const QString& session);

  const Engine& engine_;
  Document& document_;
  Runner& runner_;
  QWidget* window_;
  SaveRules rules_;
  std::string stamp_;   ///< of the session as it was opened or saved
  QString allowedFor_;  ///< whose permissions count for what is being opened; "" = its own
  QString frameToSelect_, photographToSelect_;
  std::shared_ptr<const Scene> savingScene_;  ///< not null while a save is under way
  ViewState saving_;                          ///< what it writes
  std::shared_ptr<const Tradeoff> savingTradeoff_;
  bool savingResults_ = false, saveWorked_ = false;
  std::function<void(Opened&)> addView_;
};

}  // namespace glint::gui
