// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/retexture.h"

#include <filesystem>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/app/session.h"
#include "core/base/number_text.h"
#include "core/highlight/report.h"
#include "core/report/texts.h"
#include "core/retexture/wish.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

struct RetextureArguments : RetextureWish {
  std::string frame, exclude, out, marks;
  std::vector<std::string> set;
  SceneArguments places;
};

void checkOutputs(const RetextureArguments& a, const Scene& scene) {
  const std::string& given = a.texture.empty() ? a.background : a.texture;
  Outputs outputs(a.session, scene);
  outputs.file(a.out, "--out", OutputKind::png());
  outputs.file(a.marks, "--marks", OutputKind::png());
  if (given.empty()) return;
  Outputs picture(std::vector<std::filesystem::path>{given});
  picture.file(a.out, "--out", OutputKind::png());
  picture.file(a.marks, "--marks", OutputKind::png());
}

std::string summary(const Retextured& result, const Scene& scene, int frame, const std::string& model) {
  std::string text = formatted("frame %s, model %s\n", scene.frames[std::size_t(frame)].id.c_str(), model.c_str());
  text += formatted("%-12s %-20s %9s %9s %9s %6s %9s\n", "light", "fall by", "red", "green", "blue", "views", "spread");
  for (const PredictedRadiance::OfLight& l : result.lights)
    text += formatted("%-12.40s %-20s %9.4f %9.4f %9.4f %6d %8.1f%%\n", l.light.c_str(), nameOf(l.appearance.kind),
                      l.appearance.strength(0), l.appearance.strength(1), l.appearance.strength(2), l.appearance.views,
                      100 * l.appearance.spread);
  return text;
}

int run(RetextureArguments& a, const Context& context) {
  requireAnswerable(a);
  const OpenedSession opened = a.places.openSession(a.session);
  for (const std::string& w : opened.session.warnings) context.warn(w);
  if (!opened.warning.empty()) context.warn(opened.warning);
  const Scene& scene = *opened.scene;
  const std::vector<int> frames = parseFrames(a.frame, scene, "--frame");
  if (frames.size() != 1) throw InputError("", "--frame", "\"" + a.frame + "\" must name exactly one frame");
  checkOutputs(a, scene);
  InspectionRequest request = opened.session.request;
  applyEach(request.settings, a.set);
  exclude(a.exclude, *opened.scene, request);
  a.shown = opened.session.view.model;
  const RetexturedFrame made = retextureAsWished(opened.scene, request, frames[0], a, context.progress());
  if (!made.result) {
    requireUsableViews(made.inspection);
    throw CannotAnswer{made.result.failure()};
  }
  for (const std::string& w : warningsOf(made.inspection)) context.warn(w);
  for (const std::string& remark : made.result->remarks) context.warn(remark);
  warnOfUnusedTrainingFrames(made.inspection, context);
  if (!a.marks.empty()) writePng(a.marks, markPicture(*made.result));
  writePng(a.out, made.result->picture);
  context.wrote(a.out);
  context.print(summary(*made.result, scene, frames[0], made.model));
  return kDone;
}

}  // namespace

Command retextureCommand() {
  const auto a = std::make_shared<RetextureArguments>();
  Command c;
  c.name = "retexture";
  c.summary = "Put a predicted highlight over another texture or background, or remove the observed one";
  c.description =
      "Opens a session, predicts the highlights of one frame with one model, and writes a picture of it in sRGB:\n"
      "  --background FILE   the highlight over a picture without it, of the frame's size\n"
      "  --texture FILE      the frame with this texture on its surface, shaded like the frame, and the highlight over it\n"
      "  --remove            the frame without its highlight, filled from around it; no highlight is put over it\n"
      "Colour, strength and fall of the highlight are learned from the training frames' photographs; everything is added in\n"
      "linear light. Warnings name each assumption that may not hold. The table shows the highlight's strength in linear light\n"
      "(1 = the largest code) and how much it differs between the training views.";
  c.examples =
      "  glint retexture run.glint --frame 0012 --texture wood.png -o wood.png\n"
      "  glint retexture run.glint --frame 0012 --model reflectance --background clean.png -o composite.png\n"
      "  glint retexture run.glint --frame 0012 --remove -o plain.png\n";
  c.declare = [a](Options& o) {
    o.positional(a->session, "FILE.glint", "A session written by `glint reconstruct` or the inspector");
    o.required(a->frame, "--frame", "ID", "The frame: id or number");
    o.required(a->out, "-o,--out", "PNG", "The picture to write");
    o.option(a->exclude, "--exclude", "SPEC", kExcludeHelp);
    o.option(a->texture, "--texture", "FILE", "A picture that becomes the surface's albedo");
    o.option(a->background, "--background", "FILE", "A picture of this frame without the highlight, of the frame's size");
    o.flag(a->remove, "--remove", "Remove the observed highlight");
    o.option(a->model, "--model", "NAME", "The model that predicts (default: the one that the session shows, else its richest)");
    o.option(a->light, "--light", "ID", "One light alone (default: all of the frame)");
    o.choice(a->mapping, "--mapping", kTextureMappings,
             "How the texture lies: natural = the surface's own coordinates, for meshes and depth maps box");
    o.option(a->repeat, "--repeat", "N", "How many textures in place of one, in both directions");
    o.option(a->albedo, "--albedo", "A",
             "Albedo of the surface as it was, 0 to 1; the texture's values are then albedos (default: its mean takes the place "
             "of it)");
    o.choice(a->shading, "--shading", kShadingSources,
             "Under the texture: lambert = a matt surface under the estimated lights, frame = the frame without its highlight; "
             "none = the texture already holds the light (glint texture); auto = lambert where the model knows a light");
    o.option(a->marginPx, "--margin", "PX", "How far beyond its visible part a highlight is removed, px");
    o.option(a->marks, "--marks", "PNG",
             "Write which pixels the highlight changes: white = predicted (or filled), grey = extrapolated, black = none");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name; may be repeated");
    a->places.declareForSession(o);
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
