// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QStringList>
#include <QWidget>

#include "gui/document/document.h"

namespace glint::gui {

class ElidedLabel;

/// While results are pinned: what changed since, and the shown model's held-out errors. Always two lines; tool tip: all models.
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
