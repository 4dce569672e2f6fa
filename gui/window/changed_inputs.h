// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>
#include <QStringList>
#include <memory>

#include "gui/base/latest_job.h"
#include "gui/document/document.h"

namespace glint::gui {

class MessageBar;

/// Inputs of the open session that are not what they were when it was saved: their hashes are compared once the first results are
/// there, and a difference is shown on the message bar and, file by file, in the log.
class ChangedInputs : public QObject {
  Q_OBJECT
 public:
  ChangedInputs(Document& document, MessageBar& bar, QObject* parent);
  /// One line for each: "frames/0002.png: changed".
  const QStringList& all() const { return all_; }
  bool busy() const { return job_.awaited(); }

 signals:
  void message(const QString& oneLine);

 private:
  void forget();
  void check();
  void tell(const QStringList& lines);

  Document& document_;
  MessageBar& bar_;
  QStringList all_;
  bool checked_ = false;
  LatestJob job_;
};

}  // namespace glint::gui
