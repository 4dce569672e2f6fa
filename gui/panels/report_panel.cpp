// SPDX-License-Identifier: BSD-3-Clause
#include "gui/panels/report_panel.h"

#include <QFontDatabase>
#include <QHBoxLayout>
#include <QLabel>
#include <QLayoutItem>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include "gui/base/text.h"

namespace glint::gui {

namespace {
constexpr int kTextLines = 8;  // of the report that a low dock shows at least
}

ReportPanel::ReportPanel(QWidget* parent)
    : QWidget(parent), summary_(new QLabel), findings_(new QVBoxLayout), text_(new QPlainTextEdit) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 0);
  column->setSpacing(4);
  summary_->setObjectName(QStringLiteral("reportSummary"));
  summary_->setWordWrap(true);
  column->addWidget(summary_);
  column->addLayout(findings_);
  text_->setObjectName(QStringLiteral("reportText"));
  text_->setReadOnly(true);
  text_->setAccessibleName(tr("Input report"));
  text_->setLineWrapMode(QPlainTextEdit::NoWrap);
  text_->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
  text_->setMinimumHeight(kTextLines * text_->fontMetrics().lineSpacing());
  column->addWidget(text_, 1);
  show({}, tr("Open a scene to check it."));
}

void ReportPanel::addFinding(const QString& words, const Correction* correction) {
  auto* row = new QWidget;
  auto* line = new QHBoxLayout(row);
  line->setContentsMargins(0, 0, 0, 0);
  auto* label = new QLabel(words);
  label->setWordWrap(true);
  label->setTextFormat(Qt::PlainText);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse);
  line->addWidget(label, 1);
  if (correction) {
    auto* button = new QPushButton(tr("%1…").arg(toQString(correction->words)));
    button->setObjectName(QStringLiteral("fix:") + toQString(correction->fix));
    button->setToolTip(tr("Write a corrected scene file and open it. Nothing of the input changes."));
    connect(button, &QPushButton::clicked, this, [this, c = *correction] { emit fixRequested(c); });
    line->addWidget(button, 0, Qt::AlignTop);
  }
  findings_->addWidget(row);
}

void ReportPanel::show(const ReportPtr& report, const QString& why) {
  while (QLayoutItem* item = findings_->takeAt(0)) {
    delete item->widget();
    delete item;
  }
  text_->setPlainText(report ? toQString(glint::toText(*report)) : QString());
  if (!report) return summary_->setText(why);
  const std::size_t n = report->findings.size();
  summary_->setText(n == 0 ? toQString(report->cleanBill())
                           : tr("%n thing(s) to look at:", nullptr, int(n))
                                 .replace(QStringLiteral("(s)"), n == 1 ? QString() : QStringLiteral("s")));
  for (std::size_t i = 0; i < n; ++i) {
    const Correction* correction = nullptr;
    for (const ConventionReport::Proposal& p : report->corrections)
      if (p.finding == i) correction = &p.correction;
    addFinding(toQString(report->findings[i]), correction);
  }
}

QString ReportPanel::text() const { return text_->toPlainText(); }

}  // namespace glint::gui
