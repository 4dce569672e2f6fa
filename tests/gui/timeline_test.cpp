// SPDX-License-Identifier: BSD-3-Clause
#include "gui/timeline/timeline.h"

#include <QComboBox>
#include <QScrollBar>
#include <QToolButton>
#include <QWheelEvent>

#include "gui/base/focus_frame.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/timeline/light_switches.h"
#include "gui/timeline/timeline_strip.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
/// Counts the paint events of a widget.
class Paints : public QObject {
 public:
  explicit Paints(QWidget* widget) { widget->installEventFilter(this); }
  int count = 0;

 protected:
  bool eventFilter(QObject*, QEvent* e) override {
    if (e->type() == QEvent::Paint) ++count;
    return false;
  }
};

void open(Document& document, const Fixture& fixture) {
  document.open(fixture.opened());
  document.setInspection(std::make_shared<const Inspection>(drawnCircles(fixture.scene(), document.request())),
                         document.request());
}

/// A timeline on screen with an open scene.
struct Shown {
  Shown() {
    timeline.resize(900, 140);
    timeline.show();
    if (!QTest::qWaitForWindowExposed(&timeline)) qFatal("the timeline is not shown");
    open(document, fixture);
  }
  const Fixture fixture;
  Document document{parseTrainSpec};
  Timeline timeline{document};
};

void turnWheel(QWidget* widget, const QPointF& at, int angle, Qt::KeyboardModifiers keys = Qt::NoModifier) {
  QWheelEvent wheel(at, widget->mapToGlobal(at.toPoint()), {}, QPoint(0, angle), Qt::NoButton, keys, Qt::NoScrollPhase, false);
  QCoreApplication::sendEvent(widget, &wheel);
}
}  // namespace

class TimelineTest : public QObject {
  Q_OBJECT
 private slots:
  void theKeyboardsFocusIsSeenAndAClicksIsNot() {
    Shown shown;
    TimelineStrip* strip = shown.timeline.strip();
    auto* frame = strip->findChild<FocusFrame*>();
    QVERIFY(frame && !frame->isVisible());
    const auto focus = [strip](QEvent::Type type, Qt::FocusReason reason) {
      QFocusEvent event(type, reason);
      QCoreApplication::sendEvent(strip, &event);
    };
    focus(QEvent::FocusIn, Qt::TabFocusReason);
    QVERIFY(frame->isVisible());
    QCOMPARE(frame->size(), strip->size());
    QVERIFY(strip->childAt(strip->rect().center()) != frame);  // the mouse does not meet it
    focus(QEvent::FocusOut, Qt::ActiveWindowFocusReason);
    QVERIFY(!frame->isVisible());
    focus(QEvent::FocusIn, Qt::ActiveWindowFocusReason);
    QVERIFY(frame->isVisible());
    QTest::mouseClick(strip, Qt::LeftButton, {}, strip->cell(3).center().toPoint());
    QCOMPARE(shown.document.selection().frame, 3);  // it takes no clicks
    QVERIFY(!frame->isVisible());
    focus(QEvent::FocusOut, Qt::OtherFocusReason);
    focus(QEvent::FocusIn, Qt::MouseFocusReason);
    QVERIFY(!frame->isVisible());
  }

  /// A click looks at a frame, wherever it lands; only Ctrl+click changes what trains.
  void onlyCtrlAndAClickGiveTheNextRole() {
    Shown shown;
    Document& document = shown.document;
    Timeline& timeline = shown.timeline;
    TimelineStrip* strip = timeline.strip();
    QCOMPARE(document.role(3), FrameRole::Training);
    QTest::mouseClick(strip, Qt::LeftButton, {}, strip->roleMark(3).center().toPoint());
    QCOMPARE(document.role(3), FrameRole::Training);
    QCOMPARE(document.selection().frame, 3);
    document.selectFrame(0);
    for (const FrameRole next : {FrameRole::HeldOut, FrameRole::Excluded, FrameRole::Training}) {
      const int steps = document.undoStack()->index();
      QTest::mouseClick(strip, Qt::LeftButton, Qt::ControlModifier, strip->roleMark(3).center().toPoint());
      QCOMPARE(document.role(3), next);
      QCOMPARE(document.undoStack()->index(), steps + 1);
    }
    QCOMPARE(document.selection().frame, 0);  // a change of role is no selection
  }

  /// Which light a row is of is told where the pointer rests, also in a strip that is too low for names.
  void rowsOfLightsSayWhichLightTheyAre() {
    Document document(parseTrainSpec);
    const Fixture fixture;
    TimelineStrip strip(document);
    Opened opened = fixture.opened();
    auto scene = std::make_shared<Scene>(*opened.scene);
    scene->lights.clear();
    for (Frame& f : scene->frames) f.lightsOn = {"window", "lamp"};
    scene->frames[1].lightsOn = {"lamp"};
    opened.scene = scene;
    document.open(opened);
    for (const int height : {90, 122, 200}) {
      strip.resize(800, height);
      strip.grab();
      QStringList rows;
      for (int y = 0; y < height; ++y) {
        const QString tip = strip.tipAt({5, y});  // beside the frames
        if (!tip.isEmpty() && (rows.isEmpty() || rows.last() != tip)) rows << tip;
      }
      QCOMPARE(rows.size(), 2);
      QVERIFY2(rows[0].contains(QStringLiteral("window")) && rows[1].contains(QStringLiteral("lamp")),
               qPrintable(rows.join('|')));
      const int x = int(strip.cell(1).center().x());
      QStringList first;
      for (int y = 0; y < height; ++y) first << strip.tipAt({x, y}).section(QLatin1Char('\n'), 0, 0);
      QVERIFY2(first.contains(QStringLiteral("Light window: off")), qPrintable(first.join('|')));
      QVERIFY(first.contains(QStringLiteral("Light lamp: on")));
    }
  }

  /// A click on a light's row switches it in that frame, by one step of undo, and says where it cannot.
  void aClickOnALightSwitchesItInAFrame() {
    Document document(parseTrainSpec);
    const Fixture fixture;
    TimelineStrip strip(document);
    Opened opened = fixture.opened();
    auto scene = std::make_shared<Scene>(*opened.scene);
    scene->lights.clear();
    for (Frame& f : scene->frames) f.lightsOn = {"window", "lamp"};
    scene->frames[1].lightsOn = {"lamp"};
    opened.scene = scene;
    document.open(opened);
    strip.resize(800, 160);
    strip.grab();
    const auto click = [&](int light, int frame) {
      QTest::mouseClick(&strip, Qt::LeftButton, {}, strip.lightMark(light, frame).center().toPoint());
    };
    const auto tip = [&](int light, int frame) { return strip.tipAt(strip.lightMark(light, frame).center().toPoint()); };
    const int steps = document.undoStack()->index();
    click(0, 2);
    QVERIFY(isSwitchedOff(document.request().whatIf, 2, "window"));
    QVERIFY(!isSwitchedOff(document.request().whatIf, 2, "lamp"));
    QCOMPARE(document.undoStack()->index(), steps + 1);
    QCOMPARE(document.undoStack()->undoText(),
             QStringLiteral("Switch light window off in frame ") + QString::fromStdString(scene->frames[2].id));
    QCOMPARE(document.selection().frame, 0);  // no selection
    QVERIFY2(tip(0, 2).startsWith(QStringLiteral("Light window: switched off by hand")), qPrintable(tip(0, 2)));
    QVERIFY(tip(0, 2).contains(QStringLiteral("lights on: lamp")));
    const QImage off = strip.grab().toImage();
    document.undoStack()->undo();
    QVERIFY(document.request().whatIf.none());
    QVERIFY(strip.grab().toImage() != off);  // it is drawn
    document.undoStack()->redo();
    click(0, 2);  // back
    QVERIFY(document.request().whatIf.none());
    // Captured dark: nothing can show it lit, unless contours are synthesised.
    click(0, 1);
    QVERIFY(document.request().whatIf.none());
    QVERIFY2(tip(0, 1).contains(QStringLiteral("synthesised")), qPrintable(tip(0, 1)));
    WhatIf w;
    w.synthesise = true;
    document.setWhatIf(w, QStringLiteral("synthesise"));
    click(0, 1);
    QVERIFY(isOn(*scene, document.request().whatIf, 1, "window"));
    // All at once, from the menu of the row.
    switchLightEverywhere(document, strip.lights()[1], false);
    for (int i = 0; i < document.frameCount(); ++i) QVERIFY(isSwitchedOff(document.request().whatIf, i, "lamp"));
    switchLightEverywhere(document, strip.lights()[1], true);
    QCOMPARE(document.request().whatIf.lightsSwitched.size(), std::size_t(1));
  }

  /// A setting paints nothing again: a slider's step would wait for it.
  void aSettingPaintsNothingAgain() {
    Shown shown;
    TimelineStrip* strip = shown.timeline.strip();
    shown.document.setSetting("detect.level", 0.4);  // from here on the results are stale
    strip->grab();
    const int painted = strip->backgroundsPainted();
    shown.document.setSetting("detect.level", 0.3);
    strip->grab();
    QCOMPARE(strip->backgroundsPainted(), painted);
    shown.document.setRole(3, FrameRole::Excluded);
    strip->grab();
    QVERIFY(strip->backgroundsPainted() > painted);
  }

  void theWheelZoomsAroundTheFrameUnderTheMouse() {
    Shown shown;
    Document& document = shown.document;
    Timeline& timeline = shown.timeline;
    TimelineStrip* strip = timeline.strip();
    auto* scroll = timeline.findChild<QScrollBar*>(QStringLiteral("timelineScroll"));
    QVERIFY(!scroll->isVisible());
    const QPointF at = strip->cell(8).center();
    turnWheel(strip, at, 240);
    QCOMPARE(strip->framesInView(), 6.0);
    QCOMPARE(strip->frameAt(at), 8);
    QVERIFY(scroll->isVisible());
    scroll->setValue(0);
    QCOMPARE(strip->firstFrame(), 0.0);
    turnWheel(strip, at, -1200, Qt::ShiftModifier);
    QCOMPARE(strip->firstFrame(), 6.0);
    document.selectFrame(1);  // what is selected comes into view
    QCOMPARE(strip->firstFrame(), 1.0);
    turnWheel(strip, at, -4800);
    QCOMPARE(strip->framesInView(), 12.0);
    QVERIFY(!scroll->isVisible());
  }

  void barsSpeedAndThumbnailsAreOptionsThatUndoRestores() {
    Shown shown;
    Document& document = shown.document;
    Timeline& timeline = shown.timeline;
    // Thumbnails are asked for by the first painting, which may not have come yet: idle is not enough.
    QTRY_VERIFY(timeline.strip()->thumbnails().reads() >= 12 && !timeline.busy());
    QTest::qWait(20);
    const QImage lines = timeline.strip()->grab().toImage();
    QTest::mouseClick(timeline.findChild<QToolButton*>(QStringLiteral("timelineBars")), Qt::LeftButton);
    QCOMPARE(document.option("timeline/chart", std::string()), std::string("bars"));
    QVERIFY(timeline.strip()->grab().toImage() != lines);
    document.undoStack()->undo();
    QVERIFY(timeline.strip()->grab().toImage() == lines);
    document.setOption("timeline/thumbnails", "off", QString());
    QVERIFY(timeline.strip()->grab().toImage() != lines);
    auto* speed = timeline.findChild<QComboBox*>(QStringLiteral("playSpeed"));
    document.setOption("timeline/speed", 30.0, QString());
    QCOMPARE(speed->currentData().toInt(), 30);
  }

  /// 1,000 frames under the mouse: painting and reading depend on how often the screen is refreshed, not on how many frames
  /// passed by.
  void scrubbingPaintsACursorAndReadsWhereItStops() {
    const Fixture fixture(1000);
    Document document(parseTrainSpec);
    Timeline timeline(document);
    FramePanel frame(document);
    timeline.resize(1200, 140);
    frame.resize(400, 400);
    timeline.show();
    frame.show();
    QVERIFY(QTest::qWaitForWindowExposed(&timeline));
    QVERIFY(QTest::qWaitForWindowExposed(&frame));
    open(document, fixture);
    QTRY_VERIFY(!timeline.busy() && !frame.busy());
    QVERIFY(timeline.strip()->thumbnails().reads() < 60);  // those that are seen
    TimelineStrip* strip = timeline.strip();
    strip->grab();
    const int backgrounds = strip->backgroundsPainted(), thumbnails = strip->thumbnails().reads(),
              reads = frame.loader()->reads();
    Paints stripPaints(strip), framePaints(frame.canvas());
    constexpr int kTurns = 50;
    const auto send = [strip](QEvent::Type type, const QPointF& at, Qt::MouseButton button) {
      QMouseEvent event(type, at, strip->mapToGlobal(at.toPoint()), button, Qt::LeftButton, Qt::NoModifier);
      QCoreApplication::sendEvent(strip, &event);
    };
    send(QEvent::MouseButtonPress, strip->cell(0).center(), Qt::LeftButton);
    for (int i = 1; i < 1000; ++i) {
      send(QEvent::MouseMove, strip->cell(i).center(), Qt::NoButton);
      QCOMPARE(document.selection().frame, i);
      if (i % (1000 / kTurns) == 0) QCoreApplication::processEvents();
    }
    send(QEvent::MouseButtonRelease, strip->cell(999).center(), Qt::LeftButton);
    QTRY_VERIFY(!frame.busy());
    QCOMPARE(document.undoStack()->count(), 1);
    QCOMPARE(strip->backgroundsPainted(), backgrounds);
    QCOMPARE(strip->thumbnails().reads(), thumbnails);
    QVERIFY2(frame.loader()->reads() - reads <= kTurns + 2, qPrintable(QString::number(frame.loader()->reads() - reads)));
    QVERIFY2(stripPaints.count <= 2 * kTurns + 4, qPrintable(QString::number(stripPaints.count)));
    QVERIFY2(framePaints.count <= 3 * kTurns + 4, qPrintable(QString::number(framePaints.count)));
    QCOMPARE(frame.loader()->pictureFrame(), 999);
  }
};

QObject* makeTimelineTest() { return new TimelineTest; }

}  // namespace glint::gui

#include "timeline_test.moc"
