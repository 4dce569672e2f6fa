// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QDialog>
#include <QObject>

#include "core/app/minimal_repro.h"
#include "gui/base/actions.h"
#include "gui/document/document.h"

class QComboBox;
class QWidget;

namespace glint::gui {

class NumberBox;

class FolderRow;
class LongJob;

/// Names the fault, asks how near the smaller one must come to it, and for the folder to write.
class ReproDialog : public QDialog {
  Q_OBJECT
 public:
  ReproDialog(const Fault& fault, const QString& frame, int training, const QString& folder, QWidget* parent);
  FaultTolerance tolerance() const;
  QString folder() const;

 private:
  QComboBox* kept_;
  NumberBox* percent_;
  FolderRow* folder_;
};

/// The smallest set of training frames that still shows the selected error, as a session folder.
class ReproActions : public QObject {
  Q_OBJECT
 public:
  ReproActions(Document& document, LongJob& job, QWidget* window);
  void addActions(Actions& actions, QMenu* menu);
  /// The fault of the selected frame, the selected (else plotted) model and the selected light (else the worst); written() or
  /// problem() tells how it ended.
  Outcome<Fault> fault() const;
  void write(const Fault& fault, const FaultTolerance& tolerance, const QString& folder);

 signals:
  void problem(const QString& oneLine);
  void written(const QString& oneLine, const QString& session);

 private:
  Document& document_;
  LongJob& job_;
  QWidget* window_;
};

}  // namespace glint::gui
