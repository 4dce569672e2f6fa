// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <functional>
#include <optional>

#include "gui/window/autosave.h"

namespace glint::gui {

class FileActions;
class MessageBar;

/// Keeps an autosave while the program runs, and at its start offers what a crashed program left behind.
class Recovery : public QObject {
  Q_OBJECT
 public:
  /// @param snapshot  as Autosave.
  Recovery(const Engine& engine, Document& document, std::function<Opened()> snapshot, FileActions& files, MessageBar& bar,
           QObject* parent);
  void offer();

 signals:
  void problem(const QString& oneLine);
  void opened(bool recovered);  ///< a scene was opened; recovered: the undo history of what was on screen then is not kept

 private:
  Autosave autosave_;
  FileActions& files_;
  MessageBar& bar_;
  std::optional<Autosave::Found> opening_;  ///< what the user asked to recover, until it is open
};

}  // namespace glint::gui
