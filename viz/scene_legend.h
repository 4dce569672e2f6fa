// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "viz/annotations.h"
#include "viz/camera_colours.h"

namespace glint::viz {

/// The legend in the corner of the 3D picture.
struct SceneLegend {
  std::string title;
  std::vector<LegendEntry> entries;
  std::vector<std::string> notes, remarks;
  std::optional<ColourBar> bar;  ///< where colours are a scale
};

/// Legend of the layers that are shown: contents and visibilities in the order of sceneLayers().
struct ShownLayer {
  bool visible = false;
  const LayerContent* content = nullptr;  ///< never null
};
SceneLegend legendOf(const LayerInput& in, const std::vector<ShownLayer>& layers);

}  // namespace glint::viz
