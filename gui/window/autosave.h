// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDateTime>
#include <QLockFile>
#include <QObject>
#include <functional>
#include <memory>
#include <optional>

#include "gui/base/job_queue.h"
#include "gui/document/document.h"

namespace glint::gui {

/// Keeps what is not saved in a file that outlives a crash: written after every action off the interface thread (the newest
/// state wins), removed once nothing is unsaved or the program ends in order. At most the last action is lost.
class Autosave : public QObject {
  Q_OBJECT
 public:
  /// @param snapshot  what a session would store now. @param folder  for the files of all running programs; it is made.
  Autosave(const Engine& engine, Document& document, std::function<Opened()> snapshot, const QString& folder,
           QObject* parent = nullptr);
  ~Autosave() override;

  struct Found {
    QString file;
    QString of;  ///< session or scene that it is about; "" if the file does not tell
    QDateTime when;
  };
  /// The newest file left behind by a program that runs no more; this program's own file does not count.
  std::optional<Found> leftBehind() const;
  static void discard(const Found& found);
  /// Waits until the newest state is written. For tests and for the end of the program.
  void flush() { jobs_.wait(); }
  QString file() const { return file_; }

 signals:
  void problem(const QString& oneLine);

 private:
  void schedule();

  const Engine& engine_;
  Document& document_;
  std::function<Opened()> snapshot_;
  QString folder_, file_;
  std::unique_ptr<QLockFile> lock_;
  bool reported_ = false;  ///< a folder that cannot be written is reported once
  JobQueue jobs_{JobQueue::Rank::Foreground};
};

}  // namespace glint::gui
