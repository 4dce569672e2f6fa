// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <utility>

#include "cli/commands.h"
#include "cli/scene_arguments.h"
#include "core/scene/correction.h"
#include "core/scene/export_capture.h"
#include "core/scene/outputs.h"
#include "core/scene/scene.h"

namespace glint::cli {

Command convertCommand() {
  struct Arguments {
    std::string input, output;
    std::vector<std::string> fixes;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "convert";
  c.summary = "Convert any input to a scene file, transforms.json or a COLMAP model";
  c.description =
      "Reads INPUT and writes what was understood, by the name of the output: transforms.json (nerfstudio), another *.json (a "
      "scene\n"
      "file, with unknown keys of a scene kept), or a folder (COLMAP's text model). Paths are relative to the new file. Images "
      "and\n"
      "meshes stay in place. The last two hold cameras, and paths of images, depth maps and masks; a warning names what is left "
      "out.";
  c.examples =
      "  glint convert DIR -o DIR/scene.json\n"
      "  glint convert COLMAP --surface mesh.ply -o scene.json\n"
      "  glint convert COLMAP --fix invert-poses -o corrected.json\n"
      "  glint convert scene.json -o DIR/transforms.json\n"
      "  glint convert scene.json -o DIR/sparse\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT",
                 "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
    o.required(a->output, "-o,--out,--output", "FILE", "transforms.json, a scene file (*.json), or a folder for a COLMAP model");
    o.repeated(a->fixes, "--fix", "NAME[=VALUE]", "Make a correction that `glint info` proposes: " + correctionNames());
    a->places.declare(o);
  };
  c.run = [a](const Context& context) -> int {
    namespace fs = std::filesystem;
    const fs::path output(a->output);
    const bool json = output.extension() == ".json", transforms = output.filename() == "transforms.json";
    if (!json && output.has_extension())
      throw InputError(a->output, "--out", "expected transforms.json, a scene file (*.json), or a folder for a COLMAP model");
    Scene scene = a->places.read(a->input);
    for (const std::string& fix : a->fixes) scene = corrected(std::move(scene), fix);
    for (const std::string& w : scene.warnings) context.warn(w);
    if (!json || transforms) {
      const Exported exported = transforms ? transformsOf(scene, output) : colmapOf(scene, output);
      for (const std::string& w : exported.leftOut) context.warn(w);
      exported.write();
      return kDone;
    }
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
