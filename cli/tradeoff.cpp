// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/tradeoff.h"

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/app/session.h"
#include "core/app/tradeoff_run.h"
#include "core/base/number_text.h"
#include "core/base/version.h"
#include "core/report/report.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

std::optional<double> positive(const std::string& text, const std::string& flag, const std::string& what) {
  if (text.empty()) return std::nullopt;
  const std::optional<double> value = numberFrom(text);
  if (!value || !(*value > 0)) throw InputError("", flag + " " + text, "expected a positive number, in " + what);
  return value;
}

/// Beside the first file that the command writes: what an interrupted run has measured so far.
std::string workFileFor(const std::vector<std::string>& outputs) {
  for (const std::string& file : outputs)
    if (!file.empty() && file != "-") return file + ".work";
  return "";
}

struct TradeoffArguments : InspectionArguments {
  std::string budget, maxError, json, html, out, work;
  int repeats = 5, maxTrials = SearchOptions{}.maxTrials;
};

TradeoffOptions optionsFrom(const TradeoffArguments& a) {
  if (a.models == "auto")
    throw InputError("", "--models auto", "not available here; name the models to compare or omit the flag");
  if (!a.preset.empty()) throw InputError("", "--preset " + a.preset, "not available here; this command finds the presets");
  TradeoffOptions options;
  options.bound.budgetUs = positive(a.budget, "--budget-us", "microseconds");
  options.bound.maxErrorPct = positive(a.maxError, "--max-error-pct", "percent");
  if (options.bound.budgetUs && options.bound.maxErrorPct)
    throw InputError("", "--budget-us, --max-error-pct", "give only one of the two");
  if (a.repeats < 1 || a.repeats > 1000) throw InputError("", "--repeats", "must be between 1 and 1000");
  if (a.maxTrials < 1) throw InputError("", "--max-trials", "must be at least 1");
  options.repeats = a.repeats;
  options.search.maxTrials = a.maxTrials;
  options.input = a.input;
  options.program = GLINT_VERSION;
  options.workFile = a.work.empty() ? workFileFor({a.json, a.html, a.out}) : a.work;
  return options;
}

/// Why no setting was measured.
[[noreturn]] void cannotMeasure(const Tradeoff& t, const std::shared_ptr<const Scene>& scene, InspectionRequest request,
                                const Context& context) {
  request.models.clear();
  requireUsableViews(inspect(scene, request, context.progress()));
  throw CannotAnswer{{Reason::NotReached, t.pruned.empty()
                                              ? t.reason
                                              : t.reason + " First: " + t.pruned.front().model + ": " + t.pruned.front().reason}};
}

void writeChosen(const std::string& file, const Tradeoff& t, const std::shared_ptr<const Scene>& scene, InspectionRequest request,
                 const Context& context) {
  request.models = {t.points[*t.chosen].model};
  request.settings = t.points[*t.chosen].settings;
  Session session = sessionOf(inspect(scene, request, context.progress()), context.progress());
  session.tradeoff = t;
  writeSession(session, file);
  context.wrote(file);
}

int run(const TradeoffArguments& a, const Context& context) {
  const TradeoffOptions options = optionsFrom(a);
  InspectionRequest request = a.request();
  if (std::filesystem::path(a.input).extension() != ".glint" && a.models.empty()) {
    request.models.clear();
    for (const auto& m : allModels()) request.models.push_back(m->id());
  }
  std::string levelReason;
  const std::shared_ptr<const Scene> scene = a.scene(request, &levelReason);
  for (const std::string& w : scene->warnings) context.warn(w);
  Outputs outputs(a.input, *scene);
  outputs.file(a.json, "--json", OutputKind::document("glint_tradeoff"));
  outputs.file(a.html, "--html", OutputKind::page());
  outputs.file(a.out, "--out", OutputKind::document("glint_session"));
  outputs.file(options.workFile, "--work", OutputKind::document("glint_tradeoff_work"));
  const Tradeoff t = measureTradeoff(scene, request, options, context.progress());

  if (!a.json.empty()) context.write(a.json, tradeoffJson(t));
  if (!a.html.empty()) context.write(a.html, tradeoffHtml(t));
  if (t.points.empty()) cannotMeasure(t, scene, request, context);
  if (!a.out.empty() && t.chosen) writeChosen(a.out, t, scene, request, context);
  std::error_code ignored;
  if (!options.workFile.empty()) std::filesystem::remove(options.workFile, ignored);
  if (a.json != "-" && a.html != "-") context.print((levelReason.empty() ? "" : levelReason + "\n\n") + tradeoffTable(t));
  if (!t.chosen) throw CannotAnswer{{Reason::NotReached, t.reason}};
  return kDone;
}

}  // namespace

Command tradeoffCommand() {
  const auto a = std::make_shared<TradeoffArguments>();
  Command c;
  c.name = "tradeoff";
  c.summary = "Measure speed against accuracy of models and settings on this input";
  c.description =
      "Tries models and settings on the input: first on a few frames, dropping those that another setting beats, then the\n"
      "rest on all frames. Prints error, time per frame, fit time and memory of each, marks those that no other beats in both\n"
      "error and time, and chooses one: the most accurate within --budget-us, the fastest within --max-error-pct, else the\n"
      "balanced preset. Unfinished work is kept in FILE.work beside the first output file; the same command resumes from it.\n"
      "The session that -o writes has the result, too: for the inspector and --preset. INPUT stays as it is.";
  c.examples =
      "  glint tradeoff scene.json --html tradeoff.html\n"
      "  glint tradeoff scene.json --budget-us 100 -o fast.glint   a session with the chosen settings\n"
      "  glint tradeoff run.glint --max-error-pct 0.5 --json -\n"
      "  glint evaluate fast.glint --preset fast\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Models to compare (default: the session's, else all)");
    o.option(a->budget, "--budget-us", "T", "Choose the most accurate setting within this many microseconds per frame");
    o.option(a->maxError, "--max-error-pct", "E",
             "Choose the fastest setting with at most this contour error in percent; what it misses counts as 100");
    o.option(a->json, "--json", "FILE", "Write everything as JSON (- = standard output)");
    o.option(a->html, "--html", "FILE", "Write a self-contained HTML page with the Pareto front");
    o.option(a->out, "-o,--out", "FILE.glint", "Write a session with the chosen settings, their results and the Pareto front");
    o.option(a->work, "--work", "FILE", "File for unfinished work (default: beside the first output file)");
    o.option(a->repeats, "--repeats", "N", "Repeats of each timed prediction");
    o.option(a->maxTrials, "--max-trials", "N", "Maximum number of settings tried on a few frames");
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
