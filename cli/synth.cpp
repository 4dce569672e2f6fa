// SPDX-License-Identifier: BSD-3-Clause
#include "core/synth/synth.h"

#include "cli/commands.h"
#include "core/base/version.h"
#include "core/synth/part.h"

namespace glint::cli {

Command synthCommand() {
  struct Arguments {
    std::string spec, out, shard;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "synth";
  c.summary = "Make a synthetic scene with exact contours, peaks and frames";
  c.description =
      "Makes the scene described by SPEC.json: exact highlights traced on the analytic field (not on pixels) and, where it\n"
      "has \"render\", frames with depth, normals and masks. Reflectances: phong, blinn-phong, torrance-sparrow, ggx. Lights:\n"
      "point, directional, sphere, tube. resources/specs holds the two experiments of the paper.";
  c.examples =
      "  glint synth resources/specs/ellipsoid_80.json -o DIR    then: glint evaluate DIR --train spread:6\n"
      "  glint synth SPEC.json -o DIR --shard 1/8              the first eighth; after all: glint merge DIR/parts/* -o "
      "DIR/scene.json\n";
  c.declare = [a](Options& o) {
    o.positional(a->spec, "SPEC", "Specification (JSON): a scene without images, with path, surface_steps, contour, render");
    o.required(a->out, "-o,--out", "DIR", "Folder for scene.json and the images; created if missing");
    o.option(a->shard, "--shard", "i/n",
             "Make the i-th of n equal parts of the frames, and DIR/parts/i-of-n.json; `glint merge` then writes scene.json");
  };
  c.run = [a](const Context& context) -> int {
    const std::optional<Shard> shard = a->shard.empty() ? std::nullopt : std::optional(parseShard(a->shard, "--shard"));
    const SynthSpec spec = readSynthSpec(a->spec);
    if (shard) {
      const SynthPart part = synthesisePart(spec, a->out, *shard, "glint " GLINT_VERSION, context.progress());
      for (const std::string& warning : part.warnings) context.warn(warning);
      context.print(part.file.string() + ": " + std::to_string(part.frames) + " frames, " + std::to_string(part.highlights) +
                    " highlights\n");
      return kDone;  // whether any frame shows a highlight is known when all parts are merged
    }
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
