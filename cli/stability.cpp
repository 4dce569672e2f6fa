// SPDX-License-Identifier: BSD-3-Clause
#include "core/stability/stability.h"

#include <algorithm>

#include "cli/commands.h"
#include "core/scene/outputs.h"

namespace glint::cli {

Command stabilityCommand() {
  struct Arguments {
    std::string json, stage;
    bool markdown = false;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "stability";
  c.summary = "Check the numerics at extremes against higher-precision references";
  c.description =
      "Light at a billion metres, curvature of 1e-9 per metre, a thousand views, flat ellipsoids, NaN in every input ...: each\n"
      "case is compared with an independent fifty-digit reference. The verdict is accurate, named failure (where no unique\n"
      "answer exists) or wrong. Exit code 1 when any case is wrong.";
  c.examples =
      "  glint stability                    the table\n"
      "  glint stability --stage conic      one stage alone\n"
      "  glint stability --json -           JSON for a script\n"
      "  glint stability --markdown         the table of docs/stability.md, with the reasons of its limits\n";
  c.declare = [a](Options& o) {
    o.option(a->json, "--json", "FILE", "Write all cases as JSON (- = standard output, replaces the table)");
    o.option(a->stage, "--stage", "NAME", "Run only the cases of one stage, as the table names it");
    o.flag(a->markdown, "--markdown", "Print the table for the documentation");
  };
  c.run = [a](const Context& context) -> int {
    Outputs(std::vector<std::filesystem::path>{}).file(a->json, "--json", OutputKind::document("glint_stability"));
    const std::vector<StabilityResult> results = runStability(context.progress(), a->stage);
    if (!a->json.empty()) context.write(a->json, stabilityJson(results));
    if (a->json != "-") context.print(a->markdown ? stabilityMarkdown(results) : stabilityTable(results));
    const bool wrong =
        std::any_of(results.begin(), results.end(), [](const StabilityResult& r) { return r.verdict == CaseVerdict::Wrong; });
    return wrong ? kComparisonFailed : kDone;
  };
  return c;
}

}  // namespace glint::cli
