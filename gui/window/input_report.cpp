// SPDX-License-Identifier: BSD-3-Clause
#include "gui/window/input_report.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QStandardPaths>

#include "core/scene/correction.h"
#include "core/scene/outputs.h"
#include "gui/base/text.h"
#include "gui/document/own_files.h"
#include "gui/window/file_actions.h"
#include "gui/window/message_bar.h"

namespace glint::gui {

InputReport::InputReport(const Engine& engine, Document& document, FileActions& files, MessageBar& bar, QWidget* window)
    : QObject(window), engine_(engine), document_(document), files_(files), bar_(bar), window_(window), panel_(new ReportPanel) {
  connect(&document_, &Document::sceneOpened, this, &InputReport::forget);
  connect(panel_, &ReportPanel::fixRequested, this, &InputReport::fix);
}

void InputReport::forget() {
  job_.drop();
  started_ = false;
  report_.reset();
  bar_.withdraw(offered_);
  panel_->show({}, tr("The check starts once the first results are there."));
}

void InputReport::start() {
  if (started_ || !engine_.check || !document_.scene()) return;
  started_ = true;
  panel_->show({}, tr("Checking conventions…"));
  job_.run(
      [this, check = engine_.check, scene = document_.sharedScene()](const JobToken& token) -> LatestJob::Deliver {
        const auto report =
            std::make_shared<const ConventionReport>(check(*scene, [&token](const StageEvent&) { return token.wanted(); }));
        return [this, report] { take(report); };
      },
      [this](const QString& oneLine) { panel_->show({}, tr("The check failed: %1").arg(oneLine)); });
}

void InputReport::take(const ReportPtr& report) {
  report_ = report;
  panel_->show(report, {});
  if (!report->findings.empty()) emit message(tr("Report: %1").arg(toQString(report->findings.front())));
  if (report->findings.empty()) return;
  MessageBar::Answers answers;
  for (const ConventionReport::Proposal& p : report->corrections)
    answers << std::pair(tr("%1…").arg(toQString(p.correction.words)), [this, c = p.correction] { fix(c); });
  answers << std::pair(tr("Show report"), [this] { emit shown(); });
  // What can be corrected at once comes first.
  const std::size_t first = report->corrections.empty() ? 0 : report->corrections.front().finding;
  offered_ = toQString(report->findings[first]);
  offered_[0] = offered_[0].toUpper();  // a sentence there; in lists a word precedes it
  if (report->findings.size() > 1) offered_ += tr(" (1 of %1 findings)").arg(report->findings.size());
  bar_.queueOffer(offered_, answers);
}

void InputReport::fix(const Correction& correction) {
  const std::shared_ptr<const Scene> scene = document_.sharedScene();
  if (!scene) return;
  const QFileInfo input(document_.inputFile());
  const QString folder = input.isDir() ? input.absoluteFilePath() : input.absolutePath();
  const QString own = isShipped(folder) ? QStandardPaths::writableLocation(QStandardPaths::DocumentsLocation) : folder;
  const QString file =
      QFileDialog::getSaveFileName(window_, tr("Write corrected scene"), QDir(own).filePath(QStringLiteral("corrected.json")),
                                   tr("Scenes (*.json)"), nullptr, QFileDialog::DontConfirmOverwrite);
  if (file.isEmpty()) return;
  try {
    Outputs(document_.inputFile().toStdString(), *scene).file(file.toStdString(), "--out", OutputKind::document("glint_scene"));
    writeScene(correctedFor(*scene, {correction.fix}, file.toStdString()), file.toStdString());
  } catch (const InputError& e) {
    emit problem(toQString(e.what()));
    return;
  }
  emit message(tr("Wrote %1").arg(shownText(file)));
  files_.openWritten(file);
}

}  // namespace glint::gui
