// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/scene_arguments.h"
#include "core/advise/camera_check.h"
#include "core/scene/convention_report.h"
#include "core/scene/outputs.h"
#include "core/scene/scene.h"

namespace glint::cli {

Command infoCommand() {
  struct Arguments {
    std::string input, json;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "info";
  c.summary = "Report what was recognised and check its conventions";
  c.description =
      "Reads the scene, every surface and every image, and checks the result against the data: how many vertices of the\n"
      "surface project inside each frame, whether depth maps agree with the surface (median and 95 %), and which images\n"
      "contain NaN or negative values. Each problem is listed as a finding with its likely cause.";
  c.examples =
      "  glint info scene.json                 the report as text\n"
      "  glint info DIR --json -               the same as JSON on standard output\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT",
                 "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
    o.option(a->json, "--json", "FILE", "Write the report as JSON instead of text (- = standard output)");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) -> int {
    const Scene scene = a->places.read(a->input);
    Outputs(a->input, scene).file(a->json, "--json", OutputKind::document("glint_info"));
    const ConventionReport report = fullReport(scene, context.progress());
    if (a->json.empty())
      context.print(toText(report));
    else
      context.write(a->json, toJson(report));
    if (!report.anyFrameSeesSurface())
      throw CannotAnswer{{Reason::NoSurface, scene.file.string() + ": no camera sees a surface"}};
    return kDone;
  };
  return c;
}

}  // namespace glint::cli
