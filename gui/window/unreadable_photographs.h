// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QMap>
#include <QObject>
#include <QPointer>
#include <QString>
#include <functional>
#include <memory>

#include "gui/base/actions.h"
#include "gui/base/latest_job.h"
#include "gui/document/document.h"

class QDialog;
class QMenu;

namespace glint::gui {

class MessageBar;

/// The photographs of the open scene that cannot be read, with file and reason: those that the pipeline or a view failed at, and
/// those whose file is missing, empty or cut off, which is found out once the first results are there. Names them all in one
/// place, and looks for them in another folder when asked.
class UnreadablePhotographs : public QObject {
  Q_OBJECT
 public:
  /// @param reopen  takes a state whose scene finds its photographs elsewhere.
  UnreadablePhotographs(Document& document, MessageBar& bar, std::function<void(const std::shared_ptr<const Opened>&)> reopen,
                        QWidget* window);
  void addActions(Actions& actions, QMenu* menu);
  /// By frame: "frames/0003.png: the PNG is truncated".
  const QMap<int, QString>& all() const { return all_; }
  bool busy() const { return job_.busy(); }

 public slots:
  /// A view could not show it.
  void note(int frame, const QString& reason);
  void showList();
  void locate();
  /// Opens what is on screen again, with photographs from `folder` where it holds them. problem() when it holds none.
  void locateIn(const QString& folder);

 signals:
  void changed();
  void problem(const QString& oneLine);
  void message(const QString& oneLine);

 private:
  void forget();
  void check();
  void add(const std::map<int, std::string>& found);
  void tell();

  Document& document_;
  MessageBar& bar_;
  std::function<void(const std::shared_ptr<const Opened>&)> reopen_;
  QWidget* window_;
  QMap<int, QString> all_;
  std::shared_ptr<const Scene> checked_;  ///< whose files were looked at
  QString said_;                          ///< on the message bar
  QPointer<QDialog> list_;
  std::function<void()> enable_;
  LatestJob job_, search_;
};

}  // namespace glint::gui
