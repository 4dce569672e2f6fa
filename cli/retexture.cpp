// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/retexture.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/number_text.h"
#include "core/highlight/report.h"
#include "core/inspect/frame_score.h"
#include "core/report/warnings.h"
#include "core/retexture/picture_file.h"
#include "core/scene/frame_spec.h"
#include "core/scene/outputs.h"
#include "core/session/session.h"

namespace glint::cli {
namespace {

struct RetextureArguments {
  std::string session, frame, exclude, texture, background, out, marks, model, light, mapping = "natural", shading = "auto";
  bool remove = false;
  double repeat = 1, albedo = 0, margin = 4;
  std::vector<std::string> set;
  SceneArguments places;
};

constexpr double kMostRepeats = 1e4;     // more textures than a frame has pixels
constexpr double kLargestMargin = 1000;  // px

/// One of the three, and numbers in their ranges: said before anything is computed.
void check(const RetextureArguments& a) {
  const int asked = int(!a.texture.empty()) + int(!a.background.empty()) + int(a.remove);
  if (asked != 1) throw InputError("", "retexture", "give one of --texture FILE, --background FILE and --remove");
  if (!(a.repeat > 0 && a.repeat <= kMostRepeats)) throw InputError("", "--repeat", "must be above 0, at most 10000");
  if (!(a.albedo >= 0 && a.albedo <= 1)) throw InputError("", "--albedo", "must be above 0, at most 1");
  if (!(a.margin >= 0 && a.margin <= kLargestMargin)) throw InputError("", "--margin", "must be 0 to 1000 px");
}

/// The model asked for, the one that the session shows, or the richest of its models.
std::string modelFor(const RetextureArguments& a, const Session& session) {
  if (!a.model.empty()) return modelByName(a.model).id();
  const std::vector<std::string>& models = session.request.models;
  if (std::find(models.begin(), models.end(), session.view.model) != models.end()) return session.view.model;
  std::string richest;
  for (const std::string& name : modelIds())
    if (std::find(models.begin(), models.end(), name) != models.end()) richest = name;
  if (richest.empty()) throw InputError(a.session, "--model", "the session names no model; give one");
  return richest;
}

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

RetextureRequest requestOf(const RetextureArguments& a, const std::string& model, const Camera& camera) {
  RetextureRequest r;
  r.model = model;
  r.light = a.light;
  r.mapping = textureMappingNamed(a.mapping);
  r.shading = shadingSourceNamed(a.shading);
  r.repeat = a.repeat;
  if (a.albedo > 0) r.albedo = a.albedo;
  r.marginPx = a.margin;
  r.base = a.remove ? RetextureBase::Removed : a.texture.empty() ? RetextureBase::Background : RetextureBase::Texture;
  if (r.base == RetextureBase::Texture) r.picture = readTexture(a.texture, "--texture");
  if (r.base == RetextureBase::Background) r.picture = readBackground(a.background, camera, "--background");
  return r;
}

/// A light that no frame nor fit names is a slip of the pen, not a lack of data.
void requireLight(const std::string& light, const Inspection& inspection, const std::string& model) {
  if (light.empty()) return;
  std::set<std::string> known;
  for (const ModelResult::Fit& f : inspection.models.at(model).fits) known.insert(f.light);
  if (known.count(light)) return;
  std::string names;
  for (const std::string& id : known) names += (names.empty() ? "" : ", ") + id;
  throw InputError("", "--light", "there is no light \"" + light + "\"" + (names.empty() ? "" : "; the model has " + names));
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

int run(const RetextureArguments& a, const Context& context) {
  check(a);
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
  const std::string model = modelFor(a, opened.session);
  request.models = {model};
  const RetextureRequest wanted = requestOf(a, model, scene.frames[std::size_t(frames[0])].camera);
  const Inspection inspection = inspectOneFrame(opened.scene, request, frames[0], context.progress());
  requireLight(a.light, inspection, model);
  const Outcome<Retextured> result = retexture(inspection, frames[0], wanted, context.progress());
  if (!result) {
    requireUsableViews(inspection);
    const Failure& f = result.failure();
    throw CannotAnswer{
        {f.reason, model + ", frame " + scene.frames[std::size_t(frames[0])].id + (f.detail.empty() ? "" : ": " + f.detail)}};
  }
  for (const std::string& w : warningsOf(inspection)) context.warn(w);
  for (const std::string& remark : result->remarks) context.warn(remark);
  warnOfUnusedTrainingFrames(inspection, context);
  if (!a.marks.empty()) writePng(a.marks, markPicture(*result));
  writePng(a.out, result->picture);
  context.wrote(a.out);
  context.print(summary(*result, scene, frames[0], model));
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
             "auto = lambert where the model knows a light");
    o.option(a->margin, "--margin", "PX", "How far beyond its visible part a highlight is removed, px");
    o.option(a->marks, "--marks", "PNG",
             "Write which pixels the highlight changes: white = predicted (or filled), grey = extrapolated, black = none");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name; may be repeated");
    a->places.declareForSession(o);
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
