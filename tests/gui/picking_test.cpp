// SPDX-License-Identifier: BSD-3-Clause
// Whatever is picked anywhere, with the mouse, is selected in the document and shown by every other view.
#include <vtkRenderer.h>

#include <QTableView>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "gui/frame/frame_canvas.h"
#include "gui/frame/frame_panel.h"
#include "gui/frame/ladder_panel.h"
#include "gui/panels/error_model.h"
#include "gui/panels/error_table.h"
#include "gui/panels/numbers_panel.h"
#include "gui/plots/conditioning_panel.h"
#include "gui/plots/plot_canvas.h"
#include "gui/plots/plots_panel.h"
#include "gui/scene/scene_options.h"
#include "gui/scene/scene_panel.h"
#include "gui/scene/scene_views.h"
#include "gui/timeline/timeline.h"
#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
using Views = std::set<QString>;
/// The views that show what is selected.
const Views kShowFrame{"scene", "frame", "ladder", "timeline", "table", "plots", "numbers"},
    kShowModel{"scene", "frame", "timeline", "table", "plots", "conditioning", "numbers"},
    kShowHighlight{"scene", "frame", "ladder", "numbers"}, kShowDirection{"scene", "frame", "ladder", "plots", "numbers"},
    kShowLight{"scene", "numbers"};
constexpr int kStart = 0;  ///< frame selected before every pick
}  // namespace

class PickingTest : public QObject {
  Q_OBJECT
 private slots:
  void initTestCase() {
    Opened opened = coreEngine().open(GLINT_SOURCE_DIR "/sessions/plane/plane.glint", {});
    opened.request.models = {"primal", "canonical", "limit-angle"};
    opened.selection = {};
    opened.selection.frame = kStart;
    opened.layers.clear();
    opened.options.clear();
    opened.viewPoints.clear();
    opened_ = opened;
    inspection_ = std::make_shared<const Inspection>(inspect(opened.scene, opened.request));
  }
  void init() {
    document_ = std::make_unique<Document>(parseTrainSpec);
    scene_ = std::make_unique<ScenePanel>(*document_);
    frame_ = std::make_unique<FramePanel>(*document_);
    ladder_ = std::make_unique<LadderPanel>(*document_, *frame_->loader());
    timeline_ = std::make_unique<Timeline>(*document_);
    table_ = std::make_unique<ErrorTable>(*document_);
    plots_ = std::make_unique<PlotsPanel>(*document_);
    conditioning_ = std::make_unique<ConditioningPanel>(*document_);
    numbers_ = std::make_unique<NumbersPanel>(*document_);
    document_->open(opened_);
    document_->setInspection(inspection_, opened_.request);
    document_->undoStack()->clear();
    const std::map<QWidget*, QSize> sizes{
        {scene_.get(), {700, 500}}, {frame_.get(), {700, 620}},  {ladder_.get(), {900, 320}},       {timeline_.get(), {900, 160}},
        {table_.get(), {900, 400}}, {plots_.get(), {1000, 360}}, {conditioning_.get(), {600, 300}}, {numbers_.get(), {420, 700}}};
    for (const auto& [widget, size] : sizes) {
      widget->resize(size);
      widget->show();
      QVERIFY(QTest::qWaitForWindowExposed(widget));
    }
    settle();
    frame_->goToHighlight();
    settle();
  }
  void cleanup() {
    numbers_.reset();
    conditioning_.reset();
    plots_.reset();
    table_.reset();
    timeline_.reset();
    ladder_.reset();
    frame_.reset();
    scene_.reset();
  }

  // ---- a frame ----
  void aFrameInTheTimeline() {
    pick("timeline", kShowFrame, [this] { click(timeline_->strip(), timeline_->strip()->cell(3).center()); });
    QCOMPARE(document_->selection().frame, 3);
  }
  void aRowOfTheTable() {
    pick("table", both(kShowFrame, kShowModel), [this] {
      QTableView* view = table_->view();
      const int rows = view->model()->rowCount();
      for (int row = 0; row < rows; ++row) {
        const QModelIndex id = view->model()->index(row, ErrorModel::Frame);
        if (id.data().toString() != QStringLiteral("0004") ||
            id.siblingAtColumn(ErrorModel::Model).data().toString() != QStringLiteral("canonical"))
          continue;
        view->scrollTo(id);
        click(view->viewport(), view->visualRect(id).center());
      }
    });
    QCOMPARE(document_->selection().frame, 4);
    QCOMPARE(document_->selection().model, std::string("canonical"));
  }
  void aSampleOfTheErrors() {
    // The errors of primal and canonical lie on the same pixel here; that of limit-angle lies apart from both.
    draw::Selection other = document_->selection();
    other.model = "canonical";
    document_->select(other);
    pick("plots", both(kShowFrame, kShowModel), [this] { clickSample(0, "error", "limit-angle", 4); });
    QCOMPARE(document_->selection().frame, 4);
    QCOMPARE(document_->selection().model, std::string("limit-angle"));
  }
  void aCameraInTheScene() {
    pick("scene", kShowFrame, [this] {
      onlyLayer("cameras");
      clickWorld(inspection_->scene->frames[2].camera.centreInWorld());
    });
    QCOMPARE(document_->selection().frame, 2);
  }

  // ---- a model ----
  void anEllipsoidInTheScene() {
    const Ellipsoid* ellipsoid = nullptr;
    for (const ModelResult::Fit& fit : inspection_->models.at("canonical").fits)
      if (fit.fit && fit.fit->ellipsoid()) ellipsoid = fit.fit->ellipsoid();
    QVERIFY(ellipsoid);
    pick("scene", kShowModel, [&] {
      onlyLayer("ellipsoids");
      document_->setOption(viewOption("models", 0), std::string("canonical"), "Models");
      clickWorld(ellipsoid->centre());
    });
    QVERIFY(inspection_->models.count(document_->selection().model));
    QCOMPARE(document_->selection().light, inspection_->evidence[0].highlights[0].light);
  }
  void aChipOfTheConditioning() {
    pick("conditioning", kShowModel, [this] {
      Chip* chip = nullptr;
      for (Chip* c : conditioning_->findChildren<Chip*>())
        if (c == conditioning_->chip("canonical", "gap")) chip = c;
      QVERIFY(chip);
      click(chip, chip->rect().center());
    });
    QCOMPARE(document_->selection().model, std::string("canonical"));
  }
  void aTileOfTheLadder() {
    pick("ladder", kShowModel, [this] {
      FrameCanvas* tile = ladder_->canvases().at(1);
      click(tile, QPointF(6, 6));  // away from every contour
    });
    QCOMPARE(document_->selection().model, std::string("canonical"));
    QCOMPARE(document_->selection().highlight, -1);
  }

  // ---- a highlight, a point of a contour ----
  void aHighlightInTheFrame() {
    const Highlight& h = observed();
    pick("frame", kShowHighlight, [&] { click(frame_->canvas(), frame_->canvas()->widgetFromPixel(h.peak)); });
    QCOMPARE(document_->selection().highlight, 0);
    QCOMPARE(document_->selection().light, h.light);
    QVERIFY(!document_->selection().direction);
  }
  void aContourPointInTheFrame() {
    const Pixel vertex = observed().contour.points[observed().contour.points.size() / 3];
    onlyObserved();
    pick("frame", kShowDirection, [&] { click(frame_->canvas(), frame_->canvas()->widgetFromPixel(vertex)); });
    expectDirection(vertex);
    // The angles of ellipse, light and direction are written as elsewhere.
    QVERIFY(numbers_->text().count(QStringLiteral("°")) >= 3);
    QVERIFY2(!numbers_->text().contains(QStringLiteral(" °")), qPrintable(numbers_->text()));
  }
  void aContourPointInTheLadder() {
    const Pixel vertex = observed().contour.points[observed().contour.points.size() / 3];
    pick("ladder", kShowDirection, [&] {
      FrameCanvas* tile = ladder_->canvases().at(1);
      click(tile, tile->widgetFromPixel(vertex));
    });
    expectDirection(vertex);
    QCOMPARE(document_->selection().model, std::string("canonical"));
  }
  void aContourPointInTheScene() {
    const Pixel vertex = observed().contour.points[observed().contour.points.size() / 3];
    onlyLayer("observed-contours");
    document_->setOption(viewOption("look-through", 0), std::string("camera"), "Look through the camera");
    settle();
    pick("scene", kShowDirection, [&] {
      const Eigen::Vector2d display = *scene_->view().displayOf(vertex.x(), vertex.y());
      clickDisplay(display.x(), display.y());
    });
    expectDirection(vertex);
  }
  void aSampleOfTheDial() {
    std::optional<double> wanted;
    pick("plots", kShowDirection, [&] { wanted = clickSample(1, "dial", "canonical", 20); });
    QVERIFY(wanted && document_->selection().direction);
    QVERIFY(std::abs(*document_->selection().direction - *wanted) < 0.2);  // another model's curve may lie over it
    QCOMPARE(document_->selection().highlight, 0);
  }
  void aSampleOfTheLimitAngles() {
    document_->setOption("plots/second", "limit-angle", "Plot");
    settle();
    std::optional<double> wanted;
    pick("plots", kShowDirection, [&] { wanted = clickSample(1, "limit-angle", "observed contour", 20); });
    QVERIFY(wanted && document_->selection().direction);
    QVERIFY(std::abs(*document_->selection().direction - *wanted) < 0.1);
  }

  // ---- a light ----
  void aLightInTheScene() {
    pick("scene", kShowLight, [this] {
      onlyLayer("light");
      clickWorld(inspection_->lights.begin()->second->light.position());
    });
    QCOMPARE(document_->selection().light, inspection_->lights.begin()->first.light);
  }

 private:
  /// Picks, and expects one more step of undo, a change in every view that shows such a thing, and the same pictures for the same
  /// selection without the mouse. Every other thing that is selected on the way is undone first.
  void pick(const QString& place, const Views& shownBy, const std::function<void()>& byMouse) {
    const draw::Selection before = document_->selection();
    const std::map<QString, QImage> old = pictures();
    byMouse();
    const draw::Selection picked = document_->selection();
    QVERIFY2(!(picked == before), "nothing was picked");
    const std::map<QString, QImage> now = pictures();
    document_->select(before);
    settle();
    document_->select(picked);
    const std::map<QString, QImage> again = pictures();
    for (const auto& [view, picture] : now) {
      if (view == place) continue;
      QVERIFY2(!shownBy.count(view) || picture != old.at(view), qPrintable(view + " does not show it"));
      QVERIFY2(picture == again.at(view), qPrintable(view + " shows it otherwise when it is selected elsewhere"));
    }
  }
  static Views both(Views a, const Views& b) {
    a.insert(b.begin(), b.end());
    return a;
  }
  const Highlight& observed() const { return inspection_->evidence[kStart].highlights.at(0); }
  void onlyObserved() {
    for (const draw::OverlayLayer& layer : draw::overlayLayers())
      document_->setLayerVisible(layer.name, layer.title, layer.role == draw::OverlayRole::ObservedContour);
    settle();
  }
  void expectDirection(const Pixel& vertex) {
    const draw::Selection s = document_->selection();
    QCOMPARE(s.highlight, 0);
    QVERIFY(s.direction);
    double area = 0;  // of the contour, with its first moments: the centroid by Green's theorem
    Pixel moment(0, 0);
    const std::vector<Pixel>& p = observed().contour.points;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Pixel &a = p[i], &b = p[(i + 1) % p.size()];
      const double cross = a.x() * b.y() - b.x() * a.y();
      area += cross / 2;
      moment += cross / 6 * (a + b);
    }
    const Pixel out = vertex - moment / area;
    QVERIFY(std::abs(std::remainder(*s.direction - std::atan2(out.y(), out.x()), 2 * std::numbers::pi)) < 0.05);
  }
  std::optional<double> clickSample(int pane, const std::string& plot, const std::string& series, int point) {
    PlotCanvas* canvas = plots_->canvas(pane);
    if (canvas->plot().id != plot) return QTest::qFail("another plot", __FILE__, __LINE__), std::nullopt;
    for (int s = 0; s < int(canvas->plot().series.size()); ++s) {
      if (canvas->plot().series[std::size_t(s)].name.rfind(series, 0) != 0) continue;
      const auto at = canvas->positionOf({s, point});
      if (!at) break;
      const auto direction = canvas->plot().series[std::size_t(s)].points[std::size_t(point)].target.direction;
      click(canvas, *at);
      return direction;
    }
    QTest::qFail("no such sample", __FILE__, __LINE__);
    return std::nullopt;
  }
  void onlyLayer(const std::string& name) {
    for (const viz::Layer& layer : viz::sceneLayers()) document_->setLayerVisible(layer.name, layer.title, layer.name == name);
    settle();
  }
  void clickWorld(const Eigen::Vector3d& at) {
    settle();
    vtkRenderer* renderer = scene_->view().renderer();
    renderer->SetWorldPoint(at.x(), at.y(), at.z(), 1);
    renderer->WorldToDisplay();
    clickDisplay(renderer->GetDisplayPoint()[0], renderer->GetDisplayPoint()[1]);
  }
  void clickDisplay(double x, double y) {
    QWidget* widget = scene_->views().widget();
    const double ratio = widget->devicePixelRatioF();
    click(widget, QPointF(x / ratio, widget->height() - 1 - y / ratio));
  }
  static void click(QWidget* widget, const QPointF& at) { QTest::mouseClick(widget, Qt::LeftButton, {}, at.toPoint()); }
  void settle() {
    QCoreApplication::processEvents();
    QTRY_VERIFY(!scene_->views().busy() && !frame_->busy() && plots_->idle());
    QTest::qWait(15);
    QTRY_VERIFY(!scene_->views().busy() && !frame_->busy() && plots_->idle());
    scene_->renderNow();
    plots_->renderNow();
  }
  std::map<QString, QImage> pictures() {
    settle();
    return {{"scene", scene_->views().widget()->grab().toImage()},
            {"frame", frame_->grab().toImage()},
            {"ladder", ladder_->grab().toImage()},
            {"timeline", timeline_->grab().toImage()},
            {"table", table_->grab().toImage()},
            {"plots", plots_->grab().toImage()},
            {"conditioning", conditioning_->grab().toImage()},
            {"numbers", numbers_->grab().toImage()}};
  }

  Opened opened_;
  std::shared_ptr<const Inspection> inspection_;
  std::unique_ptr<Document> document_;
  std::unique_ptr<ScenePanel> scene_;
  std::unique_ptr<FramePanel> frame_;
  std::unique_ptr<LadderPanel> ladder_;
  std::unique_ptr<Timeline> timeline_;
  std::unique_ptr<ErrorTable> table_;
  std::unique_ptr<PlotsPanel> plots_;
  std::unique_ptr<ConditioningPanel> conditioning_;
  std::unique_ptr<NumbersPanel> numbers_;
};

QObject* makePickingTest() { return new PickingTest; }

}  // namespace glint::gui

#include "picking_test.moc"
