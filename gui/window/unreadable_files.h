// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMap>
#include <QObject>
#include <QPointer>
#include <QString>
#include <functional>
#include <map>
#include <memory>
#include <set>

#include "core/scene/scene_files.h"
#include "gui/base/actions.h"
#include "gui/base/latest_job.h"
#include "gui/document/document.h"

class QDialog;
class QMenu;

namespace glint::gui {

class MessageBar;

/// The files of the open scene's frames that cannot be read, with file and reason: photographs, depth maps, normal maps and
/// masks. Those that the pipeline or a view could not read, and those whose file is missing, empty or cut off, known once
/// the first results are there. Names them all in one place, and looks for them in another folder when asked. The same for a mesh
/// that is there but damaged, one at a time: nothing is computed without it.
class UnreadableFiles : public QObject {
  Q_OBJECT
 public:
  /// @param reopen  takes a state whose scene finds its files elsewhere.
  UnreadableFiles(Document& document, MessageBar& bar, std::function<void(const std::shared_ptr<const Opened>&)> reopen,
                  QWidget* window);
  void addActions(Actions& actions, QMenu* menu);
  /// By frame: "frames/0003.png: the PNG is truncated".
  QMap<int, QString> all(FrameFile kind = FrameFile::Photograph) const;
  bool busy() const { return job_.busy(); }

  /// Shows a failure with the offer to locate the mesh that it is about; false if it is about none of the scene's.
  bool offerMesh(const QString& oneLine);

 public slots:
  /// A view could not show it.
  void note(int frame, const QString& reason);
  void showList();
  void locate();
  /// Opens what is on screen again, with the files of the kinds that cannot be read from `folder` where it holds them. Asks where
  /// it holds files that could be of either of two kinds. problem() when it holds none.
  void locateIn(const QString& folder);

 signals:
  void changed();
  void problem(const QString& oneLine);
  void message(const QString& oneLine);

 private:
  using ByKind = std::map<FrameFile, QMap<int, QString>>;
  void forget();
  void check();
  void add(const FrameFileProblems& found);
  void tell();
  int count() const;
  std::set<FrameFile> kinds() const;
  void locateIn(const QString& folder, const std::set<FrameFile>& kinds);
  void askWhich(const QString& folder, const std::set<FrameFile>& kinds);
  void offerMesh(const QString& oneLine, const std::string& named);
  void locateMesh(const std::string& named, const std::filesystem::path& now);
  /// Opens what is on screen again, with another scene for it.
  void reopen(const std::shared_ptr<const Scene>& scene, const std::shared_ptr<const Session>& session,
              const std::string& warning);

  Document& document_;
  MessageBar& bar_;
  std::function<void(const std::shared_ptr<const Opened>&)> reopen_;
  QWidget* window_;
  ByKind all_;                            ///< kinds with a file that cannot be read only
  std::shared_ptr<const Scene> checked_;  ///< whose files were looked at
  QString tried_;                         ///< a file that was given for the mesh `triedFor_`
  std::string triedFor_;
  QString said_;  ///< on the message bar
  QPointer<QDialog> list_;
  std::function<void()> enable_;
  LatestJob job_, search_;
};

}  // namespace glint::gui
