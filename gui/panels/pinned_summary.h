// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QStringList>
#include <QWidget>

#include "gui/document/document.h"

namespace glint::gui {

class ElidedLabel;

/// While results are pinned: how the held-out errors of the shown model changed since, and what was changed, in words. Two lines, so that nothing jumps; the tool tip has all models.
class PinnedSummary : public QWidget {
  Q_OBJECT
 public:
  explicit PinnedSummary(Document& document, QWidget* parent = nullptr);
  /// "light.solver: bundle → triangulated", one for each thing that was changed between two runs.
  static QStringList changes(const Inspection& before, const Inspection& after);

 private:
  void refresh();
  void say(const QString& result, const QString& changed, const QString& tip);

  Document& document_;
  ElidedLabel *result_, *changed_;
};

}  // namespace glint::gui
