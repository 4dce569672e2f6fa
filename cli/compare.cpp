// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/scene_arguments.h"
#include "core/report/compare_runs.h"
#include "core/scene/outputs.h"

namespace glint::cli {

Command compareCommand() {
  struct Arguments {
    std::string a, b, json;
    bool all = false;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "compare";
  c.summary = "List the differences between two sessions: inputs, settings, results, error of each frame";
  c.description =
      "Recomputes both sessions and compares them: input files by hash, training and excluded frames, models, settings\n"
      "with their units, what-if, key results, and the contour error of every frame that either session has (frames\n"
      "match when their ids match). Differences are not an error: the exit code is 0.";
  c.examples =
      "  glint compare before.glint after.glint              list the differences\n"
      "  glint compare before.glint after.glint --all --json both.json\n";
  c.declare = [a](Options& o) {
    o.positional(a->a, "A.glint", "The first session");
    o.positional(a->b, "B.glint", "The second session");
    o.flag(a->all, "--all", "Also list equal values");
    a->places.declareForSession(o);
    o.option(a->json, "--json", "FILE", "Write the comparison as JSON (- = standard output, replaces the text)");
  };
  c.run = [a](const Context& context) -> int {
    const auto opened = [&](const std::string& file) {
      OpenedSession session = a->places.openSession(file);
      for (const std::string& w : session.session.warnings) context.warn(w);
      Outputs(file, *session.scene).file(a->json, "--json", OutputKind::document("glint_comparison"));
      return session;
    };
    const OpenedSession openedA = opened(a->a), openedB = opened(a->b);
    const auto computed = [&](const OpenedSession& o) { return inspect(o.scene, o.session.request, context.progress()); };
    const Inspection first = computed(openedA), second = computed(openedB);
    const RunComparison comparison =
        compareRuns(sessionOf(first, context.progress()), first, sessionOf(second, context.progress()), second);
    if (!a->json.empty()) context.write(a->json, comparisonJson(comparison, a->a, a->b));
    if (a->json != "-") context.print("A = " + a->a + "\nB = " + a->b + "\n" + comparisonText(comparison, a->all));
    return kDone;
  };
  return c;
}

}  // namespace glint::cli
