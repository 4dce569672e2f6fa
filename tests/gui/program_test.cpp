// SPDX-License-Identifier: BSD-3-Clause
// The program itself, as a script runs it.
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QImage>
#include <QProcess>
#include <QSet>
#include <set>

#include "gui/base/text.h"
#include "gui/document/document.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
struct Run {
  int code = -1;
  QString out, err;
};

/// @param display  where the X server is; "none" = not set, null = that of this test
Run run(const QStringList& arguments, const QString& platform = QStringLiteral("xcb"), const QString& display = {}) {
  static const QTemporaryDir runtime;  // without one, Qt itself writes a line
  QProcess process;
  QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
  if (platform.isEmpty())
    environment.remove(QStringLiteral("QT_QPA_PLATFORM"));
  else
    environment.insert(QStringLiteral("QT_QPA_PLATFORM"), platform);
  if (!display.isNull()) {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "XDG_SESSION_TYPE"})
      environment.remove(QLatin1String(name));
    if (display != QLatin1String("none")) environment.insert(QStringLiteral("DISPLAY"), display);
  }
  environment.insert(QStringLiteral("XDG_RUNTIME_DIR"), runtime.path());
  environment.remove(QStringLiteral("QT_SCALE_FACTOR"));
  process.setProcessEnvironment(environment);
  process.start(QStringLiteral(GLINT_INSPECTOR), arguments);
  process.waitForFinished(180000);
  return {process.exitStatus() == QProcess::NormalExit ? process.exitCode() : -1,
          QString::fromUtf8(process.readAllStandardOutput()), QString::fromUtf8(process.readAllStandardError())};
}

const char* const kScene = R"({"glint_scene": 1, "name": "ball",
      "camera": {"width": 160, "height": 120, "fx": 200, "fy": 200, "cx": 79.5, "cy": 59.5},
      "frames": [
        {"id": "a", "camera_from_world": [[1,0,0,0],[0,1,0,0],[0,0,1,2],[0,0,0,1]], "surface": "ball",
         "highlights": [{"light": "lamp", "peak": [85,60],
                         "contour": [[90,60],[88,64],[85,66],[82,64],[80,60],[82,56],[85,54],[88,56]]}]},
        {"id": "b", "camera_from_world": [[1,0,0,0.1],[0,1,0,0],[0,0,1,2],[0,0,0,1]], "surface": "ball",
         "highlights": [{"light": "lamp", "peak": [93,60],
                         "contour": [[98,60],[96,64],[93,66],[90,64],[88,60],[90,56],[93,54],[96,56]]}]},
        {"id": "c", "camera_from_world": [[1,0,0,0],[0,1,0,0.1],[0,0,1,2],[0,0,0,1]], "surface": "ball"}],
      "surfaces": {"ball": {"analytic": {"type": "sphere", "radius": 0.4}}},
      "lights": [{"id": "lamp", "position": [0.5, 0, -2]}]})";

int colours(const QImage& image, const QRect& part) {
  std::set<QRgb> found;
  for (int y = part.top(); y <= part.bottom(); ++y)
    for (int x = part.left(); x <= part.right(); ++x) found.insert(image.pixel(x, y));
  return int(found.size());
}
}  // namespace

class ProgramTest : public QObject {
  Q_OBJECT
 private slots:
  void theEmptyWindow() {
    const QString file = folder_.filePath(QStringLiteral("empty.png"));
    const Run r = run({QStringLiteral("--screenshot"), file, QStringLiteral("--size"), QStringLiteral("1200x800"),
                       QStringLiteral("--wait-idle")});
    QVERIFY2(r.code == 0, qPrintable(r.err));
    QCOMPARE(QImage(file).size(), QSize(1200, 800));
  }

  /// The example plugin: listed with its file, its layer drawn; one that cannot be loaded is refused by name.
  void plugins() {
    const Run listed = run({QStringLiteral("--plugin"), QStringLiteral(GLINT_EXAMPLE_PLUGIN), QStringLiteral("--version")});
    QCOMPARE(listed.code, 0);
    QVERIFY2(listed.out.contains(QStringLiteral("plugin example 1.0")) &&
                 listed.out.contains(QStringLiteral("model flat-mirror")) &&
                 listed.out.contains(QStringLiteral(GLINT_EXAMPLE_PLUGIN)),
             qPrintable(listed.out));
    const Run refused =
        run({QStringLiteral("--plugin"), QStringLiteral(GLINT_SOURCE_DIR "/LICENSE"), QStringLiteral("--version")});
    QCOMPARE(refused.code, 2);
    QVERIFY2(refused.err.contains(QStringLiteral("LICENSE")) && refused.err.contains(QStringLiteral("cannot be loaded")),
             qPrintable(refused.err));
  }

  /// A sphere with given highlights, seen by three cameras, computed by the real pipeline; the 3D view must not be blank.
  void aScene() {
    const QString scene = folder_.filePath(QStringLiteral("scene.json"));
    QFile out(scene);
    QVERIFY(out.open(QIODevice::WriteOnly));
    out.write(kScene);
    out.close();
    const QString file = folder_.filePath(QStringLiteral("scene.png"));
    const Run r = run({scene, QStringLiteral("--layout"), QStringLiteral("present"), QStringLiteral("--theme"),
                       QStringLiteral("light"), QStringLiteral("--frame"), QStringLiteral("b"), QStringLiteral("--screenshot"),
                       file, QStringLiteral("--size"), QStringLiteral("1200x800"), QStringLiteral("--wait-idle")});
    QVERIFY2(r.code == 0, qPrintable(r.err));
    const QImage image(file);
    QCOMPARE(image.size(), QSize(1200, 800));
    QVERIFY2(colours(image, QRect(60, 150, 450, 400)) > 50, "the 3D view is blank");
  }

  void aSessionComesBackAsItWasSaved() {
    const QString scene = folder_.filePath(QStringLiteral("scene.json")), file = folder_.filePath(QStringLiteral("s.glint"));
    QFile out(scene);
    QVERIFY(out.open(QIODevice::WriteOnly));
    out.write(kScene);
    out.close();
    const Engine engine = coreEngine();
    Document document(engine.parseTrain);
    document.open(engine.open(scene.toStdString(), {}));
    document.setSetting("fit.solver", std::string("anchored"));
    document.setRole(2, FrameRole::Excluded);
    document.setTrain("0-1");
    document.setLayerVisible("rays", "Rays", !document.layerVisible("rays"));
    document.setLayerVisible("frame/peak", "Peaks", false);
    document.select({1, "canonical", 0});
    Opened saved = document.toSave();
    saved.layout = "compare";
    saved.viewPoints = {{{1, 2, 3}, {0, 0, 1}, {0, 1, 0}, 25}};
    engine.save(saved, nullptr, file.toStdString(), {});
    const Opened back = engine.open(file.toStdString(), {});
    QVERIFY(back.isSession);
    QVERIFY(back.request == document.request());
    QCOMPARE(back.layers, document.state().layers);
    QCOMPARE(back.selection.frame, 1);
    QCOMPARE(back.selection.model, std::string("canonical"));
    QCOMPARE(back.selection.highlight, 0);
    QCOMPARE(back.layout, std::string("compare"));
    QCOMPARE(int(back.viewPoints.size()), 1);
    QVERIFY(back.viewPoints[0].position == Eigen::Vector3d(1, 2, 3) && back.viewPoints[0].viewAngleDeg == 25);
    QCOMPARE(engine.open(folder_.path().toStdString(), {}).isSession, false);  // a scene.json beside it comes first
  }

  void whatIsWrongIsOneLineAndExitTwo_data() {
    QTest::addColumn<QStringList>("arguments");
    QTest::addColumn<QString>("mentions");
    const QString shot = folder_.filePath(QStringLiteral("never.png"));
    QTest::newRow("no such input") << QStringList{QStringLiteral("/nowhere/scene.json"), QStringLiteral("--screenshot"), shot}
                                   << QStringLiteral("/nowhere/scene.json");
    QTest::newRow("unknown option") << QStringList{QStringLiteral("--colour")} << QStringLiteral("--colour");
    QTest::newRow("mistyped option") << QStringList{QStringLiteral("--layuot"), QStringLiteral("debug")}
                                     << QStringLiteral("did you mean '--layout'?");
    QTest::newRow("mistyped action") << QStringList{QStringLiteral("--run"), QStringLiteral("view.theem")}
                                     << QStringLiteral("did you mean 'view.theme'?");
    QTest::newRow("unknown layout") << QStringList{QStringLiteral("--layout"), QStringLiteral("x")} << QStringLiteral("--layout");
    QTest::newRow("unknown theme") << QStringList{QStringLiteral("--theme"), QStringLiteral("red")} << QStringLiteral("--theme");
    QTest::newRow("size") << QStringList{QStringLiteral("--size"), QStringLiteral("12")} << QStringLiteral("--size");
    QTest::newRow("missing value") << QStringList{QStringLiteral("--frame")} << QStringLiteral("--frame");
    QTest::newRow("unknown limit") << QStringList{QStringLiteral("--limit"), QStringLiteral("patience=3")}
                                   << QStringLiteral("patience");
    QTest::newRow("limit") << QStringList{QStringLiteral("--limit=json.values=3"),
                                          QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane/plane.glint"),
                                          QStringLiteral("--screenshot"), shot}
                           << QStringLiteral("--limit json.values=");
    QTest::newRow("two inputs") << QStringList{QStringLiteral("a"), QStringLiteral("b")} << QStringLiteral("more than one");
    QTest::newRow("unwritable") << QStringList{QStringLiteral("--screenshot"), QStringLiteral("/nowhere/x.png")}
                                << QStringLiteral("/nowhere/x.png");
  }
  void whatIsWrongIsOneLineAndExitTwo() {
    QFETCH(QStringList, arguments);
    QFETCH(QString, mentions);
    const Run r = run(arguments);
    QCOMPARE(r.code, 2);
    QVERIFY2(r.err.contains(mentions), qPrintable(r.err));
    QCOMPARE(r.err.trimmed().count('\n'), 0);
    QVERIFY(!QFile::exists(folder_.filePath(QStringLiteral("never.png"))));
  }

  void everyActionIsListedOnALineOfItsOwn() {
    const Run r = run({QStringLiteral("--run"), QStringLiteral("list")});
    QVERIFY2(r.code == 0, qPrintable(r.err));
    const QStringList ids = r.out.split('\n', Qt::SkipEmptyParts);
    QVERIFY2(ids.contains(QStringLiteral("plots.try-remedy")) && ids.contains(QStringLiteral("file.open")), qPrintable(r.out));
    QCOMPARE(QSet<QString>(ids.begin(), ids.end()).size(), ids.size());
  }

  /// A message is a line of at most 400 bytes without control characters, whatever the arguments and names hold.
  void errorLinesAreShortAndEscaped_data() {
    QTest::addColumn<QStringList>("arguments");
    QTest::addColumn<QString>("mentions");
    QTest::newRow("long option") << QStringList{QStringLiteral("--nope") + QString(3000, 'a')}
                                 << QStringLiteral("unknown option");
    QTest::newRow("escapes") << QStringList{QStringLiteral("--x\x1b[31my\nz")} << QStringLiteral("--x\\x1B[31my z");
    QDir folder(folder_.path());
    const QString below = (QString(240, 'd') + '/').repeated(5);
    QVERIFY(folder.mkpath(below));
    const QString scene = folder.filePath(below + QStringLiteral("scene.json"));
    QFile out(scene);
    QVERIFY(out.open(QIODevice::WriteOnly));
    out.write("{\"glint_scene\": 1, \"frames\": 3}");
    out.close();
    QTest::newRow("long path") << QStringList{scene, QStringLiteral("--screenshot"), folder.filePath(QStringLiteral("never.png"))}
                               << QStringLiteral("scene.json");
  }
  void errorLinesAreShortAndEscaped() {
    QFETCH(QStringList, arguments);
    QFETCH(QString, mentions);
    const Run r = run(arguments);
    QCOMPARE(r.code, 2);
    QVERIFY2(r.err.contains(mentions), qPrintable(r.err));
    QVERIFY2(r.err.toUtf8().size() <= 400, qPrintable(r.err));
    QCOMPARE(r.err.count('\n'), 1);
    QVERIFY(!r.err.contains(QChar(0x1b)));
  }

  /// As in the commands, a picture replaces only a PNG, and never a file of the open input.
  void aScreenshotReplacesNoFileOfTheInput() {
    QTemporaryDir folder;
    const auto path = [&](const char* name) { return folder.filePath(QString::fromLatin1(name)); };
    const auto put = [](const QString& file, const QByteArray& content) {
      QFile out(file);
      return out.open(QIODevice::WriteOnly) && out.write(content) == content.size();
    };
    const auto contentOf = [](const QString& file) {
      QFile in(file);
      return in.open(QIODevice::ReadOnly) ? in.readAll() : QByteArray();
    };
    QImage photograph(160, 120, QImage::Format_RGB32);
    photograph.fill(Qt::darkGray);
    QVERIFY(photograph.save(path("0000.png")));
    QVERIFY(put(path("scene.json"), QByteArray(kScene).replace("\"id\": \"a\",", "\"id\": \"a\", \"image\": \"0000.png\",")));
    QVERIFY(put(path("notes.txt"), "a person's notes\n"));
    QVERIFY(QFile::link(path("0000.png"), path("link.png")));
    struct Row {
      QString file, mentions;
    };
    for (const Row& row :
         {Row{path("scene.json"), QStringLiteral("scene.json: --screenshot: ")},
          Row{path("0000.png"), QStringLiteral("is an input file")}, Row{path("link.png"), QStringLiteral("is an input file")},
          Row{path("notes.txt"), QStringLiteral("already exists and is not a PNG")}}) {
      const QByteArray before = contentOf(row.file);
      QVERIFY(!before.isEmpty());
      const Run r = run({folder.path(), QStringLiteral("--screenshot"), row.file});
      QVERIFY2(r.code == 2, qPrintable(row.file));
      QVERIFY2(r.err.contains(row.mentions), qPrintable(r.err));
      QCOMPARE(r.err.count('\n'), 1);
      QCOMPARE(contentOf(row.file), before);
    }
    QVERIFY(QFileInfo(path("link.png")).isSymLink());
    // Another picture is replaced.
    QVERIFY(photograph.save(path("shot.png")));
    const Run r = run({folder.path(), QStringLiteral("--screenshot"), path("shot.png")});
    QVERIFY2(r.code == 0, qPrintable(r.err));
    QVERIFY(QImage(path("shot.png")).width() > 160);
  }

  /// The check of the input ends after the results: a picture without its findings would say that all is well.
  void aScreenshotWaitsForFindings() {
    const QString capture = QStringLiteral(GLINT_SHARED_DIR "/data/reports/mesh-y-up");
    if (!QFileInfo::exists(capture)) QSKIP("no data beside the project");
    const QString file = folder_.filePath(QStringLiteral("finding.png"));
    const Run r = run({capture, QStringLiteral("--wait-idle"), QStringLiteral("--screenshot"), file});
    QVERIFY2(r.code == 0, qPrintable(r.err));
    const QImage shown(file);
    int ofTheBar = 0;
    for (int y = 0; y < shown.height() / 4; ++y)
      for (int x = 0; x < shown.width(); ++x) ofTheBar += shown.pixelColor(x, y) == QColor(0x24, 0x4f, 0x7a);
    QVERIFY2(ofTheBar > 10 * shown.width(), qPrintable(QString::number(ofTheBar)));
  }

  void aPlatformWithoutOpenGlIsRefused() {
    const Run r =
        run({QStringLiteral("--screenshot"), folder_.filePath(QStringLiteral("never.png"))}, QStringLiteral("offscreen"));
    QCOMPARE(r.code, 2);
    QVERIFY2(r.err.contains("xvfb-run"), qPrintable(r.err));
  }

  /// Qt would end the program by itself, with SIGABRT and lines of its own.
  void aMissingDisplayIsOneLineAndExitTwo_data() {
    QTest::addColumn<QString>("platform");
    QTest::addColumn<QString>("display");
    QTest::addColumn<QString>("mentions");
    const QString x = QStringLiteral("xcb"), none = QStringLiteral("none"), wrong = QStringLiteral(":4711");
    const QString unset = QStringLiteral("DISPLAY is not set"), closed = QStringLiteral("the display ':4711' cannot be opened");
    QTest::newRow("xcb, not set") << x << none << unset;
    QTest::newRow("xcb, no server") << x << wrong << closed;
    QTest::newRow("with options") << QStringLiteral("xcb:nograb;xcb") << wrong << closed;
    QTest::newRow("no platform chosen, not set") << QString() << none << unset;
    QTest::newRow("no platform chosen, no server") << QString() << wrong << closed;
    QTest::newRow("found by Qt alone") << QStringLiteral("wayland") << none << QStringLiteral("Qt");
    QTest::newRow("no such platform") << QStringLiteral("nonsense") << none << QStringLiteral("Qt");
  }
  void aMissingDisplayIsOneLineAndExitTwo() {
    QFETCH(QString, platform);
    QFETCH(QString, display);
    QFETCH(QString, mentions);
    const Run r = run({QStringLiteral("--screenshot"), folder_.filePath(QStringLiteral("never.png"))}, platform, display);
    QCOMPARE(r.code, 2);
    QVERIFY2(r.err.startsWith(QLatin1String("glint-inspector: ")) && r.err.contains(mentions), qPrintable(r.err));
    QCOMPARE(r.err.count('\n'), 1);
  }

  void withoutAPlatformTheDisplayIsUsed() {
    const QString file = folder_.filePath(QStringLiteral("default.png"));
    const QString display = qEnvironmentVariable("DISPLAY");
    const Run r = run({QStringLiteral("--screenshot"), file}, {}, display);
    QVERIFY2(r.code == 0, qPrintable(r.err));
    QVERIFY(QFile::exists(file));
  }

  void helpNeedsNoDisplay() {
    const Run r = run({QStringLiteral("--help")}, QStringLiteral("offscreen"));
    QCOMPARE(r.code, 0);
    for (const char* flag : {"--layout", "--theme", "--frame", "--screenshot", "--size", "--wait-idle"})
      QVERIFY(r.out.contains(flag));
  }

 private:
  QTemporaryDir folder_;
};

QObject* makeProgramTest() { return new ProgramTest; }

}  // namespace glint::gui

#include "program_test.moc"
