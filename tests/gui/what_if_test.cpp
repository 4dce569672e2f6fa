// SPDX-License-Identifier: BSD-3-Clause
// While a what-if synthesises the contours, every view shows the photograph that belongs to them.
#include <QCheckBox>
#include <QImage>
#include <QLabel>
#include <algorithm>
#include <cmath>

#include "core/geometry/polyline.h"
#include "gui/document/engine.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/scene/photograph_store.h"
#include "gui/timeline/thumbnails.h"
#include "gui/whatif/what_if_panel.h"
#include "gui/window/main_window.h"
#include "tests/gui/fixture.h"
#include "tests/sanitizers/cases.h"

namespace glint::gui {

class WhatIfTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() {
    window_ = std::make_unique<MainWindow>(coreEngine());
    window_->resize(1200, 800);
    window_->show();
    window_->open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/ellipsoid/ellipsoid.glint"));
    settle();
    document().setModels({"dual"});
    settle();
    captured_ = loader().picture().shown.copy();
    QVERIFY(!captured_.isNull() && !loader().picture().synthesised);
  }

  void init() { change({}); }

  void theFrameViewShowsTheHighlightThatIsInTheOverlay() {
    WhatIf w;
    w.synthesise = true;
    w.roughness = 0.08;
    change(w);
    QVERIFY(loader().picture().synthesised && loader().picture().complete);
    QVERIFY(panel().canvas()->caption().contains("photograph"));
    const Pixel before = brightest(loader().picture().shown);
    QVERIFY(inContour(before));
    w.lightsBy[document().scene()->lights.at(0).id] = Eigen::Vector3d(0.4, 0, 0);
    change(w);
    const Pixel after = brightest(loader().picture().shown);
    QVERIFY(inContour(after));
    QVERIFY2((after - before).norm() > 10, "the highlight went with the lamp");
  }

  void aQuickLookComesBeforeTheWhole() {
    QList<bool> complete;
    const auto seen = connect(&loader(), &PhotoLoader::loaded, this, [&](int, const FramePicture& p) {
      if (p.synthesised) complete << p.complete;  // the captured one is shown until then
    });
    WhatIf w;
    w.synthesise = true;
    w.roughness = 0.12;
    change(w);
    disconnect(seen);
    QVERIFY(complete.size() >= 2);
    QVERIFY(complete.contains(false));
    QVERIFY(complete.last());
  }

  void exposureDevelopsItWithoutRenderingAgain() {
    WhatIf w;
    w.synthesise = true;
    change(w);
    const int reads = loader().reads();
    const QImage before = loader().picture().shown.copy();
    document().setOption("frame/exposure", 2.0, "Exposure");
    settle();
    QVERIFY(loader().picture().shown != before);
    QCOMPARE(loader().reads(), reads);
    document().setOption("frame/exposure", 0.0, "Exposure");
    settle();
  }

  void puttingItBackShowsWhatWasCaptured() {
    WhatIf w;
    w.synthesise = true;
    change(w);
    QVERIFY(loader().picture().shown != captured_);
    change({});
    QVERIFY(!loader().picture().synthesised);
    QCOMPARE(loader().picture().shown, captured_);
    QVERIFY(!panel().canvas()->caption().contains("photograph"));
  }

  /// The lines below the photograph, which had more to say, become as few as before.
  void puttingEverythingBackGivesThePhotographItsRoomBack() {
    MainWindow window(coreEngine());
    window.resize(1280, 720);
    window.show();
    window.open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/lessons/plane-to-cylinder/plane-to-cylinder.glint"));
    Document& d = window.document();
    const auto settled = [&] { return d.inspection() && !d.stale() && window.idle() && !window.framePanel()->busy(); };
    QTRY_VERIFY_WITH_TIMEOUT(settled(), testing_support::kWaitMs);
    d.selectFrame(d.frameCount() - 1);
    QTRY_VERIFY_WITH_TIMEOUT(settled(), testing_support::kWaitMs);
    const FrameCanvas* canvas = window.framePanel()->canvas();
    auto* captions = window.findChild<QLabel*>("frameCaptions");
    const int room = canvas->height(), lines = captions->height();
    const double zoom = canvas->zoom();
    int most = 0;
    WhatIf w;
    w.synthesise = true;
    for (const Eigen::Vector3d& by : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1.5, 0, -0.5), Eigen::Vector3d(4, 2, -1)}) {
      w.lightsBy[d.scene()->lights.at(0).id] = by;
      d.setWhatIf(w, "What-if");
      QTRY_VERIFY_WITH_TIMEOUT(settled(), testing_support::kWaitMs);
      QTest::qWait(50);
      most = std::max(most, captions->height());
    }
    QVERIFY2(most > lines, "the what-if must need more lines, or this tests nothing");
    d.setWhatIf({}, "What-if: reset");
    QTRY_VERIFY_WITH_TIMEOUT(settled(), testing_support::kWaitMs);
    QTRY_COMPARE(captions->height(), lines);
    QTRY_COMPARE(canvas->height(), room);
    QCOMPARE(canvas->zoom(), zoom);
  }

  void aMovedCameraAloneKeepsItsPhotograph() {
    WhatIf w;
    w.poses[document().selection().frame].translation = {0.01, 0, 0};
    change(w);
    QCOMPARE(loader().picture().shown, captured_);
  }

  void thumbnailsAndTexturesFollowAndStayUntilReplaced() {
    Thumbnails thumbnails;
    PhotographStore store;
    const auto idle = [&] { return !thumbnails.busy() && !store.busy(); };
    thumbnails.setScene(document().sharedScene());
    store.setScene(document().sharedScene());
    const auto ask = [&] {
      thumbnails.setInspection(document().inspection());
      store.setInspection(document().inspection());
      thumbnails.want({0}, 40);
      return store.get(0, 200);
    };
    ask();
    QTRY_VERIFY_WITH_TIMEOUT(idle(), 20000);
    const QImage small = thumbnails.find(0);
    const vtkSmartPointer<vtkImageData> texture = store.get(0, 200).texture;
    QVERIFY(!small.isNull() && texture);
    WhatIf w;
    w.synthesise = true;
    w.lightsBy[document().scene()->lights.at(0).id] = Eigen::Vector3d(0.1, 0, 0);
    change(w);
    const viz::LayerCache::Photograph meanwhile = ask();
    QVERIFY(meanwhile.arriving);
    QCOMPARE(meanwhile.texture.Get(), texture.Get());
    QCOMPARE(thumbnails.find(0), small);
    QTRY_VERIFY_WITH_TIMEOUT(idle(), 20000);
    QVERIFY(thumbnails.find(0) != small);
    QVERIFY(!store.get(0, 200).arriving && store.get(0, 200).texture != texture);
    change({});
    ask();
    QTRY_VERIFY_WITH_TIMEOUT(idle(), 20000);
    QCOMPARE(thumbnails.find(0), small);
  }

  /// Switched on, the contours stay about where they were; switched off, nothing of it is left.
  void aSynthesisStartsFromTheLobeOfTheScene() {
    auto* panel = window_->findChild<WhatIfPanel*>();
    auto* box = panel->findChild<QCheckBox*>("whatif.synthesise");
    auto* origin = panel->findChild<QLabel*>("whatif.origin");
    document().setModels({"dual", "reflectance"});
    settle();
    const FittedLobe fitted = *fittedLobe(*document().inspection(), document().selection().frame);
    QVERIFY(fitted.roughness != WhatIf{}.roughness);
    QTRY_VERIFY2(origin->text().contains("reflectance, light"), qPrintable(origin->text()));
    const double area = areaOfTheContour();
    QMetaObject::invokeMethod(box, "clicked", Q_ARG(bool, true));
    settle();
    QCOMPARE(document().request().whatIf.roughness, fitted.roughness);
    QCOMPARE(document().request().whatIf.lobe, fitted.lobe);
    constexpr double kSameArea = 0.05;  // relative: of contours in eight-bit codes
    QVERIFY2(std::abs(areaOfTheContour() / area - 1) < kSameArea, qPrintable(QString::number(areaOfTheContour() / area)));
    QVERIFY2(origin->text().contains("Same lobe as captured"), qPrintable(origin->text()));
    QMetaObject::invokeMethod(box, "clicked", Q_ARG(bool, false));
    settle();
    QVERIFY(document().request().whatIf.none());
    document().setModels({"primal"});  // tells no light, hence no lobe
    settle();
    QTRY_VERIFY2(origin->text().contains("default lobe") && origin->text().contains("0.1"), qPrintable(origin->text()));
    QMetaObject::invokeMethod(box, "clicked", Q_ARG(bool, true));
    QCOMPARE(document().request().whatIf.roughness, WhatIf{}.roughness);
    settle();
    change({});
    document().setModels({"dual"});
    settle();
  }

 private:
  double areaOfTheContour() {
    return document().inspection()->evidence.at(std::size_t(document().selection().frame)).highlights.at(0).areaPx2;
  }

  Document& document() { return window_->document(); }
  FramePanel& panel() { return *window_->findChild<FramePanel*>(); }
  PhotoLoader& loader() { return *panel().loader(); }

  void settle() {
    QTRY_VERIFY_WITH_TIMEOUT(document().inspection() && window_->idle() && !panel().busy(), testing_support::kWaitMs);
  }

  void change(const WhatIf& w) {
    document().setWhatIf(w, "What-if");
    settle();
  }

  static Pixel brightest(const QImage& image) {
    Pixel best(0, 0);
    for (int y = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        if (qGray(image.pixel(x, y)) > qGray(image.pixel(int(best.x()), int(best.y())))) best = Pixel(x, y);
    return best;
  }

  bool inContour(const Pixel& p) {
    const FrameEvidence& e = document().inspection()->evidence.at(std::size_t(document().selection().frame));
    return std::any_of(e.scored().begin(), e.scored().end(), [&](const Highlight& h) { return contains(h.contour, p); });
  }

  std::unique_ptr<MainWindow> window_;
  QImage captured_;
};

QObject* makeWhatIfTest() { return new WhatIfTest; }

}  // namespace glint::gui
#include "what_if_test.moc"
