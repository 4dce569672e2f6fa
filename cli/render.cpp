// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "core/pipeline/frame_spec.h"
#include "core/pipeline/session.h"
#include "viz/offscreen.h"
#include "viz/pictures.h"
#include "viz/scene_view.h"

namespace glint::cli {
namespace {

struct RenderArguments {
  std::string input, view = "scene", frame, size = "1600x1000", layers, models, train, out, theme = "dark";
  std::string source;
  std::vector<std::string> set;
  double glyphs = 1;
  bool through = false, allowOutside = false;
};

std::vector<std::string> split(const std::string& text, char separator, const std::string& flag) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) {
    if (part.empty()) throw InputError("", flag, "\"" + text + "\" has an empty part");
    parts.push_back(part);
  }
  return parts;
}

std::pair<int, int> parseSize(const std::string& text) {
  std::istringstream in(text);
  int width = 0, height = 0;
  char x = 0, rest = 0;
  if (!(in >> width >> x >> height) || (x != 'x' && x != 'X') || in >> rest)
    throw InputError("", "--size", "\"" + text + "\" is not WxH");
  if (width < 64 || height < 64 || width > 16384 || height > 16384)
    throw InputError("", "--size", "width and height must be within 64 and 16384 px");
  return {width, height};
}

/// A session is told by what is in it, not by its name.
bool isSession(const std::string& input) {
  std::ifstream file(input);
  std::string head(4096, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, file.gcount())));
  return head.find("\"glint_session\"") != std::string::npos;
}

/// "+rays,-surface", "none,+surface": applied in order.
void applyLayers(const std::string& text, viz::SceneView& view) {
  if (text.empty()) return;
  for (const std::string& part : split(text, ',', "--layers")) {
    if (part == "all" || part == "none") {
      for (const viz::Layer& layer : viz::sceneLayers()) view.setLayerVisible(layer.name, part == "all");
      continue;
    }
    const bool signedName = part[0] == '+' || part[0] == '-';
    const std::string name = signedName ? part.substr(1) : part;
    const auto& layers = viz::sceneLayers();
    if (std::none_of(layers.begin(), layers.end(), [&](const viz::Layer& layer) { return layer.name == name; })) {
      std::string known;
      for (const viz::Layer& layer : layers) known += (known.empty() ? "" : ", ") + layer.name;
      throw InputError("", "--layers", "no layer \"" + name + "\"; there are: " + known);
    }
    view.setLayerVisible(name, part[0] != '-');
  }
}

Image scenePicture(const RenderArguments& a, const std::shared_ptr<const Inspection>& inspection, const SessionView& saved,
                   int frame, const std::set<std::string>& models, int width, int height) {
  // The display first: a missing one is said before anything is drawn.
  Outcome<std::unique_ptr<viz::Offscreen>> target = viz::Offscreen::create(width, height);
  if (!target) throw CannotAnswer{target.failure()};
  viz::SceneView view;
  view.setDarkBackground(a.theme == "dark");
  view.setInspection(inspection);
  view.setModels(models);
  view.setSelection({frame, saved.model, saved.highlight});
  view.setGlyphScale(a.glyphs);
  for (const auto& [name, visible] : saved.layers) {
    const auto& layers = viz::sceneLayers();
    if (std::any_of(layers.begin(), layers.end(), [&, key = name](const viz::Layer& layer) { return layer.name == key; }))
      view.setLayerVisible(name, visible);
  }
  applyLayers(a.layers, view);
  const auto camera = saved.cameras.find("scene");
  if (a.through) {
    view.lookThrough(frame);
  } else if (camera != saved.cameras.end()) {
    const SessionCamera& c = camera->second;
    view.setViewPoint({c.position, c.focalPoint, c.up, c.viewAngleDeg, c.parallel});
  }
  return (*target)->render(view);
}

/// A picture that could only repeat an error is refused with that error. The scene in 3D is always worth drawing: it shows
/// why no camera sees the surface.
void requireContent(const RenderArguments& a, const Inspection& inspection, int frame) {
  const auto predicted = [&](const FrameComparison& c) { return !c.prediction.highlights.empty(); };
  if (a.view == "plots") {
    for (const auto& [name, model] : inspection.models)
      if (std::any_of(model.frames.begin(), model.frames.end(), predicted)) return;
    requireUsableViews(inspection);
    throw CannotAnswer{{Reason::NotReached, "no model predicted anything"}};
  }
  if (a.view == "scene") return;
  const Frame& f = inspection.scene->frames[static_cast<std::size_t>(frame)];
  const Outcome<Image> photograph = readPhotograph(f);
  if (photograph || !inspection.evidence[static_cast<std::size_t>(frame)].scored().empty()) return;
  for (const auto& [name, model] : inspection.models)
    for (const FrameComparison& c : model.frames)
      if (c.frame == frame && predicted(c)) return;
  throw CannotAnswer{photograph.failure()};
}

int run(const RenderArguments& a, const Context& context) {
  const auto [width, height] = parseSize(a.size);
  if (!(a.glyphs > 0 && a.glyphs <= 100)) throw InputError("", "--glyphs", "must be above 0 and at most 100");
  std::shared_ptr<const Scene> scene;
  InspectionRequest request;
  SessionView saved;
  if (isSession(a.input)) {
    OpenedSession opened = openSession(a.input);
    for (const std::string& w : opened.session.warnings) context.warn(w);
    scene = opened.scene;
    request = opened.session.request;
    saved = opened.session.view;
  } else {
    scene = std::make_shared<const Scene>(readScene(a.input, ReadOptions{a.allowOutside}));
    for (const std::string& w : scene->warnings) context.warn(w);
  }
  if (scene->frames.empty()) throw CannotAnswer{{Reason::TooFewViews, a.input + ": no frames"}};
  if (!a.train.empty()) request.train = a.train;
  if (!a.source.empty()) request.source = a.source == "image" ? FrameSource::Image : FrameSource::Radiance;
  for (const std::string& entry : a.set) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) throw InputError("", "--set " + entry, "expected KEY=VALUE");
    request.settings.setFromText(entry.substr(0, equals), entry.substr(equals + 1));
  }
  std::set<std::string> models;
  if (!a.models.empty()) {
    const std::vector<std::string> names = split(a.models, ',', "--models");
    for (const std::string& name : names) modelByName(name);
    request.models = names;
    models.insert(names.begin(), names.end());
  }
  // Everything that may be wrong with the request is found before the long work.
  {
    viz::SceneView dry;
    applyLayers(a.layers, dry);
  }
  std::optional<int> frame;
  const std::string wanted = a.frame.empty() ? saved.frame : a.frame;
  if (!wanted.empty()) {
    const std::vector<int> frames = parseFrames(wanted, *scene, "--frame");
    if (frames.size() != 1) throw InputError("", "--frame", "\"" + wanted + "\" must name one frame");
    frame = frames[0];
  }
  const auto inspection = std::make_shared<const Inspection>(inspect(scene, request, context.progress()));
  if (!frame) {  // the first frame that shows what the models are worth
    frame = 0;
    for (int i = static_cast<int>(scene->frames.size()) - 1; i >= 0; --i) {
      if (inspection->isHeldOut(i)) frame = i;
    }
  }
  viz::PictureOptions options;
  options.models = models;
  options.dark = a.theme == "dark";
  Image picture;
  requireContent(a, *inspection, *frame);
  if (a.view == "scene") {
    picture = scenePicture(a, inspection, saved, *frame, models, width, height);
  } else if (a.view == "plots") {
    picture = viz::plotsPicture(*inspection, width, height, options);
  } else {
    const Outcome<Image> photograph = readPhotograph(scene->frames[static_cast<std::size_t>(*frame)]);
    picture = a.view == "frame" ? viz::framePicture(*inspection, *frame, photograph, width, height, options)
                                : viz::ladderPicture(*inspection, *frame, photograph, width, height, options);
  }
  viz::writePng(picture, a.out);
  warnOfUnusedTrainingFrames(*inspection, context);
  return kDone;
}

}  // namespace

Command renderCommand() {
  const auto a = std::make_shared<RenderArguments>();
  Command c;
  c.name = "render";
  c.summary = "Draw the scene, a frame, the models side by side, or the errors, as a PNG";
  c.description =
      "Computes the inspection of a scene or session and draws it without opening a window.\n"
      "  scene    in 3D: surface, cameras with their photographs, virtual cameras, lights, ellipsoids, contours\n"
      "  frame    one photograph with the observed contour and each model's prediction\n"
      "  ladder   the same frame for each model, side by side, with its error below\n"
      "  plots    contour error over frames, one line for each model\n"
      "frame, ladder and plots need no display. scene starts a private virtual display (Xvfb) and ends it afterwards;\n"
      "where Xvfb is not installed it uses DISPLAY, and without that it ends with exit code 3.\n"
      "Layers of the scene (those marked * are shown without being asked for):\n  ";
  for (const viz::Layer& layer : viz::sceneLayers()) c.description += layer.name + (layer.onByDefault ? "* " : " ");
  c.examples =
      "  glint render scene.json -o scene.png                                   the scene in 3D\n"
      "  glint render scene.json --view frame --frame 0012 -o frame.png         one frame with its overlay\n"
      "  glint render scene.json --view ladder --size 2000x700 -o ladder.png    one tile for each model\n"
      "  glint render a.glint --layers=none,+surface,+rays,+light -o rays.png   chosen layers\n";
  c.declare = [a](Options& o) {
    o.positional(a->input, "FILE.glint|INPUT", "A session, a scene file or a folder with one");
    o.required(a->out, "-o,--out", "PNG", "The picture");
    o.choice(a->view, "--view", {"scene", "frame", "ladder", "plots"}, "What to draw");
    o.option(a->frame, "--frame", "ID", "The frame that is shown or selected: id or number (default: the first held-out one)");
    o.option(a->size, "--size", "WxH", "Size of the picture, px");
    o.option(a->layers, "--layers", "LIST",
             "Layers of the scene to add or take away, in order: +rays,-surface; also all, none. Write --layers=-surface");
    o.option(a->models, "--models", "A,B", "Models to compute and draw (default: all, or the session's)");
    o.option(a->train, "--train", "SPEC",
             "Training frames: 0-5, first:6, spread:6, per-surface (default: first:6, or the session's)");
    o.choice(a->source, "--source", {"", "radiance", "image"},
             "Where highlights are found (default: radiance, or the session's)");
    o.repeated(a->set, "--set", "KEY=VALUE", "Any setting by its dotted name (glint settings)");
    o.choice(a->theme, "--theme", {"dark", "light"}, "Background");
    o.option(a->glyphs, "--glyphs", "FACTOR", "Size of drawn cameras, points and arrows, relative to the default");
    o.flag(a->through, "--through", "scene: look from the frame's camera");
    o.flag(a->allowOutside, "--allow-outside", "Accept paths that leave the folder of the scene file");
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
