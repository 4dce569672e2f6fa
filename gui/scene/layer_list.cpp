// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/layer_list.h"

#include <QCheckBox>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <utility>

#include "gui/base/eliding_delegate.h"
#include "gui/base/text.h"
#include "gui/base/theme.h"
#include "gui/scene/scene_options.h"
#include "viz/style.h"

namespace glint::gui {

namespace {
/// What the legend of a narrow 3D view leaves out.
const std::pair<const char*, draw::Colour> kColours[] = {{"virtual-cameras", draw::kVirtualCamera},
                                                         {"tangent-planes", draw::kVirtualCamera},
                                                         {"light", draw::kLightColour},
                                                         {"true-light", draw::kTruth},
                                                         {"measured-lamps", draw::kMeasuredLamp},
                                                         {"observed-contours", draw::kObserved}};
}  // namespace

LayerList::LayerList(Document& document, QWidget* parent) : QListWidget(parent), document_(document) {
  setObjectName(QStringLiteral("layers"));
  setAccessibleName(tr("Layers"));
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
    setLayerVisibleIn(document_, view_, item->data(Qt::UserRole).toString().toStdString(), item->text().toStdString(),
                      item->checkState() == Qt::Checked);
  });
  connect(&document_, &Document::layersChanged, this, &LayerList::refresh);
  connect(&document_, &Document::optionsChanged, this, &LayerList::refresh);
  connect(&document_, &Document::sceneOpened, this, &LayerList::refresh);
  refresh();
}

void LayerList::setActiveView(int view) {
  view_ = view;
  refresh();
}

void LayerList::refresh() {
  const QSignalBlocker quiet(this);
  for (int i = 0; i < count(); ++i)
    item(i)->setCheckState(
        layerVisibleIn(document_, view_, item(i)->data(Qt::UserRole).toString().toStdString()) ? Qt::Checked : Qt::Unchecked);
}

LayerPanel::LayerPanel(Document& document, QWidget* parent)
    : QWidget(parent), document_(document), own_(new QCheckBox), list_(new LayerList(document)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(2);
  own_->setObjectName(QStringLiteral("ownLayers"));
  own_->setToolTip(tr("The list below then applies to the active 3D view only; click a view to activate it"));
  own_->setContentsMargins(4, 0, 0, 0);
  column->addWidget(own_);
  column->addWidget(list_, 1);
  connect(own_, &QCheckBox::clicked, this, [this](bool own) { setOwnLayers(document_, view_, own); });
  connect(&document_, &Document::optionsChanged, this, &LayerPanel::refresh);
  connect(&document_, &Document::sceneOpened, this, &LayerPanel::refresh);
  refresh();
}

void LayerPanel::setActiveView(int view) {
  view_ = view;
  list_->setActiveView(view);
  refresh();
}

void LayerPanel::refresh() {
  own_->setVisible(sceneOptions(document_).viewCount() > 1);
  own_->setText(tr("View %1: own layers").arg(QLatin1Char(char('A' + view_))));
  own_->setChecked(hasOwnLayers(document_, view_));
}

}  // namespace glint::gui
