// SPDX-License-Identifier: BSD-3-Clause
// What leaves the program comes back: figures with their session, commands, the diagnostic report.
#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QDialog>
#include <QDialogButtonBox>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QGuiApplication>
#include <QImage>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QLineEdit>
#include <QProcess>
#include <QPushButton>
#include <QSvgRenderer>
#include <QTimer>

#include "core/report/report.h"
#include "gui/base/text.h"
#include "gui/document/figure.h"
#include "gui/document/session_file.h"
#include "gui/export/export_actions.h"
#include "gui/export/figure_actions.h"
#include "gui/export/figure_caption.h"
#include "gui/export/figure_dialog.h"
#include "gui/export/folder_dialog.h"
#include "gui/frame/frame_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
const char* const kSession = GLINT_SOURCE_DIR "/sessions/plane/plane.glint";
}

class ExportTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    window_ = std::make_unique<MainWindow>(knownEngine());
    window_->show();
    window_->open(QString::fromUtf8(kSession));
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().scene() && window_->idle() && window_->document().inspection(), 60000);
  }
  void cleanup() { window_.reset(); }

  void aFigureOpensAsWhatItShows() {
    Document& d = window_->document();
    d.setSetting("detect.level", 0.4);
    d.setRole(5, FrameRole::Excluded);
    d.selectFrame(2);
    const QString file = folder_.filePath("a figure.png");
    QImage picture(64, 48, QImage::Format_RGB888);
    picture.fill(QColor(10, 200, 30));
    writeFigure(picture, d.toSave(), engine_, file);
    QCOMPARE(QImage(file).pixelColor(5, 5), QColor(10, 200, 30));
    QCOMPARE(QDir(folder_.path()).entryList(QDir::Files | QDir::Hidden), QStringList{"a figure.png"});  // nothing beside it

    const Opened back = openInput(file.toStdString());
    QCOMPARE(back.request.settings.number("detect.level"), 0.4);
    QCOMPARE(back.request.excluded, std::vector<int>{5});
    QCOMPARE(back.selection.frame, 2);
    // A picture may come from others: the place where it says that it was saved is no place to save to.
    QVERIFY(back.unsaved && !back.isSession && back.warning.empty());
    QCOMPARE(toQString(back.path), file);
  }

  /// The name of the text in the picture is a contract with figures that were written long ago.
  void aFigureOfAnotherProgramOpens() {
    QFile session(QString::fromUtf8(kSession));
    QVERIFY(session.open(QIODevice::ReadOnly));
    QImage picture(8, 8, QImage::Format_RGB888);
    picture.fill(Qt::black);
    picture.setText("glint-session", QString::fromUtf8(session.readAll()));
    const QString file = folder_.filePath("old figure.png");
    QVERIFY(picture.save(file));
    const Opened opened = openInput(file.toStdString(), {(QFileInfo(kSession).path() + "/scene.json").toStdString()});
    QCOMPARE(opened.request.train, std::string("0-3"));
    QCOMPARE(int(opened.scene->frames.size()), 6);
  }

  void aPictureWithoutASessionIsNoScene() {
    const QString file = folder_.filePath("plain.png");
    QImage(8, 8, QImage::Format_RGB888).save(file);
    QVERIFY_EXCEPTION_THROWN(openInput(file.toStdString()), InputError);
  }

  void aFigureThatCannotBeWrittenLeavesNothing() {
    QVERIFY_EXCEPTION_THROWN(writeFigure(QImage(8, 8, QImage::Format_RGB888), window_->document().toSave(), engine_,
                                         folder_.filePath("no such/a.png")),
                             InputError);
  }

  /// What is written belongs to one state: numbers of an earlier one never leave under the name of the new one.
  void nothingIsWrittenOfResultsThatAreOutOfDate() {
    Document& d = window_->document();
    d.setSetting("detect.level", 0.4);
    QVERIFY(d.stale());
    for (const char* id :
         {"export.csv", "export.json", "export.html", "export.share", "export.coco", "export.masks", "export.frame",
          "export.ladder", "export.plots", "export.frame-view", "export.scene", "export.movie"}) {
      emit window_->exports()->message(QStringLiteral("another"));
      QTimer::singleShot(3000, qApp, [] {
        if (QWidget* asked = QApplication::activeModalWidget()) asked->close();
      });
      window_->actions().find(id)->trigger();
      QVERIFY2(d.stale(), "it was computed meanwhile");
      QVERIFY2(window_->lastError().contains(QStringLiteral("earlier state")), id);
    }
  }

  /// The pinned results are of another state than what is asked for: a picture of them opens as that one.
  void aFigureOfPinnedResultsHoldsTheirSession() {
    Document& d = window_->document();
    const InspectionRequest before = d.request();
    QVERIFY(d.pin());
    d.setSetting("detect.level", 0.4);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !d.stale(), 60000);
    d.showPinned(true);
    const QString file = folder_.filePath("pinned.png");
    window_->exports()->figures()->writeFrame({{400, 300}, false, false}, file);
    settle();
    QVERIFY(openInput(file.toStdString()).request == before);
  }

  void theCommandComputesWhatIsOnScreen() {
    Document& d = window_->document();
    d.setModels({"canonical"});
    d.setSetting("detect.level", 0.4);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !d.stale(), 60000);
    window_->actions().find("export.command")->trigger();
    const QString command = QGuiApplication::clipboard()->text();
    QVERIFY2(command.startsWith("glint evaluate "), qPrintable(command));
    QProcess shell;
    shell.start("sh", {"-c", QString(command).replace(QStringLiteral("glint evaluate"), QStringLiteral(GLINT_CLI " evaluate")) +
                                 " --json -"});
    QVERIFY(shell.waitForFinished(60000));
    QCOMPARE(shell.exitCode(), 0);
    const QJsonObject all = QJsonDocument::fromJson(shell.readAllStandardOutput()).object();
    QCOMPARE(all["models"].toObject().keys(), QStringList{"canonical"});
    const double printed =
        all["models"].toObject()["canonical"].toObject()["frames"].toArray()[0].toObject()["contour_error_px"].toDouble();
    const auto& rows = d.inspection()->models.at("canonical").frames;
    const int index = all["models"].toObject()["canonical"].toObject()["frames"].toArray()[0].toObject()["index"].toInt();
    double shown = -1;
    for (const FrameComparison& c : rows)
      if (c.frame == index) shown = c.rows.at(0).metrics->contourErrorPx;
    QVERIFY2(std::abs(printed - shown) < 1e-9, qPrintable(QStringLiteral("%1 %2").arg(printed).arg(shown)));
  }

  /// The session is opened by a relative path, a frame is excluded, and the command is run by a shell in another folder.
  void theCommandWorksInAnyFolder() {
    const QString stood = QDir::currentPath();
    QVERIFY(QDir::setCurrent(QFileInfo(kSession).path()));
    window_->open(QStringLiteral("scene.json"));
    QTRY_VERIFY_WITH_TIMEOUT(
        window_->document().inputFile() == "scene.json" && window_->idle() && window_->document().inspection(), 60000);
    Document& d = window_->document();
    d.setModels({"canonical"});
    QVERIFY(d.setTrain("0-3"));  // so that a frame is held out, and the command has an answer
    d.setRole(5, FrameRole::Excluded);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !d.stale(), 60000);
    window_->actions().find("export.command")->trigger();
    const QString command = QGuiApplication::clipboard()->text();
    QVERIFY(QDir::setCurrent(stood));
    QProcess shell;
    shell.setWorkingDirectory(folder_.path());
    shell.start("sh", {"-c", QString(command).replace(QStringLiteral("glint evaluate"), QStringLiteral(GLINT_CLI " evaluate")) +
                                 " --json -"});
    QVERIFY(shell.waitForFinished(60000));
    QVERIFY2(shell.exitCode() == 0, shell.readAllStandardError().constData());
    const QJsonObject all = QJsonDocument::fromJson(shell.readAllStandardOutput()).object();
    QCOMPARE(all["excluded"].toArray(), QJsonArray{5});
    for (const QJsonValue& row : all["models"].toObject()["canonical"].toObject()["frames"].toArray())
      QVERIFY(row.toObject()["index"].toInt() != 5);
  }

  void whatHasNoFlagIsNoCommandUntilItIsSaved() {
    Document& d = window_->document();
    WhatIf turned;
    turned.poses[5].rotation = {0.01, 0, 0};
    d.setWhatIf(turned, "turned");
    const Outcome<std::string> command = window_->exports()->command();
    QVERIFY(!command);
    QVERIFY(toQString(command.failure().detail).contains("what-if"));
    QGuiApplication::clipboard()->setText("untouched");
    window_->actions().find("export.command")->trigger();
    QCOMPARE(QGuiApplication::clipboard()->text(), QStringLiteral("untouched"));
    // The session computes it, as if it had been saved.
    d.markSaved("/some where/a b.glint", d.state());
    QVERIFY(window_->exports()->command());
    QCOMPARE(toQString(*window_->exports()->command()), QStringLiteral("glint evaluate '/some where/a b.glint'"));
  }

  void theCommandOfTheWindowDrawsItAgain() {
    Document& d = window_->document();
    d.setModels({"canonical"});
    d.selectFrame(3);
    QVERIFY(!window_->exports()->windowCommand());  // nothing stores this
    Opened opened = d.toSave();
    opened.layout = "compare";
    const QString file = folder_.filePath("as it is.glint");
    window_->applyLayout("compare");
    saveSession(opened, nullptr, file.toStdString());
    d.markSaved(file, d.state());
    window_->actions().find("export.window-command")->trigger();
    const QString command = QGuiApplication::clipboard()->text();
    QVERIFY2(command.contains("--layout compare --frame 0003 --theme "), qPrintable(command));
    QProcess shell;
    shell.setWorkingDirectory(folder_.path());
    shell.start("sh", {"-c", QString(command).replace(QStringLiteral("glint-inspector "), QStringLiteral(GLINT_INSPECTOR " "))});
    QVERIFY(shell.waitForFinished(120000));
    QCOMPARE(shell.exitCode(), 0);
    QCOMPARE(QImage(folder_.filePath("window.png")).size(), window_->size());
  }

  /// A folder is asked for as a folder: beside the session at first, then where the last one went.
  void aFolderOfLabelsIsProposedBesideTheSessionAndNeverWrittenOver() {
    QTemporaryDir place;
    const auto answer = [this](const QString& folder, QString* proposed, bool* possible) {
      QTimer::singleShot(0, this, [=] {
        auto* dialog = qobject_cast<QDialog*>(QApplication::activeModalWidget());
        if (!dialog || dialog->objectName() != "folderDialog") return;
        auto* line = dialog->findChild<QLineEdit*>("newFolder");
        auto* go = dialog->findChild<QDialogButtonBox*>()->button(QDialogButtonBox::Ok);
        *proposed = line->text();
        if (!folder.isEmpty()) line->setText(folder);
        *possible = go->isEnabled();
        if (*possible)
          go->click();
        else
          dialog->reject();
      });
      window_->actions().find("export.masks")->trigger();
    };
    QString proposed;
    bool possible = false;
    answer(place.path(), &proposed, &possible);
    QVERIFY(possible);  // an empty folder may be filled
    QCOMPARE(QFileInfo(proposed).absolutePath(), QFileInfo(window_->document().inputFile()).absolutePath());
    QTRY_VERIFY(QFileInfo::exists(place.filePath("masks.json")) && window_->idle());
    answer(place.path(), &proposed, &possible);
    QVERIFY(!possible);  // now there is something in it
    answer(place.filePath("no/such"), &proposed, &possible);
    QVERIFY(!possible);
    answer(place.filePath("second"), &proposed, &possible);
    QVERIFY(possible);
    QTRY_VERIFY(QFileInfo::exists(place.filePath("second/masks.json")) && window_->idle());
    answer({}, &proposed, &possible);
    QCOMPARE(QFileInfo(proposed).absolutePath(), place.path());
    QTRY_VERIFY(window_->idle());
  }

  void aNewFolderIsOneWithNothingInIt() {
    QTemporaryDir place;
    const QDir dir(place.path());
    const auto write = [&](const char* name) {
      QFile file(dir.filePath(name));
      QVERIFY(file.open(QIODevice::WriteOnly) && file.write("x") == 1);
    };
    QVERIFY(dir.mkdir("empty") && dir.mkdir("full") && dir.mkdir("hidden") && dir.mkdir("full-2"));
    write("full/a");
    write("hidden/.a");
    write("full-2/a");
    write("file");
    QCOMPARE(FolderRow(dir.filePath("new")).folder(), dir.filePath("new"));
    QCOMPARE(FolderRow(dir.filePath("empty")).folder(), dir.filePath("empty"));
    QCOMPARE(FolderRow(dir.filePath("full")).folder(), dir.filePath("full-3"));
    QCOMPARE(FolderRow(dir.filePath("hidden")).folder(), dir.filePath("hidden-2"));
    FolderRow row(dir.filePath("new"));
    auto* line = row.findChild<QLineEdit*>("newFolder");
    const auto possible = [&](const QString& typed) {
      line->setText(typed);
      return row.problem().isEmpty();
    };
    QVERIFY(possible(dir.filePath("new")) && possible(dir.filePath("empty")) && possible("  " + dir.filePath("new") + " "));
    for (const QString& typed :
         {QString(), QStringLiteral("  "), QStringLiteral("labels"), QStringLiteral("./labels"), dir.filePath("full"),
          dir.filePath("hidden"), dir.filePath("file"), dir.filePath("file/in"), dir.filePath("no/such")})
      QVERIFY2(!possible(typed), qPrintable(typed));
    line->setText(" ");
    QCOMPARE(row.problem(), QStringLiteral("Enter a folder name"));
  }

  void whereTheLastExportWentCountsForItsInputOnly() {
    QTemporaryDir first, second, exports;
    Document document(parseTrainSpec);
    Opened opened = Fixture().opened();
    const auto open = [&](const QTemporaryDir& folder) {
      opened.path = folder.filePath("scene.json").toStdString();
      document.open(opened);
      return QFileInfo(suggestedFile(document, "labels", {})).absolutePath();
    };
    QCOMPARE(open(first), first.path());
    rememberExport(document, exports.filePath("a"));
    QCOMPARE(QFileInfo(suggestedFile(document, "labels", {})).absolutePath(), exports.path());
    QCOMPARE(open(second), second.path());
  }

  void theDiagnosticReportNamesNoFolder() {
    window_->document().setSetting("detect.level", 0.4);
    const QString report = window_->exports()->diagnosticReport();
    QVERIFY(report.contains("detect.level = 0.4"));
    QVERIFY(report.contains("plane.glint"));  // names of files stay
    QVERIFY2(!report.contains(QStringLiteral(GLINT_SOURCE_DIR)), qPrintable(report));
    QVERIFY2(!report.contains(QDir::homePath() + '/'), qPrintable(report));
    // Numbers with a stroke between them are no folders.
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle() && !window_->document().stale(), 60000);
    const QString again = window_->exports()->diagnosticReport();
    const QStringList table = toQString(evaluationTable(*window_->document().inspection())).split('\n', Qt::SkipEmptyParts);
    QVERIFY(table.size() > 3 && table.join(' ').contains('/'));
    for (const QString& line : table) QVERIFY2(again.contains(line), qPrintable(line));
  }

  /// The scene is named by a relative path, as from a shell; no part of the path is left.
  void theDiagnosticReportNamesNoPartOfARelativePath() {
    const QDir shared(folder_.filePath("private name/deeper"));
    QVERIFY(QDir().mkpath(shared.path()));
    for (const char* file : {"scene.json", "plane.glint"})
      QVERIFY(QFile::copy(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/") + QLatin1String(file), shared.filePath(file)));
    const QString before = QDir::currentPath();
    QVERIFY(QDir::setCurrent(folder_.path()));
    MainWindow window(engine_);
    window.open(QStringLiteral("private name/deeper/plane.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window.document().scene() && window.idle(), 60000);
    const QString report = window.exports()->diagnosticReport();
    QDir::setCurrent(before);
    QVERIFY(report.contains("plane.glint"));
    QVERIFY2(!report.contains("private") && !report.contains("deeper"), qPrintable(report));
  }

  /// Real text in lines as wide as the page, within the size that was asked for, and in one piece as description.
  void aCaptionStandsBelowTheFigure() {
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    window_->framePanel()->goToHighlight();
    const QString words =
        QStringLiteral("Figure 1: errors < 1 % & a caption that is too long for one line of a figure that is this narrow.");
    FigureLook look{{500, 400}, false, false};
    look.caption = words;
    for (const char* name : {"caption.svg", "caption.pdf", "caption.png"}) {
      window_->exports()->figures()->writeFrame(look, folder_.filePath(name));
      settle();
    }
    QFile file(folder_.filePath("caption.svg"));
    QVERIFY(file.open(QIODevice::ReadOnly));
    const QString svg = QString::fromUtf8(file.readAll());
    QVERIFY(svg.contains(QStringLiteral("<desc>%1</desc>").arg(words.toHtmlEscaped())));
    QVERIFY(svg.contains(QStringLiteral("<title>plane.glint</title>")));
    QVERIFY(svg.contains(QStringLiteral(">Figure 1: errors &lt; 1 % &amp; a caption")));
    QVERIFY(!svg.contains(words.toHtmlEscaped() + QStringLiteral("</text>")));  // it takes several lines
    QVERIFY(svg.contains(QStringLiteral("narrow.</text>")));
    QVERIFY(QSvgRenderer(file.fileName()).isValid());
    // What stands above is the figure, as high as the caption leaves it.
    const QImage with(folder_.filePath("caption.png"));
    QCOMPARE(with.size(), look.size);
    const int top = FigureCaption(look).above().size.height();
    QVERIFY(top < 370 && top > 300);  // two or three lines of 12 px
    window_->exports()->figures()->writeFrame(FigureCaption(look).above(), folder_.filePath("without.png"));
    settle();
    QCOMPARE(with.copy(0, 0, 500, top), QImage(folder_.filePath("without.png")).convertToFormat(with.format()));
    int ink = 0;
    for (int y = top; y < 400; ++y)
      for (int x = 0; x < 500; ++x) ink += with.pixelColor(x, y).lightness() < 128;
    QVERIFY2(ink > 500, qPrintable(QString::number(ink)));
    QCOMPARE(with.pixelColor(2, 398), QColor(Qt::white));
    window_->exports()->figures()->writeScene(look, folder_.filePath("caption-3d.png"));
    settle();
    QCOMPARE(QImage(folder_.filePath("caption-3d.png")).size(), look.size);
  }

  void theDialogProposesACaptionAndStartsWithoutOne() {
    FigureDialog dialog("figure", "caption", QSize(400, 300), nullptr);
    window_->document().select({0, "canonical"});
    const QString proposed = proposedCaption(window_->document(), QStringLiteral("3D view"));
    QVERIFY2(proposed.startsWith(QStringLiteral("3D view of the scene ")) && proposed.contains(QStringLiteral("canonical")),
             qPrintable(proposed));
    dialog.proposeCaption(proposed);
    auto* field = dialog.findChild<QLineEdit*>("figureCaption");
    QVERIFY(field && field->text().isEmpty() && dialog.look().caption.isEmpty());
    QCOMPARE(field->placeholderText(), proposed);
    dialog.findChild<QPushButton*>("figureProposeCaption")->click();
    QCOMPARE(dialog.look().caption, proposed);
    dialog.accept();
    QVERIFY(FigureDialog("figure", "caption", QSize(400, 300), nullptr).look().caption.isEmpty());  // it was of that figure
  }

 private:
  void settle() { QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 60000); }

  QTemporaryDir folder_;
  Engine engine_ = coreEngine();
  std::unique_ptr<MainWindow> window_;
};

QObject* makeExportTest() { return new ExportTest; }

}  // namespace glint::gui

#include "export_test.moc"
