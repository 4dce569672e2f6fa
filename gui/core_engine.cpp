// SPDX-License-Identifier: BSD-3-Clause
#include "gui/engine.h"
#include "gui/session_file.h"

namespace glint::gui {

Engine coreEngine() {
  Engine engine;
  engine.open = openInput;
  engine.save = saveSession;
  engine.inspect = [](std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress,
                      const Inspection* previous) { return inspect(std::move(scene), request, progress, previous); };
  engine.parseTrain = parseTrainSpec;
  return engine;
}

}  // namespace glint::gui
