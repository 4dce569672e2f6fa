// SPDX-License-Identifier: BSD-3-Clause
#include "gui/export/export_actions.h"

#include <QApplication>
#include <QClipboard>
#include <QDir>
#include <QFileInfo>
#include <QMenu>
#include <QRegularExpression>
#include <QSysInfo>
#include <exception>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/highlight/report.h"
#include "core/pipeline/photograph.h"
#include "core/report/labels.h"
#include "core/report/masks.h"
#include "core/report/report.h"
#include "core/report/share.h"
#include "core/report/texts.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/base/to_qimage.h"
#include "gui/document/figure.h"
#include "gui/document/session_file.h"
#include "gui/export/figure_actions.h"
#include "gui/export/folder_dialog.h"
#include "gui/export/movie_actions.h"
#include "gui/export/repro_actions.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/retexture_bar.h"
#include "viz/pictures.h"

namespace glint::gui {

namespace {
constexpr int kFigureWidth = 1600, kFigureHeight = 1000;

void writeText(const QString& file, const std::string& text) { atomicWrite(file.toStdString(), text); }

std::vector<int> allFrames(const Inspection& inspection) {
  std::vector<int> frames(inspection.scene->frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i] = int(i);
  return frames;
}
}  // namespace

ExportActions::ExportActions(const Engine& engine, Document& document, QWidget* window)
    : QObject(window), engine_(engine), document_(document), window_(window), long_(window) {
  repro_ = new ReproActions(document_, long_, window_);
  connect(repro_, &ReproActions::problem, this, &ExportActions::problem);
  connect(repro_, &ReproActions::written, this, &ExportActions::sessionWritten);
  connect(&long_, &LongJob::problem, this, &ExportActions::problem);
  connect(&long_, &LongJob::message, this, &ExportActions::message);
}

void ExportActions::setViews(ScenePanel& scene, FramePanel& frame) {
  const auto wrote = [this](const QString& file) { emit message(tr("Wrote %1").arg(QDir::toNativeSeparators(file))); };
  figures_ = new FigureActions(engine_, document_, scene, frame, long_, window_);
  connect(figures_, &FigureActions::problem, this, &ExportActions::problem);
  connect(figures_, &FigureActions::written, this, wrote);
  retexture_ = frame.retexture();
  connect(retexture_, &RetextureBar::saveRequested, this, &ExportActions::saveRetextured);
  movies_ = new MovieActions(document_, scene, frame, long_, window_);
  connect(movies_, &MovieActions::problem, this, &ExportActions::problem);
  connect(movies_, &MovieActions::written, this, wrote);
}

void ExportActions::setSnapshot(std::function<Opened()> snapshot) {
  // What a figure shows is what its session computes, even if that is pinned.
  snapshot_ = [this, snapshot = std::move(snapshot)] {
    Opened opened = snapshot();
    if (document_.pinnedShown()) opened.request = document_.inspection()->request;
    return opened;
  };
  if (figures_) figures_->setSnapshot(snapshot_);
}

bool ExportActions::ready() {
  if (document_.shownStale()) emit problem(notUpToDate());
  return document_.inspection() && !document_.shownStale();
}

void ExportActions::ask(const QString& title, const QString& name, const QString& filter, const std::function<Write()>& prepare) {
  if (!ready()) return;
  const QFileInfo proposed(name);
  const QString file =
      askForFile(window_, document_, title,
                 suggestedFile(document_, proposed.completeBaseName(), QLatin1Char('.') + proposed.suffix()), filter);
  if (file.isEmpty()) return;
  const auto work = [this, file, write = prepare()] {
    write(file);
    return LatestJob::Deliver([this, file] { emit message(tr("Wrote %1").arg(QDir::toNativeSeparators(file))); });
  };
  job_.run(work, [this](const QString& trouble) { emit problem(trouble); });
}

void ExportActions::addActions(Actions& actions, QMenu* menu) {
  if (figures_) figures_->addActions(actions, menu);
  menu->addSeparator();
  const auto picture = [this](const QString& title, const QString& name, auto draw) {
    ask(title, name, tr("Pictures (*.png)"), [this, draw]() -> Write {
      return [this, draw, inspection = document_.inspection(), frame = document_.selection().frame, state = snapshot_(),
              dark = currentTheme() == Theme::Dark](const QString& file) {
        viz::PictureOptions options;
        options.dark = dark;
        writeFigure(toQImage(draw(*inspection, frame, options)), state, engine_, file);
      };
    });
  };
  actions.add("export.frame", menu, tr("&Frame with errors…"), [=] {
    picture(tr("Frame as picture"), QStringLiteral("frame.png"),
            [](const Inspection& i, int frame, const viz::PictureOptions& o) {
              return viz::framePicture(i, frame, photographOf(i, frame), kFigureWidth, kFigureHeight, o);
            });
  });
  actions.add("export.ladder", menu, tr("Model &ladder…"), [=] {
    picture(tr("Model ladder as picture"), QStringLiteral("ladder.png"),
            [](const Inspection& i, int frame, const viz::PictureOptions& o) {
              return viz::ladderPicture(i, frame, photographOf(i, frame), kFigureWidth, kFigureHeight, o);
            });
  });
  actions.add("export.plots", menu, tr("Error &plot…"), [=] {
    picture(tr("Error plot"), QStringLiteral("errors.png"), [](const Inspection& i, int, const viz::PictureOptions& o) {
      return viz::plotsPicture(i, kFigureWidth, kFigureHeight, o);
    });
  });
  if (retexture_)
    actions.add("export.retexture", menu, tr("Re&textured frame…"), [this] { saveRetextured(); },
                {{}, {}, tr("The picture that the frame view shows with Retexture on, whole, as `glint retexture` writes it")});
  menu->addSeparator();
  if (movies_) movies_->addActions(actions, menu);
  menu->addSeparator();
  const auto report = [this] {
    ReportContext context;
    context.input = QFileInfo(document_.inputFile()).fileName().toStdString();
    context.program =
        (QCoreApplication::applicationName() + QLatin1Char(' ') + QCoreApplication::applicationVersion()).toStdString();
    return context;
  };
  actions.add("export.html", menu, tr("&Report (HTML)…"), [=, this] {
    ask(tr("Report"), QStringLiteral("report.html"), tr("Web pages (*.html)"), [=, this]() -> Write {
      return [inspection = document_.inspection(), context = report()](const QString& file) {
        writeText(file, evaluationHtml(*inspection, context));
      };
    });
  });
  actions.add("export.share", menu, tr("&Page to hand out (HTML)…"),
              [=, this] {
                ask(tr("Page to hand out"), QStringLiteral("page.html"), tr("Web pages (*.html)"), [=, this]() -> Write {
                  return [inspection = document_.inspection(), context = report(),
                          view = viewOf(snapshot_ ? snapshot_() : document_.toSave())](const QString& file) {
                    writeText(file, sharePage(*inspection, context, {{}, view}));
                  };
                });
              },
              {{},
               {},
               tr("One file with the scene in 3D, photographs, contours and errors, as `glint share` writes it: it opens in a "
                  "browser without Glint or a network")});
  actions.add("export.json", menu, tr("Evaluation (&JSON)…"), [=, this] {
    ask(tr("Evaluation"), QStringLiteral("evaluation.json"), tr("JSON (*.json)"), [=, this]() -> Write {
      return [inspection = document_.inspection(), context = report()](const QString& file) {
        writeText(file, evaluationJson(*inspection, context));
      };
    });
  });
  actions.add("export.csv", menu, tr("Errors (&CSV)…"), [=, this] {
    ask(tr("Errors"), QStringLiteral("errors.csv"), tr("Tables (*.csv)"), [this]() -> Write {
      return [inspection = document_.inspection()](const QString& file) { writeText(file, evaluationCsv(*inspection)); };
    });
  });
  actions.add("export.coco", menu, tr("Labels of plotted model (C&OCO)…"), [=, this] {
    ask(tr("Labels"), QStringLiteral("labels.json"), tr("COCO (*.json)"), [this]() -> Write {
      return [inspection = document_.inspection(), model = document_.plottedModel()](const QString& file) {
        writeText(file, cocoJson(*inspection, model, allFrames(*inspection)));
      };
    });
  });
  actions.add("export.masks", menu, tr("Labels with m&asks…"),
              [this] {
                if (!ready()) return;
                FolderDialog dialog(tr("Labels with masks"),
                                    tr("Writes a folder with COCO labels and one mask per frame, light and model."),
                                    suggestedFile(document_, "labels", {}), tr("Write"), window_);
                if (dialog.exec() != QDialog::Accepted) return;
                rememberExport(document_, dialog.folder());
                writeLabels(dialog.folder());
              },
              {{}, {}, tr("Folder with COCO labels and one mask per frame, light and model")});
  repro_->addActions(actions, menu);
  menu->addSeparator();
  actions.add("export.command", menu, tr("Copy as comma&nd"), [this] { copyCommand(); },
              {{QKeySequence("Ctrl+Shift+C")}, {}, tr("Command line that computes these results")});
  actions.add("export.window-command", menu, tr("Copy &window as command"), [this] { copyWindowCommand(); },
              {{}, {}, tr("Command line that redraws this window from the saved session")});
  actions.add("export.diagnostic", menu, tr("Copy &diagnostic report"), [this] {
    QApplication::clipboard()->setText(diagnosticReport());
    emit message(tr("Diagnostic report copied to the clipboard; it contains no folder names of this computer"));
  });
}

void ExportActions::saveRetextured() {
  const std::shared_ptr<const Retextured> result = retexture_->result();
  if (!result)
    return void(emit problem(retexture_->busy() ? tr("The retextured frame is still being computed")
                                                : tr("There is no retextured frame; the frame view says why")));
  ask(tr("Retextured frame"), QStringLiteral("retextured.png"), tr("Pictures (*.png)"),
      [result]() -> Write { return [result](const QString& file) { glint::writePng(file.toStdString(), result->picture); }; });
}

void ExportActions::writeLabels(const QString& folder) {
  long_.start(tr("Writing labels"), [this, folder, inspection = document_.inspection()](const ProgressFn& progress) {
    glint::writeLabels(*inspection, folder.toStdString(), progress);
    return [this, folder] { emit message(tr("Wrote %1").arg(QDir::toNativeSeparators(folder))); };
  });
}

/// A command is pasted into a shell in any folder.
std::string ExportActions::sessionPath() const { return QFileInfo(document_.sessionFile()).absoluteFilePath().toStdString(); }

Outcome<std::string> ExportActions::command() const {
  if (!document_.scene()) return Failure{Reason::NoSurface, "no scene is open"};
  Outcome<std::string> text = commandOf(*document_.scene(), document_.request());
  if (text || document_.sessionFile().isEmpty() || document_.hasUnsavedChanges()) return text;
  return "glint evaluate " + shellWord(sessionPath());  // the session holds what has no flag
}

Outcome<std::string> ExportActions::windowCommand() const {
  if (!document_.scene()) return Failure{Reason::NoSurface, "no scene is open"};
  if (document_.sessionFile().isEmpty() || document_.hasUnsavedChanges() || !document_.looksAsSaved())
    return Failure{Reason::NotSupported, "the command opens a saved session; save this session first"};
  const Frame& frame = document_.scene()->frames[std::size_t(document_.selection().frame)];
  const QSize size = window_->window()->size();
  const std::string layout = snapshot_ ? snapshot_().layout : std::string();
  return "glint-inspector " + shellWord(sessionPath()) + (layout.empty() ? std::string() : " --layout " + layout) + " --frame " +
         shellWord(frame.id) + " --theme " + (currentTheme() == Theme::Dark ? "dark" : "light") + " --size " +
         std::to_string(size.width()) + "x" + std::to_string(size.height()) + " --screenshot window.png --wait-idle";
}

void ExportActions::copyCommand() { copy(command()); }
void ExportActions::copyWindowCommand() { copy(windowCommand()); }

void ExportActions::copy(const Outcome<std::string>& text) {
  if (!text) return void(emit problem(tr("Cannot copy a command: %1").arg(toQString(text.failure().detail))));
  QApplication::clipboard()->setText(exactQString(*text));
  emit message(toQString(*text));
}

QString ExportActions::diagnosticReport() const {
  QStringList lines{
      QStringLiteral("%1 %2").arg(QCoreApplication::applicationName(), QCoreApplication::applicationVersion()),
      QStringLiteral("Qt %1, %2, %3").arg(qVersion(), QSysInfo::prettyProductName(), QSysInfo::currentCpuArchitecture())};
  if (const Scene* scene = document_.scene()) {
    lines << QStringLiteral("scene: %1 frames, %2 surfaces, %3 lights given, %4 warnings")
                 .arg(scene->frames.size())
                 .arg(scene->surfaces.size())
                 .arg(scene->lights.size())
                 .arg(scene->warnings.size());
    const InspectionRequest& q = document_.request();
    lines << QStringLiteral("models: ") + joined(q.models)
          << QStringLiteral("train: %1, excluded: %2").arg(toQString(q.train)).arg(q.excluded.size());
    for (const auto& [key, value] : q.settings.values())
      lines << QStringLiteral("set %1 = %2").arg(toQString(key), valueText(value, paramSpec(key)));
    if (const auto inspection = document_.inspection()) lines << toQString(evaluationTable(*inspection));
  }
  if (log_) {
    QString log = log_();  // it names the input as it was given: perhaps relative
    for (const QString& file : {document_.inputFile(), QFileInfo(document_.inputFile()).absoluteFilePath()})
      if (const QString folder = QFileInfo(file).path(); folder.size() > 1) log.replace(folder + '/', QStringLiteral("…/"));
    lines << QStringLiteral("log:") << log;
  }
  // File names stay, folders go: they may hold a person's or a project's name. A path starts where a word does ("25/0/0" is
  // none).
  static const QRegularExpression folders(
      QStringLiteral("(?<![^\\s\"'(=])(?:[A-Za-z]:)?[\\\\/](?:[^\\\\/\\n\"']+[\\\\/])*(?=[^\\\\/\\s\"']+)"));
  return lines.join('\n').replace(folders, QStringLiteral("…/"));
}

}  // namespace glint::gui
