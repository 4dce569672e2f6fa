// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "cli/picture_input.h"
#include "core/pipeline/photograph.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"
#include "viz/offscreen.h"
#include "viz/pictures.h"
#include "viz/scene_view.h"

namespace glint::cli {
namespace {

struct RenderArguments : PictureInput {
  std::string view = "scene", frame, size = "1600x1000", out;
  bool through = false;
};

Image scenePicture(const RenderArguments& a, const PictureInput::Opened& opened,
                   const std::shared_ptr<const Inspection>& inspection, int frame, int width, int height) {
  // Checks the display before anything is drawn.
  Outcome<std::unique_ptr<viz::Offscreen>> target = viz::Offscreen::create(width, height);
  if (!target) throw CannotAnswer{target.failure()};
  viz::SceneView view;
  a.apply(view, opened, inspection);
  view.setSelection({frame, opened.saved.model, opened.saved.highlight});
  if (a.through) view.setEye(viz::Eye::Camera);  // of the selected frame
  return (*target)->render(view);
}

/// A picture that could only repeat an error is refused with that error. The scene in 3D is always worth drawing: it shows
/// why no camera sees the surface.
void requireContent(const RenderArguments& a, const Inspection& inspection, int frame) {
  const auto predicted = [&](const FrameComparison& c) { return !c.prediction.highlights().empty(); };
  if (a.view == "plots") {
    for (const auto& [name, model] : inspection.models)
      if (std::any_of(model.frames.begin(), model.frames.end(), predicted)) return;
    requireUsableViews(inspection);
    throw CannotAnswer{{Reason::NotReached, "no model predicted a highlight"}};
  }
  if (a.view == "scene") return;
  const Outcome<Image> photograph = photographOf(inspection, frame);
  if (photograph || !inspection.evidence[static_cast<std::size_t>(frame)].scored().empty()) return;
  for (const auto& [name, model] : inspection.models)
    for (const FrameComparison& c : model.frames)
      if (c.frame == frame && predicted(c)) return;
  throw CannotAnswer{photograph.failure()};
}

int run(const RenderArguments& a, const Context& context) {
  const auto [width, height] = parseSize(a.size);
  const PictureInput::Opened opened = a.open(context);
  const Scene& scene = *opened.scene;
  Outputs(a.input, scene).file(a.out, "--out", OutputKind::png());
  std::optional<int> frame;
  const std::string wanted = a.frame.empty() ? opened.saved.frame : a.frame;
  if (!wanted.empty()) {
    const std::vector<int> frames = parseFrames(wanted, scene, "--frame");
    if (frames.size() != 1) throw InputError("", "--frame", "\"" + wanted + "\" must name exactly one frame");
    frame = frames[0];
  }
  const auto inspection = std::make_shared<const Inspection>(inspect(opened.scene, opened.request, context.progress()));
  if (!frame) frame = firstHeldOut(*inspection);
  viz::PictureOptions options;
  options.models = opened.models;
  options.dark = a.dark();
  Image picture;
  requireContent(a, *inspection, *frame);
  if (a.view == "scene") {
    picture = scenePicture(a, opened, inspection, *frame, width, height);
  } else if (a.view == "plots") {
    picture = viz::plotsPicture(*inspection, width, height, options);
  } else {
    const Outcome<Image> photograph = photographOf(*inspection, *frame);
    picture = a.view == "frame" ? viz::framePicture(*inspection, *frame, photograph, width, height, options)
                                : viz::ladderPicture(*inspection, *frame, photograph, width, height, options);
  }
  viz::writePng(picture, a.out);
  context.wrote(a.out);
  warnOfUnusedTrainingFrames(*inspection, context);
  return kDone;
}

}  // namespace

Command renderCommand() {
  const auto a = std::make_shared<RenderArguments>();
  Command c;
  c.name = "render";
  c.summary = "Draw the scene, a frame, the models side by side or the errors as a PNG";
  c.description =
      "Computes a scene or session and draws it without opening a window.\n"
      "  scene    in 3D: surface, cameras with their photographs, virtual cameras, lights, ellipsoids, contours\n"
      "  frame    one photograph with the observed contour and each model's prediction\n"
      "  ladder   the same frame for each model, side by side, with its error below\n"
      "  plots    contour error over frames, one line per model\n"
      "frame, ladder and plots need no display. scene starts a private virtual display (Xvfb) and stops it afterwards;\n"
      "without Xvfb it uses DISPLAY, and without that it ends with exit code 3.\n"
      "Scene layers (* = shown by default):\n  ";
  for (const viz::Layer& layer : viz::sceneLayers()) c.description += layer.name + (layer.onByDefault ? "* " : " ");
  c.examples =
      "  glint render scene.json -o scene.png                                   the scene in 3D\n"
      "  glint render scene.json --view frame --frame 0012 -o frame.png         one frame with its overlay\n"
      "  glint render scene.json --view ladder --size 2000x700 -o ladder.png    one tile per model\n"
      "  glint render a.glint --layers=none,+surface,+rays,+light -o rays.png   chosen layers\n";
  c.declare = [a](Options& o) {
    a->declare(o);
    o.required(a->out, "-o,--out", "PNG", "The picture to write");
    o.choice(a->view, "--view", {"scene", "frame", "ladder", "plots"}, "What to draw");
    o.option(a->frame, "--frame", "ID",
             "Frame to show or select: id or number (default: the session's, else the first held-out frame)");
    o.option(a->size, "--size", "WxH", "Picture size, px");
    o.flag(a->through, "--through", "Look through the frame's camera (scene view)");
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
