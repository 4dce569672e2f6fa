// SPDX-License-Identifier: BSD-3-Clause
#include "gui/frame/lobe_layer.h"

#include <algorithm>

#include "core/draw/frame_overlay.h"

namespace glint::gui {

LobeLayer::LobeLayer(Document& document, QObject* parent) : QObject(parent), document_(document) {
  connect(&loader_, &SamplesLoader::loaded, this, [this](const FrameSamplesPtr& samples) {
    samples_ = samples;
    emit changed();
  });
  for (const auto signal :
       {&Document::sceneOpened, &Document::inspectionChanged, &Document::layersChanged, &Document::selectionChanged})
    connect(&document_, signal, this, &LobeLayer::follow);
}

void LobeLayer::follow() {
  const std::vector<draw::OverlayLayer>& layers = draw::overlayLayers();
  const auto layer =
      std::find_if(layers.begin(), layers.end(), [](const draw::OverlayLayer& l) { return l.role == draw::OverlayRole::Lobes; });
  const std::shared_ptr<const Inspection> inspection =
      document_.layerVisible(layer->name) ? document_.inspection() : std::shared_ptr<const Inspection>();
  const int frame = document_.selection().frame;
  const std::string model = document_.plottedModel();
  if (inspection == wantedOf_ && (!inspection || (frame == wantedFrame_ && model == wantedModel_))) return;
  if (!inspection || frame != wantedFrame_) samples_.reset();  // of results that are computed again, the old ones stay until then
  wantedOf_ = inspection;
  wantedFrame_ = frame;
  wantedModel_ = model;
  loader_.want(inspection, frame, model);
  emit changed();
}

}  // namespace glint::gui
