// SPDX-License-Identifier: BSD-3-Clause
// The screen tells the truth: no heading with another frame's numbers, no old numbers as new ones, no missed highlight as a small
// error, no line of the window below the screen.
#include <QAbstractItemModel>
#include <QGuiApplication>
#include <QLabel>
#include <QScreen>
#include <QStatusBar>
#include <QTextDocument>

#include "core/base/number_text.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/panels/error_model.h"
#include "gui/panels/numbers_panel.h"
#include "gui/plots/plot_canvas.h"
#include "gui/plots/plots_panel.h"
#include "gui/timeline/timeline_strip.h"
#include "gui/window/fit_on_screen.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"
#include "viz/scene_questions.h"

namespace glint::gui {

namespace {
constexpr int kMissedFrame = 4;
constexpr double kSmallPct = 0.01;  // of what is matched beside a missed highlight: smaller than every other error

/// The stand-in's result, but in one frame there is a second highlight, which every model misses.
Inspection withAMiss(const std::shared_ptr<const Scene>& scene, const InspectionRequest& request) {
  Inspection result = drawnCircles(scene, request);
  Highlight second = result.evidence[kMissedFrame].highlights[0];
  for (Pixel& p : second.contour.points) p.y() += 45;
  result.evidence[kMissedFrame].highlights.push_back(second);
  for (auto& [name, model] : result.models) {
    FrameComparison& c = model.frames[kMissedFrame];
    c.rows[0].metrics->contourErrorPct = kSmallPct;
    c.rows.push_back({1, -1, {}, Failure{Reason::NotReached, "no prediction overlaps this highlight"}, {}});
  }
  return result;
}

QString plain(const QLabel* label) {
  QTextDocument text;
  text.setHtml(label->text());
  return text.toPlainText();
}
}  // namespace

class TruthTest : public QObject {
  Q_OBJECT
 private slots:
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    document_->open(fixture_.opened());
  }

  void theTimelineHasACrossForAMissedHighlight() {
    TimelineStrip strip(*document_);
    document_->open(fixture_.opened());  // with the strip there, as in the window: it then shows all frames
    strip.resize(800, 200);
    const auto show = [&](const Inspection& inspection) {
      document_->setInspection(std::make_shared<const Inspection>(inspection), document_->request());
      strip.grab();
      return strip.grab().toImage();
    };
    const QImage missed = show(withAMiss(fixture_.scene(), document_->request()));
    const QRectF row = strip.missedRow();
    QVERIFY(row.height() >= 6);
    const QString overMissed = strip.tipAt(strip.cell(kMissedFrame).center().toPoint());
    QVERIFY2(overMissed.contains(QStringLiteral("missed 1 of 2 highlights")), qPrintable(overMissed));
    QVERIFY(!strip.tipAt(strip.cell(kMissedFrame - 1).center().toPoint()).contains(QStringLiteral("missed")));
    const QColor ground = strip.palette().color(QPalette::Base);
    const auto inked = [&](const QImage& image, int frame, double top, double bottom) {
      constexpr int kSeen = 60;  // of 255
      int n = 0;
      const QRectF cell = strip.cell(frame);
      for (int y = int(top) + 1; y < int(bottom); ++y)
        for (int x = int(cell.left()) + 2; x < int(cell.right()) - 2; ++x) {
          const QColor c = image.pixelColor(x, y);
          n += std::abs(c.red() - ground.red()) > kSeen || std::abs(c.green() - ground.green()) > kSeen ||
               std::abs(c.blue() - ground.blue()) > kSeen;
        }
      return n;
    };
    QVERIFY(inked(missed, kMissedFrame, row.top(), row.bottom()) > 2);
    QCOMPARE(inked(missed, kMissedFrame - 1, row.top(), row.bottom()), 0);
    // The errors below have a gap.
    const double bottom = strip.roleMark(0).top() - 2;
    QCOMPARE(inked(missed, kMissedFrame, row.bottom() + 2, bottom), 0);
    QVERIFY(inked(missed, kMissedFrame - 2, row.bottom() + 2, bottom) > 2);
    // Where it is excluded nothing is missed, and nothing evaluated.
    document_->setRole(kMissedFrame, FrameRole::Excluded);
    const QImage excluded = show(withAMiss(fixture_.scene(), document_->request()));
    QCOMPARE(inked(excluded, kMissedFrame, row.top(), row.bottom()), 0);
    const QString tip = strip.tipAt(strip.cell(kMissedFrame).center().toPoint());
    QVERIFY2(tip.contains(QStringLiteral("not evaluated")) && !tip.contains('%'), qPrintable(tip));
  }

  void whatWasPickedFollowsNewResultsOrSaysThatItIsOld() {
    NumbersPanel numbers(*document_);
    const auto first = std::make_shared<Inspection>(drawnCircles(fixture_.scene(), document_->request()));
    auto second = std::make_shared<Inspection>(*first);
    first->models.at("canonical").frames[2].rows[0].metrics->contourErrorPct = 1.25;
    second->models.at("canonical").frames[2].rows[0].metrics->contourErrorPct = 7.75;
    document_->setInspection(first, document_->request());
    numbers.showPicked(viz::cameraPicked(*first, {"canonical"}, 2));
    const QString error = QStringLiteral("canonical contour error = ");
    QVERIFY2(numbers.text().contains(error + QStringLiteral("1.25 %")), qPrintable(numbers.text()));
    document_->setInspection(second, document_->request());
    QVERIFY2(numbers.text().contains(error + QStringLiteral("7.75 %")), qPrintable(numbers.text()));
    QVERIFY(!numbers.text().contains(error + QStringLiteral("1.25 %")));
    viz::Picked ellipsoid;
    ellipsoid.layer = "ellipsoids";
    ellipsoid.text = "semi-axes = 1, 2, 3 m\n";
    numbers.showPicked(ellipsoid);
    QVERIFY(numbers.text().startsWith(QStringLiteral("Picked: ellipsoids")));
    document_->setInspection(std::make_shared<Inspection>(*first), document_->request());
    QVERIFY2(numbers.text().startsWith(QStringLiteral("Picked (results out of date): ellipsoids")), qPrintable(numbers.text()));
    document_->selectFrame(3);
    QVERIFY(!numbers.text().contains(QStringLiteral("Picked")));
  }

  void headingAndNumbersAreOfOneFrame() {
    FramePanel panel(*document_);
    panel.resize(600, 600);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    const auto inspection = std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request()));
    document_->setInspection(inspection, document_->request());
    QTRY_VERIFY(!panel.busy());
    const auto* title = panel.findChild<QLabel*>(QStringLiteral("frameTitle"));
    const auto* captions = panel.findChild<QLabel*>(QStringLiteral("frameCaptions"));
    const auto agree = [&] {
      const int frame = plain(title).toInt();  // fixture: "0007"
      const FrameScore score = frameScore(inspection->models.at("canonical"), frame);
      return plain(captions).contains(toQString(errorText(*score.errorPct)));
    };
    QVERIFY(agree());
    for (const int frame : {3, 7, 2, 9}) {
      document_->selectFrame(frame);
      QVERIFY2(agree(), "at once");
      QTRY_VERIFY(!panel.busy());
      QCOMPARE(plain(title).toInt(), frame);
      QVERIFY2(agree(), "then");
    }
  }

  void anotherFramesPhotographIsFaintAndNamed() {
    FrameCanvas canvas;
    canvas.resize(300, 200);
    QImage white(160, 120, QImage::Format_RGB888);
    white.fill(Qt::white);
    canvas.setPhotograph(white);
    const auto brightness = [&] {
      return canvas.grab().toImage().pixelColor(canvas.width() / 2, canvas.height() / 2).lightness();
    };
    const int before = brightness();
    canvas.setAwaited(QStringLiteral("reading the photograph of 7"));
    QCOMPARE(brightness(), before);  // one that comes soon leaves no flicker
    QTRY_VERIFY(brightness() < before - 60);
    canvas.setPhotograph(white);
    QCOMPARE(brightness(), before);
  }

  void aPlotOfOneFrameIsNeverThatOfAnother() {
    PlotsPanel panel(*document_);
    panel.resize(1000, 340);
    panel.show();
    QVERIFY(QTest::qWaitForWindowExposed(&panel));
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request())),
                             document_->request());
    for (const char* kind : {"limit-angle", "lobe"}) {
      document_->setOption("plots/first", kind, QString());
      document_->selectFrame(2);
      QTRY_VERIFY(panel.idle());
      const auto title = [&] { return toQString(panel.canvas(0)->plot().title); };
      QVERIFY2(title().contains(QStringLiteral("0002")), qPrintable(title()));
      document_->selectFrame(5);
      QVERIFY2(!title().contains(QStringLiteral("0002")), qPrintable(title()));
      QTRY_VERIFY(panel.idle() && title().contains(QStringLiteral("0005")));
    }
  }

  void anExcludedFrameIsNoHeldOutOneInTheTable() {
    document_->setRole(7, FrameRole::Excluded);
    document_->setRole(11, FrameRole::Excluded);  // where every model fails
    ErrorModel model(*document_);
    document_->setInspection(std::make_shared<const Inspection>(drawnCircles(fixture_.scene(), document_->request())),
                             document_->request());
    int excluded = 0;
    for (int row = 0; row < model.rowCount(); ++row) {
      const bool is = model.frameOf(row) == 7 || model.frameOf(row) == 11;
      excluded += is;
      const QModelIndex error = model.index(row, ErrorModel::ErrorPct);
      const QColor ink = error.data(Qt::ForegroundRole).value<QBrush>().color();
      QCOMPARE(
          error.data(Qt::ForegroundRole).isValid() && ink == QGuiApplication::palette().color(QPalette::Disabled, QPalette::Text),
          is);
      QCOMPARE(model.index(row, ErrorModel::Role).data().toString() == QStringLiteral("excluded"), is);
      if (is) QVERIFY(!error.data(ErrorModel::kProblemRole).toBool());
    }
    QCOMPARE(excluded, 2 * int(document_->request().models.size()));
  }

  void theWindowFitsItsScreenWithItsFrame() {
    const QMargins frame(2, 28, 2, 3);
    const QRect screen(0, 0, 1600, 1000);
    QCOMPARE(contentWithin({0, 0, 1600, 1000}, frame, screen), QRect(2, 28, 1596, 969));
    QCOMPARE(contentWithin({100, 50, 800, 600}, frame, screen), QRect(100, 50, 800, 600));  // nothing to do
    QCOMPARE(contentWithin({1200, 700, 800, 600}, frame, screen), QRect(798, 397, 800, 600));
    QCOMPARE(contentWithin({0, 0, 1600, 1000}, {}, screen), screen);
    const QRect available = QGuiApplication::primaryScreen()->availableGeometry();
    MainWindow window(fixture_.engine());
    new FitOnScreen(&window, [frame] { return frame; });
    window.show();
    QVERIFY(QTest::qWaitForWindowExposed(&window));
    QTRY_VERIFY(available.contains(window.geometry().marginsAdded(frame)));
    const QPoint lowest = window.statusBar()->mapToGlobal(QPoint(0, window.statusBar()->height()));
    QVERIFY(lowest.y() <= available.bottom() + 1 - frame.bottom());
    // Afterwards its size is the user's.
    QTRY_VERIFY(!window.findChild<FitOnScreen*>());
  }

 private:
  Fixture fixture_;
  std::unique_ptr<Document> document_;
};

QObject* makeTruthTest() { return new TruthTest; }

}  // namespace glint::gui

#include "truth_test.moc"
