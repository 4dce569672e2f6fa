// SPDX-License-Identifier: BSD-3-Clause
#include "cli/picture_input.h"

#include <algorithm>
#include <sstream>

#include "cli/inspection_arguments.h"
#include "core/base/found_file.h"
#include "core/base/words.h"

namespace glint::cli {
namespace {

/// A session is told by what is in it, not by its name.
bool isSession(const std::string& input) { return firstBytes(input, 4096).find("\"glint_session\"") != std::string::npos; }

/// "+rays,-surface", "none,+surface": applied in order.
void applyLayers(const std::string& text, viz::SceneView& view) {
  if (text.empty()) return;
  for (const std::string& part : splitList(text, "--layers")) {
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
      throw InputError("", "--layers", "unknown layer \"" + name + "\"; known: " + known + kPluginHint);
    }
    view.setLayerVisible(name, part[0] != '-');
  }
}

}  // namespace

std::pair<int, int> parseSize(const std::string& text) {
  std::istringstream in(text);
  int width = 0, height = 0;
  char x = 0, rest = 0;
  if (!(in >> width >> x >> height) || (x != 'x' && x != 'X') || in >> rest)
    throw InputError("", "--size", "\"" + text + "\" is not of the form WxH");
  if (width < 64 || height < 64 || width > 16384 || height > 16384)
    throw InputError("", "--size", "width and height must be between 64 and 16384 px");
  return {width, height};
}

void PictureInput::declare(Options& o) {
  o.positional(input, "FILE.glint|INPUT", "Session, scene file, capture of another program, or folder that contains one");
  o.option(layers, "--layers", "LIST",
           "Scene layers to show or hide, in order: +rays,-surface; also all, none. Needs the equals sign: --layers=-surface");
  o.option(models, "--models", "A,B", "Models to compute and draw (default: the session's, else all)");
  o.option(train, "--train", "SPEC",
           "Training frames: 0-5, first:6, spread:6, per-surface (default: the session's, else first:6)");
  o.option(exclude, "--exclude", "SPEC", kExcludeHelp);
  o.choice(source, "--source", {"", "radiance", "image"},
           "Pixels to use where a frame has both: float radiance or captured image (default: the session's, else radiance)");
  o.repeated(set, "--set", "KEY=VALUE", "Any setting by its dotted name (`glint settings` lists them); may be repeated");
  o.choice(theme, "--theme", {"dark", "light"}, "Theme of the picture");
  o.option(glyphs, "--glyphs", "FACTOR", "Size of cameras, points and arrows relative to the default");
  places.declare(o);
}

PictureInput::Opened PictureInput::open(const Context& context) const {
  if (!(glyphs > 0 && glyphs <= 100)) throw InputError("", "--glyphs", "must be above 0 and at most 100");
  Opened opened;
  if (isSession(input)) {
    OpenedSession session = places.openSession(input);
    for (const std::string& w : session.session.warnings) context.warn(w);
    if (!session.warning.empty()) context.warn(session.warning);
    opened.scene = session.scene;
    opened.request = session.session.request;
    opened.saved = session.session.view;
  } else {
    opened.scene = std::make_shared<const Scene>(places.read(input));
    for (const std::string& w : opened.scene->warnings) context.warn(w);
  }
  if (opened.scene->frames.empty()) throw CannotAnswer{{Reason::TooFewViews, input + ": the scene has no frames"}};
  if (!train.empty()) opened.request.train = train;
  cli::exclude(exclude, *opened.scene, opened.request);
  if (!source.empty()) opened.request.source = source == "image" ? FrameSource::Image : FrameSource::Radiance;
  applyEach(opened.request.settings, set);
  if (!models.empty()) {
    const std::vector<std::string> names = splitList(models, "--models");
    for (const std::string& name : names) modelByName(name);
    opened.request.models = names;
    opened.models.insert(names.begin(), names.end());
  }
  viz::SceneView dry;
  applyLayers(layers, dry);
  return opened;
}

void PictureInput::apply(viz::SceneView& view, const Opened& opened, const std::shared_ptr<const Inspection>& inspection) const {
  view.setDarkBackground(dark());
  view.setInspection(inspection);
  view.setModels(opened.models);
  view.setGlyphScale(glyphs);
  for (const auto& [name, visible] : opened.saved.layers) {
    const auto& all = viz::sceneLayers();
    if (std::any_of(all.begin(), all.end(), [&, key = name](const viz::Layer& layer) { return layer.name == key; }))
      view.setLayerVisible(name, visible);
  }
  applyLayers(layers, view);
  const auto camera = opened.saved.cameras.find("scene");
  if (camera == opened.saved.cameras.end()) return;
  const SessionCamera& c = camera->second;
  view.setViewPoint({c.position, c.focalPoint, c.up, c.viewAngleDeg, c.parallel});
}

int firstHeldOut(const Inspection& inspection) {
  for (int i = 0; i < static_cast<int>(inspection.scene->frames.size()); ++i)
    if (inspection.isHeldOut(i)) return i;
  return 0;
}

}  // namespace glint::cli
