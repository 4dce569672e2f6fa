// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/synth.h"

#include "plugins/python/src/failures.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

SceneHandle synthesised(const std::string& spec, const std::string& folder, py::object progress) {
  return withProgress(std::move(progress), [&](const ProgressFn& report) {
    SceneHandle made;
    made.scene = std::make_shared<const Scene>(synthesise(readSynthSpec(spec), folder, report));
    made.surfaces = std::make_shared<const SurfaceCache>(*made.scene);
    made.input = made.scene->file.string();
    return made;
  });
}

}  // namespace

void declareSynth(py::module_& module) { module.def("_synth", &synthesised); }

}  // namespace glint::python
