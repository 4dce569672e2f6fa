// SPDX-License-Identifier: BSD-3-Clause
#include "viz/solver_runs.h"

#include "core/base/number_text.h"
#include "core/base/words.h"
#include "viz/glyphs.h"
#include "viz/layers.h"

namespace glint::viz {
namespace {

constexpr double kFarPlace = 4;  ///< in scene sizes, as for estimates: beyond, an arrow shows the direction

/// A place of a run: itself, or for one that is far or at infinity a place beside the scene in its direction.
struct Shown {
  Eigen::Vector3d at;
  bool far = false;
};
Shown shownAt(const LayerInput& in, const Eigen::Vector4d& place) {
  const Eigen::Vector3d middle = in.scale.sceneBox.center();
  if (place.w() != 0) {
    const Eigen::Vector3d at = place.hnormalized();
    if ((at - middle).norm() <= kFarPlace * in.scale.sceneSize) return {at};
  }
  const Eigen::Vector3d towards = place.head<3>() - place.w() * middle;
  return {middle + in.scale.sceneSize * towards.normalized(), true};
}

Picked infoOf(const DrawnRuns& of, const SolverRun& run) {
  Picked info;
  info.layer = "solver-runs";
  info.model = of.model;
  info.light = of.light;
  info.text = line("run of a solver", run.what) + line("ended", run.ending) + line("steps", double(run.steps()));
  if (!run.rounds.empty() && !run.rounds.back().empty())
    info.text += line("cost, last round", formatted("%.4g", run.rounds.back().front()) +
                                              formatted(" -> %.4g %s", run.rounds.back().back(), run.unit.c_str()));
  return info;
}

void addRun(LayerContent& content, const LayerInput& in, const DrawnRuns& of, const SolverRun& run) {
  if (!run.start || !run.end) return;
  const Shown from = shownAt(in, *run.start), to = shownAt(in, *run.end);
  const Colour colour = run.answer ? modelColour(of.model) : in.ink();
  const double r = (run.answer ? 1.0 : 0.6) * in.scale.point, width = run.answer ? 3 : 1;
  const Picked info = infoOf(of, run);
  // The start is hollow, the end is full.
  const Eigen::Affine3d ball(Eigen::Translation3d(from.at) * Eigen::Scaling(r));
  content.add(lineActor(principalEllipses(ball), colour, width), info, width);
  content.add(sphereActor({to.at}, r, colour), info);
  content.add(segmentActor({{from.at, to.at}}, colour, width), info, width);
  content.extent.push_back(from.at);
  content.extent.push_back(to.at);
  if (!run.answer || in.selection.model != of.model) return;  // of several models they would cover the scene
  const auto label = [&](const Shown& s, const char* what) {
    content.labels.push_back({s.at,
                              std::string(what) + " of " + (run.what.rfind("ellipsoid", 0) == 0 ? "ellipsoid, " : "") +
                                  lightName(of.light) + (s.far ? " (far away)" : ""),
                              colour});
  };
  if ((from.at - to.at).norm() > 4 * r) label(from, "start");
  label(to, "end");
}

}  // namespace

LayerContent solverRunsLayer(const LayerInput& in) {
  LayerContent content;
  if (!in.runs) return content;
  for (const DrawnRuns& of : *in.runs) {
    if (in.hidden.lights.count(of.light)) continue;
    if (!in.selection.model.empty() ? of.model != in.selection.model
                                    : std::find(in.models.begin(), in.models.end(), of.model) == in.models.end())
      continue;
    for (const SolverRun& run : of.runs) addRun(content, in, of, run);
  }
  return content;
}

}  // namespace glint::viz
