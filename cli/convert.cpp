// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "cli/commands.h"
#include "cli/scene_arguments.h"
#include "core/scene/outputs.h"
#include "core/scene/scene.h"

namespace glint::cli {

Command convertCommand() {
  struct Arguments {
    std::string input, output;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "convert";
  c.summary = "Convert any input to a scene file";
  c.description =
      "Reads INPUT and writes it as scene.json, version 1, with paths relative to the new file. Images and meshes stay\n"
      "in place. Unknown keys are kept.";
  c.examples = "  glint convert DIR -o DIR/scene.json\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT", "Scene file, folder that contains one, or session");
    o.required(a->output, "-o,--out,--output", "FILE", "The scene file to write (*.json)");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) -> int {
    namespace fs = std::filesystem;
    const fs::path output(a->output);
    if (output.extension() != ".json") throw InputError(a->output, "--out", "only scene files (*.json) can be written");
    if (output.filename() == "transforms.json")
      throw InputError(a->output, "--out", "nerfstudio files cannot be written yet, only scene files");
    const Scene scene = a->places.read(a->input);
    for (const std::string& w : scene.warnings) context.warn(w);
    Outputs(a->input, scene).file(a->output, "--out", OutputKind::document("glint_scene"));
    writeScene(scene, output);
    try {
      readScene(output);
    } catch (const InputError& e) {
      context.warn(std::string("reading this file needs --allow-outside: ") + e.what());
    }
    return kDone;
  };
  return c;
}

}  // namespace glint::cli
