// SPDX-License-Identifier: BSD-3-Clause
// Plots and the conditioning strip: real clicks, files that can be read, work off the interface thread.
#include <QAccessible>
#include <QAction>
#include <QApplication>
#include <QClipboard>
#include <QComboBox>
#include <QFile>
#include <QImage>
#include <QLabel>
#include <QMimeData>
#include <QPointer>
#include <QSet>
#include <QSignalSpy>
#include <QSplitter>
#include <QSvgRenderer>
#include <QTabBar>
#include <QToolButton>
#include <cmath>

#include "gui/base/text.h"
#include "gui/plots/conditioning_panel.h"
#include "gui/plots/plot_canvas.h"
#include "gui/plots/plots_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
/// An influence without any fit: frame f matters by f.
Influence influenceForTest(const Inspection& inspection) {
  Influence influence;
  for (int f = 0; f < 3; ++f) {
    FrameInfluence one;
    one.frame = f;
    for (const auto& [model, result] : inspection.models) one.models[model].leftOutPct = 1.0 + f;
    influence.frames.push_back(one);
  }
  influence.trainingFrames = 3;
  return influence;
}
}  // namespace

class PlotsTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    panel_ = std::make_unique<PlotsPanel>(*document_);
    document_->open(fixture_.opened());
    panel_->resize(1000, 340);
    panel_->show();
    QVERIFY(QTest::qWaitForWindowExposed(panel_.get()));
    inspect();
  }
  void cleanup() { panel_.reset(); }

  void aClickOnASampleSelectsFrameAndModel() {
    PlotCanvas* canvas = panel_->canvas(0);
    QCOMPARE(canvas->plot().id, std::string("error"));
    panel_->renderNow();
    int series = -1;
    for (int s = 0; s < int(canvas->plot().series.size()); ++s)
      if (canvas->plot().series[std::size_t(s)].name == "dual") series = s;
    QVERIFY(series >= 0);
    const auto at = canvas->positionOf({series, 7});
    QVERIFY(at);
    QTest::mouseClick(canvas, Qt::LeftButton, {}, at->toPoint());
    QCOMPARE(document_->selection().frame, 7);
    QCOMPARE(document_->selection().model, std::string("dual"));
    QVERIFY(canvas->plot().shades.size() >= 1);  // first:6 trains
    document_->undoStack()->undo();
    QCOMPARE(document_->selection().frame, 0);
    // Beside every sample nothing is selected.
    QTest::mouseClick(canvas, Qt::LeftButton, {}, QPoint(4, 4));
    QCOMPARE(document_->selection().frame, 0);
  }

  void aDirectionOfTheDialIsSelectedEverywhere() {
    PlotCanvas* dial = panel_->canvas(1);
    QCOMPARE(dial->plot().id, std::string("dial"));
    panel_->renderNow();
    const draw::PlotSample sample{0, 17};
    const auto at = dial->positionOf(sample);
    QVERIFY(at);
    QTest::mouseClick(dial, Qt::LeftButton, {}, at->toPoint());
    QVERIFY(document_->selection().direction.has_value());
    // Another model's curve may run over this one; the direction is that of the place in any case.
    QVERIFY(std::abs(*document_->selection().direction - *dial->plot().series[0].points[17].target.direction) < 0.2);
    QCOMPARE(document_->selection().highlight, 0);
    QVERIFY(!draw::selectedSamples(dial->plot(), document_->selection()).empty());
    document_->selectFrame(3);
    QVERIFY(!document_->selection().direction.has_value());
    panel_->renderNow();
    QVERIFY(toQString(dial->plot().title).contains(QStringLiteral("0003")));
  }

  /// The arrow keys go from point to point, with the keyboard's ring on the point and words for people who do not see it.
  void theArrowKeysGoFromPointToPoint() {
    PlotCanvas* canvas = panel_->canvas(0);
    QApplication::setActiveWindow(panel_.get());
    panel_->renderNow();
    canvas->setFocus(Qt::TabFocusReason);
    QTRY_VERIFY(canvas->hasFocus());
    const auto said = [&] { return QAccessible::queryAccessibleInterface(canvas)->text(QAccessible::Description); };
    const auto key = [&](Qt::Key k, Qt::KeyboardModifiers with = {}) { QTest::keyClick(canvas, k, with); };
    QVERIFY2(!said().contains("At point"), qPrintable(said()));
    const QImage before = canvas->grab().toImage();
    key(Qt::Key_End);
    key(Qt::Key_Home);
    QVERIFY2(said().contains("At point 1 of "), qPrintable(said()));
    QVERIFY(canvas->grab().toImage() != before);
    key(Qt::Key_Left);  // there is nothing before the first
    QVERIFY(said().contains("At point 1 of "));
    // All points, each once and none to the left of the one before.
    const int all = said().section("At point 1 of ", 1).section(':', 0, 0).toInt();
    int points = 0;
    for (const draw::PlotSeries& s : canvas->plot().series)
      for (const draw::PlotPoint& p : s.points) points += std::isfinite(p.y) || p.noValue;  // a cross at the top
    QCOMPARE(all, points);
    for (int i = 2; i <= all; ++i) {
      key(Qt::Key_Right);
      QVERIFY2(said().contains(QStringLiteral("At point %1 of ").arg(i)), qPrintable(said()));
    }
    key(Qt::Key_Return);
    QCOMPARE(document_->selection().frame, document_->frameCount() - 1);  // the last one by x is of the last frame
    key(Qt::Key_Escape);
    QVERIFY(!said().contains("At point"));
  }

  void shiftAndTheArrowKeysBrush() {
    document_->setOption("plots/first", std::string("scatter"), QStringLiteral("x"));
    document_->setOption("plots/scatter-x", std::string("frame"), QStringLiteral("x"));
    PlotCanvas* canvas = panel_->canvas(0);
    QApplication::setActiveWindow(panel_.get());
    panel_->renderNow();
    canvas->setFocus(Qt::TabFocusReason);
    QTRY_VERIFY(canvas->hasFocus());
    const auto said = [&] { return QAccessible::queryAccessibleInterface(canvas)->text(QAccessible::Description); };
    const auto key = [&](Qt::Key k, Qt::KeyboardModifiers with = {}) {
      QTest::keyClick(canvas, k, with);
      canvas->renderNow();  // those that are not brushed are drawn in grey, as another series
    };
    key(Qt::Key_Home);
    QVERIFY(document_->brushed().empty());
    for (int i = 0; i < 3; ++i) key(Qt::Key_Right, Qt::ShiftModifier);
    QCOMPARE(int(document_->brushed().size()), 4);
    QVERIFY2(said().contains("At point 4 of "), qPrintable(said()));
    key(Qt::Key_Left, Qt::ShiftModifier);
    QCOMPARE(int(document_->brushed().size()), 3);
    for (const RowKey& k : document_->brushed()) QVERIFY(k.frame <= 2);
    key(Qt::Key_Right);  // goes on without brushing
    QCOMPARE(int(document_->brushed().size()), 3);
    key(Qt::Key_Escape);
    QVERIFY(document_->brushed().empty());
    QVERIFY(!said().contains("At point"));
  }

  void theListChoosesThePlotAndUndoTakesItBack() {
    QComboBox* list = panel_->selector(0);
    list->setFocus();
    const int axes = list->findData(QStringLiteral("axes"));
    list->setCurrentIndex(axes);
    emit list->activated(axes);
    QCOMPARE(panel_->canvas(0)->plot().id, std::string("axes"));
    QVERIFY(!panel_->canvas(0)->plot().empty.empty());  // the stand-in fits nothing, and the plot says so
    document_->undoStack()->undo();
    QCOMPARE(panel_->canvas(0)->plot().id, std::string("error"));
    QCOMPARE(list->currentData().toString(), QStringLiteral("error"));
    document_->setOption("plots/two", "off", QStringLiteral("One plot"));
    QVERIFY(!panel_->canvas(1)->isVisible());
    document_->setOption("plots/two", "on", QStringLiteral("Two plots"));
    QVERIFY(panel_->canvas(1)->isVisible());
  }

  void everyPlotIsMadeOffOrOnTheInterfaceThread() {
    for (const draw::PlotKind& kind : draw::plotKinds()) {
      document_->setOption("plots/first", kind.id, QStringLiteral("Plot"));
      QTRY_VERIFY(panel_->idle());
      panel_->renderNow();
      QCOMPARE(panel_->canvas(0)->plot().id, std::string(kind.id));
      QVERIFY2(!panel_->canvas(0)->plot().series.empty() || !panel_->canvas(0)->plot().empty.empty(), kind.id);
    }
  }

  void savingWritesValidFiles() {
    const QTemporaryDir folder;
    panel_->renderNow();
    const QString svg = folder.filePath(QStringLiteral("a.svg")), png = folder.filePath(QStringLiteral("a.png")),
                  csv = folder.filePath(QStringLiteral("a.csv"));
    QString problem;
    QVERIFY2(panel_->saveTo(svg, &problem), qPrintable(problem));
    QSvgRenderer renderer(svg);
    QVERIFY(renderer.isValid());
    QVERIFY2(panel_->saveTo(png, &problem), qPrintable(problem));
    const QImage picture(png);
    QCOMPARE(picture.width(), 2 * panel_->canvas(0)->width());
    QVERIFY2(panel_->saveTo(csv, &problem), qPrintable(problem));
    // The size that a dialog asks for: 85 mm at 600 dpi, on a light page.
    const QString paper = folder.filePath(QStringLiteral("paper.png")), slide = folder.filePath(QStringLiteral("slide.svg"));
    const FigureLook look{{2008, 1506}, false, false, 600};
    QVERIFY2(panel_->saveTo(paper, &problem, look), qPrintable(problem));
    const QImage printed(paper);
    QCOMPARE(printed.size(), QSize(2008, 1506));
    QVERIFY2(std::abs(printed.dotsPerMeterX() - 600 / 0.0254) < 1, "what a text program makes of it");
    QVERIFY2(printed.pixelColor(2, 2).lightness() > 230, "a light page");
    QVERIFY2(panel_->saveTo(slide, &problem, look), qPrintable(problem));
    QFile text(slide);
    QVERIFY(text.open(QIODevice::ReadOnly));
    QVERIFY2(text.readAll().contains("</text>"), "texts stay texts");
    QFile file(csv);
    QVERIFY(file.open(QIODevice::ReadOnly));
    const QList<QByteArray> lines = file.readAll().trimmed().split('\n');
    QCOMPARE(lines.size(), 1 + 12 * int(document_->inspection()->models.size()));  // 12 frames
    QVERIFY(!panel_->saveTo(folder.filePath(QStringLiteral("a.bmp")), &problem));
    QVERIFY(problem.contains(QStringLiteral(".svg")));
    QVERIFY(!panel_->saveTo(QStringLiteral("/no/such/folder/a.svg"), &problem));
    panel_->copyNumbers();
    QVERIFY(QApplication::clipboard()->text().startsWith(QStringLiteral("series,")));
    panel_->copySvg();
    QVERIFY(QApplication::clipboard()->mimeData()->hasFormat(QStringLiteral("image/svg+xml")));
    panel_->copyPicture();
    QVERIFY(!QApplication::clipboard()->image().isNull());
  }

  /// The line and the rings of what is selected are of the window: a saved figure is the same whatever is selected.
  void aSavedPlotHasNoCursor() {
    const QTemporaryDir folder;
    panel_->renderNow();
    const auto saved = [&](const char* name) {
      const QString file = folder.filePath(QLatin1String(name));
      if (!panel_->saveTo(file)) return QByteArray();
      QFile read(file);
      return read.open(QIODevice::ReadOnly) ? read.readAll() : QByteArray();
    };
    const QByteArray svg = saved("a.svg"), png = saved("a.png");
    draw::Selection s;
    s.frame = 5;
    s.model = "dual";
    document_->select(s);
    panel_->renderNow();
    QVERIFY(!svg.isEmpty() && !png.isEmpty());
    QCOMPARE(saved("b.svg"), svg);
    QCOMPARE(saved("b.png"), png);
  }

  void theWheelZoomsAndADoubleClickShowsEverything() {
    PlotCanvas* canvas = panel_->canvas(0);
    panel_->renderNow();
    const QPointF first = *canvas->positionOf({0, 2}), second = *canvas->positionOf({0, 3});
    const QPointF at = first;
    QWheelEvent wheel(at, canvas->mapToGlobal(at.toPoint()), {}, {0, 480}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase,
                      false);
    QCoreApplication::sendEvent(canvas, &wheel);
    panel_->renderNow();
    QVERIFY(canvas->positionOf({0, 3})->x() - canvas->positionOf({0, 2})->x() > 1.5 * (second.x() - first.x()));
    QTest::mouseDClick(canvas, Qt::LeftButton, {}, QPoint(200, 150));
    panel_->renderNow();
    QVERIFY(std::abs(canvas->positionOf({0, 3})->x() - second.x()) < 1.5);
  }

  void whichViewMattersRunsOnTheWorkerAndAClickSelects() {
    Engine engine = fixture_.engine();
    QThread* ranOn = nullptr;
    engine.influence = [&](const Inspection& inspection, const ProgressFn& progress) {
      ranOn = QThread::currentThread();
      if (!progress({"influence", 0, 1})) throw Stopped{};
      return influenceForTest(inspection);
    };
    MainWindow window(engine);
    window.resize(1500, 950);
    window.show();
    window.document().open(fixture_.opened());
    QTRY_VERIFY(window.idle() && !window.document().stale());
    window.actions().find(QStringLiteral("plots.influence"))->trigger();
    QTRY_VERIFY(window.document().influence());
    QVERIFY(ranOn && ranOn != QThread::currentThread());
    auto* plots = window.findChild<PlotsPanel*>();
    plots->renderNow();
    PlotCanvas* canvas = plots->canvas(0);
    QCOMPARE(canvas->plot().id, std::string("influence"));
    const auto at = canvas->positionOf({0, 2});
    QVERIFY(at);
    QTest::mouseClick(canvas, Qt::LeftButton, {}, (*at + QPointF(0, 2)).toPoint());
    QCOMPARE(window.document().selection().frame, 2);
    QVERIFY(!window.document().influenceStale());
    window.document().setTrain("0-4");
    QVERIFY(window.document().influenceStale());
    QTRY_VERIFY(window.idle() && !window.document().stale());
    // Asked for while results are out of date: measured as soon as they are not.
    window.document().setTrain("0-5");
    window.actions().find(QStringLiteral("plots.influence"))->trigger();
    QTRY_VERIFY(!window.document().stale() && !window.document().influenceStale());
    window.document().open(fixture_.opened());
    QVERIFY(!window.document().influence());
    QTRY_VERIFY(window.idle());
  }

  void aNarrowChipKeepsItsNumber() {
    Chip chip(Verdict::Green, QStringLiteral("0.0034 px"));
    const QFontMetrics metrics = chip.fontMetrics();
    const auto shownAt = [&](const QString& words) {  // as wide as these words
      chip.resize(metrics.horizontalAdvance(words) + 5, 20);
      return chip.shown();
    };
    QVERIFY(shownAt(QStringLiteral("MMMM 0.0034 px")).endsWith(QStringLiteral("0.0034 px")));
    const QString all = chip.shown(), sign = all.left(all.size() - 9);
    // Digits go before the sign, which tells the verdict where colours cannot.
    QCOMPARE(shownAt(sign.trimmed() + QStringLiteral("0.003 px")), sign.trimmed() + QStringLiteral("0.003 px"));
    QVERIFY(shownAt(QStringLiteral("0.0")).endsWith(QChar(0x2026)));
    chip.setUnitShown(false);
    QVERIFY(shownAt(QStringLiteral("0.0034")).startsWith(sign.trimmed()));
    QVERIFY(!chip.shown().contains(QStringLiteral("px")));
    // Digits go before the number is cut.
    for (const auto& [text, room, expected] :
         {std::tuple("0.00347 px", "0.0035", "0.0035"), std::tuple("1.23e-05", "1.23e-5", "1.23e-5"),
          std::tuple("1.23e-05", "1e-5", "1e-5"), std::tuple("12.34°", "12°", "12°"), std::tuple("0.00012", "1e-4", "1e-4")}) {
      chip.show(Verdict::Green, QString::fromUtf8(text));
      QCOMPARE(shownAt(sign.trimmed() + QString::fromUtf8(room)), sign.trimmed() + QString::fromUtf8(expected));
    }
    QVERIFY(sign.size() > 0);
    Chip words(Verdict::Amber, QStringLiteral("1-sheet"));
    words.resize(metrics.horizontalAdvance(QStringLiteral("!1-sheet")) + 5, 20);
    QCOMPARE(words.shown(), QStringLiteral("!1-sheet"));  // no unit
    // Columns as narrow as five of them are: a shorter word, not a cut one.
    for (const char* text : {"1-sheet", "2-sheet", "imaginary", "flat hyp.", "ellips.", "open"}) {
      Chip narrow(Verdict::Red, QLatin1String(text));
      narrow.resize(narrow.minimumSizeHint());
      QVERIFY2(!narrow.shown().contains(QChar(0x2026)), qPrintable(narrow.shown()));
      QVERIFY(QFontMetrics(narrow.font()).horizontalAdvance(narrow.shown()) <= narrow.width() - 4);
    }
  }

  /// Columns are of one light, chosen by a tab with its id and the sign of its worst number.
  void theStripShowsOneLightAndNamesTheOthers() {
    Inspection inspection = drawnCircles(fixture_.scene(), document_->request());
    for (auto& [name, model] : inspection.models) {
      ModelResult::Fit other = model.fits.front();
      other.light = "window";
      other.fit = Failure{Reason::TooFewViews, "of the window"};
      model.fits.push_back(other);
    }
    document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
    ConditioningPanel strip(*document_);
    strip.resize(330, 320);
    strip.show();
    QVERIFY(QTest::qWaitForWindowExposed(&strip));
    auto* tabs = strip.findChild<QTabBar*>();
    QVERIFY(tabs && tabs->isVisible());
    QCOMPARE(tabs->count(), 2);
    QVERIFY(tabs->tabText(1).endsWith(QStringLiteral("window")) && tabs->tabText(1) != QStringLiteral("window"));
    const auto columns = [&] { return strip.findChildren<Chip*>(QStringLiteral("chip_canonical_fit")).size(); };
    QCOMPARE(columns(), 1);
    tabs->setCurrentIndex(1);
    QCOMPARE(document_->selection().light, std::string("window"));
    QTRY_COMPARE(columns(), 1);
    QVERIFY(strip.chip("canonical", "fit")->toolTip().contains(QStringLiteral("of the window")));
    for (Chip* chip : strip.findChildren<Chip*>())
      QTRY_VERIFY(chip->mapTo(&strip, QPoint(chip->width(), 0)).x() <= strip.width());
    draw::Selection s = document_->selection();  // chosen elsewhere
    s.light = "lamp";
    document_->select(s);
    QCOMPARE(tabs->currentIndex(), 0);
    QVERIFY(!strip.chip("canonical", "fit")->toolTip().contains(QStringLiteral("of the window")));
  }

  /// The unit that the chips of a row share stands in the row's name, whatever room and numbers there are, so that it never
  /// moves.
  void aUnitStandsInTheNameOfItsRow() {
    Inspection inspection = drawnCircles(fixture_.scene(), document_->request());
    TrainingView view;
    view.camera = fixture_.scene()->frames[0].camera;
    view.highlight.light = "lamp";
    SeenOnSurface seen;
    seen.brightest.point.position = {0, 0, -0.4};
    seen.brightest.point.normal = {0, 0, -1};
    view.seen = seen;
    inspection.views = {view};
    double sigma = 2.7e-5;  // at a distance of 1 m: 0.0027 %
    for (auto& [name, model] : inspection.models) {
      ModelFit fit;
      fit.model = name;
      fit.light = "lamp";
      fit.lightEstimate = Light::at({0, 0, -1.4});
      fit.lightCovariance = sigma * sigma * Eigen::Matrix3d::Identity();
      model.fits.front().fit = fit;
      if (name != "primal") sigma *= 2;
    }
    document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
    ConditioningPanel strip(*document_);
    strip.resize(700, 320);
    strip.show();
    QVERIFY(QTest::qWaitForWindowExposed(&strip));
    for (int width = 700; width >= 240; width -= 20) {
      strip.resize(width, 320);
      QCoreApplication::processEvents();
      int with = 0, all = 0;
      for (const auto& [name, model] : inspection.models)
        if (const Chip* chip = strip.chip(name, "light"); chip && chip->text().contains('%')) {
          ++all;
          QVERIFY2(!chip->shown().at(0).isDigit(), qPrintable(chip->shown()));  // a sign first
          with += chip->shown().contains('%');
        }
      QVERIFY(all >= 2);
      QString title;
      for (const QLabel* label : strip.findChildren<QLabel*>())
        if (label->text().startsWith(QStringLiteral("Light"))) title = label->text();
      QVERIFY2(with == 0, qPrintable(QString::number(width)));
      QVERIFY2(title.contains(QStringLiteral("(%)")), qPrintable(QString::number(width)));
    }
    // New numbers go into the chips that are there.
    const QPointer<Chip> chip = strip.chip("dual", "light");
    const QString text = chip->text();
    *inspection.models.at("dual").fits.front().fit->lightCovariance *= 9;
    document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
    QVERIFY(chip && chip == strip.chip("dual", "light") && chip->text() != text);
  }

  /// The stand-in's errors are put to 1, 2, 3, ... % in the held-out frames 6 to 11, of which the last one is missed.
  void conditioningSaysHowGoodThePredictionIs() {
    Inspection inspection = drawnCircles(fixture_.scene(), document_->request());
    for (FrameComparison& c : inspection.models.at("dual").frames) {
      FrameComparison::Row& row = c.rows.front();
      if (!row.metrics) row.metrics.emplace(), c.prediction = inspection.models.at("dual").frames.front().prediction;
      row.failure.reset();
      row.metrics->contourErrorPct = c.frame - 5;
      if (c.frame != 11) continue;
      row.metrics.reset();
      row.predicted = -1;
    }
    document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
    ConditioningPanel strip(*document_);
    strip.resize(380, 320);
    strip.show();
    QVERIFY(QTest::qWaitForWindowExposed(&strip));
    document_->select({0, "dual"});
    const auto* row = strip.findChild<QLabel*>(QStringLiteral("conditioningPrediction"));
    QVERIFY(row);
    QVERIFY2(row->text().startsWith(QStringLiteral("median 3, max 5, missed 1, ")), qPrintable(row->text()));
    document_->select({0, "primal"});
    QVERIFY(!row->text().startsWith(QStringLiteral("median 3,")));
    InspectionRequest request = document_->request();
    request.train = "0-11";
    document_->setRequest(request, QStringLiteral("Train on all"));
    inspection = drawnCircles(fixture_.scene(), request);
    for (auto& [name, model] : inspection.models) {  // a fit that failed would be the reason
      ModelFit fit;
      fit.model = name;
      fit.light = "lamp";
      model.fits.front().fit = fit;
    }
    document_->setInspection(std::make_shared<const Inspection>(inspection), request);
    row = strip.findChild<QLabel*>(QStringLiteral("conditioningPrediction"));
    QVERIFY(row);
    QCOMPARE(row->text(), QStringLiteral("no frame is held out"));
  }

  void conditioningSaysWhyInWords() {
    ConditioningPanel strip(*document_);
    strip.resize(380, 320);
    strip.show();
    QVERIFY(QTest::qWaitForWindowExposed(&strip));
    Chip* chip = strip.chip("canonical", "fit");
    QVERIFY(chip);  // the stand-in's fit failed
    QCOMPARE(int(chip->verdict()), int(Verdict::Red));
    QVERIFY(chip->toolTip().contains(QStringLiteral("too few views")));
    QTest::mouseClick(chip, Qt::LeftButton);
    QCOMPARE(document_->selection().model, std::string("canonical"));
    QVERIFY(strip.reason().contains(QStringLiteral("too few views")));
    QVERIFY(!strip.chip("canonical", "gap"));
    InspectionRequest request = document_->request();
    request.models = {"dual"};
    document_->setRequest(request, QStringLiteral("Models"));
    inspect();
    QVERIFY(!strip.chip("canonical", "fit"));
    QVERIFY(strip.chip("dual", "fit"));
  }

 private:
  void inspect() {
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request())),
                             document_->request());
  }
  Fixture fixture_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<PlotsPanel> panel_;
};

QObject* makePlotsTest() { return new PlotsTest; }

}  // namespace glint::gui

#include "plots_test.moc"
