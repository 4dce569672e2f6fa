// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/app/session.h"
#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/report/texts.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

std::string vectorText(const Eigen::Vector3d& v) { return formatted("%.6g %.6g %.6g", v.x(), v.y(), v.z()); }

std::string fitText(const ModelResult::Fit& entry, const std::string& model) {
  std::string out = model + ", " + lightName(entry.light) + (entry.surface ? ", surface " + *entry.surface : "") + ": ";
  if (entry.failure()) return out + entry.failure()->message() + "\n";
  const ModelFit& f = *entry.fit;
  out += std::to_string(f.frames.size()) + " views, " + f.solver + "\n";
  if (!f.poor.empty()) out += "  poor              " + f.poor + "\n";
  const EllipsoidFit* const fitted = f.as<EllipsoidFit>();
  if (f.ellipsoid()) {
    out += "  ellipsoid centre  " + vectorText(f.ellipsoid()->centre()) + " m\n";
    out += "  semi-axes         " + vectorText(f.ellipsoid()->semiAxes()) + " m\n";
  } else if (fitted) {
    out += "  Q* is not an ellipsoid: " + std::string(describe(fitted->quadric)) + "\n";
  }
  if (f.lightEstimate && !f.lightEstimate->atInfinity())
    out += "  light             " + vectorText(f.lightEstimate->position()) + " m\n";
  if (f.lightEstimate && f.lightEstimate->atInfinity())
    out += "  light             at infinity, towards " + vectorText(f.lightEstimate->homogeneous().head<3>()) + "\n";
  if (f.limitAngle()) {
    out += formatted("  limit angle       %.6g deg\n", *f.limitAngle() * 180 / M_PI);
  }
  if (const ReflectanceFit* const lobe = f.as<ReflectanceFit>()) {
    for (const LampFact& fact : f.lamp() ? factsOf(*f.lamp()) : std::vector<LampFact>())
      out += formatted("  light %-11s ", fact.name.c_str()) +
             (fact.value.size() == 1 ? formatted("%.6g", fact.value(0)) : vectorText(fact.value)) + " m\n";
    out += formatted("  lobe              %s, m = %.6g\n", nameOf(lobe->lobe), lobe->roughness.mean);
  }
  if (fitted && !fitted->singularValues.empty()) {
    out += formatted("  gap ratio         %.3g, condition %.3g\n", fitted->gapRatio, f.condition);
  }
  if (!f.residualPx.empty()) {
    out += "  residuals         ";
    for (std::size_t i = 0; i < f.residualPx.size(); ++i) {
      out += formatted("%s%.3g", i ? ", " : "", f.residualPx[i]);
    }
    out += " px\n";
  }
  return out;
}

}  // namespace

Command reconstructCommand() {
  struct Arguments : InspectionArguments {
    std::string out;
  };
  const auto a = std::make_shared<Arguments>();
  Command c;
  c.name = "reconstruct";
  c.summary = "Fit a model to training frames and save a session";
  c.description =
      "Finds the highlights, fits the model to the training frames and writes a session (*.glint): the inputs with their\n"
      "hashes, every setting, the frames and the results. `glint predict`, `glint render`, `glint replay` and\n"
      "glint-inspector open it.";
  c.examples =
      "  glint reconstruct scene.json --model canonical -o canonical.glint\n"
      "  glint reconstruct scene.json --model limit-angle --train spread:6 -o run.glint\n";
  c.declare = [a](Options& o) {
    a->declare(o, "Model to fit: " + modelNames() + " (default: all)");
    o.required(a->out, "-o,--out", "FILE.glint", "The session to write");
  };
  c.run = [a](const Context& context) -> int {
    if (a->models == "auto")
      throw InputError("", "--model auto", "not available here; choose a model with `glint evaluate --models auto` first");
    InspectionRequest request = a->request();
    std::string levelReason;
    const std::shared_ptr<const Scene> scene = a->scene(request, &levelReason);
    for (const std::string& w : scene->warnings) context.warn(w);
    Outputs(a->input, *scene).file(a->out, "--out", OutputKind::document("glint_session"));
    const Inspection result = inspect(scene, request, context.progress());
    std::string text = levelReason.empty() ? "" : levelReason + "\n";
    std::optional<Failure> first;
    bool any = false;
    for (const std::string& name : request.models)
      for (const ModelResult::Fit& f : result.models.at(name).fits) {
        text += fitText(f, name);
        any = any || f.fit;
        if (f.failure() && !first)
          first = Failure{f.failure()->reason, name + ", " + lightName(f.light) + ": " + f.failure()->detail};
      }
    if (!any) {
      requireUsableViews(result);
      throw CannotAnswer{first.value_or(Failure{Reason::NoHighlight, "no light"})};
    }
    warnOfUnusedTrainingFrames(result, context);
    for (const std::string& w : warningsOf(result)) context.warn(w);
    Session session = sessionOf(result, context.progress());
    session.file = a->out;
    session.notes = levelReason;
    writeSession(session, a->out);
    context.wrote(a->out);
    context.print(text);
    return kDone;
  };
  return c;
}

}  // namespace glint::cli
