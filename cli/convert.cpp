// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <filesystem>
#include <utility>

#include "cli/commands.h"
#include "cli/scene_arguments.h"
#include "core/base/number_text.h"
#include "core/pipeline/given_labels.h"
#include "core/scene/correction.h"
#include "core/scene/outputs.h"
#include "core/scene/scene.h"

namespace glint::cli {

namespace {

constexpr const char* kDescription =
    "Reads INPUT and writes what was understood, by the name of the output: transforms.json (nerfstudio), another *.json (a "
    "scene\n"
    "file, with unknown keys of a scene kept), or a folder (COLMAP's text model). Paths are relative to the new file. Images "
    "and\n"
    "meshes stay in place. The last two hold cameras, and paths of images, depth maps and masks; a warning names what is left "
    "out.\n"
    "--labels takes the polygons of a COCO file as the highlights of its frames: labels that were corrected by hand are "
    "evidence\n"
    "again. A highlight keeps the peak that the scene or the photograph shows inside of its polygon.";

/// The scene with the highlights of a COCO file; says what they are.
Scene labelledBy(const std::string& file, const Scene& scene, const Context& context) {
  LabelledScene labelled = withLabels(scene, std::filesystem::path(file), context.progress());
  for (const std::string& w : labelled.warnings) context.warn(w);
  context.print(formatted("%d highlights in %d frames\n", labelled.highlights, labelled.frames));
  return std::move(labelled.scene);
}

}  // namespace

Command convertCommand() {
  struct Arguments {
    std::string input, output, labels;
    std::vector<std::string> fixes;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "convert";
  c.summary = "Convert any input to a scene file, transforms.json or a COLMAP model";
  c.description = kDescription;
  c.examples =
      "  glint convert DIR -o DIR/scene.json\n"
      "  glint convert COLMAP --surface mesh.ply -o scene.json\n"
      "  glint convert COLMAP --fix invert-poses -o corrected.json\n"
      "  glint convert run.glint --labels corrected.json -o DIR/labelled.json\n"
      "  glint convert scene.json -o DIR/transforms.json\n"
      "  glint convert scene.json -o DIR/sparse\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT",
                 "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
    o.required(a->output, "-o,--out,--output", "FILE", "transforms.json, a scene file (*.json), or a folder for a COLMAP model");
    o.repeated(a->fixes, "--fix", "NAME[=VALUE]", "Make a correction that `glint info` proposes: " + correctionNames());
    o.option(a->labels, "--labels", "FILE", "COCO polygons that become the highlights of the scene file");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) -> int {
    namespace fs = std::filesystem;
    const fs::path output(a->output);
    const bool json = output.extension() == ".json", transforms = output.filename() == "transforms.json";
    if (!json && output.has_extension())
      throw InputError(a->output, "--out", "expected transforms.json, a scene file (*.json), or a folder for a COLMAP model");
    if (!a->labels.empty() && (!json || transforms))
      throw InputError(a->output, "--labels", "only a scene file (*.json) holds highlights");
    Scene scene = a->places.read(a->input);
    if ((!json || transforms) && std::count(a->fixes.begin(), a->fixes.end(), flipFacesCorrection().fix) > 0)
      throw InputError(a->output, "--fix flip-faces", "only a scene file (*.json) names a mesh");
    if (json && !transforms) Outputs(a->input, scene).file(a->output, "--out", OutputKind::document("glint_scene"));
    scene = correctedFor(std::move(scene), a->fixes, output);
    for (const std::string& w : scene.warnings) context.warn(w);
    if (!json || transforms) {
      const Exported exported = transforms ? transformsOf(scene, output) : colmapOf(scene, output);
      for (const std::string& w : exported.leftOut) context.warn(w);
      exported.write();
      context.wrote(output);
      return kDone;
    }
    if (!a->labels.empty()) scene = labelledBy(a->labels, scene, context);
    writeScene(scene, output);
    context.wrote(output);
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
