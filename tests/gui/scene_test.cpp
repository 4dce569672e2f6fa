// SPDX-License-Identifier: BSD-3-Clause
// The 3D views with real clicks and keys: what is set is an option of the document, one step of undo, and seen in the views.
#include <vtkRenderer.h>

#include <QAction>
#include <QCheckBox>
#include <QImage>
#include <QLabel>
#include <QMenu>
#include <QSignalSpy>
#include <QSlider>
#include <QToolBar>
#include <QToolButton>
#include <QWheelEvent>
#include <cmath>

#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "gui/scene/layer_list.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "tests/gui/scene_fixture.h"

namespace glint::gui {

class SceneTest : public QObject, SceneFixture {
  Q_OBJECT
 private slots:
  void init() { begin(); }
  void cleanup() { end(); }

  void aViewMayHaveLayersOfItsOwn() {
    LayerPanel layers(*document_);
    connect(panel_.get(), &ScenePanel::activeViewChanged, &layers, &LayerPanel::setActiveView);
    layers.show();
    auto* own = layers.findChild<QCheckBox*>(QStringLiteral("ownLayers"));
    auto* list = layers.findChild<LayerList*>();
    const auto tick = [&](const char* name, bool on) {
      for (int i = 0; i < list->count(); ++i)
        if (list->item(i)->data(Qt::UserRole).toString() == QLatin1String(name))
          list->item(i)->setCheckState(on ? Qt::Checked : Qt::Unchecked);
    };
    const auto shown = [&](int view, const char* name) { return views().view(view).layerVisible(name); };
    QVERIFY(own->isHidden());  // one view has the layers of all
    panel_->setArrangement(Arrangement::SideBySide);
    QVERIFY(!own->isHidden());
    QTest::mouseClick(views().widget(), Qt::LeftButton, {}, {700, 300});
    QCOMPARE(views().activeView(), 1);
    QVERIFY(own->text().contains("View B") && !own->isChecked());
    const int before = document_->undoStack()->count();
    own->click();
    tick("surface", false);
    tick("rays", true);
    QCOMPARE(document_->undoStack()->count(), before + 3);
    QVERIFY(!shown(1, "surface") && shown(1, "rays"));
    QVERIFY(shown(0, "surface") && !shown(0, "rays") && document_->layerVisible("surface"));
    QTest::mouseClick(views().widget(), Qt::LeftButton, {}, {100, 300});
    QVERIFY(own->text().contains("View A") && !own->isChecked());
    tick("cameras", false);  // of all, but not of B
    QVERIFY(!shown(0, "cameras") && shown(1, "cameras"));
    panel_->setArrangement(Arrangement::One);
    QVERIFY(shown(0, "surface"));
    panel_->setArrangement(Arrangement::SideBySide);
    QVERIFY(!shown(1, "surface"));
    while (document_->undoStack()->count() > before && document_->undoStack()->index() > before) document_->undoStack()->undo();
    QVERIFY(shown(1, "surface") && !shown(1, "rays") && shown(0, "cameras"));
    // The checklist says what the active view shows, also after undo; a view may have no layers at all, and its own layers can be
    // given up again.
    const auto ticked = [&](const char* name) {
      for (int i = 0; i < list->count(); ++i)
        if (list->item(i)->data(Qt::UserRole).toString() == QLatin1String(name))
          return list->item(i)->checkState() == Qt::Checked;
      return false;
    };
    QVERIFY(ticked("surface") && ticked("cameras"));
    own->click();
    tick("surface", false);
    QVERIFY(!ticked("surface") && own->isChecked());
    document_->undoStack()->undo();
    QVERIFY(ticked("surface"));
    for (const viz::Layer& layer : viz::sceneLayers()) tick(layer.name.c_str(), false);
    QVERIFY(own->isChecked() && !shown(0, "surface") && !shown(0, "light") && shown(1, "surface"));
    panel_->setArrangement(Arrangement::One);
    QVERIFY(shown(0, "surface"));  // one view has the layers of all
    panel_->setArrangement(Arrangement::SideBySide);
    QVERIFY(!shown(0, "surface"));
    own->click();
    QVERIFY(!own->isChecked() && shown(0, "surface") && ticked("surface"));
  }

  void lookingThroughACameraHasABadgeAndThreeWaysBack() {
    const viz::ViewPoint outside = panel_->view().viewPoint();
    auto* bar = panel_->findChild<QWidget*>(QStringLiteral("eyeBar"));
    QVERIFY(bar->isHidden());
    document_->selectFrame(7);
    for (int way = 0; way < 3; ++way) {
      trigger("view.look-through");
      QVERIFY(panel_->view().looksThrough());
      QVERIFY(bar->isVisible());
      QCOMPARE(panel_->findChild<QWidget*>(QStringLiteral("eyeBar"))->toolTip(), QStringLiteral("through camera 0007"));
      QVERIFY(actions_->find("view.look-through")->isChecked());
      if (way == 0) {
        views().widget()->setFocus();
        QTest::keyClick(views().widget(), Qt::Key_Escape);
      } else if (way == 1) {
        QTest::mouseClick(panel_->findChild<QToolButton*>(QStringLiteral("leaveEye")), Qt::LeftButton);
      } else {
        trigger("view.look-through");
      }
      QVERIFY(!panel_->view().looksThrough());
      QVERIFY(bar->isHidden());
      QVERIFY((panel_->view().viewPoint().position - outside.position).norm() < 1e-9);
    }
    document_->undoStack()->undo();
    QVERIFY(panel_->view().looksThrough());
    document_->selectFrame(3);  // it follows the frames
    QCOMPARE(panel_->findChild<QWidget*>(QStringLiteral("eyeBar"))->toolTip(), QStringLiteral("through camera 0003"));
  }

  void whatTheBarHasNoRoomForIsBehindItsArrow() {
    panel_->resize(panel_->minimumSizeHint().width(), 400);
    settle();
    auto* bar = panel_->findChild<QToolBar*>(QStringLiteral("sceneBar"));
    auto* arrow = bar->findChild<QToolButton*>(QStringLiteral("qt_toolbar_ext_button"));
    QVERIFY(arrow && arrow->isVisible() && arrow->menu());
    auto* slider = arrow->menu()->findChild<QSlider*>(QStringLiteral("glyphScale"));
    QVERIFY(slider);
    slider->setValue(20);
    QCOMPARE(document_->option("scene/glyph-scale", 1.0), 10.0);
    QCOMPARE(bar->findChild<QSlider*>(QStringLiteral("glyphScale"), Qt::FindDirectChildrenOnly)->value(), 20);
    document_->undoStack()->undo();
    QCOMPARE(slider->value(), 0);
    panel_->resize(900, 400);
    settle();
    QVERIFY(!arrow->isVisible());
  }

  /// The photograph of the fixture is one colour per frame: red 10 + 5 i.
  void thePhotographIsDrawnOverTheSceneWithItsOpacity() {
    for (const viz::Layer& layer : viz::sceneLayers()) document_->setLayerVisible(layer.name, layer.title, false);
    document_->selectFrame(9);
    trigger("view.look-through");
    document_->setOption("scene/photograph-opacity", 1.0, "opacity");
    QTRY_VERIFY(!views().busy());
    settle();
    const QPoint middle(views().widget()->width() / 2, views().widget()->height() / 2);
    QCOMPARE(qRed(picture().pixel(middle)), 55);
    auto* slider = panel_->findChild<QSlider*>(QStringLiteral("photographOpacity"));
    QCOMPARE(slider->value(), 100);
    const int steps = document_->undoStack()->count();
    emit slider->sliderPressed();  // a drag
    slider->setValue(70);
    slider->setValue(30);
    slider->setValue(0);
    emit slider->sliderReleased();
    QCOMPARE(document_->undoStack()->count(), steps + 1);
    settle();
    QVERIFY(qRed(picture().pixel(middle)) < 40);  // the background
    document_->undoStack()->undo();
    QCOMPARE(slider->value(), 100);
  }

  void theWheelEnlargesAtThePointerAndADragMoves() {
    trigger("view.look-through");
    settle();
    const Eigen::Vector2d before = *panel_->view().displayOf(80, 60);
    const double ratio = views().widget()->devicePixelRatioF();
    const QPointF at(before.x() / ratio, views().widget()->height() - before.y() / ratio);
    QWheelEvent wheel(at, views().widget()->mapToGlobal(at.toPoint()), {}, {0, 240}, Qt::NoButton, Qt::NoModifier,
                      Qt::NoScrollPhase, false);
    QCoreApplication::sendEvent(views().widget(), &wheel);
    settle();
    QVERIFY((*panel_->view().displayOf(80, 60) - before).norm() < 1e-6);
    const double grown = (*panel_->view().displayOf(90, 60) - before).norm();
    drag(views().widget(), {QPoint(300, 300), QPoint(320, 290), QPoint(340, 280)});
    settle();
    const Eigen::Vector2d moved = *panel_->view().displayOf(80, 60) - before;
    QVERIFY(std::abs(moved.x() - 40 * ratio) < 1e-6 && std::abs(moved.y() - 20 * ratio) < 1e-6);
    QVERIFY(grown > 1);
    QVERIFY(panel_->view().looksThrough());
  }

  void axisViewsKeepTheirDirectionsAndParallelIsAnOption() {
    trigger("view.axis-top");
    settle();
    const viz::ViewPoint top = panel_->view().viewPoint();
    trigger("view.axis-bottom");
    const viz::ViewPoint bottom = panel_->view().viewPoint();
    const Eigen::Vector3d a = (top.position - top.focalPoint).normalized(),
                          b = (bottom.position - bottom.focalPoint).normalized();
    QVERIFY((a + b).norm() < 1e-9);
    QVERIFY(std::abs(a.cwiseAbs().maxCoeff() - 1) < 1e-9);  // along an axis
    trigger("view.parallel");
    QVERIFY(panel_->view().parallel());
    QCOMPARE(document_->option("scene/parallel", std::string()), std::string("1"));
    document_->undoStack()->undo();
    QVERIFY(!panel_->view().parallel());
  }

  void keptViewsComeBack() {
    trigger("view.axis-left");
    trigger("view.parallel");
    const viz::ViewPoint kept = panel_->view().viewPoint();
    trigger("view.save-view");
    QCOMPARE(panel_->savedViews(), QStringList{"View 1"});
    trigger("view.parallel");
    trigger("view.axis-top");
    trigger("view.save-view");
    QCOMPARE(panel_->savedViews(), (QStringList{"View 1", "View 2"}));
    panel_->goToView("View 1");
    QVERIFY((panel_->view().viewPoint().position - kept.position).norm() < 1e-9);
    QVERIFY(panel_->view().parallel());
    trigger("view.next-view");
    QVERIFY((panel_->view().viewPoint().position - kept.position).norm() > 0.1);
    panel_->removeView("View 1");
    QCOMPARE(panel_->savedViews(), QStringList{"View 2"});
    document_->undoStack()->undo();
    QCOMPARE(panel_->savedViews().size(), 2);
    QVERIFY(!viewPointFromText("1 2 3"));
    QVERIFY(!viewPointFromText("1 2 3 4 5 6 7 8 nan 30 parallel"));
  }

  void linkedViewsMoveTogetherAndUnlinkedOnesDoNot() {
    trigger("view.views-4");
    QCOMPARE(views().viewCount(), 4);
    settle();
    trigger("view.axis-right");
    settle();
    for (int i = 1; i < 4; ++i)
      QVERIFY((views().view(i).viewPoint().position - views().view(0).viewPoint().position).norm() < 1e-9);
    trigger("view.link-views");
    QTest::mouseClick(views().widget(), Qt::LeftButton, {},
                      {views().widget()->width() * 3 / 4, views().widget()->height() * 3 / 4});
    QCOMPARE(views().activeView(), 3);
    trigger("view.axis-top");
    settle();
    QVERIFY((views().view(3).viewPoint().position - views().view(0).viewPoint().position).norm() > 0.1);
    trigger("view.look-through");  // of the active view only
    QVERIFY(views().view(3).looksThrough());
    QVERIFY(!views().view(0).looksThrough());
    trigger("view.next-models");
    QVERIFY(!sceneOptions(*document_).views[3].models.empty());
    QVERIFY(sceneOptions(*document_).views[0].models.empty());
    trigger("view.views-1");
    QCOMPARE(views().viewCount(), 1);
    QCOMPARE(views().activeView(), 0);
  }

  void undoBringsUnlinkedViewsBackToTheirOwnCameras() {
    trigger("view.views-4");
    settle();
    trigger("view.link-views");
    const int unlinked = document_->undoStack()->index();
    const std::vector<viz::ViewPoint> own = lookFourWays();
    document_->selectFrame(2);  // a step that arranges nothing lies between
    trigger("view.link-views");
    trigger("view.axis-back");
    settle();
    QVERIFY(samePlaces(placesNow(), std::vector(4, views().view(0).viewPoint())));
    document_->undoStack()->undo();
    settle();
    QVERIFY(samePlaces(placesNow(), own));
    document_->undoStack()->redo();
    settle();
    const viz::ViewPoint linked = views().view(0).viewPoint();
    QVERIFY(samePlaces(placesNow(), std::vector(4, linked)));
    document_->undoStack()->undo();
    settle();
    for (const char* other : {"view.views-1", "view.views-2", "view.views-wipe"}) {
      trigger(other);
      settle();
      trigger("view.axis-back");
      settle();
      document_->undoStack()->undo();
      settle();
      QCOMPARE(views().viewCount(), 4);
      QVERIFY2(samePlaces(placesNow(), own), other);
    }
    // A click in the history far away, and back.
    trigger("view.views-1");
    settle();
    const int last = document_->undoStack()->index();
    document_->undoStack()->setIndex(0);
    settle();
    QCOMPARE(views().viewCount(), 1);
    document_->undoStack()->setIndex(last);
    settle();
    document_->undoStack()->setIndex(unlinked);
    settle();
    QVERIFY(samePlaces(placesNow(), own));
  }

  void aNewStepArrangesTheViewsAnew() {
    trigger("view.views-4");
    settle();
    trigger("view.link-views");
    lookFourWays();
    document_->undoStack()->undo();
    settle();
    document_->selectFrame(2);  // the step that unlinked is gone from the history
    trigger("view.axis-back");
    settle();
    const viz::ViewPoint linked = views().view(0).viewPoint();
    trigger("view.link-views");
    settle();
    QVERIFY(samePlaces(placesNow(), std::vector(4, linked)));
  }

  /// One view can be large for a moment.
  void unlinkedViewsComeBackWhereTheyStood() {
    trigger("view.views-4");
    settle();
    trigger("view.link-views");
    std::vector<viz::ViewPoint> own = lookFourWays();
    trigger("view.views-1");
    settle();
    trigger("view.axis-back");
    own[0] = views().view(0).viewPoint();
    trigger("view.views-4");
    settle();
    QVERIFY(samePlaces(placesNow(), own));
  }

  void camerasAndSurfaceAreShownBeforeThereAreResults() {
    const int surfaces = views().view().buildCount("surface");
    document_->open(spread());
    QVERIFY(!document_->inspection());
    settle();
    QTest::mouseClick(views().widget(), Qt::LeftButton, {}, onScreen(document_->scene()->frames[3].camera.centreInWorld()));
    QCOMPARE(document_->selection().frame, 3);
    QVERIFY(views().view().buildCount("surface") > surfaces);
    // Results of the selected frame come first; a view that a person has moved by then stays.
    trigger("view.axis-top");
    const viz::ViewPoint moved = views().view().viewPoint();
    setResults(true);
    QCOMPARE(toText(views().view().viewPoint()), toText(moved));
    setResults(false);
    QCOMPARE(toText(views().view().viewPoint()), toText(moved));
    // A view that was not moved shows all of them.
    document_->open(spread());
    settle();
    document_->setOption("scene/views", std::string("1"), "as it is");
    setResults(false);
    const viz::ViewPoint shown = views().view().viewPoint();
    trigger("view.frame-all");
    QVERIFY(samePlaces({shown}, {views().view().viewPoint()}));
  }

  void aPictureThatIsBehindTheSelectionIsMarked() {
    const auto* badge = panel_->findChild<StaleBadge*>();
    QVERIFY(badge && badge->isHidden() && !views().behind());
    QSignalSpy changes(&views(), &SceneViews::behindChanged);
    views().widget()->hide();  // nothing is drawn
    document_->selectFrame(3);
    QVERIFY(views().behind());
    QTRY_VERIFY(!badge->isHidden());
    views().widget()->show();
    views().scheduleRender();
    QTRY_VERIFY(badge->isHidden() && !views().behind());
    QCOMPARE(changes.count(), 2);
    document_->selectFrame(4);
    views().renderNow();  // as for a picture of the window
    QVERIFY(!views().behind() && badge->isHidden());
  }

  void theWipesLineIsDragged() {
    trigger("view.views-wipe");
    settle();
    const SceneOptions options = sceneOptions(*document_);
    QVERIFY(options.views[0].models != options.views[1].models);
    const int width = views().widget()->width(), steps = document_->undoStack()->count();
    drag(views().widget(), {QPoint(width / 2, 200), QPoint(width / 2 - 50, 210), QPoint(width / 4, 220)});
    QVERIFY(std::abs(sceneOptions(*document_).wipe - 0.25) < 0.01);
    QCOMPARE(document_->undoStack()->count(), steps + 1);
    QVERIFY(std::abs(views().view(1).renderer()->GetViewport()[0] - 0.25) < 0.01);
    document_->undoStack()->undo();
    QCOMPARE(sceneOptions(*document_).wipe, 0.5);
  }

  void glyphSizeColoursAndSoloAreStepsOfUndo() {
    auto* slider = panel_->findChild<QSlider*>(QStringLiteral("glyphScale"));
    settle();
    const QImage first = picture();
    emit slider->sliderPressed();
    for (int i = 1; i <= 12; ++i) slider->setValue(i);
    emit slider->sliderReleased();
    QCOMPARE(document_->undoStack()->count(), 1);
    settle();
    QVERIFY(differingPixels(picture(), first) > 50);
    document_->undoStack()->undo();
    settle();
    QCOMPARE(slider->value(), 0);
    QCOMPARE(differingPixels(picture(), first), 0);
    trigger("view.colour-error");
    settle();
    QVERIFY(differingPixels(picture(), first) > 50);
    QVERIFY(actions_->find("view.colour-error")->isChecked() && !actions_->find("view.colour-role")->isChecked());
    trigger("view.colour-error");  // one of the three stays on
    QVERIFY(actions_->find("view.colour-error")->isChecked());
    document_->undoStack()->undo();
    settle();
    QCOMPARE(differingPixels(picture(), first), 0);
    trigger("view.solo");
    settle();
    QVERIFY(differingPixels(picture(), first) > 50);
    document_->undoStack()->undo();
    settle();
    QCOMPARE(differingPixels(picture(), first), 0);
  }

  /// A session is opened again, as from a picture, with cameras coloured by an earlier measurement.
  void influenceIsMeasuredAgainWhenAViewThatShowsItIsReopened() {
    QSignalSpy asked(panel_.get(), &ScenePanel::influenceRequested);
    Opened opened = spread();
    opened.options["scene/colour-by"] = "influence";
    document_->open(opened);
    QCOMPARE(asked.count(), 0);  // nothing to measure yet
    const auto result = [&] {
      auto inspection = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request()));
      inspection->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
      document_->setInspection(inspection, document_->request());
    };
    result();
    QCOMPARE(asked.count(), 1);
    result();  // once; after that the user asks
    QCOMPARE(asked.count(), 1);
    document_->open(opened);
    document_->setSetting("detect.level", 0.4);
    auto early = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), InspectionRequest()));
    early->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
    document_->setInspection(early, InspectionRequest());
    QCOMPARE(asked.count(), 1);  // of an earlier request: what it measures would be out of date, too
    result();
    QCOMPARE(asked.count(), 2);
    opened.options["scene/colour-by"] = "error";
    document_->open(opened);
    result();
    QCOMPARE(asked.count(), 2);  // not what this view shows
  }

  void camerasAreColouredByWhatLeavingThemOutDoes() {
    for (const viz::Layer& layer : viz::sceneLayers())
      document_->setLayerVisible(layer.name, layer.title, layer.name == "cameras");
    QSignalSpy asked(panel_.get(), &ScenePanel::influenceRequested);
    trigger("view.colour-influence");
    QCOMPARE(asked.count(), 1);
    settle();
    const QImage unknown = picture();
    auto influence = std::make_shared<Influence>();
    for (int frame = 0; frame < 6; ++frame) {
      FrameInfluence f;
      f.frame = frame;
      f.models[document_->plottedModel()].changePct = frame == 2 ? -3.0 : 1.0;
      influence->frames.push_back(f);
    }
    influence->probes = {7};
    document_->setInfluence(influence, document_->request());
    settle();
    QVERIFY(picture() != unknown);
    const SceneOptions options = sceneOptions(*document_);
    QCOMPARE(options.colours.influence.size(), std::size_t(6));
    QCOMPARE(options.colours.influence.at(2), -3.0);
    trigger("view.colour-influence");  // measured: nothing to ask for
    QCOMPARE(asked.count(), 1);
    const QImage measured = picture();
    document_->setSetting("detect.level", 0.4);
    settle();
    QVERIFY(sceneOptions(*document_).colours.influence.empty());  // of another request: it says nothing here
    QVERIFY(picture() != measured);
    trigger("view.colour-influence");
    QCOMPARE(asked.count(), 2);
    document_->undoStack()->undo();
    settle();
    QCOMPARE(sceneOptions(*document_).colours.influence.size(), std::size_t(6));
  }

  void theLampIsDraggedWhereContoursAreSynthesised() {
    auto scene = std::make_shared<Scene>(*document_->scene());
    TrueLight lamp;
    lamp.id = "lamp";
    lamp.lamp = lampAt(Eigen::Vector3d(0.3, -0.6, -0.8));
    scene->lights = {lamp};
    Opened opened = fixture_.opened();
    opened.scene = scene;
    document_->open(opened);
    const auto show = [&] {
      auto inspection = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request()));
      inspection->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
      document_->setInspection(inspection, document_->request());
      settle();
    };
    for (const viz::Layer& layer : viz::sceneLayers())
      document_->setLayerVisible(layer.name, layer.title, layer.name == "true-light");
    show();
    const QPoint at = onScreen(lamp.lamp.position()), to = at + QPoint(-60, 35);
    drag(views().widget(), {at, at + QPoint(-20, 10), to});  // not synthesised: the view turns
    QVERIFY(document_->request().whatIf.none());
    WhatIf w;
    w.synthesise = true;
    document_->setWhatIf(w, "synthesise");
    panel_->frameAll();
    show();
    const QPoint from = onScreen(lamp.lamp.position()), there = from + QPoint(-60, 35);
    const int steps = document_->undoStack()->count();
    drag(views().widget(), {from, from + QPoint(-20, 10), there});
    QCOMPARE(document_->undoStack()->count(), steps + 1);
    QVERIFY(document_->request().whatIf.lightsBy.count("lamp"));
    const Eigen::Vector3d moved = lamp.lamp.position() + document_->request().whatIf.lightsBy.at("lamp");
    QVERIFY((onScreen(moved) - there).manhattanLength() <= 3);  // where the mouse let it go, within the pixels of both clicks
  }

  void aClickOnAContourSelectsItsDirection() {
    for (const viz::Layer& layer : viz::sceneLayers())
      document_->setLayerVisible(layer.name, layer.title, layer.name == "observed-contours");
    document_->selectFrame(2);
    trigger("view.look-through");
    settle();
    constexpr double kDirection = 0.7;
    const Pixel pixel = Fixture::centre(2) + Fixture::kRadius * Pixel(std::cos(kDirection), std::sin(kDirection));
    const Eigen::Vector2d display = *panel_->view().displayOf(pixel.x(), pixel.y());
    const double ratio = views().widget()->devicePixelRatioF();
    QTest::mouseClick(views().widget(), Qt::LeftButton, {},
                      {int(display.x() / ratio), views().widget()->height() - 1 - int(display.y() / ratio)});
    QCOMPARE(document_->selection().frame, 2);
    QCOMPARE(document_->selection().highlight, 0);
    QCOMPARE(document_->selection().light, std::string("lamp"));
    QVERIFY(document_->selection().direction);
    QVERIFY(std::abs(*document_->selection().direction - kDirection) < 0.06);
  }

  void everyActionCanBeUndoneToTheFirstState() {
    const ViewState first = document_->state();
    for (QAction* action : actions_->all()) {
      action->trigger();
      QCoreApplication::processEvents();
    }
    settle();
    while (document_->undoStack()->canUndo()) document_->undoStack()->undo();
    QVERIFY(document_->state().options == first.options);
    QVERIFY(document_->state().selection == first.selection);
    settle();
  }

 private:
  /// Results as the program gets them. @param first  results of the selected frame alone
  void setResults(bool first) {
    auto inspection = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request()));
    inspection->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
    if (first)
      document_->setFrameInspection(inspection, document_->selection().frame);
    else
      document_->setInspection(inspection, document_->request());
    settle();
  }
  static int differingPixels(const QImage& a, const QImage& b) {
    if (a.size() != b.size()) return a.width() * a.height();
    int n = 0;
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) n += a.pixel(x, y) != b.pixel(x, y);
    return n;
  }
  std::vector<viz::ViewPoint> placesNow() {
    std::vector<viz::ViewPoint> places;
    for (int i = 0; i < views().viewCount(); ++i) places.push_back(views().view(i).viewPoint());
    return places;
  }
  static bool samePlaces(const std::vector<viz::ViewPoint>& a, const std::vector<viz::ViewPoint>& b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
             return (p.position - q.position).norm() < 1e-9 && (p.focalPoint - q.focalPoint).norm() < 1e-9;
           });
  }
  /// Every one of four unlinked views gets a camera of its own.
  std::vector<viz::ViewPoint> lookFourWays() {
    const char* const ways[] = {"view.axis-front", "view.axis-left", "view.axis-top", "view.axis-right"};
    const int w = views().widget()->width(), h = views().widget()->height();
    for (int i = 0; i < 4; ++i) {
      QTest::mouseClick(views().widget(), Qt::LeftButton, {}, {w * (i % 2) / 2 + 4, h * (i / 2) / 2 + 4});
      trigger(ways[i]);
    }
    settle();
    return placesNow();
  }
  QImage picture() {
    panel_->renderNow();
    return views().widget()->grab().toImage();
  }
};

QObject* makeSceneTest() { return new SceneTest; }

}  // namespace glint::gui

#include "scene_test.moc"
