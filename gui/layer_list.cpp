// SPDX-License-Identifier: BSD-3-Clause
#include "gui/layer_list.h"

#include <QSignalBlocker>

#include "gui/text.h"

namespace glint::gui {

LayerList::LayerList(Document& document, QWidget* parent) : QListWidget(parent), document_(document) {
  setObjectName(QStringLiteral("layers"));
  setSelectionMode(QAbstractItemView::NoSelection);
  for (const viz::Layer& layer : viz::sceneLayers()) {
    auto* item = new QListWidgetItem(toQString(layer.title), this);
    item->setData(Qt::UserRole, toQString(layer.name));
    item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsUserCheckable);
    item->setCheckState(Qt::Unchecked);
  }
  connect(this, &QListWidget::itemChanged, this, [this](const QListWidgetItem* item) {
    document_.setLayerVisible(item->data(Qt::UserRole).toString().toStdString(), item->text().toStdString(),
                              item->checkState() == Qt::Checked);
  });
  connect(&document_, &Document::layersChanged, this, &LayerList::refresh);
  connect(&document_, &Document::sceneOpened, this, &LayerList::refresh);
  refresh();
}

void LayerList::refresh() {
  const QSignalBlocker quiet(this);
  for (int i = 0; i < count(); ++i)
    item(i)->setCheckState(document_.layerVisible(item(i)->data(Qt::UserRole).toString().toStdString()) ? Qt::Checked
                                                                                                        : Qt::Unchecked);
}

}  // namespace glint::gui
