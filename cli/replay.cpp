// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"
#include "cli/scene_arguments.h"
#include "core/app/session.h"
#include "core/base/number_text.h"

namespace glint::cli {

Command replayCommand() {
  struct Arguments {
    std::string session;
    bool exact = false;
    SceneArguments places;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "replay";
  c.summary = "Recompute a session and compare with its stored results";
  c.description =
      "Checks that the inputs are unchanged (SHA-256), recomputes everything and compares the key results, which agree\n"
      "when their relative difference is at most 1e-9. Exit code 1: results differ (each difference is one line on\n"
      "standard output, followed by the first stage that changed); 2: an input changed or is missing.";
  c.examples =
      "  glint replay sessions/ellipsoid/ellipsoid.glint            the same results, on any machine\n"
      "  glint replay sessions/ellipsoid/ellipsoid.glint --exact    the same bits, on the machine that saved it\n";
  c.declare = [a](Options& o) {
    o.positional(a->session, "FILE.glint", "The session to replay");
    o.flag(a->exact, "--exact", "Also compare the digest of all results");
    a->places.declareForSession(o);
  };
  c.run = [a](const Context& context) -> int {
    const Session session = readSession(a->session);
    for (const std::string& w : session.warnings) context.warn(w);
    const Replay result = a->places.replay(session, context.progress());
    std::string out;
    const std::string largest = formatted("%.2g", result.largestDifference);
    for (const std::string& line : result.differences) out += line + "\n";
    if (!result.firstChanged.empty()) out += "first changed stage: " + result.firstChanged + "\n";
    out += std::to_string(result.compared - static_cast<int>(std::min<std::size_t>(result.differences.size(), result.compared))) +
           " of " + std::to_string(result.compared) + " key results agree; digest " +
           (result.digestAgrees ? "equal" : "different") + "; largest relative difference " + largest + "\n";
    context.print(out);
    return result.differences.empty() && (!a->exact || result.digestAgrees) ? kDone : kComparisonFailed;
  };
  return c;
}

}  // namespace glint::cli
