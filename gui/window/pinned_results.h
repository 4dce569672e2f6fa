// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QList>
#include <QMap>
#include <QObject>

#include "gui/base/actions.h"
#include "gui/document/document.h"

class QAction;
class QDockWidget;
class QLabel;
class QMainWindow;

namespace glint::gui {

/// Two states side by side: pins the newest results, flips every view between them and the newest ones, and shows everywhere
/// which of both is shown. While the pinned ones are shown nothing can be exported: files would not be of what the settings say.
class PinnedResults : public QObject {
  Q_OBJECT
 public:
  /// @param views  get a badge; docks of results say it in their titles, and the status line says that results are pinned.
  PinnedResults(Document& document, const QList<QWidget*>& views, QMainWindow* window);
  /// Adds "view.pin", "view.pinned" and "view.unpin".
  void addActions(Actions& actions, QMenu* menu);

 signals:
  void message(const QString& oneLine);

 private:
  void pin();
  void refresh();

  Document& document_;
  QMainWindow* window_;
  const Actions* actions_ = nullptr;
  QLabel* state_;
  QList<QLabel*> badges_;
  QMap<QDockWidget*, QString> titles_;  ///< as they were before "pinned" was added
  QList<QAction*> held_;                ///< exports that are switched off meanwhile
  QAction *pin_ = nullptr, *flip_ = nullptr, *unpin_ = nullptr;
};

}  // namespace glint::gui
