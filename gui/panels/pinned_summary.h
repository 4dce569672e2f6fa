// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QLabel>
#include <QStringList>

#include "gui/document/document.h"

namespace glint::gui {

/// While results are pinned: how the held-out errors of the shown model changed since, and what was changed, in words. The tool tip has all models.
class PinnedSummary : public QLabel {
  Q_OBJECT
 public:
  explicit PinnedSummary(Document& document, QWidget* parent = nullptr);
  /// "light.solver: bundle → triangulated", one for each thing that was changed between two runs.
  static QStringList changes(const Inspection& before, const Inspection& after);

 private:
  void refresh();
  Document& document_;
};

}  // namespace glint::gui
