// SPDX-License-Identifier: BSD-3-Clause
#include "gui/engine.h"

namespace glint::gui {

Engine coreEngine() {
  Engine engine;
  engine.open = [](const std::string& path) {
    Opened opened;
    opened.path = path;
    opened.scene = std::make_shared<const Scene>(readScene(path));
    return opened;
  };
  engine.inspect = [](std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress,
                      const Inspection* previous) { return inspect(std::move(scene), request, progress, previous); };
  engine.parseTrain = parseTrainSpec;
  return engine;
}

}  // namespace glint::gui
