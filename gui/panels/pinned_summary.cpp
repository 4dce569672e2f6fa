// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/pinned_summary.h"

#include <QVBoxLayout>
#include <QVariant>

#include "core/advise/row_changes.h"
#include "core/report/compare_runs.h"
#include "gui/base/elided_label.h"
#include "gui/base/text.h"
#include "gui/base/tips.h"

namespace glint::gui {

PinnedSummary::PinnedSummary(Document& document, QWidget* parent)
    : QWidget(parent), document_(document), result_(new ElidedLabel), changed_(new ElidedLabel) {
  setObjectName(QStringLiteral("pinnedSummary"));
  setAccessibleName(tr("Changes since results were pinned"));
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(8, 0, 6, 3);
  column->setSpacing(0);
  result_->setObjectName(QStringLiteral("pinnedResult"));
  changed_->setObjectName(QStringLiteral("pinnedChanges"));
  changed_->setProperty("role", "faded");
  column->addWidget(result_);
  column->addWidget(changed_);
  for (const auto signal : {&Document::inspectionChanged, &Document::pinnedChanged, &Document::selectionChanged})
    connect(&document_, signal, this, &PinnedSummary::refresh);
  connect(&document_, &Document::staleChanged, this, &PinnedSummary::refresh);
  hide();
}

QStringList PinnedSummary::changes(const Inspection& before, const Inspection& after) {
  QStringList words;
  for (const ComparedValue& v : compareRuns(Session{}, before, Session{}, after).values) {
    if (!v.differs || v.group == "results" || v.group == "input") continue;
    if (v.name == "training frames" && before.request.train == after.request.train) continue;  // what is excluded says it
    const auto side = [&](const std::string& text) {
      return text.empty() ? tr("none") : toQString(text) + (v.unit.empty() ? QString() : QLatin1Char(' ') + toQString(v.unit));
    };
    words << tr("%1: %2 → %3").arg(toQString(v.name), side(v.a), side(v.b));
  }
  return words;
}

void PinnedSummary::say(const QString& result, const QString& changed, const QString& tip) {
  result_->setText(result);
  changed_->setText(changed);
  for (ElidedLabel* label : {result_, changed_}) label->setToolTip(plainTip(tip));
}

void PinnedSummary::refresh() {
  const std::shared_ptr<const Inspection> pinned = document_.pinned(), now = document_.computed();
  setVisible(pinned != nullptr);
  if (!pinned || !now) return;
  if (document_.pinnedShown())
    return say(tr("Pinned state: every view shows the results as they were pinned"),
               tr("The same key, or any change of settings, shows the newest ones"), {});
  if (pinned == now) return say(tr("Pinned"), tr("Change something: the table then shows what became of each error"), {});
  QString line, tip;
  const std::string shown = document_.plottedModel();
  for (const ErrorChange& c : errorChanges(*pinned, *document_.pinnedRows(), *now, *document_.rows())) {
    const QString text = tr("%1: %2").arg(toQString(c.model), toQString(textOf(c)));
    if (c.model == shown) line = text;
    tip += text + QLatin1Char('\n');
  }
  if (line.isEmpty()) line = tr("%1: not among the pinned models").arg(toQString(shown));
  const QStringList words = changes(*pinned, *now);
  const QString changed =
      words.isEmpty() ? tr("Nothing was changed since") : tr("Changed: %1").arg(words.join(QStringLiteral("; ")));
  say((document_.stale() ? tr("out of date… ") : QString()) + line, changed, tip + changed);
}

}  // namespace glint::gui
