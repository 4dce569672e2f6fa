// SPDX-License-Identifier: BSD-3-Clause
#include "core/choice/tradeoff.h"

#include <pybind11/stl.h>

#include "core/app/tradeoff_run.h"
#include "core/base/version.h"
#include "core/report/evaluation.h"
#include "core/report/report.h"
#include "plugins/python/src/arrays.h"
#include "plugins/python/src/evaluation.h"
#include "plugins/python/src/failures.h"
#include "plugins/python/src/options.h"
#include "plugins/python/src/progress.h"
#include "plugins/python/src/types.h"

namespace glint::python {
namespace {

constexpr int kMostRepeats = 1000;  // the command line's limit

struct TradeoffHandle {
  Tradeoff tradeoff;
  std::optional<Failure> failure;  ///< why nothing was chosen
};

/// Why nothing was chosen; nothing if something was.
std::optional<Failure> whyNothingChosen(const Tradeoff& t, const SceneHandle& scene, InspectionRequest request,
                                        const ProgressFn& report) {
  if (!t.points.empty()) return t.chosen ? std::nullopt : std::optional(Failure{Reason::NotReached, t.reason});
  request.models.clear();
  if (std::optional<Failure> none = noUsableView(inspect(scene.scene, request, report))) return none;
  const std::string first = t.pruned.empty() ? "" : " First: " + t.pruned.front().model + ": " + t.pruned.front().reason;
  return Failure{Reason::NotReached, t.reason + first};
}

TradeoffHandle measuredTradeoff(const SceneHandle& scene, const RequestHandle* request,
                                const std::optional<std::vector<std::string>>& models, const std::optional<std::string>& train,
                                const std::optional<std::string>& exclude, const std::optional<std::string>& level,
                                const std::optional<std::string>& source, std::optional<double> budgetUs,
                                std::optional<double> maxErrorPct, int repeats, int maxTrials, py::handle settings,
                                py::object progress) {
  InspectionRequest r = requestAsAsked(scene, request, models, train, exclude, level, source, settings);
  if (!request && !models) r.models = modelIds();
  TradeoffOptions options;
  options.bound = {budgetUs, maxErrorPct};
  if (budgetUs && !(*budgetUs > 0)) throw InputError("", "--budget-us", "expected a positive number, in microseconds");
  if (maxErrorPct && !(*maxErrorPct > 0)) throw InputError("", "--max-error-pct", "expected a positive number, in percent");
  if (budgetUs && maxErrorPct) throw InputError("", "--budget-us, --max-error-pct", "give only one of the two");
  if (repeats < 1 || repeats > kMostRepeats) throw InputError("", "--repeats", "must be between 1 and 1000");
  if (maxTrials < 1) throw InputError("", "--max-trials", "must be at least 1");
  options.repeats = repeats;
  options.search.maxTrials = maxTrials;
  options.input = scene.input;
  options.program = GLINT_VERSION;
  return withProgress(std::move(progress), [&](const ProgressFn& report) {
    chooseLevelIfAsked(*scene.scene, level, r, report);
    TradeoffHandle out;
    out.tradeoff = measureTradeoff(scene.scene, r, options, report);
    out.failure = whyNothingChosen(out.tradeoff, scene, r, report);
    return out;
  });
}

void declarePoint(py::module_& module) {
  py::class_<TradeoffPoint>(module, "TradeoffPoint", "A model with settings, and what it was measured to give.")
      .def_readonly("model", &TradeoffPoint::model, "Id of the model.")
      .def_property_readonly(
          "settings", [](const TradeoffPoint& p) { return dictOf(p.settings); }, "Every setting by its dotted name.")
      .def_readonly("frames", &TradeoffPoint::frames, "Frames with an observed highlight.")
      .def_readonly("predicted", &TradeoffPoint::predicted, "How many of them have a prediction.")
      .def_readonly("matched", &TradeoffPoint::matched, "Highlights that a prediction was compared with.")
      .def_readonly("missed", &TradeoffPoint::missed, "Observed highlights without a prediction.")
      .def_readonly("spurious", &TradeoffPoint::spurious, "Predictions without an observed highlight.")
      .def_readonly("contour_error_pct", &TradeoffPoint::contourErrorPct,
                    "Mean over matched highlights, percent of the diameter.")
      .def_readonly("iou", &TradeoffPoint::iou, "Mean over matched highlights.")
      .def_readonly("coverage", &TradeoffPoint::coverage, "Mean share of predicted directions.")
      .def_readonly("ranked_error_pct", &TradeoffPoint::rankedErrorPct, "What points are compared by: what is left out counts.")
      .def_readonly("predict_us", &TradeoffPoint::predictUs, "Microseconds for a frame, median, one thread.")
      .def_readonly("fit_us", &TradeoffPoint::fitUs, "Microseconds for light and fit, median, one thread.")
      .def_readonly("peak_mb", &TradeoffPoint::peakMb, "Most memory of this process meanwhile, 2^20 bytes; Python's counts, too.")
      .def_readonly("pareto", &TradeoffPoint::pareto, "Whether no other point beats it in both error and time.")
      .def("__repr__", [](const TradeoffPoint& p) {
        return "<glint.TradeoffPoint " + p.model + ", " + std::to_string(p.rankedErrorPct) + " %, " +
               std::to_string(p.predictUs) + " us>";
      });
}

}  // namespace

void declareTradeoff(py::module_& module) {
  declarePoint(module);
  py::class_<TradeoffHandle>(module, "Tradeoff", "Speed against accuracy on one input, as `glint tradeoff` measures it.")
      .def_property_readonly(
          "points",
          [](py::object self) {
            std::vector<const TradeoffPoint*> points;
            for (const TradeoffPoint& p : self.cast<const TradeoffHandle&>().tradeoff.points) points.push_back(&p);
            return points;
          },
          py::return_value_policy::reference_internal, "List of TradeoffPoint, fastest first.")
      .def_property_readonly(
          "presets", [](const TradeoffHandle& t) { return t.tradeoff.presets; },
          "Index of the point by name: fast, balanced, exact.")
      .def_property_readonly(
          "chosen", [](const TradeoffHandle& t) { return t.tradeoff.chosen; }, "Index of the chosen point, or None.")
      .def_property_readonly(
          "reason", [](const TradeoffHandle& t) { return t.tradeoff.reason; }, "Why it was chosen, one sentence.")
      .def_property_readonly(
          "trials", [](const TradeoffHandle& t) { return t.tradeoff.trials; }, "Settings tried on few frames.")
      .def_property_readonly(
          "measurement", [](const TradeoffHandle& t) { return t.tradeoff.measurement; }, "How time and memory were measured.")
      .def(
          "to_json", [](const TradeoffHandle& t) { return tradeoffJson(t.tradeoff); },
          "The text that `glint tradeoff --json` writes.")
      .def(
          "to_html", [](const TradeoffHandle& t) { return tradeoffHtml(t.tradeoff); },
          "The page that `glint tradeoff --html` writes.")
      .def(
          "table", [](const TradeoffHandle& t) { return tradeoffTable(t.tradeoff); }, "The table that `glint tradeoff` prints.")
      .def_property_readonly("_failure", [](const TradeoffHandle& t) { return partsOrNone(t.failure); })
      .def("__len__", [](const TradeoffHandle& t) { return t.tradeoff.points.size(); })
      .def("__repr__",
           [](const TradeoffHandle& t) { return "<glint.Tradeoff, " + std::to_string(t.tradeoff.points.size()) + " points>"; });
  module.def("_tradeoff", &measuredTradeoff);
}

}  // namespace glint::python
