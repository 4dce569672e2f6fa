// SPDX-License-Identifier: BSD-3-Clause
// Pictures, movies and labels that leave the program, and what comes back by dropping it on the window.
#include <vtkActor2DCollection.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>
#include <vtkTextProperty.h>

#include <QAction>
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QImage>
#include <QLineEdit>
#include <QMimeData>
#include <QPainter>
#include <QProgressDialog>
#include <QSvgRenderer>
#include <QTimer>
#include <QUrl>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "core/draw/epipolar_overlay.h"
#include "gui/base/number_box.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/document/session_file.h"
#include "gui/export/export_actions.h"
#include "gui/export/figure_actions.h"
#include "gui/export/figure_dialog.h"
#include "gui/export/movie_actions.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
const QString kSessions = QStringLiteral(GLINT_SOURCE_DIR "/sessions/");

/// Mean difference of two pictures of one size, 0 .. 255.
double difference(const QImage& a, const QImage& b) {
  double sum = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x) {
      const QColor p = a.pixelColor(x, y), q = b.pixelColor(x, y);
      sum += std::abs(p.red() - q.red()) + std::abs(p.green() - q.green()) + std::abs(p.blue() - q.blue());
    }
  return sum / 3 / a.width() / a.height();
}

/// Drops a file on a window as a file manager does.
void dropOn(QWidget* window, const QString& path) {
  QMimeData data;
  data.setUrls({QUrl::fromLocalFile(path)});
  QDragEnterEvent enter(QPoint(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QCoreApplication::sendEvent(window, &enter);
  QVERIFY(enter.isAccepted());
  QDropEvent drop(QPointF(50, 50), Qt::CopyAction, &data, Qt::LeftButton, Qt::NoModifier);
  QCoreApplication::sendEvent(window, &drop);
}

struct Movie {
  int frames = 0;
  QSize size;
  double least = 1e9;  ///< difference between one frame and the next
};
Movie readMovie(const QString& file) {
  Movie movie;
  cv::VideoCapture reader(file.toStdString());
  cv::Mat frame, before;
  while (reader.read(frame)) {
    movie.size = {frame.cols, frame.rows};
    if (movie.frames++ > 0) movie.least = std::min(movie.least, cv::norm(frame, before, cv::NORM_L1) / double(frame.total()));
    before = frame.clone();
  }
  return movie;
}
}  // namespace

class FigureTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    QApplication::setAttribute(Qt::AA_DontUseNativeDialogs);
    window_ = std::make_unique<MainWindow>(coreEngine());
    window_->show();
    open(kSessions + "plane/plane.glint");
  }
  void cleanup() {
    window_.reset();
    QVERIFY2(problem_.isEmpty(), qPrintable(problem_));
  }

  void the3dViewAtAnySize() {
    const QString solid = folder_.filePath("solid.png"), open = folder_.filePath("open.png");
    window_->exports()->figures()->writeScene({{500, 300}, false, false}, solid);
    wait();
    window_->exports()->figures()->writeScene({{500, 300}, true, false}, open);
    wait();
    const QImage a(solid), b(open);
    QCOMPARE(a.size(), QSize(500, 300));
    QCOMPARE(b.size(), QSize(500, 300));
    QVERIFY(!a.hasAlphaChannel() || a.pixelColor(2, 150).alpha() == 255);
    QVERIFY(a.pixelColor(2, 150).lightness() > 200);  // light colours were asked for
    QVERIFY(b.hasAlphaChannel());
    int clear = 0, full = 0;
    for (int y = 0; y < 300; ++y)
      for (int x = 0; x < 500; ++x) {
        clear += b.pixelColor(x, y).alpha() == 0;
        full += b.pixelColor(x, y).alpha() == 255;
      }
    QVERIFY2(clear > 15000 && clear < 140000 && full > 1000,
             qPrintable(QStringLiteral("%1 clear, %2 full").arg(clear).arg(full)));
    // On the light background the transparent one is the solid one again.
    QImage both(a.size(), QImage::Format_RGB32);
    both.fill(a.pixelColor(2, 150));
    QPainter(&both).drawImage(0, 0, b);
    QVERIFY2(difference(both, a) < 0.7, qPrintable(QString::number(difference(both, a))));
    const Opened back = openInput(solid.toStdString());
    QCOMPARE(back.scene->frames.size(), window_->document().scene()->frames.size());
  }

  /// All views as they lie beside each other; B shows nothing here, so that its half is empty.
  void theArrangementOf3dViews() {
    Document& d = window_->document();
    const QString file = folder_.filePath("views.png");
    d.setOption("scene/views", "2", "two");
    d.setOption("scene/layers-2", " ", "nothing in B");
    window_->exports()->figures()->writeScene({{800, 300}, false, true}, file);
    wait();
    const QImage two(file);
    QCOMPARE(two.size(), QSize(800, 300));
    const auto ink = [](const QImage& picture, int from, int to) {
      int count = 0;
      for (int y = 60; y < picture.height() - 60; ++y)  // without names and scale
        for (int x = from; x < to; ++x) count += picture.pixelColor(x, y).lightness() > 90;
      return count;
    };
    QVERIFY2(ink(two, 150, 390) > 1000, qPrintable(QString::number(ink(two, 150, 390))));
    QVERIFY2(ink(two, 410, 790) < 100, qPrintable(QString::number(ink(two, 410, 790))));
    // A wipe is one picture: left of its line that of A.
    d.setOption("scene/layers-2", "", "B as all");
    d.setOption("scene/views", "wipe", "wipe");
    d.setOption("scene/models", "all", "all");
    d.setOption("scene/models-2", "all", "all");
    window_->exports()->figures()->writeScene({{800, 300}, false, true}, file);
    wait();
    QVERIFY(ink(QImage(file), 300, 500) > 1000);
    const QImage wiped(file);
    const auto differ = [](const QImage& a, const QImage& b) {  // without names, legend and scale
      int count = 0;
      for (int y = 60; y < a.height() - 60; ++y)
        for (int x = a.width() / 4; x < a.width() - 60; ++x)
          count += std::abs(a.pixelColor(x, y).lightness() - b.pixelColor(x, y).lightness()) > 20;
      return count;
    };
    d.setOption("scene/views", "1", "one");
    window_->exports()->figures()->writeScene({{800, 300}, false, true}, file);
    wait();
    const QImage one(file);
    QVERIFY2(differ(wiped, one) < 200, qPrintable(QString::number(differ(wiped, one))));  // the line is 180 px long
    // Another point of view gives another picture, and so do fewer models.
    window_->findChild<ScenePanel*>()->lookAlong(viz::AxisView::Right);
    window_->exports()->figures()->writeScene({{800, 300}, false, true}, file);
    wait();
    QVERIFY(differ(QImage(file), one) > 1000);
    const QImage side(file);
    d.setOption("scene/models", "dual", "one model");
    window_->exports()->figures()->writeScene({{800, 300}, false, true}, file);
    wait();
    QVERIFY2(differ(QImage(file), side) > 20, qPrintable(QString::number(differ(QImage(file), side))));
    // Four: A and B above, C and D below, which show nothing here.
    d.setOption("scene/layers-2", "", "B as all");
    d.setOption("scene/layers-3", " ", "nothing in C");
    d.setOption("scene/layers-4", " ", "nothing in D");
    d.setOption("scene/views", "4", "four");
    window_->exports()->figures()->writeScene({{800, 600}, false, true}, file);
    wait();
    const QImage four(file);
    const auto inkIn = [&four](const QRect& area) {
      int count = 0;
      for (int y = area.top(); y <= area.bottom(); ++y)
        for (int x = area.left(); x <= area.right(); ++x) count += four.pixelColor(x, y).lightness() > 90;
      return count;
    };
    QVERIFY2(inkIn({450, 60, 300, 190}) > 300, qPrintable(QString::number(inkIn({450, 60, 300, 190}))));
    QVERIFY2(inkIn({450, 360, 300, 180}) < 50, qPrintable(QString::number(inkIn({450, 360, 300, 180}))));
  }

  /// The other side of a wipe shows another model: it has its own legend and colour bar, without the title again.
  void everyViewThatShowsSomethingElseHasItsLegend() {
    Document& d = window_->document();
    auto* panel = window_->findChild<ScenePanel*>();
    const auto texts = [&](int view) {
      panel->renderNow();
      QStringList shown;
      vtkActor2DCollection* actors = panel->views().view(view).renderer()->GetActors2D();
      actors->InitTraversal();
      while (vtkActor2D* actor = actors->GetNextActor2D())
        if (auto* text = vtkTextActor::SafeDownCast(actor); text && text->GetVisibility() && text->GetInput())
          shown << QString::fromUtf8(text->GetInput());
      return shown.join(QLatin1Char('\n'));
    };
    d.setOption("scene/views", "wipe", "wipe");
    d.setOption("scene/models", "dual", "A");
    d.setOption("scene/models-2", "canonical", "B");
    d.setOption("scene/colour-by", "error", "colours");
    QVERIFY2(texts(0).contains(QStringLiteral("dual: contour error")), qPrintable(texts(0)));
    QVERIFY2(texts(1).contains(QStringLiteral("canonical: contour error")), qPrintable(texts(1)));
    const QString title = toQString(d.scene()->name) + QStringLiteral(", frame");
    QVERIFY(texts(0).contains(title) && !texts(1).contains(title));
    const QString file = folder_.filePath("wipe-legends.png");
    const auto legendOfB = [&] {  // bright pixels below B's name, beside the line
      window_->exports()->figures()->writeScene({{1600, 600}, false, true}, file);
      wait();
      const QImage picture(file);
      int count = 0;
      for (int y = 28; y < 60; ++y)
        for (int x = 806; x < 960; ++x) count += picture.pixelColor(x, y).lightness() > 110;
      return count;
    };
    const int with = legendOfB();
    d.setOption("scene/models-2", "dual", "B as A");
    QVERIFY2(!texts(1).contains(QStringLiteral("contour error")), qPrintable(texts(1)));
    QVERIFY2(with > legendOfB() + 50, qPrintable(QString::number(with)));
    // A view with layers of its own differs, too; without room it has no legend.
    d.setOption("scene/layers-2", " cameras ", "cameras in B");
    QVERIFY2(texts(1).contains(QStringLiteral("contour error")), qPrintable(texts(1)));
    d.setOption("scene/wipe", 0.97, "aside");
    QVERIFY2(!texts(1).contains(QStringLiteral("contour error")), qPrintable(texts(1)));
  }

  void strokesOfTwoFramesStayInTheirHalves() {
    window_->document().setOption("frame/side-by-side", "on", "two frames");
    window_->document().setOption("frame/epipolar", "both", "lines");
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    window_->framePanel()->goToHighlight();
    const FigureLook look{{1000, 400}, false, true};
    for (const char* name : {"pair.png", "pair.svg"}) {
      window_->exports()->figures()->writeFrame(look, folder_.filePath(name));
      wait();
    }
    QImage drawn(1000, 400, QImage::Format_RGB32);
    drawn.fill(Qt::black);
    {
      QPainter painter(&drawn);
      QSvgRenderer(folder_.filePath("pair.svg")).render(&painter);
    }
    const QImage png(folder_.filePath("pair.png"));  // its painter clips
    constexpr int kKey = 130;                        // px: above is the key, whose letters are not those of the other renderer
    // The strokes of the right frame, which is drawn last, would show in the left half. Smoothing and letters of the two
    // renderers differ by 683 px there; without the cut it is 2,489 px.
    int over = 0;
    for (int y = kKey; y < 400; ++y)
      for (int x = 0; x < 500; ++x) over += std::abs(drawn.pixelColor(x, y).lightness() - png.pixelColor(x, y).lightness()) > 60;
    QVERIFY2(over < 1400, qPrintable(QString::number(over)));
  }

  /// A figure stands alone: it says what white and what each colour is.
  void aFigureOfAFrameHasAKey() {
    const auto words = [&](const char* name) {
      window_->exports()->figures()->writeFrame({{1000, 700}, false, false}, folder_.filePath(QLatin1String(name)));
      wait();
      QFile svg(folder_.filePath(QLatin1String(name)));
      return svg.open(QIODevice::ReadOnly) ? QString::fromUtf8(svg.readAll()) : QString();
    };
    const QString all = words("all.svg");
    QVERIFY(all.contains(QStringLiteral(">observed<")));
    for (const std::string& model : window_->document().request().models)
      QVERIFY2(all.contains(QStringLiteral(">%1<").arg(toQString(model))), model.c_str());
    window_->document().setLayerVisible("frame/observed", "Observed", false);
    window_->document().setLayerVisible("frame/model/dual", "dual", false);
    const QString less = words("less.svg");
    QVERIFY(!less.contains(QStringLiteral(">observed<")) && !less.contains(QStringLiteral(">dual<")));
    QVERIFY(less.contains(QStringLiteral(">canonical<")));
  }

  /// Only the key tells the lines of real and virtual cameras apart; in the window it stands above the pictures.
  void twoFramesKeepTheKeyOfTheirLines() {
    window_->document().setOption("frame/side-by-side", "on", "two frames");
    const FigureLook look{{1000, 400}, false, false};
    for (const char* lines : {"both", "off"}) {
      window_->document().setOption("frame/epipolar", lines, "lines");
      QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
      for (const char* name : {"key.svg", "key.pdf", "key.png"}) {
        window_->exports()->figures()->writeFrame(look, folder_.filePath(name));
        wait();
      }
      QFile svg(folder_.filePath("key.svg"));
      QVERIFY(svg.open(QIODevice::ReadOnly));
      const QString text = QString::fromUtf8(svg.readAll());
      const bool wanted = QLatin1String(lines) == QLatin1String("both");
      for (const char* whose : {"real cameras miss by", "virtual cameras miss by"})
        QVERIFY2(text.contains(QLatin1String(whose)) == wanted, whose);
      // Beginning of the first entry: a square of its colour on the page.
      const QImage png(folder_.filePath("key.png"));
      int marked = 0;
      const QColor real = toQColor(draw::kRealEpipolar);
      for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 40; ++x) marked += png.pixelColor(x, y).rgb() == real.rgb();
      QVERIFY2(wanted ? marked > 10 : marked == 0, qPrintable(QString::number(marked)));
    }
  }

  /// A typed size belongs to the picture for which it was typed.
  void aTypedSizeTakesTheShapeOfWhatIsShown() {
    const auto dialog = [](const QSize& shown) { return std::make_unique<FigureDialog>("figure", "shape", shown, nullptr); };
    auto asked = dialog({400, 300});
    asked->findChild<NumberBox*>("figureWidth")->setValue(1200);
    asked->accept();
    QCOMPARE(dialog({400, 300})->look().size, QSize(1200, 900));
    QCOMPARE(dialog({800, 600})->look().size, QSize(1200, 900));
    QCOMPARE(dialog({800, 400})->look().size, QSize(1200, 600));
    asked = dialog({400, 300});  // proportions that were given up stay so for the same picture
    asked->findChild<QCheckBox*>("figureKeepShape")->setChecked(false);
    asked->findChild<NumberBox*>("figureHeight")->setValue(300);
    asked->accept();
    QCOMPARE(dialog({400, 300})->look().size, QSize(1200, 300));
  }

  void theFrameViewAsPictureAndAsStrokes() {
    window_->document().selectFrame(4);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    window_->framePanel()->goToHighlight();
    const FigureLook look{{900, 700}, false, true};
    for (const char* name : {"f.png", "f.svg", "f.pdf"}) {
      window_->exports()->figures()->writeFrame(look, folder_.filePath(name));
      wait();
    }
    const QImage png(folder_.filePath("f.png"));
    QCOMPARE(png.size(), QSize(900, 700));
    QSvgRenderer svg(folder_.filePath("f.svg"));
    QVERIFY(svg.isValid());
    QCOMPARE(svg.viewBox(), QRect(0, 0, 900, 700));
    QImage drawn(900, 700, QImage::Format_RGB32);
    drawn.fill(Qt::black);
    {
      QPainter painter(&drawn);
      svg.render(&painter);
    }
    QVERIFY2(difference(drawn, png) < 4, qPrintable(QString::number(difference(drawn, png))));
    // The contours are strokes: their vertices are in the file, at the canvas's places.
    QFile text(folder_.filePath("f.svg"));
    QVERIFY(text.open(QIODevice::ReadOnly));
    const QByteArray content = text.readAll();
    QVERIFY(content.contains("<path") && content.contains("<image") && content.contains("#56b4e9"));  // dual's colour
    QFile pdf(folder_.filePath("f.pdf"));
    QVERIFY(pdf.open(QIODevice::ReadOnly));
    QVERIFY(pdf.readAll().contains("/MediaBox [0 0 675.000000 525.000000]"));  // 900 x 700 px of 1/96 inch, in points
  }

  void aFigureOfTheFrameIsWhatTheCanvasShows() {
    window_->document().selectFrame(5);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    FrameCanvas* canvas = window_->framePanel()->canvas();
    // Here a key would name nothing, because the key takes a part of the figure.
    window_->document().setLayerVisible("frame/observed", "Observed", false);
    for (const std::string& model : window_->document().request().models)
      window_->document().setLayerVisible("frame/model/" + model, model.c_str(), false);
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    window_->framePanel()->goToHighlight();
    const QString file = folder_.filePath("same.png");
    const QPixmap shown = canvas->grab();
    window_->exports()->figures()->writeFrame({shown.size(), false, true}, file);
    wait();
    QVERIFY(difference(QImage(file), shown.toImage().convertToFormat(QImage::Format_RGB32)) < 1.5);
  }

  void endingsThatAreNoneAreRefused() {
    window_->exports()->figures()->writeFrame({{200, 200}, false, true}, folder_.filePath("f.gif"));
    QVERIFY(problem_.contains("f.gif"));
    problem_.clear();
    window_->exports()->figures()->writeScene({{200, 200}, false, true}, folder_.filePath("s.svg"));
    QVERIFY(problem_.contains("s.svg"));
    problem_.clear();
    window_->exports()->figures()->writeFrame({{200, 200}, false, true}, folder_.filePath("none/f.png"));
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    QVERIFY(problem_.contains("cannot be written"));
    problem_.clear();
  }

  void theDialogAsksForSizeAndFile() {
    const QString file = folder_.filePath("asked.png");
    QTimer::singleShot(0, this, [] {
      auto* dialog = qobject_cast<QDialog*>(QApplication::activeModalWidget());
      auto* width = dialog->findChild<NumberBox*>("figureWidth");
      auto* height = dialog->findChild<NumberBox*>("figureHeight");
      const double aspect = double(width->value()) / height->value();
      QVERIFY(width->problemOf(QStringLiteral("5")).contains(QStringLiteral("outside")));  // said, not put back without a word
      width->setValue(640);
      QVERIFY(std::abs(640 / aspect - height->value()) <= 0.51);  // proportions are kept
      dialog->accept();
    });
    QTimer poll;  // the file dialog comes when the first one is closed
    connect(&poll, &QTimer::timeout, this, [&] {
      if (auto* files = qobject_cast<QFileDialog*>(QApplication::activeModalWidget())) {
        poll.stop();
        files->selectFile(file);
        files->findChild<QLineEdit*>()->setText(file);
        static_cast<QDialog*>(files)->accept();
      }
    });
    poll.start(20);
    window_->actions().find("export.scene")->trigger();
    wait();
    QCOMPARE(QImage(file).width(), 640);
  }

  /// Bright lines of a dark window would vanish on white paper.
  void aFigureIsForALightPageUnlessADarkOneIsChosen() {
    const auto dialog = [] { return std::make_unique<FigureDialog>("figure", "test", QSize(400, 300), nullptr); };
    auto asked = dialog();
    auto* colours = asked->findChild<QComboBox*>("figureColours");
    auto* transparent = asked->findChild<QCheckBox*>("figureTransparent");
    QVERIFY(!asked->look().dark && !asked->look().transparent);
    QCOMPARE(colours->currentText(), QStringLiteral("Light"));
    transparent->setChecked(true);
    QVERIFY(!asked->look().dark);
    QCOMPARE(colours->currentText(), QStringLiteral("For a light page"));
    colours->setCurrentIndex(0);
    asked->accept();
    asked = dialog();  // the choice is remembered
    QVERIFY(asked->look().dark && asked->look().transparent);
    asked->findChild<QCheckBox*>("figureTransparent")->setChecked(false);
    QVERIFY(asked->look().dark);
    QCOMPARE(asked->findChild<QComboBox*>("figureColours")->currentText(), QStringLiteral("Dark"));
  }

  /// 25.4 mm are an inch.
  void aFigureIsAskedForInMillimetres() {
    FigureDialog dialog("figure", "printed", QSize(800, 600), nullptr);
    auto* mm = dialog.findChild<NumberBox*>("figurePrinted");
    auto* dpi = dialog.findChild<NumberBox*>("figureDpi");
    QVERIFY(mm && dpi);
    dpi->setValue(254);
    QCOMPARE(dialog.look().size, QSize(800, 600));  // the same pixels, smaller on paper
    QCOMPARE(mm->value(), 80.0);
    mm->setValue(120);
    QCOMPARE(dialog.look().size, QSize(1200, 900));
    QCOMPARE(dialog.look().dpi, 254);
    auto* column = dialog.findChild<QComboBox*>();
    column->setCurrentIndex(4);
    emit column->activated(4);
    QVERIFY2(std::abs(mm->value() - 85) < 0.1 && dialog.look().dpi == 600, qPrintable(mm->text()));
    dialog.setOpaque();
    QVERIFY(!dialog.look().transparent);
  }

  void aMovieOfTheTimeline() {
    const int frames = window_->document().frameCount();
    for (const MovieOf of : {MovieOf::FrameView, MovieOf::LookThrough}) {
      const QString file = folder_.filePath(of == MovieOf::FrameView ? "timeline.mp4" : "through.webm");
      window_->exports()->movies()->write({of, {320, 240, 5}, frames, true}, file);
      wait();
      const Movie movie = readMovie(file);
      QCOMPARE(movie.frames, frames);
      QCOMPARE(movie.size, QSize(320, 240));
      QVERIFY2(movie.least > 0.2, qPrintable(QString::number(movie.least)));
    }
  }

  void aMovieOfATurntable() {
    const QString file = folder_.filePath("turn.avi");
    window_->exports()->movies()->write({MovieOf::Turntable, {320, 240, 25}, 12, true}, file);
    wait();
    const Movie movie = readMovie(file);
    QCOMPARE(movie.frames, 12);
    QCOMPARE(movie.size, QSize(320, 240));
    QVERIFY2(movie.least > 1, qPrintable(QString::number(movie.least)));
  }

  void aMovieThatIsStoppedLeavesNothing() {
    QTemporaryDir empty;
    window_->exports()->movies()->write({MovieOf::Turntable, {320, 240, 25}, 5000, true}, empty.filePath("long.mp4"));
    QTest::qWait(300);
    QVERIFY(window_->exports()->busy());
    window_->actions().find("edit.stop")->trigger();
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 5000);
    QCOMPARE(QDir(empty.path()).entryList(QDir::Files | QDir::Hidden), QStringList());
    window_->exports()->movies()->write({MovieOf::Turntable, {320, 240, 25}, 5000, true}, empty.filePath("long.mp4"));
    QTest::qWait(100);
    window_.reset();  // closing the program stops it too
    QCOMPARE(QDir(empty.path()).entryList(QDir::Files | QDir::Hidden), QStringList());
  }

  void aMovieEndsWithItsScene() {
    QTemporaryDir empty;
    window_->exports()->movies()->write({MovieOf::Turntable, {320, 240, 25}, 5000, true}, empty.filePath("long.mp4"));
    QTest::qWait(200);
    open(kSessions + "ellipsoid/ellipsoid.glint");
    QVERIFY(!window_->exports()->busy());
    QCOMPARE(QDir(empty.path()).entryList(QDir::Files | QDir::Hidden), QStringList());
  }

  void labelsWithMasks() {
    const QString labels = folder_.filePath("labels");
    window_->exports()->writeLabels(labels);
    wait();
    QVERIFY(QFileInfo::exists(labels + "/masks.json"));
    const QImage mask(labels + "/masks/canonical/A/0003.png");
    QVERIFY(!mask.isNull());
    QCOMPARE(mask.depth(), 8);
    window_->exports()->writeLabels(labels);  // never into a folder that holds something
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 20000);
    QVERIFY(problem_.contains("not empty"));
    problem_.clear();
  }

  // --- dropped ---------------------------------------------------------------------------------------------------------------

  void aDroppedSessionAndFolder() {
    dropOn(window_.get(), kSessions + "vase");  // holds scene.json
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().inputFile().contains("vase"), 20000);
    QVERIFY(window_->document().sessionFile().isEmpty());
    dropOn(window_.get(), kSessions + "ellipsoid/ellipsoid.glint");
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().sessionFile().contains("ellipsoid"), 20000);
  }

  void aDroppedFigure() {
    const QString file = folder_.filePath("dropped.png");
    window_->document().selectFrame(5);
    window_->exports()->figures()->writeFrame({{200, 150}, false, true}, file);
    wait();
    open(kSessions + "ellipsoid/ellipsoid.glint");
    dropOn(window_.get(), file);
    QTRY_COMPARE_WITH_TIMEOUT(window_->document().inputFile(), file, 20000);
    QVERIFY2(window_->document().sessionFile().isEmpty(), "a picture names no file to save to");
    QCOMPARE(window_->document().selection().frame, 5);
  }

  void aDroppedPhotographSelectsItsFrame() {
    const auto photograph = [](const Scene& scene, int frame) {
      return QString::fromStdString(scene.frames[std::size_t(frame)].image.string());
    };
    dropOn(window_.get(), photograph(*window_->document().scene(), 4));
    QCOMPARE(window_->document().selection().frame, 4);
    // A photograph of another scene opens that scene.
    const Scene vase = readScene((kSessions + "vase/scene.json").toStdString());
    dropOn(window_.get(), photograph(vase, 3));
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().inputFile().contains("vase"), 20000);
    QCOMPARE(window_->document().selection().frame, 3);
    window_->open(photograph(vase, 5));  // from the command line: as if it were dropped
    QCOMPARE(window_->document().selection().frame, 5);
    window_->document().selectFrame(3);
    // A picture that belongs to no scene is refused.
    const QString stray = folder_.filePath("stray.jpg");
    QVERIFY(QImage(8, 8, QImage::Format_RGB32).save(stray));
    dropOn(window_.get(), stray);
    QVERIFY(problem_.contains("stray.jpg"));
    problem_.clear();
    QCOMPARE(window_->document().selection().frame, 3);
  }

 private:
  void open(const QString& input) {
    connect(window_.get(), &MainWindow::problem, this, [this](const QString& line) { problem_ = line; });
    window_->open(input);
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().inputFile().contains(QFileInfo(input).dir().dirName()) && window_->idle() &&
                                 window_->document().inspection() && !window_->document().stale(),
                             60000);
  }
  void wait() {
    QTRY_VERIFY_WITH_TIMEOUT(window_->idle(), 60000);
    QVERIFY2(problem_.isEmpty(), qPrintable(problem_));
  }

  QTemporaryDir folder_;
  QString problem_;
  std::unique_ptr<MainWindow> window_;
};

QObject* makeFigureTest() { return new FigureTest; }

}  // namespace glint::gui

#include "figure_test.moc"
