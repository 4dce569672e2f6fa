// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/picture_access.h"

#include <QAccessible>
#include <QAccessibleWidget>
#include <QHash>
#include <QWidget>
#include <QWindow>
#include <utility>

namespace glint::gui {

namespace {

struct Description {
  QString name;
  std::function<QString()> words;
  PictureParts parts;
};
QHash<const QObject*, Description>& descriptions() {
  static QHash<const QObject*, Description> all;
  return all;
}

/// One part of a picture.
class PartAccess : public QAccessibleInterface, public QAccessibleActionInterface {
 public:
  PartAccess(QWidget* picture, int part) : picture_(picture), part_(part) {}
  bool isValid() const override { return descriptions().contains(picture_) && part_ < parts().count(); }
  QObject* object() const override { return nullptr; }
  QWindow* window() const override { return picture_->window()->windowHandle(); }
  QAccessibleInterface* parent() const override { return QAccessible::queryAccessibleInterface(picture_); }
  QAccessibleInterface* child(int) const override { return nullptr; }
  QAccessibleInterface* childAt(int, int) const override { return nullptr; }
  int childCount() const override { return 0; }
  int indexOfChild(const QAccessibleInterface*) const override { return -1; }
  /// The first line is its name, the others say more.
  QString text(QAccessible::Text text) const override {
    if (!isValid()) return {};
    const QString all = parts().name(part_);
    if (text == QAccessible::Name) return all.section('\n', 0, 0);
    return text == QAccessible::Description ? all.section('\n', 1) : QString();
  }
  void setText(QAccessible::Text, const QString&) override {}
  QRect rect() const override {
    const QRect place = isValid() ? parts().place(part_) : QRect();
    return place.isEmpty() ? QRect() : QRect(picture_->mapToGlobal(place.topLeft()), place.size());
  }
  QAccessible::Role role() const override { return QAccessible::ListItem; }
  QAccessible::State state() const override {
    QAccessible::State state;
    state.selectable = state.focusable = true;
    if (!isValid()) return state;
    state.selected = parts().selected() == part_;
    state.focused = state.selected && picture_->hasFocus();
    state.offscreen = parts().place(part_).isEmpty();
    return state;
  }
  void* interface_cast(QAccessible::InterfaceType type) override {
    return type == QAccessible::ActionInterface ? static_cast<QAccessibleActionInterface*>(this) : nullptr;
  }
  QStringList actionNames() const override { return {pressAction()}; }
  void doAction(const QString& action) override {
    if (action == pressAction() && isValid()) parts().choose(part_);
  }
  QStringList keyBindingsForAction(const QString&) const override { return {}; }

 private:
  const PictureParts& parts() const { return descriptions().find(picture_)->parts; }
  QWidget* picture_;
  int part_;
};

class PictureAccess : public QAccessibleWidget {
 public:
  PictureAccess(QWidget* picture, bool hasParts)
      : QAccessibleWidget(picture, hasParts ? QAccessible::List : QAccessible::Graphic) {}
  ~PictureAccess() override {
    for (const QAccessible::Id id : std::as_const(children_)) QAccessible::deleteAccessibleInterface(id);
  }
  QString text(QAccessible::Text text) const override {
    const auto it = descriptions().constFind(widget());
    if (it == descriptions().constEnd()) return QAccessibleWidget::text(text);
    if (text == QAccessible::Name) return widget()->accessibleName().isEmpty() ? it->name : widget()->accessibleName();
    return text == QAccessible::Description ? it->words() : QAccessibleWidget::text(text);
  }
  int childCount() const override { return hasParts() ? parts().count() : QAccessibleWidget::childCount(); }
  QAccessibleInterface* child(int index) const override {
    if (!hasParts()) return QAccessibleWidget::child(index);
    if (index < 0 || index >= parts().count()) return nullptr;
    if (const auto it = children_.constFind(index); it != children_.constEnd()) return QAccessible::accessibleInterface(*it);
    auto* part = new PartAccess(widget(), index);
    children_.insert(index, QAccessible::registerAccessibleInterface(part));
    return part;
  }
  QAccessibleInterface* childAt(int x, int y) const override {
    if (!hasParts()) return QAccessibleWidget::childAt(x, y);
    for (int i = 0; i < parts().count(); ++i)
      if (parts().place(i).contains(widget()->mapFromGlobal(QPoint(x, y)))) return child(i);
    return nullptr;
  }
  int indexOfChild(const QAccessibleInterface* wanted) const override {
    if (!hasParts()) return QAccessibleWidget::indexOfChild(wanted);
    for (auto it = children_.constBegin(); it != children_.constEnd(); ++it)
      if (QAccessible::accessibleInterface(it.value()) == wanted) return it.key();
    return -1;
  }
  QAccessibleInterface* focusChild() const override {
    return hasParts() && widget()->hasFocus() ? child(parts().selected()) : QAccessibleWidget::focusChild();
  }

 private:
  bool hasParts() const {
    const auto it = descriptions().constFind(widget());
    return it != descriptions().constEnd() && it->parts.count;
  }
  const PictureParts& parts() const { return descriptions().find(widget())->parts; }
  mutable QHash<int, QAccessible::Id> children_;  // made when asked for: there may be thousands
};

QAccessibleInterface* makeAccess(const QString&, QObject* object) {
  const auto it = descriptions().constFind(object);
  if (it == descriptions().constEnd()) return nullptr;
  return new PictureAccess(static_cast<QWidget*>(object), bool(it->parts.count));
}

}  // namespace

void describePicture(QWidget* picture, const QString& name, std::function<QString()> words, PictureParts parts) {
  static const bool installed = (QAccessible::installFactory(makeAccess), true);
  Q_UNUSED(installed)
  if (!descriptions().contains(picture))
    QObject::connect(picture, &QObject::destroyed, [](const QObject* gone) { descriptions().remove(gone); });
  descriptions().insert(picture, {name, std::move(words), std::move(parts)});
}

void announceSelection(QWidget* picture) {
  if (!QAccessible::isActive() || !picture->hasFocus()) return;
  const auto it = descriptions().constFind(picture);
  if (it == descriptions().constEnd() || !it->parts.selected) return;
  QAccessibleEvent event(picture, QAccessible::Focus);
  event.setChild(it->parts.selected());
  QAccessible::updateAccessibility(&event);
}

}  // namespace glint::gui
