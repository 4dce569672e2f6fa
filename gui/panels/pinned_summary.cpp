// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/pinned_summary.h"

#include "core/diagnostics/row_changes.h"
#include "core/report/compare_runs.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"

namespace glint::gui {

PinnedSummary::PinnedSummary(Document& document, QWidget* parent) : QLabel(parent), document_(document) {
  setObjectName(QStringLiteral("pinnedSummary"));
  setAccessibleName(tr("Changes since results were pinned"));
  setTextFormat(Qt::PlainText);
  setWordWrap(true);
  setTextInteractionFlags(Qt::TextSelectableByMouse);
  setContentsMargins(8, 2, 6, 4);
  for (const auto signal : {&Document::inspectionChanged, &Document::pinnedChanged, &Document::selectionChanged})
    connect(&document_, signal, this, &PinnedSummary::refresh);
  connect(&document_, &Document::staleChanged, this, &PinnedSummary::refresh);
  hide();
}

QStringList PinnedSummary::changes(const Inspection& before, const Inspection& after) {
  QStringList words;
  for (const ComparedValue& v : compareRuns(Session{}, before, Session{}, after).values) {
    if (!v.differs || v.group == "results" || v.group == "input") continue;
    const auto side = [&](const std::string& text) {
      return text.empty() ? tr("none") : toQString(text) + (v.unit.empty() ? QString() : QLatin1Char(' ') + toQString(v.unit));
    };
    words << tr("%1: %2 → %3").arg(toQString(v.name), side(v.a), side(v.b));
  }
  return words;
}

void PinnedSummary::refresh() {
  const std::shared_ptr<const Inspection> pinned = document_.pinned(), now = document_.computed();
  setVisible(pinned != nullptr);
  if (!pinned || !now) return;
  if (document_.pinnedShown()) {
    setText(
        tr("Pinned state: every view shows the results as they were pinned.\nThe same key, or any change of settings, shows the "
           "newest ones"));
    return setToolTip({});
  }
  if (pinned == now) {
    setText(tr("Pinned. Change something: the table then shows what became of each error"));
    return setToolTip({});
  }
  QString line, tip;
  const std::string shown = document_.plottedModel();
  for (const ErrorChange& c : errorChanges(*pinned, *document_.pinnedRows(), *now, *document_.rows())) {
    const QString text = tr("%1: %2").arg(toQString(c.model), toQString(textOf(c)));
    if (c.model == shown) line = text;
    tip += (tip.isEmpty() ? QString() : QStringLiteral("\n")) + text;
  }
  if (line.isEmpty()) line = tr("%1: not among the pinned models").arg(toQString(shown));
  const QStringList words = changes(*pinned, *now);
  const QString changed =
      words.isEmpty() ? tr("Nothing was changed since") : tr("Changed: %1").arg(words.join(QStringLiteral("; ")));
  setText((document_.stale() ? tr("out of date… ") : QString()) + line + QLatin1Char('\n') + changed);
  setToolTip(plainTip(tip + QLatin1Char('\n') + changed));
}

}  // namespace glint::gui
