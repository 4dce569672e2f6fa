// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/highlight/report.h"
#include "core/model/model.h"
#include "core/retexture/surface_texture.h"
#include "core/retexture/wish.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"

namespace glint::cli {
namespace {

struct TextureArguments : InspectionArguments {
  std::string out, sure, frames, mapping = "natural", shading = "keep";
  double repeat = 1;
  int size = 0;
};

SurfaceTextureRequest wishOf(const TextureArguments& a) {
  requireRepeat(a.repeat);
  if (a.size < 0 || a.size > kWidestTexture)
    throw InputError("", "--size", "must be 1 to " + std::to_string(kWidestTexture) + " px, or 0");
  SurfaceTextureRequest r;
  r.mapping = textureMappingNamed(a.mapping);
  r.repeat = a.repeat;
  r.width = a.size;
  r.withoutShading = a.shading == "remove";
  return r;
}

std::string summary(const SurfaceTexture& t, const TextureArguments& a) {
  std::vector<int> views;
  std::vector<float> codes;
  for (std::size_t i = 0; i < t.views.size(); ++i) {
    if (t.views[i] == 0) continue;
    views.push_back(t.views[i]);
    codes.push_back(t.codes[i]);
  }
  std::string text =
      formatted("%d x %d texels by %s, from %d frames\n", t.colour.width, t.colour.height, t.words.c_str(), t.frames);
  text += formatted("%.1f %% of them are seen, by %d views (median) that differ by %.1f codes of 8 bits (median)\n",
                    100 * double(views.size()) / double(t.views.size()), views.empty() ? 0 : upperMedian(views),
                    codes.empty() ? 0 : double(upperMedian(codes)));
  text += "glint retexture puts it back with --texture FILE --shading ";
  text += a.shading == "remove" ? formatted("lambert --albedo %.4f", t.albedo) : "none";
  if (a.mapping != "natural") text += " --mapping " + a.mapping;
  if (a.repeat != 1) text += formatted(" --repeat %g", a.repeat);
  return text + "\n";
}

int run(const TextureArguments& a, const Context& context) {
  SurfaceTextureRequest wish = wishOf(a);
  InspectionRequest request = a.request();
  const std::shared_ptr<const Scene> scene = a.scene(request);
  for (const std::string& w : scene->warnings) context.warn(w);
  if (!a.frames.empty()) wish.frames = parseFrames(a.frames, *scene, "--frames");
  Outputs outputs(a.input, *scene);
  outputs.file(a.out, "--out", OutputKind::png());
  outputs.file(a.sure, "--sure", OutputKind::png());
  // Highlights of every frame; lights only where shading is asked for.
  request.models.clear();
  if (wish.withoutShading) request.models = {levelSetModel().id()};
  request.noisePx = 0;
  const Outcome<SurfaceTexture> made = surfaceTexture(inspect(scene, request, context.progress()), wish, context.progress());
  if (!made) throw CannotAnswer{made.failure()};
  for (const std::string& remark : made->remarks) context.warn(remark);
  if (!a.sure.empty()) writePng(a.sure, surePicture(*made));
  writePng(a.out, texturePicture(*made));
  context.wrote(a.out);
  context.print(summary(*made, a));
  return kDone;
}

}  // namespace

Command textureCommand() {
  const auto a = std::make_shared<TextureArguments>();
  Command c;
  c.name = "texture";
  c.summary = "Write the colour of the surface without its highlights, in the coordinates of `retexture --texture`";
  c.description =
      "Finds the highlights in every frame and writes a picture of the surface's colour, sRGB with alpha: each texel is the\n"
      "mean of the middle half of the best views that see it beside their highlights. Exposures are brought to one; texels\n"
      "that no view sees are transparent. The picture lies as `glint retexture --texture` lays it, which puts it back.";
  c.examples =
      "  glint texture scene.json -o colour.png\n"
      "  glint texture run.glint --shading remove --sure sure.png -o albedo.png\n"
      "  glint texture mesh/scene.json --mapping spherical --size 2048 -o colour.png\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "INPUT",
                 "Scene file, capture of another program (COLMAP, nerfstudio ...), folder that contains one, or session");
    o.required(a->out, "-o,--out", "PNG", "The picture to write");
    o.option(a->sure, "--sure", "PNG",
             "Write how sure each texel is: red = the number of views, green = by how many codes of 8 bits they differ");
    o.option(a->frames, "--frames", "SPEC", "Frames to take it from: numbers, ids or ranges (default: all)");
    o.choice(a->mapping, "--mapping", kTextureMappings,
             "How the texture lies: natural = the surface's own coordinates, for meshes and depth maps box");
    o.option(a->repeat, "--repeat", "N", "How many textures in place of one, in both directions");
    o.option(a->size, "--size", "W", "Width of the picture, px; 0 = as fine as the frames, a power of two");
    o.choice(a->shading, "--shading", {"keep", "remove"},
             "remove = divide out the shading of a matt surface under the estimated lights, frame by frame");
    o.option(a->train, "--train", "SPEC", "Frames that tell the lights (default: the session's, else first:6)");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name; may be repeated");
    a->places.declare(o);
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
