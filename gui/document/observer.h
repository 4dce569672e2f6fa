// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QObject>

#include "gui/base/latest_job.h"
#include "gui/document/document.h"

namespace glint::gui {

/// Observes the selected frame anew as soon as a request changes what is observed in it (a threshold, a synthesised lamp), beside
/// the run that computes everything: the contour follows the hand, models come after it. What cannot be read is left to that run
/// to say.
class Observer : public QObject {
 public:
  Observer(const Engine& engine, Document& document, QObject* parent = nullptr);
  bool busy() const { return job_.busy(); }

 private:
  void observe();

  const Engine& engine_;
  Document& document_;
  LatestJob job_{JobQueue::Rank::Foreground};  // the hand waits for it; the run beside it need not
};

}  // namespace glint::gui
