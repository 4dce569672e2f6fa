// SPDX-License-Identifier: BSD-3-Clause
// The scene tree with real clicks and keys: what it lists, selects, hides and excludes.
#include "gui/scene/scene_tree.h"

#include <QAction>
#include <QHeaderView>
#include <QLineEdit>
#include <QMenu>
#include <QSortFilterProxyModel>
#include <QTreeView>
#include <set>

#include "core/advise/influence.h"
#include "gui/base/text.h"
#include "gui/base/vtk_canvas.h"
#include "gui/scene/hidden_objects_option.h"
#include "tests/gui/scene_fixture.h"

namespace glint::gui {

using Kind = SceneObject::Kind;

class SceneTreeTest : public QObject, SceneFixture {
  Q_OBJECT
 private slots:
  void init() {
    begin();
    tree_ = std::make_unique<SceneTree>(*document_);
    tree_->addActions(*actions_, menu_.get());
    document_->open(spread());  // as the window has it: the tree is there first
    inspect();
    tree_->resize(260, 700);
    tree_->show();
    QVERIFY(QTest::qWaitForWindowExposed(tree_.get()));
  }
  void cleanup() {
    tree_.reset();
    end();
  }

  void everythingOfTheSceneIsListed() {
    const Scene& scene = *document_->scene();
    QStringList cameras;
    for (const Frame& frame : scene.frames) cameras << toQString(frame.id);
    QCOMPARE(children(group(Kind::Camera)), cameras);
    QCOMPARE(children(group(Kind::Surface)), QStringList{"ball"});
    const QStringList models = children(group(Kind::Ellipsoid));
    QCOMPARE(models.size(), int(document_->request().models.size()));
    // Highlights come and go with what was observed.
    const QModelIndex first = row(camera(0));
    QCOMPARE(tree_->view()->model()->rowCount(first), 1);
    auto without = std::make_shared<Inspection>(*document_->inspection());
    without->evidence[0].highlights.clear();
    document_->setInspection(without, document_->request());
    QCOMPARE(tree_->view()->model()->rowCount(row(camera(0))), 0);
    QCOMPARE(tree_->view()->model()->rowCount(row(camera(1))), 1);
    inspect();
    QCOMPARE(tree_->view()->model()->rowCount(row(camera(0))), 1);
  }

  void aClickSelectsEverywhereAndWhatIsSelectedElsewhereIsMarked() {
    click(camera(7), SceneTreeModel::Name);
    QCOMPARE(document_->selection().frame, 7);
    document_->selectFrame(3);
    QCOMPARE(marked(), (std::vector<SceneObject>{camera(3)}));
    draw::Selection s = document_->selection();
    const SceneObject ellipsoid = tree_->model().objectsOf(Kind::Ellipsoid).back();
    s.model = ellipsoid.key;
    document_->select(s);
    QCOMPARE(marked(), std::vector<SceneObject>{ellipsoid});
    const SceneObject other = tree_->model().objectsOf(Kind::Ellipsoid).front();
    click(other, SceneTreeModel::Name);
    QCOMPARE(document_->selection().model, other.key);
    QCOMPARE(document_->selection().frame, 3);
    // A highlight of an open camera; of a closed one its camera.
    s = document_->selection();
    s.highlight = 0;
    document_->select(s);
    QCOMPARE(marked(), (std::vector<SceneObject>{camera(3)}));
    tree_->view()->expand(row(camera(5)));
    const QModelIndex highlight = tree_->view()->model()->index(0, 0, row(camera(5)));
    tree_->view()->scrollTo(highlight);
    QTest::mouseClick(tree_->view()->viewport(), Qt::LeftButton, {}, tree_->view()->visualRect(highlight).center());
    QCOMPARE(document_->selection().frame, 5);
    QCOMPARE(document_->selection().highlight, 0);
    // A group that the user has closed stays closed: a long sequence would push all else away.
    tree_->view()->collapse(group(Kind::Camera));
    document_->selectFrame(2);
    QVERIFY(!tree_->view()->isExpanded(group(Kind::Camera)));
    QCOMPARE(marked(), (std::vector<SceneObject>{camera(2)}));
    tree_->view()->expand(group(Kind::Camera));
    // Arrow keys as clicks.
    click(camera(5), SceneTreeModel::Name);
    tree_->view()->collapse(row(camera(5)));
    QTest::qWait(700);  // longer than a run's gap
    const int before = document_->undoStack()->count();
    QTest::keyClick(tree_->view(), Qt::Key_Down);
    QCOMPARE(document_->selection().frame, 6);
    QTest::keyClick(tree_->view(), Qt::Key_Down);
    QCOMPARE(document_->selection().frame, 7);
    QCOMPARE(document_->undoStack()->count(), before + 1);  // a run of keys is one step
  }

  void aTickHidesInTheViewsAsOneStep() {
    const int before = document_->undoStack()->count();
    tick(camera(2));
    QVERIFY(hiddenObjects(*document_).frames == std::set<int>{2});
    QCOMPARE(document_->undoStack()->count(), before + 1);
    QCOMPARE(document_->undoStack()->undoText(), QStringLiteral("Hide camera 0002"));
    settle();
    showOnly({"cameras"});
    settle();
    const Eigen::Vector3d at = document_->scene()->frames[2].camera.centreInWorld();
    QVERIFY(!pickedFrame(at));
    QCOMPARE(document_->role(2), document_->role(3));  // hidden, not excluded: computed as before
    tick(camera(2));
    settle();
    QCOMPARE(pickedFrame(at), std::optional<int>(2));
    QVERIFY(hiddenObjects(*document_).count() == 0);
    document_->undoStack()->undo();
    QVERIFY(hiddenObjects(*document_).frames == std::set<int>{2});
    document_->undoStack()->undo();
  }

  void aGroupsTickIsAboutAllOfIt() {
    const QModelIndex cameras = group(Kind::Camera);
    const auto state = [&] { return Qt::CheckState(group(Kind::Camera).data(Qt::CheckStateRole).toInt()); };
    QCOMPARE(state(), Qt::Checked);
    tick(camera(1));
    QCOMPARE(state(), Qt::PartiallyChecked);
    tree_->view()->scrollTo(cameras);
    tickAt(cameras);
    QCOMPARE(state(), Qt::Checked);
    tickAt(group(Kind::Camera));
    QCOMPARE(state(), Qt::Unchecked);
    QCOMPARE(int(hiddenObjects(*document_).frames.size()), document_->frameCount());
    trigger("view.all-objects");
    QCOMPARE(state(), Qt::Checked);
  }

  void onlyTheSelectedOfAKindAreShown() {
    click(camera(4), SceneTreeModel::Name);
    click(camera(6), SceneTreeModel::Name, Qt::ControlModifier);
    trigger("view.only-object");
    const viz::HiddenObjects hidden = hiddenObjects(*document_);
    QCOMPARE(int(hidden.frames.size()), document_->frameCount() - 2);
    QVERIFY(!hidden.frames.count(4) && !hidden.frames.count(6) && hidden.ellipsoids.empty() && hidden.surfaces.empty());
    QCOMPARE(document_->undoStack()->undoText(), QStringLiteral("Show only 2 objects"));
    document_->undoStack()->undo();
    trigger("view.hide-object");
    QVERIFY((hiddenObjects(*document_).frames == std::set<int>{4, 6}));
  }

  void oneClickOnItsRoleExcludesAFrameAndOneTakesItBack() {
    document_->setTrain("2,4,6,8");
    const int before = document_->undoStack()->count();
    for (const int frame : {4, 5}) {  // it trains, it is held out
      const FrameRole was = document_->role(frame);
      const int steps = document_->undoStack()->index(), selected = document_->selection().frame;
      QVERIFY(selected != frame);
      click(camera(frame), SceneTreeModel::Detail);
      QCOMPARE(document_->undoStack()->index(), steps + 1);
      QCOMPARE(document_->selection().frame, selected);  // one action: it does not select as well
      QCOMPARE(document_->role(frame), FrameRole::Excluded);
      QCOMPARE(row(camera(frame)).siblingAtColumn(SceneTreeModel::Detail).data().toString(), QStringLiteral("excluded"));
      click(camera(frame), SceneTreeModel::Detail);
      QCOMPARE(document_->role(frame), was);
    }
    QCOMPARE(QString::fromStdString(document_->request().train), QStringLiteral("2,4,6,8"));
    QVERIFY(document_->undoStack()->count() >= before + 4);
    click(camera(4), SceneTreeModel::Name);
    QVERIFY(document_->role(4) != FrameRole::Excluded);
  }

  void whatAFrameDoesStandsBesideItAndSorts() {
    QVERIFY(tree_->view()->isColumnHidden(SceneTreeModel::Effect));
    auto influence = std::make_shared<Influence>();
    const std::string model = document_->plottedModel();
    const std::map<int, double> points{{0, 0.5}, {1, -2}, {2, 3}};
    influence->probes = {9};
    for (const auto& [frame, p] : points) {
      FrameInfluence f;
      f.frame = frame;
      f.models[model].changePct = p;
      influence->frames.push_back(f);
    }
    document_->setInfluence(influence, document_->request());
    QVERIFY(!tree_->view()->isColumnHidden(SceneTreeModel::Effect));
    const auto text = [&](int frame) { return row(camera(frame)).siblingAtColumn(SceneTreeModel::Effect).data().toString(); };
    QCOMPARE(text(2), QStringLiteral("+3.0"));
    QCOMPARE(text(1), QStringLiteral("-2.0"));
    QCOMPARE(text(5), QString());
    tree_->view()->sortByColumn(SceneTreeModel::Effect, Qt::DescendingOrder);
    QCOMPARE(children(group(Kind::Camera)).mid(0, 3), (QStringList{"0002", "0000", "0001"}));
    QCOMPARE(group(Kind::Camera).row(), 3);                                   // groups stay
    tree_->view()->sortByColumn(SceneTreeModel::Effect, Qt::AscendingOrder);  // who harms; those without a number last again
    QCOMPARE(children(group(Kind::Camera)).mid(0, 3), (QStringList{"0001", "0000", "0002"}));
    QCOMPARE(group(Kind::Camera).row(), 3);
    document_->setRole(1, FrameRole::Excluded);  // measured for another request
    QVERIFY(tree_->view()->isColumnHidden(SceneTreeModel::Effect));
    QCOMPARE(children(group(Kind::Camera)).mid(0, 3), (QStringList{"0000", "0001", "0002"}));
  }

  void aSearchLeavesWhatItFinds() {
    auto* search = tree_->findChild<QLineEdit*>(QStringLiteral("treeSearch"));
    document_->selectFrame(6);
    const int steps = document_->undoStack()->index();
    QTest::keyClicks(search, "0011");
    QCOMPARE(children(group(Kind::Camera)), QStringList{"0011"});
    // A search selects nothing, not even the row that is left when the selected one goes.
    QCOMPARE(document_->selection().frame, 6);
    QCOMPARE(document_->undoStack()->index(), steps);
    QVERIFY(marked().empty());
    search->clear();
    QCOMPARE(children(group(Kind::Camera)).size(), document_->frameCount());
    QCOMPARE(marked(), (std::vector<SceneObject>{camera(6)}));
    QTest::keyClick(tree_->view(), Qt::Key_Down);
    QCOMPARE(document_->selection().frame, 7);
  }

  void twoClicksOnATickFlyNowhere() {
    int flights = 0;
    connect(tree_.get(), &SceneTree::frameSelectionRequested, this, [&] { ++flights; });
    const QModelIndex at = row(camera(1));
    tree_->view()->scrollTo(at);
    const QRect line = tree_->view()->visualRect(at);
    const auto clickTwice = [&](int x) {  // as a window system sends it
      const QPoint place(line.left() + x, line.center().y());
      QTest::mouseClick(tree_->view()->viewport(), Qt::LeftButton, {}, place);
      QMouseEvent again(QEvent::MouseButtonDblClick, place, Qt::LeftButton, Qt::LeftButton, {});
      QCoreApplication::sendEvent(tree_->view()->viewport(), &again);
      QTest::mouseRelease(tree_->view()->viewport(), Qt::LeftButton, {}, place);
    };
    clickTwice(6);
    QCOMPARE(flights, 0);
    clickTwice(40);
    QCOMPARE(flights, 1);
  }

  void whatIsHiddenIsKeptByIdsAndUnknownOnesAreIgnored() {
    viz::HiddenObjects hidden;
    hidden.frames = {1, 3};
    hidden.surfaces = {"ball"};
    hidden.lights = {"two words"};
    hidden.ellipsoids = {{"canonical", "two words"}};
    setHiddenObjects(*document_, hidden, "hide");
    QCOMPARE(QString::fromStdString(document_->option("scene/hidden", std::string())),
             QStringLiteral("camera 0001\ncamera 0003\nsurface ball\nlight two words\nellipsoid canonical two words\n"));
    QVERIFY(hiddenObjects(*document_) == hidden);
    document_->setOption("scene/hidden", std::string("camera 0001\ncamera gone\nghost x\nellipsoid broken\n"), "by hand");
    QVERIFY(hiddenObjects(*document_).frames == std::set<int>{1});
    QCOMPARE(int(hiddenObjects(*document_).count()), 1);
  }

 private:
  static SceneObject camera(int frame) { return {Kind::Camera, frame, -1, {}, {}}; }
  void inspect() {
    auto inspection = std::make_shared<Inspection>(drawnCircles(document_->sharedScene(), document_->request()));
    inspection->surfaces = std::make_shared<SurfaceCache>(*document_->sharedScene());
    document_->setInspection(inspection, document_->request());
    settle();
  }
  QModelIndex shown(const QModelIndex& source) {
    return qobject_cast<QSortFilterProxyModel*>(tree_->view()->model())->mapFromSource(source);
  }
  QModelIndex group(Kind kind) { return shown(tree_->model().groupOf(kind)); }
  QModelIndex row(const SceneObject& object) { return shown(tree_->model().indexOf(object)); }
  QStringList children(const QModelIndex& parent) {
    QStringList names;
    for (int i = 0; i < tree_->view()->model()->rowCount(parent); ++i)
      names << tree_->view()->model()->index(i, 0, parent).data().toString();
    return names;
  }
  std::vector<SceneObject> marked() { return tree_->selected(); }
  void click(const SceneObject& object, int column, Qt::KeyboardModifiers keys = {}) {
    const QModelIndex at = row(object).siblingAtColumn(column);
    QVERIFY(at.isValid());
    tree_->view()->scrollTo(at);
    QTest::mouseClick(tree_->view()->viewport(), Qt::LeftButton, keys, tree_->view()->visualRect(at).center());
  }
  void tick(const SceneObject& object) { tickAt(row(object)); }
  void tickAt(const QModelIndex& at) {
    tree_->view()->scrollTo(at);
    QStyleOptionViewItem option;
    option.initFrom(tree_->view());
    option.features = QStyleOptionViewItem::HasCheckIndicator | QStyleOptionViewItem::HasDisplay;
    option.rect = tree_->view()->visualRect(at);
    const QRect box = tree_->view()->style()->subElementRect(QStyle::SE_ItemViewItemCheckIndicator, &option, tree_->view());
    QTest::mouseClick(tree_->view()->viewport(), Qt::LeftButton, {}, box.center());
  }
  std::optional<int> pickedFrame(const Eigen::Vector3d& at) {
    const QPoint p = onScreen(at);
    const double ratio = views().widget()->devicePixelRatioF();
    const auto picked = panel_->view().pick(int(p.x() * ratio), int((views().widget()->height() - 1 - p.y()) * ratio));
    if (!picked || picked->frame < 0) return {};
    return picked->frame;
  }

  std::unique_ptr<SceneTree> tree_;
};

QObject* makeSceneTreeTest() { return new SceneTreeTest; }

}  // namespace glint::gui

#include "scene_tree_test.moc"
