// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/synth.h"

#include "cli/commands.h"

namespace glint::cli {

Command synthCommand() {
  struct Arguments {
    std::string spec, out;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "synth";
  c.summary = "Make a synthetic scene with exact contours, peaks and frames";
  c.description =
      "Makes the scene described by SPEC.json: exact highlights traced on the analytic field (not on pixels) and, where it\n"
      "has \"render\", frames with depth, normals and masks. Reflectances: phong, blinn-phong, torrance-sparrow, ggx. Lights:\n"
      "point, directional, sphere, tube. resources/specs holds the two experiments of the paper.";
  c.examples = "  glint synth resources/specs/ellipsoid_80.json -o DIR    then: glint evaluate DIR --train spread:6\n";
  c.declare = [a](Options& o) {
    o.positional(a->spec, "SPEC", "Specification (JSON): a scene without images, with path, surface_steps, contour, render");
    o.required(a->out, "-o,--out", "DIR", "Folder for scene.json and the images; created if missing");
  };
  c.run = [a](const Context& context) -> int {
    const SynthSpec spec = readSynthSpec(a->spec);
    const Scene scene = synthesise(spec, a->out, context.progress());
    std::size_t highlights = 0;
    for (const Frame& frame : scene.frames) highlights += frame.highlights.size();
    for (const std::string& warning : scene.warnings) context.warn(warning);
    context.print(scene.file.string() + ": " + std::to_string(scene.frames.size()) + " frames, " + std::to_string(highlights) +
                  " highlights\n");
    if (highlights == 0) throw CannotAnswer{{Reason::NoHighlight, "no frame shows a highlight"}};
    return kDone;
  };
  return c;
}

}  // namespace glint::cli
