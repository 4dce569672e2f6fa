// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/scene_tree.h"

#include <QAction>
#include <QHeaderView>
#include <QItemSelectionModel>
#include <QLineEdit>
#include <QMenu>
#include <QMouseEvent>
#include <QSortFilterProxyModel>
#include <QTreeView>
#include <QVBoxLayout>
#include <algorithm>
#include <utility>

#include "gui/base/eliding_delegate.h"
#include "gui/base/stale_badge.h"
#include "gui/base/text.h"
#include "gui/document/frame_roles.h"
#include "gui/scene/hidden_objects_option.h"

namespace glint::gui {

using Kind = SceneObject::Kind;

namespace {
constexpr int kFewCameras = 40;  // more are folded away until the user asks for them

/// Groups stay in their order, whatever the objects are sorted by; what has no number comes last in both orders.
class Shown : public QSortFilterProxyModel {
 public:
  using QSortFilterProxyModel::QSortFilterProxyModel;

 protected:
  bool lessThan(const QModelIndex& a, const QModelIndex& b) const override {
    const QVariant left = a.data(SceneTreeModel::kSortRole), right = b.data(SceneTreeModel::kSortRole);
    const bool groups = !a.parent().isValid();
    if (groups) return (left.toInt() < right.toInt()) == (sortOrder() == Qt::AscendingOrder);
    if (left.isValid() != right.isValid()) return left.isValid() == (sortOrder() == Qt::AscendingOrder);
    return left.toDouble() < right.toDouble();
  }
};
}  // namespace

SceneTree::SceneTree(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      model_(new SceneTreeModel(document, this)),
      shown_(new Shown(this)),
      tree_(new QTreeView),
      search_(new QLineEdit) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(2);
  search_->setObjectName(QStringLiteral("treeSearch"));
  search_->setPlaceholderText(tr("Find object…"));
  search_->setAccessibleName(tr("Find object"));
  tree_->setAccessibleName(tr("Scene tree"));
  search_->setClearButtonEnabled(true);
  column->addWidget(search_);
  shown_->setSourceModel(model_);
  shown_->setFilterRole(SceneTreeModel::kFindRole);
  shown_->setFilterCaseSensitivity(Qt::CaseInsensitive);
  shown_->setFilterKeyColumn(0);
  shown_->setRecursiveFilteringEnabled(true);
  tree_->setObjectName(QStringLiteral("sceneTree"));
  // Before the tree's own selection hears of it.
  connect(shown_, &QAbstractItemModel::rowsAboutToBeRemoved, this, [this] { ++leaving_; });
  tree_->setModel(shown_);
  connect(shown_, &QAbstractItemModel::rowsRemoved, this, [this] { --leaving_; });
  tree_->viewport()->installEventFilter(this);
  tree_->setUniformRowHeights(true);
  tree_->setSelectionMode(QAbstractItemView::ExtendedSelection);
  tree_->setEditTriggers(QAbstractItemView::NoEditTriggers);
  tree_->setContextMenuPolicy(Qt::CustomContextMenu);
  tree_->setIconSize({10, 10});
  tree_->setIndentation(11);
  tree_->setExpandsOnDoubleClick(false);
  tree_->setItemDelegate(new ElidingDelegate(tree_));
  tree_->setSortingEnabled(true);
  QHeaderView* head = tree_->header();
  head->setStretchLastSection(false);
  head->setMinimumSectionSize(30);
  head->setSectionResizeMode(SceneTreeModel::Name, QHeaderView::Stretch);
  head->setSectionResizeMode(SceneTreeModel::Detail, QHeaderView::Interactive);
  head->setSectionResizeMode(SceneTreeModel::Effect, QHeaderView::Interactive);
  head->resizeSection(SceneTreeModel::Detail, fontMetrics().horizontalAdvance(tr("excluded")) + 19);
  head->resizeSection(SceneTreeModel::Effect, fontMetrics().horizontalAdvance(tr("Influence, pp")) + 14);
  tree_->sortByColumn(SceneTreeModel::Name, Qt::AscendingOrder);
  column->addWidget(tree_, 1);
  connect(&document_, &Document::staleChanged, new StaleBadge(tree_, Qt::BottomRightCorner), &StaleBadge::setStale);

  connect(search_, &QLineEdit::textChanged, this, &SceneTree::find);
  connect(tree_, &QTreeView::doubleClicked, this, [this](const QModelIndex& index) {
    if (!ticked_ && index.column() != SceneTreeModel::Detail && objectAt(index)) emit frameSelectionRequested();
  });
  connect(head, &QHeaderView::sectionClicked, this, [this] {  // the first of the order is what one sorts for
    const QModelIndex first = shown_->index(0, 0, shown_->mapFromSource(model_->groupOf(Kind::Camera)));
    if (first.isValid()) tree_->scrollTo(first, QAbstractItemView::PositionAtTop);
  });
  connect(tree_, &QTreeView::customContextMenuRequested, this, &SceneTree::showMenu);
  // Arrow keys select as clicks do.
  connect(tree_->selectionModel(), &QItemSelectionModel::currentChanged, this, [this](const QModelIndex& now) {
    const std::optional<SceneObject> object = objectAt(now);
    if (object && !selecting_ && leaving_ == 0) select(*object);
  });
  connect(&document_, &Document::selectionChanged, this, &SceneTree::followDocument);
  // Results bring rows, which push the others away.
  connect(shown_, &QAbstractItemModel::rowsInserted, this, [this] {
    const QModelIndex models = shown_->mapFromSource(model_->groupOf(Kind::Ellipsoid));
    for (int i = 0; i < shown_->rowCount(models); ++i) tree_->setFirstColumnSpanned(i, models, true);
    if (!tree_->hasFocus()) keepInSight();
  });
  connect(model_, &SceneTreeModel::effectsChanged, this, &SceneTree::showColumns);
  connect(&document_, &Document::sceneOpened, this, [this] {
    search_->clear();
    for (const Kind kind : {Kind::Surface, Kind::Light, Kind::Ellipsoid, Kind::Camera})
      tree_->setExpanded(shown_->mapFromSource(model_->groupOf(kind)),
                         kind != Kind::Camera || document_.frameCount() <= kFewCameras);
    followed_ = document_.selection();
    mark({Kind::Camera, followed_.frame, -1, {}, {}});
    showColumns();
  });
  showColumns();
}

std::optional<SceneObject> SceneTree::objectAt(const QModelIndex& index) const {
  return model_->objectAt(shown_->mapToSource(index));
}

std::vector<SceneObject> SceneTree::selected() const {
  std::vector<SceneObject> objects;
  for (const QModelIndex& row : tree_->selectionModel()->selectedRows())
    if (const auto object = objectAt(row)) objects.push_back(*object);
  return objects;
}

void SceneTree::setActiveView(int view) { model_->setActiveView(view); }

/// The heads are there to sort the cameras by what they do; without that they would only take a row.
void SceneTree::showColumns() {
  tree_->setColumnHidden(SceneTreeModel::Effect, !model_->hasEffects());
  if (tree_->isHeaderHidden() == model_->hasEffects()) {
    tree_->setHeaderHidden(!model_->hasEffects());
    keepInSight();
  }
  if (!model_->hasEffects()) tree_->sortByColumn(SceneTreeModel::Name, Qt::AscendingOrder);  // no head would turn it back
}

void SceneTree::find(const QString& text) {
  shown_->setFilterFixedString(text);
  for (int g = 0; g < shown_->rowCount() && !text.isEmpty(); ++g) tree_->expand(shown_->index(g, 0));
  const std::optional<SceneObject> current = objectAt(tree_->currentIndex());
  if (current && isSelected(*current, document_.selection())) return;
  selecting_ = true;
  tree_->selectionModel()->clear();  // the current item is not what is selected
  selecting_ = false;
  mark({Kind::Camera, document_.selection().frame, -1, {}, {}});
}

void SceneTree::keepInSight() {
  const QModelIndex now = tree_->currentIndex();
  for (QModelIndex above = now.parent(); above.isValid(); above = above.parent())
    if (!tree_->isExpanded(above)) return;
  if (now.isValid()) tree_->scrollTo(now);
}

// --- selection ------------------------------------------------------------------------------------------------------------

void SceneTree::mark(const SceneObject& object) {
  const QModelIndex row = shown_->mapFromSource(model_->indexOf(object));
  if (!row.isValid()) return;
  selecting_ = true;
  tree_->setAutoScroll(false);  // it would open a group that the user has closed
  tree_->selectionModel()->setCurrentIndex(row, QItemSelectionModel::ClearAndSelect | QItemSelectionModel::Rows);
  tree_->setAutoScroll(true);
  keepInSight();
  selecting_ = false;
}

void SceneTree::followDocument() {
  const draw::Selection now = document_.selection(), before = std::exchange(followed_, now);
  if (selecting_) return;
  const std::optional<SceneObject> current = objectAt(tree_->currentIndex());
  const bool frame = now.frame != before.frame;
  const bool another = frame || now.highlight != before.highlight || now.predicted != before.predicted ||
                       (now.predicted >= 0 && (now.model != before.model || now.light != before.light));
  if (another && (now.highlight >= 0 || now.predicted >= 0)) return mark(partOf(now));
  if (!frame && (now.model != before.model || now.light != before.light)) {
    for (const SceneObject& o : model_->objectsOf(Kind::Ellipsoid))
      if (!now.model.empty() && isSelected(o, now)) return mark(o);
    for (const SceneObject& o : model_->objectsOf(Kind::Light))
      if (isSelected(o, now)) return mark(o);
  }
  if (current && isSelected(*current, now)) return;
  mark({Kind::Camera, now.frame, -1, {}, {}});
}

/// The selected highlight where its camera is open, else the camera.
SceneObject SceneTree::partOf(const draw::Selection& s) const {
  const SceneObject camera{Kind::Camera, s.frame, -1, {}, {}};
  const QModelIndex row = model_->indexOf(camera);
  if (row.isValid() && tree_->isExpanded(shown_->mapFromSource(row)))
    for (int i = 0; i < model_->rowCount(row); ++i)
      if (const auto part = model_->objectAt(model_->index(i, 0, row)); part && isSelected(*part, s)) return *part;
  return camera;
}

void SceneTree::select(const SceneObject& o) {
  draw::Selection s = document_.selection();
  const auto moveTo = [&](int frame) {
    if (frame == s.frame) return;
    s.frame = frame;
    s.highlight = -1;
    s.direction.reset();
  };
  switch (o.kind) {
    case Kind::Surface: {  // the 3D views show the surface that the selected frame sees
      const std::vector<Frame>& frames = document_.scene()->frames;
      if (frames[std::size_t(s.frame)].surface == o.key || o.key == viz::HiddenObjects::kDepthMaps) return;
      const auto seen = std::find_if(frames.begin(), frames.end(), [&](const Frame& f) { return f.surface == o.key; });
      if (seen != frames.end()) moveTo(int(seen - frames.begin()));
      break;
    }
    case Kind::Camera: moveTo(o.frame); break;
    case Kind::Highlight:
      moveTo(o.frame);
      s.highlight = o.highlight;
      s.light = o.light;
      s.predicted = o.predicted;
      if (o.predicted >= 0) s.model = o.key;
      break;
    case Kind::Light: s.light = o.key; break;
    case Kind::Ellipsoid:
      s.model = o.key;
      s.light = o.light;
      break;
  }
  selecting_ = true;
  if (s != document_.selection()) {
    const int step = steps_.gesture(document_);
    o.predicted >= 0 ? document_.selectExactly(s, step) : document_.select(s, step);
  }
  selecting_ = false;
}

bool SceneTree::isRole(const QModelIndex& index) const {
  const std::optional<SceneObject> object = objectAt(index);
  return object && object->kind == Kind::Camera && index.column() == SceneTreeModel::Detail;
}

bool SceneTree::isTick(const QPoint& position) const {
  const QModelIndex index = tree_->indexAt(position);
  if (!index.isValid() || index.column() != SceneTreeModel::Name) return false;
  const int wide = style()->pixelMetric(QStyle::PM_IndicatorWidth) + 2 * style()->pixelMetric(QStyle::PM_FocusFrameHMargin);
  const QRect row = tree_->visualRect(index);
  return position.x() >= row.left() && position.x() < row.left() + wide + 2;
}

/// A click on a role is one action: it does not select as well, as in the timeline.
bool SceneTree::eventFilter(QObject* watched, QEvent* e) {
  const bool twice = e->type() == QEvent::MouseButtonDblClick;
  if (watched != tree_->viewport() || (!twice && e->type() != QEvent::MouseButtonPress)) return QWidget::eventFilter(watched, e);
  const auto* mouse = static_cast<QMouseEvent*>(e);
  ticked_ = twice && isTick(mouse->pos());
  const QModelIndex index = tree_->indexAt(mouse->pos());
  if (mouse->button() != Qt::LeftButton || mouse->modifiers() != Qt::NoModifier || !isRole(index)) return false;
  tree_->setFocus(Qt::MouseFocusReason);
  exclude(index);
  return true;
}

void SceneTree::exclude(const QModelIndex& index) {
  const int frame = objectAt(index)->frame;
  if (document_.role(frame) != FrameRole::Excluded) return document_.setRole(frame, FrameRole::Excluded);
  // Back to what it was, which the specification of the training frames still says.
  InspectionRequest request = document_.request();
  request.excluded.erase(std::remove(request.excluded.begin(), request.excluded.end(), frame), request.excluded.end());
  document_.setRequest(request, tr("Include frame %1").arg(nameText(document_.scene()->frames[std::size_t(frame)].id)));
}

// --- hiding -----------------------------------------------------------------------------------------------------------------

QString SceneTree::nameOf(const std::vector<SceneObject>& objects) const {
  return objects.size() == 1 ? model_->nameOf(objects.front()) : tr("%1 objects").arg(objects.size());
}

void SceneTree::setHiddenOf(const std::vector<SceneObject>& objects, bool hide) {
  viz::HiddenObjects hidden = hiddenObjects(document_);
  for (const SceneObject& o : objects) setHiddenIn(hidden, o, hide);
  setHiddenObjects(document_, hidden, hide ? tr("Hide %1").arg(nameOf(objects)) : tr("Show %1").arg(nameOf(objects)));
}

void SceneTree::hideSelected() {
  if (const std::vector<SceneObject> objects = selected(); !objects.empty()) setHiddenOf(objects, true);
}

void SceneTree::showSelectedOnly() {
  const std::vector<SceneObject> objects = selected();
  if (objects.empty()) return;
  viz::HiddenObjects hidden = hiddenObjects(document_);
  for (const SceneObject& o : objects) {
    const Kind kind = o.kind == Kind::Highlight ? Kind::Camera : o.kind;
    for (const SceneObject& other : model_->objectsOf(kind)) setHiddenIn(hidden, other, true);
  }
  for (SceneObject o : objects) {
    if (o.kind == Kind::Highlight) o = {Kind::Camera, o.frame, -1, {}, {}};
    setHiddenIn(hidden, o, false);
  }
  setHiddenObjects(document_, hidden, tr("Show only %1").arg(nameOf(objects)));
}

void SceneTree::showAll() { setHiddenObjects(document_, {}, tr("Show all objects")); }

void SceneTree::showMenu(const QPoint& position) {
  const std::vector<SceneObject> objects = selected();
  const std::optional<SceneObject> at = objectAt(tree_->indexAt(position));
  auto* menu = new QMenu(this);
  menu->setObjectName(QStringLiteral("treeMenu"));
  menu->setAttribute(Qt::WA_DeleteOnClose);
  if (at && !objects.empty()) {
    menu->addSection(nameOf(objects));
    const viz::HiddenObjects hidden = hiddenObjects(document_);
    const bool anyShown = std::any_of(objects.begin(), objects.end(), [&](const auto& o) { return !isHiddenIn(hidden, o); });
    menu->addAction(anyShown ? tr("&Hide") : tr("S&how"), this, [this, objects, anyShown] { setHiddenOf(objects, anyShown); });
    menu->addAction(tr("Show &only this"), this, &SceneTree::showSelectedOnly);
  }
  menu->addAction(tr("Show &all objects"), this, &SceneTree::showAll);
  if (at && (at->kind == Kind::Camera || at->kind == Kind::Highlight)) {
    menu->addSeparator();
    addRoles(*menu, document_, at->frame);
    menu->addSeparator();
    menu->addAction(tr("&Look through its camera"), this, [this, frame = at->frame] {
      document_.selectFrame(frame);
      emit lookThroughRequested();
    });
    menu->addAction(tr("&Measure influence of frames"), this, &SceneTree::influenceRequested);
  }
  menu->popup(tree_->viewport()->mapToGlobal(position));
}

void SceneTree::addActions(Actions& actions, QMenu* menu) {
  QMenu* objects = menu->addMenu(tr("O&bjects"));
  actions.add("view.hide-object", objects, tr("&Hide selected object"), [this] { hideSelected(); },
              {{QKeySequence("Ctrl+H")}, {}, tr("Hides the object selected in the scene tree")});
  actions.add("view.only-object", objects, tr("Show &only selected object"), [this] { showSelectedOnly(); },
              {{QKeySequence("Ctrl+Shift+H")}, {}, tr("Hides all other objects of its kind")});
  actions.add("view.all-objects", objects, tr("Show &all objects"), [this] { showAll(); }, {{QKeySequence("Ctrl+Alt+H")}});
}

}  // namespace glint::gui
