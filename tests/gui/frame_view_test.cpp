// SPDX-License-Identifier: BSD-3-Clause
// The frame view and the ladder on a document: what is shown, picked, toggled, and that it is one step of undo each.
#include <QComboBox>
#include <QLabel>
#include <QMenu>
#include <QMouseEvent>
#include <QSignalSpy>
#include <QSlider>
#include <QTextDocument>
#include <QToolButton>

#include "core/draw/plots.h"
#include "gui/base/stale_badge.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/hand_tool.h"
#include "gui/frame/ladder_panel.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class FrameViewTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    frame_ = std::make_unique<FramePanel>(*document_);
    ladder_ = std::make_unique<LadderPanel>(*document_, *frame_->loader());
    frame_->resize(700, 700);
    ladder_->resize(900, 260);
    frame_->show();
    ladder_->show();
    QVERIFY(QTest::qWaitForWindowExposed(frame_.get()));
    QVERIFY(QTest::qWaitForWindowExposed(ladder_.get()));
    document_->open(fixture_.opened());
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request())),
                             document_->request());
    settle();
  }
  void cleanup() {
    ladder_.reset();
    frame_.reset();
  }

  void theLookIsAnOptionAndOffTheInterfaceThread() {
    FrameCanvas* canvas = frame_->canvas();
    const QImage plain = canvas->grab().toImage();
    auto* exposure = frame_->findChild<QSlider*>(QStringLiteral("frame/exposure"));
    exposure->setValue(8);  // two stops
    QCOMPARE(document_->option("frame/exposure", 0.0), 2.0);
    settle();
    QVERIFY(canvas->grab().toImage() != plain);
    QTest::mouseClick(frame_->findChild<QToolButton*>(QStringLiteral("frame/false-colour")), Qt::LeftButton);
    settle();
    const QImage coloured = canvas->grab().toImage();
    // The corner of the photograph (10, 30, 40): linear mean 0.0124, times four 0.0497, colour 13 of the map: dark violet.
    const QPoint corner = (canvas->widgetFromPixel({3, 110}) * canvas->devicePixelRatioF()).toPoint();
    const auto& expected = viz::uniformColours()[13];
    QVERIFY(std::abs(qRed(coloured.pixel(corner)) - expected[0]) <= 2 &&
            std::abs(qBlue(coloured.pixel(corner)) - expected[2]) <= 3);
    QCOMPARE(document_->undoStack()->count(), 2);
    document_->undoStack()->undo();
    document_->undoStack()->undo();
    settle();
    QCOMPARE(exposure->value(), 0);
    QVERIFY(canvas->grab().toImage() == plain);
  }

  /// The highlight stays in the middle from frame to frame, to be compared, until the view is moved or shows the whole.
  void zoomedToTheHighlightItFollowsFromFrameToFrame() {
    FrameCanvas* canvas = frame_->canvas();
    const auto middle = [&](int frame) {
      const Highlight& h = document_->inspection()->evidence[std::size_t(frame)].highlights.front();
      return (canvas->centre() - document_->scene()->frames[std::size_t(frame)].camera.distorted(centroid(h.contour))).norm();
    };
    document_->selectFrame(2);
    settle();
    QVERIFY(canvas->fitted());
    frame_->goToHighlight();
    const double zoom = canvas->zoom();
    QVERIFY(middle(2) < 1);
    document_->selectFrame(9);
    settle();
    QVERIFY(middle(9) < 1 && middle(2) > 2);
    QCOMPARE(canvas->zoom(), zoom);
    canvas->fit();
    document_->selectFrame(3);
    settle();
    QVERIFY(canvas->fitted());
    // After a move by hand the view stays where it was put.
    frame_->goToHighlight();
    QTest::mousePress(canvas, Qt::LeftButton, {}, QPoint(200, 200));
    QMouseEvent drag(QEvent::MouseMove, QPoint(260, 260), Qt::LeftButton, Qt::LeftButton, {});  // QTest's own has no button
    QCoreApplication::sendEvent(canvas, &drag);
    QTest::mouseRelease(canvas, Qt::LeftButton, {}, QPoint(260, 260));
    const Pixel moved = canvas->centre();
    document_->selectFrame(9);
    settle();
    QVERIFY((canvas->centre() - moved).norm() < 1e-9);
  }

  /// The pixels of a session under every lobe are drawn and named for the frame that is shown, and go with their layer.
  void everyLobeOverThePhotograph() {
    Opened opened = coreEngine().open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {});
    opened.request.models = {"canonical"};
    document_->open(opened);
    document_->setInspection(std::make_shared<const Inspection>(inspect(opened.scene, opened.request)), opened.request);
    document_->selectFrame(3);
    settle();
    frame_->goToHighlight();
    const auto* captions = frame_->findChild<QLabel*>(QStringLiteral("frameCaptions"));
    const QImage without = frame_->canvas()->grab().toImage();
    QVERIFY(!frame_->overlayOptions().samples && !captions->text().contains(QStringLiteral("ggx, m =")));
    auto* toggle = frame_->findChild<QToolButton*>(QStringLiteral("frame/lobes"));
    QTest::mouseClick(toggle, Qt::LeftButton);
    settle();
    QTRY_VERIFY(frame_->overlayOptions().samples);
    QCOMPARE(frame_->overlayOptions().samples->frame, 3);
    for (const char* lobe : {"phong, m =", "blinn-phong, m =", "torrance-sparrow, m =", "ggx, m ="})
      QTRY_VERIFY2(captions->text().contains(QLatin1String(lobe)), lobe);
    settle();
    QVERIFY(frame_->canvas()->grab().toImage() != without);
    document_->selectFrame(5);
    QVERIFY(!frame_->overlayOptions().samples);  // rather none than another frame's
    QTRY_VERIFY(frame_->overlayOptions().samples);
    QCOMPARE(frame_->overlayOptions().samples->frame, 5);
    QTest::mouseClick(toggle, Qt::LeftButton);
    settle();
    QVERIFY(!frame_->overlayOptions().samples && !captions->text().contains(QStringLiteral("ggx, m =")));
  }

  /// In a low panel one button holds the switches of the overlays; the photograph keeps its room.
  void aLowPanelFoldsTheSwitchesOfTheOverlays() {
    auto* folded = frame_->findChild<QToolButton*>(QStringLiteral("foldedOverlays"));
    auto* observed = frame_->findChild<QToolButton*>(QLatin1String(draw::overlayLayers().front().name));
    QVERIFY(folded->isHidden() && !observed->isHidden());
    frame_->resize(700, 400);
    QTRY_VERIFY(!folded->isHidden() && observed->isHidden());
    emit folded->menu()->aboutToShow();
    QCOMPARE(folded->menu()->actions().size(), int(draw::overlayLayers().size()));
    QAction* first = folded->menu()->actions().front();
    const std::string layer = draw::overlayLayers().front().name;
    const bool shown = document_->layerVisible(layer);
    QCOMPARE(first->isChecked(), shown);
    first->trigger();
    QCOMPARE(document_->layerVisible(layer), !shown);
    frame_->resize(700, 700);
    QTRY_VERIFY(folded->isHidden() && !observed->isHidden());
  }

  /// Words say why the highlight of the photograph stays where it was.
  void itSaysWhatIsNotAsCaptured() {
    FrameCanvas* canvas = frame_->canvas();
    const auto caption = [&](const WhatIf& w) {
      document_->setWhatIf(w, "what if");
      document_->setInspection(std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request())),
                               document_->request());
      settle();
      return canvas->caption();
    };
    QCOMPARE(caption({}), QString());
    const QImage before = canvas->grab().toImage();
    WhatIf w;
    w.synthesise = true;
    QVERIFY(caption(w).contains("photograph synthesised"));
    QVERIFY(canvas->grab().toImage() != before);
    w = {};
    w.highlights[{0, 0}].peakBy = {2, 1};
    QVERIFY(caption(w).contains("highlight moved by hand"));
    w = {};
    w.poses[0].translation = {0.01, 0, 0};
    QVERIFY(caption(w).contains("camera moved by hand"));
    w = {};
    w.poses[1].translation = {0.01, 0, 0};  // of another frame
    QCOMPARE(caption(w), QString());
    QCOMPARE(caption({}), QString());
  }

  void contourAndPeakAreMovedByHandEachInOneStep() {
    FrameCanvas* canvas = frame_->canvas();
    const QPoint edge = canvas->widgetFromPixel(Fixture::centre(0) - Pixel(Fixture::kRadius, 0)).toPoint();
    const QPoint peak = canvas->widgetFromPixel(Fixture::centre(0)).toPoint(), by(36, 24);
    const Pixel moved = canvas->pixelFromWidget(QPointF(by)) - canvas->pixelFromWidget({0, 0});
    drag(canvas, {edge, edge + by / 2, edge + by});  // off: the picture moves
    QVERIFY(document_->request().whatIf.none());
    canvas->fit();
    QTest::mouseClick(frame_->findChild<QToolButton*>(QStringLiteral("hand")), Qt::LeftButton);
    drag(canvas, {edge, edge + by / 2, edge + by});
    QCOMPARE(document_->undoStack()->count(), 1);
    WhatIf w = document_->request().whatIf;
    QCOMPARE(w.highlights.size(), std::size_t(1));
    QVERIFY((w.highlights.at({0, 0}).contourBy - moved).norm() < 1e-9);
    QVERIFY(w.highlights.at({0, 0}).peakBy.isZero());
    QVERIFY(canvas->showsHeld());  // nothing has computed the results yet
    drag(canvas, {peak, peak - by / 2, peak - by});
    QCOMPARE(document_->undoStack()->count(), 2);
    w = document_->request().whatIf;
    QVERIFY((w.highlights.at({0, 0}).peakBy + moved).norm() < 1e-9);
    QVERIFY((w.highlights.at({0, 0}).contourBy - moved).norm() < 1e-9);
    // Away from everything, a drag moves the picture again.
    const Pixel before = canvas->centre();
    drag(canvas, {QPoint(5, 5), QPoint(25, 25), QPoint(45, 25)});
    QVERIFY((canvas->centre() - before).norm() > 1);
    QCOMPARE(document_->undoStack()->count(), 2);
    document_->undoStack()->undo();
    document_->undoStack()->undo();
    QVERIFY(document_->request().whatIf.none());
  }

  /// Until the results follow, the contour or the peak that the hand holds is drawn where the hand has it, and the other is not
  /// drawn.
  void whatTheHandHoldsIsDrawnWhereItIs() {
    auto* hand = frame_->findChild<HandTool*>();
    QVERIFY(hand);
    hand->setOn(true);
    std::vector<Pixel> line;
    std::optional<Pixel> mark;
    connect(hand, &HandTool::carried, this, [&](const std::vector<Pixel>& l, const std::optional<Pixel>& m) {
      line = l;
      mark = m;
    });
    const Pixel centre = Fixture::centre(0), edge = centre + Pixel(Fixture::kRadius, 0), by(7, -4);
    QVERIFY(hand->take(edge, 3, {}));
    hand->carry(edge + by);
    hand->release();
    QVERIFY(!mark && line.size() > 20);
    for (const Pixel& p : line) QVERIFY(std::abs((p - centre - by).norm() - Fixture::kRadius) < 1e-9);
    document_->undoStack()->undo();
    QVERIFY(hand->take(centre, 3, {}));
    hand->carry(centre + by);
    hand->release();
    QVERIFY(line.empty() && mark && (*mark - centre - by).norm() < 1e-9);
    document_->undoStack()->undo();
    QVERIFY(hand->take(edge, 3, Qt::ShiftModifier));
    hand->carry(centre + 1.5 * (edge - centre));
    hand->release();
    QVERIFY(!mark && line.size() > 20);
    for (const Pixel& p : line) QVERIFY(std::abs((p - centre).norm() - 1.5 * Fixture::kRadius) < 1e-6);
    QVERIFY(std::abs(document_->request().whatIf.highlights.at({0, 0}).contourScale - 1.5) < 1e-9);
    document_->undoStack()->undo();
    QVERIFY(hand->take(edge, 3, {}));
    document_->selectFrame(4);  // what was held is gone
    hand->carry(edge + by);
    QVERIFY(!hand->holds() && document_->request().whatIf.none());
    QVERIFY(!frame_->canvas()->showsHeld());
  }

  /// A moved lamp: contours and numbers are there before the photograph is drawn anew; until then the old one is marked.
  void aPhotographOfAnEarlierStateIsMarked() {
    Opened opened = coreEngine().open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {});
    opened.request.models = {"canonical"};
    document_->open(opened);
    const auto compute = [&] {
      document_->setInspection(std::make_shared<const Inspection>(inspect(opened.scene, document_->request())),
                               document_->request());
    };
    compute();
    settle();
    const auto* badge = frame_->canvas()->findChild<StaleBadge*>();
    QVERIFY(badge && badge->isHidden() && !frame_->loader()->behind());
    WhatIf lit;
    lit.synthesise = true;
    lit.lightsBy["A"] = {0.05, 0, 0};
    document_->setWhatIf(lit, "lamp moved");
    QTRY_VERIFY(badge->isVisible());
    compute();
    QVERIFY(!document_->stale() && frame_->loader()->behind());
    QTRY_VERIFY(badge->isVisible() || !frame_->loader()->behind());  // it may be drawn before the mark comes
    QTRY_VERIFY(!frame_->loader()->behind());
    QVERIFY(badge->isHidden());
    settle();
    QVERIFY(frame_->loader()->picture().synthesised);
  }

  void resultsForTheFrameAreShownBeforeThoseForAll() {
    auto one = std::make_shared<Inspection>(drawnCircles(fixture_.scene(), document_->request()));
    document_->setSetting("detect.level", 0.4);
    QVERIFY(document_->frameStale());
    one->request = document_->request();
    for (auto& point : one->evidence[0].highlights[0].contour.points) point.x() += 15;
    const QImage before = frame_->canvas()->grab().toImage();
    document_->setFrameInspection(one, 1);  // not the one on screen
    QCOMPARE(document_->frameInspection(), document_->inspection());
    const Fixture other;  // a scene that was closed meanwhile
    document_->setFrameInspection(std::make_shared<const Inspection>(drawnCircles(other.scene(), document_->request())), 0);
    QCOMPARE(document_->frameInspection(), document_->inspection());
    document_->setFrameInspection(one, 0);
    QVERIFY(document_->stale() && !document_->frameStale());
    QVERIFY(frame_->canvas()->grab().toImage() != before);
    document_->selectFrame(2);
    QCOMPARE(document_->frameInspection(), document_->inspection());
    QVERIFY(document_->frameStale());
  }

  void aClickOnAPredictedContourSelectsModelAndPoint() {
    FrameCanvas* canvas = frame_->canvas();
    // The first model's circle lies 8 px to the right of the observed one (fixture): its rightmost point belongs to no other
    // contour.
    const std::string model = document_->request().models.front();
    const QPointF at = canvas->widgetFromPixel(Fixture::centre(0) + Pixel(Fixture::kRadius + 8, 0));
    QTest::mouseClick(canvas, Qt::LeftButton, {}, at.toPoint());
    QCOMPARE(document_->selection().model, model);
    QCOMPARE(document_->selection().highlight, 0);
    QVERIFY(document_->selection().direction);
    QVERIFY(std::abs(*document_->selection().direction) < 0.05);
    QCOMPARE(document_->undoStack()->count(), 1);
  }

  /// The ring of the selected point lies on the observed contour within 0.1 device pixels.
  void theSelectedPointLiesOnItsPixel() {
    for (const char* layer : {"frame/predicted", "frame/peak"}) document_->setLayerVisible(layer, layer, false);
    draw::Selection s = document_->selection();
    s.highlight = 0;
    s.direction = 0.0;
    document_->select(s);
    settle();
    FrameCanvas* canvas = frame_->canvas();
    const Pixel expected = Fixture::centre(0) + Pixel(Fixture::kRadius, 0);  // a vertex of the circle
    for (const double zoom : {3.0, 15.5, 40.0}) {
      canvas->lookAt(expected + Pixel(0.31, 0.17), zoom);
      canvas->setOverlay({});
      const QImage without = canvas->grab().toImage();
      draw::FrameOverlay overlay = draw::frameOverlay(*document_->inspection(), 0, options());
      overlay.lines.clear();
      canvas->setOverlay(overlay);
      const QImage with = canvas->grab().toImage();
      double sum = 0, x = 0, y = 0;
      for (int row = 0; row < with.height(); ++row)
        for (int column = 0; column < with.width(); ++column) {
          const double change = std::max(0, qRed(with.pixel(column, row)) - qRed(without.pixel(column, row)));
          sum += change;
          x += change * (column + 0.5);
          y += change * (row + 0.5);
        }
      QVERIFY(sum > 0);
      const QPointF wanted = canvas->widgetFromPixel(expected) * canvas->devicePixelRatioF();
      QVERIFY2(std::hypot(x / sum - wanted.x(), y / sum - wanted.y()) < 0.1,
               qPrintable(QStringLiteral("zoom %1: %2 %3").arg(zoom).arg(x / sum - wanted.x()).arg(y / sum - wanted.y())));
    }
  }

  void theTableShowsAndHidesModels() {
    auto* captions = frame_->findChild<QLabel*>(QStringLiteral("frameCaptions"));
    const std::string model = document_->request().models.front();
    const QImage with = frame_->canvas()->grab().toImage();
    emit captions->linkActivated(QStringLiteral("show:") + QString::fromStdString(model));
    QVERIFY(!document_->layerVisible("frame/model/" + model));
    QVERIFY(captions->text().contains(QString::fromStdString(model)));
    QVERIFY(frame_->canvas()->grab().toImage() != with);
    emit captions->linkActivated(QStringLiteral("select:") + QString::fromStdString(model));
    QCOMPARE(document_->selection().model, model);
  }

  void twoFramesSideBySide() {
    QVERIFY(!frame_->secondCanvas()->isVisible());
    QTest::mouseClick(frame_->findChild<QToolButton*>(QStringLiteral("side-by-side")), Qt::LeftButton);
    settle();
    QVERIFY(frame_->secondCanvas()->isVisible());
    QVERIFY(frame_->secondCanvas()->hasPicture());
    // The stand-in fits no ellipses: the reason's name stands in place of the number, and the tool tip has all of it.
    const auto* miss = frame_->findChild<QLabel*>(QStringLiteral("epipolarMiss"));
    QVERIFY(miss->text().contains(QStringLiteral("too few points")));
    QVERIFY(miss->toolTip().contains(QStringLiteral("no ellipse")));
    document_->setOption("frame/second", 7.0, QString());
    settle();
    // Frame 7's photograph has red 45 (fixture).
    const QPoint corner = frame_->secondCanvas()->widgetFromPixel({3, 110}).toPoint();
    QCOMPARE(qRed(frame_->secondCanvas()->grab().toImage().pixel(corner * frame_->devicePixelRatioF())), 45);
    document_->undoStack()->undo();
    document_->undoStack()->undo();
    settle();
    QVERIFY(!frame_->secondCanvas()->isVisible());
  }

  /// In a low panel the layers' buttons scroll; the key to the lines of a pair stays whole.
  void theBarOfAPairIsWholeInALowPanel() {
    document_->setOption("frame/side-by-side", "on", QString());
    for (const QSize size : {QSize(700, 700), QSize(490, 420), QSize(420, 360)}) {
      frame_->resize(size);
      settle();
      for (const char* name : {"frame/second", "frame/epipolar", "frame/epipolar-ellipse"}) {
        auto* box = frame_->findChild<QComboBox*>(QLatin1String(name));
        QVERIFY(box && box->isVisible());
        QVERIFY2(box->visibleRegion().boundingRect().size() == box->size(), name);
      }
    }
  }

  /// The reason of a failure takes lines below the table; once it is gone the photograph has them back.
  void aFailureThatIsGoneLeavesNoEmptyStrip() {
    const auto* captions = frame_->findChild<QLabel*>(QStringLiteral("frameCaptions"));
    const auto show = [&](const QString& reason, std::size_t most = 99) {
      Inspection inspection = drawnCircles(fixture_.scene(), document_->request());
      if (!reason.isEmpty())
        for (auto& [name, model] : inspection.models) {
          if (most-- == 0) break;
          FrameComparison& c = model.frames.front();
          c.prediction = Failure{Reason::NoBrightestPoint, reason.toStdString()};
          c.rows = {{0, -1, {}, *c.prediction.failure(), {}}};
        }
      document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
      settle();
      return captions->height();
    };
    const int before = show({});
    const QString reason = QStringLiteral("a reason that takes a line of its own below the table");
    const int one = show(reason, 1), all = show(reason);
    QVERIFY(one > before + 10 && all > one + 10);
    QCOMPARE(show(reason, 1), one);  // those of the others leave none either
    QCOMPARE(show({}), before);
  }

  void theLadderIsLinked() {
    const std::vector<FrameCanvas*> tiles = ladder_->canvases();
    QCOMPARE(tiles.size(), document_->request().models.size());
    // No space is wasted: the tiles cover the panel, but for their lines of text and the gaps.
    double covered = 0;
    for (const FrameCanvas* tile : tiles) covered += double(tile->width()) * tile->height();
    QVERIFY2(covered > 0.8 * ladder_->width() * ladder_->height(), qPrintable(QString::number(covered)));
    for (const FrameCanvas* tile : tiles) QVERIFY(tile->hasPicture());
    const QPointF middle = QRectF(tiles[1]->rect()).center();
    QWheelEvent wheel(middle, middle, {}, QPoint(0, 240), Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase, false);
    QCoreApplication::sendEvent(tiles[1], &wheel);
    drag(tiles[1], {middle.toPoint(), middle.toPoint() + QPoint(30, 12)});
    for (const FrameCanvas* tile : tiles) {
      QCOMPARE(tile->zoom(), tiles[1]->zoom());
      QVERIFY((tile->centre() - tiles[1]->centre()).norm() < 1e-9);
    }
    const double zoom = tiles[1]->zoom();
    document_->selectFrame(5);
    settle();
    QCOMPARE(tiles[0]->zoom(), zoom);  // the zoom stays, the centre follows the highlight
    QVERIFY((tiles[0]->centre() - Fixture::centre(5)).norm() < 12);
    QTest::mouseClick(tiles[2], Qt::LeftButton, {}, {10, 10});
    QCOMPARE(document_->selection().model, document_->request().models[2]);
  }

  void aNarrowLadderHasItsErrorsInASecondLine() {
    const auto captions = [this] {
      std::vector<QLabel*> all;
      for (const FrameCanvas* tile : ladder_->canvases()) all.push_back(tile->parentWidget()->findChild<QLabel*>());
      return all;
    };
    const auto check = [&](const QString& unit) {
      for (const QLabel* caption : captions()) {
        QVERIFY2(!caption->text().contains(QChar(0x2026)) && caption->text().contains(unit), qPrintable(caption->text()));
        QTextDocument text;
        text.setDefaultFont(caption->font());
        text.setHtml(caption->text());
        QVERIFY(text.idealWidth() - 2 * text.documentMargin() <= caption->width());
        QVERIFY(text.size().height() - 2 * text.documentMargin() <= caption->height());
      }
    };
    const int count = int(captions().size());
    ladder_->resize(260 * count, 260);
    check(QStringLiteral("px"));
    const int one = captions().front()->height();
    ladder_->resize(130 * count, 200);
    check(QStringLiteral("px"));
    QVERIFY(captions().front()->height() > one);
    ladder_->resize(84 * count, 160);
    for (const QLabel* caption : captions()) QVERIFY2(caption->text().contains('%'), qPrintable(caption->text()));
  }

  void theProbeKnowsTheSurface() {
    auto inspection = std::make_shared<Inspection>(drawnCircles(fixture_.scene(), document_->request()));
    inspection->surfaces = std::make_shared<const SurfaceCache>(*fixture_.scene());
    LightEstimate lamp;
    lamp.light = Light::at({0, 0, -2});
    inspection->lights.insert_or_assign({"lamp"}, lamp);
    document_->setInspection(inspection, document_->request());
    QSignalSpy probed(frame_.get(), &FramePanel::probed);
    const QPointF at = frame_->canvas()->widgetFromPixel({79.5, 59.5});
    QMouseEvent move(QEvent::MouseMove, at, at, at, Qt::NoButton, Qt::NoButton, Qt::NoModifier);
    QCoreApplication::sendEvent(frame_->canvas(), &move);
    // The ball of radius 0.4 at 2 m; the light is where the camera is.
    QTRY_VERIFY(!probed.isEmpty() && probed.last()[0].toString().contains(QStringLiteral("depth 1.6 m")));
    QVERIFY(probed.last()[0].toString().contains(QStringLiteral("sRGB")));
    QVERIFY(probed.last()[0].toString().contains(QStringLiteral("0.000°")));
  }

 private:
  void settle() {
    QTRY_VERIFY(!frame_->busy());
    QTest::qWait(30);
  }
  draw::OverlayOptions options() const {
    draw::OverlayOptions o;
    o.hidden = {draw::OverlayRole::PredictedContour, draw::OverlayRole::PredictedPeak, draw::OverlayRole::ObservedPeak};
    o.selection = document_->selection();
    return o;
  }
  Fixture fixture_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<FramePanel> frame_;
  std::unique_ptr<LadderPanel> ladder_;
};

QObject* makeFrameViewTest() { return new FrameViewTest; }

}  // namespace glint::gui

#include "frame_view_test.moc"
