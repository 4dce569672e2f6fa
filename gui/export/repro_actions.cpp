// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/repro_actions.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QDir>
#include <QFormLayout>
#include <QLabel>
#include <QPushButton>

#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/export/figure_actions.h"
#include "gui/export/folder_dialog.h"
#include "gui/export/long_job.h"

namespace glint::gui {

ReproDialog::ReproDialog(const Fault& fault, const QString& frame, int training, const QString& folder, QWidget* parent)
    : QDialog(parent), folder_(new FolderRow(folder)) {
  setWindowTitle(tr("Minimal session for an error"));
  setObjectName(QStringLiteral("reproDialog"));
  auto* form = new QFormLayout(this);
  auto* what =
      new QLabel(tr("Finds the smallest set of training frames that reproduces this error of <b>%1</b> in frame <b>%2</b>: %3."
                    "<br>Training frames now: %4.")
                     .arg(nameText(fault.model).toHtmlEscaped(), frame.toHtmlEscaped(), toQString(fault.text()).toHtmlEscaped())
                     .arg(training));
  what->setTextFormat(Qt::RichText);
  what->setWordWrap(true);
  what->setMinimumWidth(420);
  form->addRow(what);
  kept_ = new QComboBox;
  kept_->addItems({tr("stays the same"), tr("stays or grows")});
  percent_ = new NumberBox(wholeRange(1, 90));
  percent_->setObjectName(QStringLiteral("reproTolerance"));
  percent_->setValue(20);
  percent_->setSuffix(tr(" %"));
  if (fault.errorPct) {  // a named failure has no size
    form->addRow(tr("&Error"), kept_);
    form->addRow(tr("&Relative tolerance"), percent_);
  } else {
    kept_->setParent(this);
    percent_->setParent(this);
    kept_->hide();
    percent_->hide();
  }
  auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  QPushButton* go = buttons->button(QDialogButtonBox::Ok);
  go->setText(tr("Find and write"));
  form->addRow(tr("New &folder"), folder_);
  form->addRow(buttons);
  const auto check = [this, go] { go->setEnabled(folder_->problem().isEmpty()); };
  connect(folder_, &FolderRow::changed, this, check);
  check();
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
}

QString ReproDialog::folder() const { return folder_->folder(); }

FaultTolerance ReproDialog::tolerance() const {
  return {kept_->currentIndex() == 0 ? FaultKept::Within : FaultKept::AtLeast, percent_->whole() / 100.0};
}

ReproActions::ReproActions(Document& document, LongJob& job, QWidget* window)
    : QObject(window), document_(document), job_(job), window_(window) {}

Outcome<Fault> ReproActions::fault() const {
  if (!document_.inspection() || document_.stale()) return Failure{Reason::NotSupported, "results are out of date"};
  const draw::Selection& s = document_.selection();
  return faultOf(*document_.inspection(), s.frame, document_.plottedModel(), s.light);
}

void ReproActions::addActions(Actions& actions, QMenu* menu) {
  actions.add("export.repro", menu, tr("Minimal &session for this error…"),
              [this] {
                if (!document_.inspection()) return;
                const Outcome<Fault> of = fault();
                if (!of) return void(emit problem(toQString(of.failure().message())));
                const std::shared_ptr<const Inspection> inspection = document_.inspection();
                int training = 0;
                for (int i = 0; i < document_.frameCount(); ++i) training += inspection->isTraining(i);
                const QString frame = nameText(inspection->scene->frames[std::size_t(of->frame)].id);
                ReproDialog dialog(*of, frame, training, suggestedFile(document_, "minimal", {}), window_);
                if (dialog.exec() != QDialog::Accepted) return;
                rememberExport(document_, dialog.folder());
                write(*of, dialog.tolerance(), dialog.folder());
              },
              {{}, {}, tr("Smallest set of training frames that still shows the error of the selected frame and model")});
}

void ReproActions::write(const Fault& fault, const FaultTolerance& tolerance, const QString& folder) {
  job_.start(
      tr("Searching for a minimal session"),
      [this, fault, tolerance, folder, inspection = document_.inspection()](const ProgressFn& progress) -> LongJob::Deliver {
        const Outcome<MinimalRepro> repro = minimalRepro(*inspection, fault, tolerance, progress);
        if (!repro) return [this, why = toQString(repro.failure().message())] { emit problem(why); };
        const WrittenRepro written = writeRepro(*inspection, *repro, tolerance, folder.toStdString(), progress);
        const QString line = tr("Wrote %5: %1 of %2 training frames, %3 (was %4)")
                                 .arg(repro->kept.size())
                                 .arg(repro->of)
                                 .arg(toQString(written.fault.text()), toQString(fault.text()),
                                      QDir::toNativeSeparators(toQString(written.session.string())));
        return [this, line, shows = written.shows, session = exactQString(written.session.string())] {
          if (shows)
            emit this->written(line, session);
          else
            emit problem(tr("The written session does not show the selected error. %1").arg(line));
        };
      });
}

}  // namespace glint::gui
