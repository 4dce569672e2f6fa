// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>

#include "cli/commands.h"
#include "core/base/shard.h"
#include "core/report/evaluation_part.h"
#include "core/scene/outputs.h"
#include "core/synth/part.h"
#include "core/trials/part.h"

namespace glint::cli {
namespace {

struct MergeArguments {
  std::vector<std::string> parts;
  std::string out;
};

Outputs outputsBeside(const std::vector<std::string>& parts) { return Outputs({parts.begin(), parts.end()}); }

int mergeEvaluation(const MergeArguments& a, const Context& context) {
  outputsBeside(a.parts).file(a.out, "--out", OutputKind::document("glint_evaluation"));
  const MergedEvaluation whole = mergedEvaluation(a.parts);
  context.write(a.out, whole.json);
  if (a.out != "-")
    context.print(a.out + ": " + std::to_string(a.parts.size()) + " parts, " + std::to_string(whole.frames) + " frames\n");
  if (!whole.reason.empty()) throw CannotAnswer{{Reason::NotReached, whole.reason}};
  return kDone;
}

int mergeSynth(const MergeArguments& a, const Context& context) {
  if (std::filesystem::path(a.out).filename() != "scene.json")
    throw InputError("", "--out " + a.out, "must be the scene.json of the folder in which the shards wrote their frames");
  outputsBeside(a.parts).file(a.out, "--out", OutputKind::document("glint_scene"));
  const MergedSynth whole = mergedSynth(a.parts, a.out);
  context.write(a.out, whole.sceneJson);
  context.print(a.out + ": " + std::to_string(whole.frames) + " frames, " + std::to_string(whole.highlights) + " highlights\n");
  if (whole.highlights == 0) throw CannotAnswer{{Reason::NoHighlight, "no frame shows a highlight"}};
  return kDone;
}

int mergeTradeoff(const MergeArguments& a, const Context& context) {
  outputsBeside(a.parts).file(a.out, "--out", OutputKind::document("glint_tradeoff"));
  const Tradeoff whole = mergedTradeoff(a.parts);
  context.write(a.out, tradeoffJson(whole));
  if (a.out != "-") context.print(tradeoffTable(whole));
  if (!whole.chosen) throw CannotAnswer{{Reason::NotReached, whole.reason}};
  return kDone;
}

}  // namespace

Command mergeCommand() {
  const auto a = std::make_shared<MergeArguments>();
  Command c;
  c.name = "merge";
  c.summary = "Put the parts of a work together that --shard divided";
  c.description =
      "Writes what one run would have written, to the last bit except for times, from the parts that evaluate, synth or\n"
      "tradeoff wrote with --shard i/n, on this machine or others. All parts must be there once, whole, of the same version, "
      "request and inputs; else the\n"
      "message names the part and nothing is written.";
  c.examples =
      "  glint evaluate scene.json --shard 1/2 --json part-1.json\n"
      "  glint evaluate scene.json --shard 2/2 --json part-2.json\n"
      "  glint merge part-1.json part-2.json -o evaluation.json\n"
      "  glint merge DIR/parts/*.json -o DIR/scene.json             a synthetic scene\n";
  c.declare = [a](Options& o) {
    o.positionals(a->parts, "PART", "Parts in any order, all of one work");
    o.required(a->out, "-o,--out", "FILE", "The whole (- = standard output)");
  };
  c.run = [a](const Context& context) -> int {
    const std::string kind = kindOfPart(a->parts.front());
    if (kind == "glint_evaluation") return mergeEvaluation(*a, context);
    if (kind == "glint_tradeoff") return mergeTradeoff(*a, context);
    if (kind == "glint_synth") return mergeSynth(*a, context);
    throw InputError(a->parts.front(), "", "holds \"" + kind + "\", which this version does not merge");
  };
  return c;
}

}  // namespace glint::cli
