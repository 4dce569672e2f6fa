// SPDX-License-Identifier: BSD-3-Clause
// The guided mode on a session of the repository, with the real engine.
#include "core/advise/explain.h"

#include <QAction>
#include <QComboBox>
#include <QDockWidget>
#include <QLabel>
#include <QListWidget>
#include <QScrollBar>
#include <QTextBrowser>
#include <QToolButton>
#include <QWheelEvent>
#include <cmath>

#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "gui/explain/duality_window.h"
#include "gui/explain/equation_browser.h"
#include "gui/explain/explain_panel.h"
#include "gui/explain/explain_texts.h"
#include "gui/explain/walk_view.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/scene/camera_glide.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "gui/window/main_window.h"
#include "gui/window/palette.h"
#include "gui/window/symbol_links.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

class ExplainTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() {
    window_ = std::make_unique<MainWindow>(knownEngine());
    window_->show();
    window_->open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/plane-to-cylinder/plane-to-cylinder.glint"));
    QTRY_VERIFY_WITH_TIMEOUT(window_->document().scene() && window_->idle() && window_->document().inspection(), 120000);
    panel_ = window_->findChild<ExplainPanel*>();
    QVERIFY(panel_);
  }
  void cleanupTestCase() { window_.reset(); }
  void cleanup() {
    while (window_->document().undoStack()->canUndo()) window_->document().undoStack()->undo();
  }

  void theTextsAreThoseOfTheSteps() {
    QStringList ids;
    for (const ExplainText& t : explainTexts().steps) ids << t.id;
    QStringList expected;
    for (const std::string& id : explainSteps()) expected << toQString(id);
    QCOMPARE(ids, expected);
    for (const ExplainText& t : explainTexts().steps) {
      QStringList layers = t.layers;
      for (const ExplainText::Shown& shown : t.shownOfModels) layers += shown.layers;
      for (const QString& layer : layers) {
        const auto& all = viz::sceneLayers();
        QVERIFY2(std::any_of(all.begin(), all.end(), [&](const viz::Layer& l) { return toQString(l.name) == layer; }),
                 qPrintable(layer));
      }
    }
  }

  /// The cones of primal and dual go through the observed ellipses: canonical ones do not belong to their picture.
  void theConesOfAModelStandWithItsOwnEllipses() {
    for (const auto& [model, canonical] : {std::pair("canonical", true), std::pair("primal", false), std::pair("dual", false)}) {
      select(1, model);
      goTo("ellipsoid");
      QCOMPARE(window_->document().layerVisible("canonical-ellipses"), canonical);
      QCOMPARE(window_->document().layerVisible("observed-contours"), !canonical);
      QCOMPARE(window_->document().layerVisible("frame/canonical"), canonical);
      QVERIFY(window_->document().layerVisible("cones"));
    }
  }

  /// Steps whose words depend on the model must not show words of another model.
  void aModelWithoutWordsHasNotThoseOfAnother() {
    for (const ExplainText& t : explainTexts().steps) {
      QVERIFY2(t.words(QStringLiteral("canonical")).text == t.text, qPrintable(t.id));
      QVERIFY2((t.words(QStringLiteral("a new model")).text == t.text) == t.ofModels.isEmpty(), qPrintable(t.id));
    }
  }

  /// A window of its own, in which plane and point are lit together by pointer and keys.
  void primalAndDualAreSideBySide() {
    window_->actions().find("explain.duality")->trigger();
    auto* shown = window_->findChild<DualityWindow*>("duality");
    QVERIFY(shown && shown->isVisible());
    QVERIFY2(shown->duality(), qPrintable(window_->document().option("explain/step", std::string()).c_str()));
    auto* words = shown->findChild<QLabel*>("duality.words");
    const QString plain = words->text();
    QVERIFY(plain.contains("linear"));
    const viz::DualityPicture before = shown->picture();
    for (const auto* places : {&before.planes, &before.points}) {
      const Eigen::Vector2d at = (*places)[places->size() / 2].at;
      QTest::mouseMove(shown->canvas(), QPoint(2, 2));
      QTest::mouseMove(shown->canvas(), QPoint(int(at.x()), int(at.y())));
      QTRY_VERIFY(shown->lit().view >= 0);
      QVERIFY(words->text() != plain);
    }
    QTest::mouseMove(shown->canvas(), QPoint(2, 2));
    QTRY_VERIFY(shown->lit().view < 0);
    QCOMPARE(words->text(), plain);
    QTest::keyClick(shown->canvas(), Qt::Key_Right);
    QCOMPARE(shown->lit().plane, 0);
    QTest::keyClick(shown->canvas(), Qt::Key_Left);
    QCOMPARE(shown->lit().plane, int(shown->duality()->views.front().planes.size()) - 1);
    QVERIFY(window_->findChild<SymbolLinks*>()->lit().planeShown());  // in the 3D view, too
    const int view = shown->lit().view;
    QTest::keyClick(shown->canvas(), Qt::Key_Down);
    QVERIFY(shown->lit().view != view);
    // It follows the selection.
    draw::Selection selection = window_->document().selection();
    selection.model = shown->duality()->model == "primal" ? "canonical" : "primal";
    window_->document().select(selection);
    QCOMPARE(QString::fromStdString(shown->duality() ? shown->duality()->model : selection.model),
             QString::fromStdString(selection.model));
    shown->close();
    QVERIFY(!window_->findChild<SymbolLinks*>()->lit().planeShown());
  }

  /// A click in 3D lights its plane there, and so does a selected training frame. The main window's keys work, too; Esc closes
  /// the window.
  void theWindowOfPrimalAndDualFollowsThe3dViewAndKnowsTheKeys() {
    window_->actions().find("explain.duality")->trigger();
    auto* shown = window_->findChild<DualityWindow*>("duality");
    QCOMPARE(shown->lit().view, -1);
    const int view = shown->duality()->views.front().frame == window_->document().selection().frame ? 1 : 0;
    viz::Picked picked;
    picked.layer = "cones";
    picked.frame = shown->duality()->views[std::size_t(view)].frame;
    window_->document().selectFrame(picked.frame);
    QVERIFY((shown->lit() == viz::DualityPlane{view, 0}));
    const Duality::View& cone = shown->duality()->views[std::size_t(view)];
    picked.position = cone.apex + 0.7 * cone.planes[5].cone.along;
    emit window_->findChild<SceneViews*>()->picked(picked);
    QVERIFY((shown->lit() == viz::DualityPlane{view, 5}));
    QVERIFY(window_->findChild<SymbolLinks*>()->lit().planeShown());
    QApplication::setActiveWindow(shown);  // there is no window manager
    QTRY_VERIFY(shown->isActiveWindow());
    QTest::keyClick(shown->canvas(), Qt::Key_K, Qt::ControlModifier);
    QTRY_VERIFY(window_->findChild<Palette*>("palette")->isVisible());
    window_->findChild<Palette*>("palette")->hide();
    QTest::keyClick(shown->canvas(), Qt::Key_Escape);
    QVERIFY(!shown->isVisible());
  }

  void everyStepIsReachedForwardsAndBackAndIsOneStepOfUndo() {
    const auto before = window_->document().state().layers;
    window_->actions().find("explain.start")->trigger();
    auto* next = panel_->findChild<QToolButton*>("explain.next");
    auto* back = panel_->findChild<QToolButton*>("explain.back");
    const int steps = int(explainSteps().size());
    for (int i = 0; i < steps; ++i) {
      QCOMPARE(panel_->step(), i);
      QTRY_VERIFY(!panel_->busy() && panel_->explanation());
      const QString shown = panel_->findChild<QTextBrowser*>("explain.text")->toPlainText();
      QVERIFY2(shown.contains(explainTexts().steps[i].title), qPrintable(shown));
      QCOMPARE(window_->document().undoStack()->count(), i + 1);
      // Planes, normals and canonical ellipses of all frames at once would be a heap.
      QCOMPARE(window_->document().option("scene/solo", 0.0) == 1,
               explainTexts().steps[i].id == "tangent-plane" || explainTexts().steps[i].id == "canonical-ellipse");
      for (const viz::Layer& layer : viz::sceneLayers())
        QCOMPARE(window_->document().layerVisible(layer.name), explainTexts().steps[i].layers.contains(toQString(layer.name)));
      if (i + 1 < steps) QTest::mouseClick(next, Qt::LeftButton);
    }
    QVERIFY(!next->isEnabled());
    QTest::mouseClick(back, Qt::LeftButton);
    QCOMPARE(panel_->step(), steps - 2);
    QTest::mouseClick(panel_->findChild<QToolButton*>("explain.leave"), Qt::LeftButton);
    QCOMPARE(panel_->step(), -1);
    QVERIFY(window_->document().state().layers == before);
    QCOMPARE(window_->document().option("scene/solo", std::string()), std::string());
    window_->document().undoStack()->undo();
    QCOMPARE(panel_->step(), steps - 2);
  }

  void itSaysWhyPrimalFailsWhereTheSheetIsBent() {
    const int last = window_->document().frameCount() - 1;  // the most bent sheet of the sequence
    draw::Selection s;
    s.frame = last;
    s.model = "primal";
    window_->document().select(s);
    panel_->goTo(2);
    QTRY_VERIFY(!panel_->busy() && panel_->explanation() && panel_->explanation()->frame == last);
    QVERIFY(panel_->findChild<QTextBrowser*>("explain.text")->toPlainText().contains("the model fails"));
    s.frame = 0;  // the plane
    window_->document().select(s);
    QTRY_VERIFY(!panel_->busy() && panel_->explanation() && panel_->explanation()->frame == 0);
    QVERIFY(!panel_->findChild<QTextBrowser*>("explain.text")->toPlainText().contains("the model fails"));
  }

  /// An earlier request is of no use then, and may still run.
  void leavingAndComingBackAtOnceComputesAgain() {
    Document& d = window_->document();
    d.selectFrame(d.frameCount() - 1);
    panel_->goTo(2);
    d.undoStack()->undo();
    d.undoStack()->undo();
    QCOMPARE(panel_->step(), -1);
    QVERIFY(panel_->busy() && !panel_->explanation());
    panel_->goTo(2);
    QTRY_VERIFY(panel_->explanation());
    QCOMPARE(panel_->explanation()->frame, d.selection().frame);
    QTRY_VERIFY(!panel_->busy());
  }

  void aStepThatIsNotReachedSaysWhy() {
    Document& d = window_->document();
    const auto settled = [&] { return window_->idle() && !d.stale() && !panel_->busy() && panel_->explanation(); };
    window_->actions().find("explain.step-light")->trigger();
    QTRY_VERIFY_WITH_TIMEOUT(settled(), 60000);
    auto* text = panel_->findChild<QTextBrowser*>("explain.text");
    QVERIFY(!text->toPlainText().contains("does not reach this step"));
    d.setModels({"primal"});  // it needs no light, so none is estimated
    QTRY_VERIFY_WITH_TIMEOUT(settled(), 60000);
    QTRY_VERIFY2(text->toPlainText().contains("does not reach this step"), qPrintable(text->toPlainText()));
    QVERIFY2(text->toPlainText().contains("no computed model needs one"), qPrintable(text->toPlainText()));
    d.undoStack()->undo();
    QTRY_VERIFY_WITH_TIMEOUT(settled(), 60000);
    QTRY_VERIFY(!text->toPlainText().contains("does not reach this step"));
  }

  /// The views show what a step speaks of, also when something else is selected meanwhile.
  void theViewsFollowWhatAStepIsAbout() {
    auto* scene = window_->findChild<ScenePanel*>();
    FrameCanvas* canvas = window_->framePanel()->canvas();
    const auto eye = [&] { return scene->view().viewPoint().position; };
    draw::Selection s;
    s.frame = 0;
    s.model = "canonical";
    window_->document().select(s);
    goTo("peak");
    settle();
    canvas->fit();
    const double whole = canvas->zoom();
    goTo("tangent-plane");
    settle();
    QVERIFY(canvas->zoom() > 1.5 * whole);  // on the highlight
    const Eigen::Vector3d first = eye();
    s.frame = window_->document().frameCount() - 1;
    window_->document().select(s);
    settle();
    QVERIFY((eye() - first).norm() > 1e-3);
    goTo("light");
    settle();
    QVERIFY(canvas->zoom() < 1.2 * whole);  // the lines below the canvas may have grown
    const Eigen::Vector3d overview = eye();
    s.frame = 0;
    window_->document().select(s);  // is in the same picture
    settle();
    QCOMPARE((eye() - overview).norm(), 0.0);
    goTo("ellipsoid");
    settle();
    const Eigen::Vector3d canonical = eye();
    s.model = "primal";
    window_->document().select(s);
    settle();
    QVERIFY((eye() - canonical).norm() > 1e-3);
    window_->document().setSetting("predict.directions", 12);  // nothing else to look at
    const Eigen::Vector3d primal = eye();
    QTRY_VERIFY_WITH_TIMEOUT(!window_->document().stale(), 60000);
    settle();
    QCOMPARE((eye() - primal).norm(), 0.0);
  }

  /// A person who turned the wheel on the photograph has chosen what is seen of it.
  void whatTheUserZoomedToStays() {
    FrameCanvas* canvas = window_->framePanel()->canvas();
    goTo("peak");
    settle();
    canvas->fit();
    const double whole = canvas->zoom();
    goTo("tangent-plane");
    settle();
    QVERIFY(canvas->zoom() > 1.5 * whole);
    const QPointF at = canvas->rect().center();
    QWheelEvent wheel(at, canvas->mapToGlobal(at.toPoint()), {}, {0, 240}, Qt::NoButton, Qt::NoModifier, Qt::NoScrollPhase,
                      false);
    QCoreApplication::sendEvent(canvas, &wheel);
    const double chosen = canvas->zoom();
    goTo("light");
    settle();
    QCOMPARE(canvas->zoom(), chosen);
  }

  void theViewGlidesForAPersonWhoCanTakeIt() {
    auto* scene = window_->findChild<ScenePanel*>();
    auto* glide = scene->findChild<CameraGlide*>();
    const auto eye = [&] { return scene->view().viewPoint().position; };
    goTo("tangent-plane");
    settle();
    const Eigen::Vector3d near = eye();
    bool ran = false;  // nobody asked for animations
    goTo("light");
    QTRY_VERIFY_WITH_TIMEOUT((ran |= glide->running(), !panel_->busy() && panel_->explanation() && window_->idle()), 60000);
    QVERIFY(!ran);
    const Eigen::Vector3d far = eye();
    QVERIFY((near - far).norm() > 0.1);
    setAnimationsWanted(true);
    goTo("tangent-plane");
    QTRY_VERIFY(glide->running());
    QVERIFY((eye() - near).norm() > 1e-6);
    QTRY_VERIFY(!glide->running());
    QCOMPARE((eye() - near).norm(), 0.0);
    goTo("light");
    QTRY_VERIFY(glide->running());
    QTest::qWait(CameraGlide::kMs / 4);
    QWidget* widget = scene->views().widget();
    QTest::mouseClick(widget, Qt::MiddleButton, {}, widget->rect().center());
    QVERIFY(!glide->running());
    const Eigen::Vector3d taken = eye();
    QTest::qWait(CameraGlide::kMs);
    setAnimationsWanted(false);
    QCOMPARE((eye() - taken).norm(), 0.0);
    QVERIFY((taken - far).norm() > 1e-6);
  }

  void whatIsWrongStandsBeforeTheNumbers() {
    select(window_->document().frameCount() - 1, "primal");
    goTo("virtual-camera");
    settle();
    const QString shown = shownText();
    QVERIFY(shown.contains("the model fails") && shown.contains("centre of the virtual camera"));
    QVERIFY2(shown.indexOf("the model fails") < shown.indexOf("centre of the virtual camera"), qPrintable(shown));
  }

  void theWordsAreThoseOfTheSelectedModel() {
    const int frame = 1;  // where every model predicts
    const auto said = [&](const char* model, const char* step) {
      select(frame, model);
      goTo(step);
      settle();
      return shownText();
    };
    QVERIFY(said("canonical", "ellipsoid").contains("P_v,i Q*"));
    QVERIFY(said("primal", "ellipsoid").contains("P_i Q* P_iᵀ") && !shownText().contains("P_v"));
    QVERIFY(said("primal", "projection").contains("C* ~ P Q* Pᵀ") && !shownText().contains("the camera mirrored"));
    QVERIFY(said("dual", "projection").contains("P_v Q* P_vᵀ"));
    for (const char* model : {"primal", "dual"}) {
      const QString shown = said(model, "inverse-walk");
      QVERIFY2(shown.contains("outline") && !shown.contains("level set") && !shown.contains("Play it"), qPrintable(shown));
      QVERIFY(!panel_->findChild<WalkView*>()->isVisibleTo(panel_));
    }
    QVERIFY(said("limit-angle", "inverse-walk").contains("level set"));
    QVERIFY(!panel_->findChild<WalkView*>()->isVisibleTo(panel_));
    QVERIFY(said("canonical", "inverse-walk").contains("Play it"));
    QTRY_VERIFY(panel_->findChild<WalkView*>()->isVisibleTo(panel_));
  }

  /// On a bulging mirror it is several times as large as the highlight, and would not be in sight where that fills half the view.
  void theFrameViewHoldsTheCanonicalEllipse() {
    MainWindow window(knownEngine());
    window.show();
    window.open(QStringLiteral(GLINT_SOURCE_DIR "/sessions/lessons/sphere/sphere.glint"));
    Document& document = window.document();
    QTRY_VERIFY_WITH_TIMEOUT(document.scene() && window.idle() && document.inspection() && !document.stale(), 120000);
    double most = 0;
    for (int frame = 0; frame < document.frameCount(); ++frame) {
      const draw::FrameOverlay overlay = draw::frameOverlay(*document.inspection(), frame, window.framePanel()->overlayOptions());
      const std::vector<Highlight>& highlights = document.inspection()->evidence[std::size_t(frame)].highlights;
      if (highlights.empty()) continue;
      Eigen::AlignedBox2d ellipse, contour;
      for (const Pixel& p : highlights[0].contour.points) contour.extend(p);
      for (const draw::OverlayLine& line : overlay.lines)
        if (line.role == draw::OverlayRole::CanonicalEllipse)
          for (const Pixel& p : line.points) ellipse.extend(p);
      if (ellipse.isEmpty()) continue;
      most = std::max(most, (ellipse.sizes().array() / contour.sizes().array()).maxCoeff());
      document.selectFrame(frame);
      window.actions().find("explain.step-contour")->trigger();
      window.actions().find("explain.step-canonical-ellipse")->trigger();
      auto* panel = window.findChild<ExplainPanel*>();
      QTRY_VERIFY_WITH_TIMEOUT(!panel->busy() && panel->explanation() && panel->explanation()->frame == frame && window.idle(),
                               60000);
      const FrameCanvas* canvas = window.framePanel()->canvas();
      for (const Pixel& corner : {ellipse.min(), ellipse.max()}) {
        const Eigen::Vector2d off = canvas->zoom() * (corner - canvas->centre());
        QVERIFY2(std::abs(off.x()) < canvas->width() / 2.0 && std::abs(off.y()) < canvas->height() / 2.0,
                 qPrintable(QStringLiteral("frame %1").arg(frame)));
      }
    }
    QVERIFY2(most > 2, qPrintable(QString::number(most)));
  }

  void whereNothingIsSelectedAllPanelsAreAboutOneModel() {
    select(0, "");
    goTo("peak");
    settle();
    QCOMPARE(window_->findChild<QComboBox*>("plottedModel")->currentText(), toQString(panel_->explanation()->model));
  }

  void inALowWindowTheTextHasRoom() {
    const QSize before = window_->size();
    window_->applyLayout(QStringLiteral("explain"));
    window_->resize(1000, 680);
    select(0, "canonical");
    goTo("light");
    settle();
    auto* browser = panel_->findChild<QTextBrowser*>("explain.text");
    const int lines = browser->viewport()->height() / QFontMetrics(browser->font()).lineSpacing();
    goTo("limit-angles");  // with the walk above it
    settle();
    QTest::qWait(50);
    const int beside = browser->viewport()->height() / QFontMetrics(browser->font()).lineSpacing();
    window_->resize(before);
    QVERIFY2(lines >= 8 && beside >= 5, qPrintable(QStringLiteral("%1, %2").arg(lines).arg(beside)));
  }

  void whatIsRoundingIsNoNumber() {
    const auto text = [](std::vector<double> values, const char* unit, double least) {
      return valuesHtml({"", "", std::move(values), unit, least}).replace(QStringLiteral("&nbsp;"), QStringLiteral(" "));
    };
    QCOMPARE(text({1e-7}, "m", 1e-6), QStringLiteral("0 within rounding"));
    QCOMPARE(text({-3e-9, 2e-8}, "px", 1e-3), QStringLiteral("0 within rounding"));
    QCOMPARE(text({0}, "px", 1e-3), QStringLiteral("0 px"));
    QCOMPARE(text({0.000123456}, "m", 2e-6), QStringLiteral("0.123 mm"));
    QCOMPARE(text({1.23456789}, "m", 2e-6), QStringLiteral("1.2346 m"));
    QCOMPARE(text({1.5, 1e-8, -2}, "m", 1e-6), QStringLiteral("1.5   0   -2 m"));
    QCOMPARE(text({0.0123456}, "px", 1e-3), QStringLiteral("0.012 px"));
    QCOMPARE(text({1e-7}, "", 0), QStringLiteral("1e-07"));  // a ratio of singular values is no rounding
  }

  /// Whatever is on screen, starting makes room for the text and the 3D view; leaving gives back what was there.
  void startingMakesRoomAndLeavingGivesItBack() {
    window_->resize(1600, 1000);
    window_->applyLayout(QStringLiteral("debug"));
    QTest::qWait(50);
    const auto shown = [&] {
      QStringList names;
      for (const QDockWidget* dock : window_->findChildren<QDockWidget*>())
        if (!dock->isHidden()) names << dock->objectName();
      names.sort();
      return names;
    };
    const QStringList before = shown();
    auto* scene = window_->findChild<ScenePanel*>();
    auto* front = window_->findChild<QDockWidget*>("history");
    front->show();
    front->raise();
    const auto layers = window_->document().state().layers;
    const auto eye = [&] { return scene->view().viewPoint().position; };
    scene->frameAll();
    viz::ViewPoint own = scene->view().viewPoint();
    own.position *= 1.1;
    scene->view().setViewPoint(own);
    const int width = scene->width();
    QVERIFY(before.contains("plots"));
    window_->actions().find("explain.start")->trigger();
    settle();
    QTRY_VERIFY(!shown().contains("plots") && shown().contains("explain"));
    QTRY_VERIFY(scene->width() > width);
    auto* browser = panel_->findChild<QTextBrowser*>("explain.text");
    QTRY_VERIFY(browser->viewport()->height() / QFontMetrics(browser->font()).lineSpacing() >= 14);
    panel_->findChild<QToolButton*>("explain.leave")->click();
    QTRY_COMPARE(shown(), before);
    QTRY_VERIFY(std::abs(scene->width() - width) <= 2);
    QTRY_VERIFY(!front->visibleRegion().isEmpty());  // before its tabs again
    QVERIFY(window_->document().state().layers == layers);
    QVERIFY2((eye() - own.position).norm() < 1e-9, "looked at from where it was");
    // Undo leaves as well; what is chosen meanwhile stays.
    window_->actions().find("explain.start")->trigger();
    window_->document().undoStack()->undo();
    QTRY_COMPARE(shown(), before);
    window_->actions().find("explain.start")->trigger();
    window_->applyLayout(QStringLiteral("compare"));
    const QStringList chosen = shown();
    panel_->leave();
    QCOMPARE(shown(), chosen);
    window_->applyLayout(QStringLiteral("explain"));
  }

  /// In a panel as narrow as large print makes it (a screen of 1600 px at 200 %), nothing ends beyond its edge.
  void inANarrowPanelEveryButtonIsWhole() {
    constexpr int kNarrow = 800 * 32 / 100 - 20;  // px of the dock without a scroll bar
    goTo("limit-angles");                         // with the walk
    settle();
    QTRY_VERIFY(panel_->findChild<WalkView*>()->isVisibleTo(panel_));
    QVERIFY2(panel_->minimumSizeHint().width() <= kNarrow, qPrintable(QString::number(panel_->minimumSizeHint().width())));
    ExplainPanel narrow(window_->document());
    narrow.resize(narrow.minimumSizeHint().expandedTo({220, 500}));
    narrow.show();
    QVERIFY(QTest::qWaitForWindowExposed(&narrow));
    for (const char* name : {"explain.back", "explain.next", "explain.leave"}) {
      auto* button = narrow.findChild<QToolButton*>(name);
      QVERIFY2(narrow.rect().contains(button->geometry()), name);
      QVERIFY2(button->width() >= button->sizeHint().width(), name);
    }
  }

  /// The observed and the predicted contour, in a frame that did not train.
  void aHeldOutFrameSaysWhatIsObserved() {
    Document& d = window_->document();
    for (const int frame : {0, d.frameCount() - 1}) {
      select(frame, "canonical");
      for (const char* step : {"limit-angles", "canonical-ellipse"}) {
        goTo(step);
        settle();
        QCOMPARE(shownText().contains("Observed here"), !d.inspection()->isTraining(frame));
        QVERIFY(!shownText().contains("does not reach this step"));
      }
    }
  }

  /// The camera of a training frame is not a new one.
  void aProjectionSaysWhetherTheCameraIsNew() {
    Document& d = window_->document();
    bool both[2] = {false, false};
    for (const int frame : {0, d.frameCount() - 1}) {
      select(frame, "canonical");
      goTo("projection");
      settle();
      const bool trains = d.inspection()->isTraining(frame);
      both[trains] = true;
      QVERIFY2(!shownText().contains("a new camera"), qPrintable(shownText()));
      QVERIFY2(shownText().contains(trains ? "not new to the model" : "is new to the model"), qPrintable(shownText()));
    }
    QVERIFY(both[0] && both[1]);
  }

  /// A symbol and its arrow light up together, whichever is pointed at; so does a number's symbol.
  void aSymbolAndItsArrowLightUpTogether() {
    select(0, "canonical");
    goTo("tangent-plane");
    settle();
    EquationBrowser& page = panel_->text();
    auto* links = window_->findChild<SymbolLinks*>();
    QTRY_VERIFY(page.hasEquations());
    page.verticalScrollBar()->setValue(0);
    const QRectF place = page.placeOf("normal");
    page.verticalScrollBar()->setValue(int(place.top()) - 20);
    QTest::mouseMove(page.viewport(), QPoint(2, 2));
    QTest::mouseMove(page.viewport(), page.placeOf("normal").center().toPoint());
    QTRY_COMPARE(page.lit(), QSet<QString>{"normal"});
    auto* scene = window_->findChild<ScenePanel*>();
    scene->renderNow();
    QVERIFY(links->lit().litCount() > 0);
    QTest::mouseMove(page.viewport(), QPoint(2, 2));
    QTRY_VERIFY(page.lit().isEmpty());
    QCOMPARE(links->lit().litCount(), 0);
    emit page.highlighted(QUrl("symbol:brightest-point"));
    QCOMPARE(page.lit(), QSet<QString>{"brightest-point"});
    emit page.highlighted(QUrl());
    QVERIFY(page.lit().isEmpty());
    // The arrow N goes up from the middle of the view.
    bool found = false;
    QWidget* canvas = scene->views().widget();
    for (int y = 10; y < canvas->height() && !found; y += 6)
      for (int x = 10; x < canvas->width() && !found; x += 6) {
        links->pointAt(QPoint(x, y));
        found = page.lit().contains("normal");
      }
    QVERIFY(found);
    scene->renderNow();
    QVERIFY(links->lit().litCount() > 0);
    links->pointAt(QPoint(1, 1));
    QVERIFY(page.lit().isEmpty());
  }

  void aClickInTheListGoesThere() {
    auto* list = panel_->findChild<QListWidget*>("explain.steps");
    window_->actions().find("explain.step-peak")->trigger();
    QTest::mouseClick(list->viewport(), Qt::LeftButton, {}, list->visualItemRect(list->item(7)).center());
    QCOMPARE(panel_->step(), 7);
  }

 private:
  void select(int frame, const char* model) {
    draw::Selection s;
    s.frame = frame;
    s.model = model;
    window_->document().select(s);
  }
  void settle() {
    QTRY_VERIFY_WITH_TIMEOUT(!panel_->busy() && panel_->explanation() && window_->idle() && !window_->document().stale(), 60000);
    QCOMPARE(panel_->explanation()->frame, window_->document().selection().frame);
  }
  QString shownText() const { return panel_->findChild<QTextBrowser*>("explain.text")->toPlainText(); }
  void goTo(const char* step) { window_->actions().find(QStringLiteral("explain.step-") + QLatin1String(step))->trigger(); }
  std::unique_ptr<MainWindow> window_;
  ExplainPanel* panel_ = nullptr;
};

QObject* makeExplainTest() { return new ExplainTest; }

}  // namespace glint::gui

#include "explain_test.moc"
