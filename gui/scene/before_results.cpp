// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/before_results.h"

#include <algorithm>

namespace glint::gui {

std::shared_ptr<const Inspection> knownBeforeResults(const Document& document) {
  const std::shared_ptr<const Scene> scene = document.sharedScene();
  if (!scene || scene->frames.empty() || !document.request().whatIf.none()) return nullptr;
  auto known = std::make_shared<Inspection>();
  known->scene = known->given = scene;
  known->request = document.request();
  known->request.models.clear();  // nothing is known of them
  known->train.text = known->request.train;
  for (int i = 0; i < document.frameCount(); ++i)
    if (document.role(i) == FrameRole::Training) known->train.frames.push_back(i);
  // A mesh takes seconds to read, and the run reads it, too.
  const bool analytic = std::all_of(scene->frames.begin(), scene->frames.end(),
                                    [&](const Frame& frame) { return scene->formulaOf(frame.surface); });
  if (analytic) known->surfaces = std::make_shared<SurfaceCache>(*scene);
  return known;
}

}  // namespace glint::gui
