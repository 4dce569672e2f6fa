// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/layer_list.h"

#include <QSignalBlocker>
#include <utility>

#include "gui/base/eliding_delegate.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "viz/style.h"

namespace glint::gui {

namespace {
/// What the legend of a narrow 3D view leaves out.
const std::pair<const char*, viz::Colour> kColours[] = {{"virtual-cameras", viz::kVirtualCamera},
                                                        {"tangent-planes", viz::kVirtualCamera},
                                                        {"light", viz::kLightColour},
                                                        {"true-light", viz::kTruth},
                                                        {"observed-contours", viz::kObserved}};
}  // namespace

LayerList::LayerList(Document& document, QWidget* parent) : QListWidget(parent), document_(document) {
  setObjectName(QStringLiteral("layers"));
  setSelectionMode(QAbstractItemView::NoSelection);
  setIconSize({10, 10});
  setItemDelegate(new ElidingDelegate(this));
  for (const viz::Layer& layer : viz::sceneLayers()) {
    auto* item = new QListWidgetItem(toQString(layer.title), this);
    item->setData(Qt::UserRole, toQString(layer.name));
    item->setFlags(Qt::ItemIsEnabled | Qt::ItemIsUserCheckable);
    item->setCheckState(Qt::Unchecked);
    for (const auto& [name, colour] : kColours)
      if (layer.name == name) item->setIcon(colourSwatch(toQColor(colour)));
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
