// SPDX-License-Identifier: BSD-3-Clause
#include "viz/movie.h"

#include <cmath>
#include <functional>

#include "cli/commands.h"
#include "cli/inspection_arguments.h"
#include "cli/picture_input.h"
#include "core/pipeline/photograph.h"
#include "core/scene/frame_name.h"
#include "core/scene/outputs.h"
#include "viz/convert.h"
#include "viz/offscreen.h"
#include "viz/pictures.h"

namespace glint::cli {
namespace {

constexpr int kPhotographPx = 4096;  // widest photograph while looking through a camera

struct MovieArguments : PictureInput {
  std::string of = "timeline", frames, size = "1280x720", out;
  double framesPerSecond = 0, seconds = 8;
};

/// The pictures of a movie, each drawn when it is asked for.
struct Reel {
  int count;
  std::function<Image(int)> picture;
};

Reel timeline(const std::shared_ptr<const Inspection>& inspection, const std::vector<int>& frames, const viz::MovieFormat& format,
              const viz::PictureOptions& options) {
  return {static_cast<int>(frames.size()), [=](int i) {
            const int f = frames[static_cast<std::size_t>(i)];
            return viz::framePicture(*inspection, f, photographOf(*inspection, f), format.width, format.height, options);
          }};
}

Reel turntable(viz::SceneView& view, viz::Offscreen& target, int turns) {
  target.render(view);  // what everything is framed in is known with the first picture
  const std::vector<viz::ViewPoint> places = viz::turntable(view, turns);
  return {static_cast<int>(places.size()), [&view, &target, places](int i) {
            view.setViewPoint(places[static_cast<std::size_t>(i)]);
            return target.render(view);
          }};
}

Reel lookThrough(viz::SceneView& view, viz::Offscreen& target, const std::shared_ptr<const Inspection>& inspection,
                 const std::vector<int>& frames, const std::string& model) {
  view.setEye(viz::Eye::Camera);
  return {static_cast<int>(frames.size()), [=, &view, &target](int i) {
            const int f = frames[static_cast<std::size_t>(i)];
            view.setSelection({f, model, -1});
            const Outcome<Image> photograph = photographOf(*inspection, f);
            view.setPhotograph(f, photograph ? viz::toTexture(*photograph, kPhotographPx) : nullptr);
            return target.render(view);
          }};
}

viz::MovieFormat formatFrom(const MovieArguments& a) {
  const auto [width, height] = parseSize(a.size);
  const double usual = a.of == "turntable" ? 25.0 : 5.0;
  const viz::MovieFormat format{width, height, a.framesPerSecond > 0 ? a.framesPerSecond : usual};
  if (!(format.framesPerSecond >= 0.1 && format.framesPerSecond <= 240))
    throw InputError("", "--fps", "must be between 0.1 and 240");
  if (!(a.seconds > 0 && a.seconds <= 3600)) throw InputError("", "--seconds", "must be above 0 and at most 3600");
  if (width > 8192 || height > 8192) throw InputError("", "--size", "a movie can be at most 8192 px wide and high");
  viz::checkMovie(a.out, format);
  return format;
}

int run(const MovieArguments& a, const Context& context) {
  const viz::MovieFormat format = formatFrom(a);
  const PictureInput::Opened opened = a.open(context);
  const Scene& scene = *opened.scene;
  std::vector<int> frames;
  if (!a.frames.empty()) frames = parseFrames(a.frames, scene, "--frames");
  for (int i = 0; a.frames.empty() && i < static_cast<int>(scene.frames.size()); ++i) frames.push_back(i);
  const bool turning = a.of == "turntable";
  const int turns = std::max(2, static_cast<int>(std::lround(a.seconds * format.framesPerSecond)));
  Outputs outputs(a.input, scene);
  for (const std::string& file : viz::filesOfMovie(a.out, turning ? turns : static_cast<int>(frames.size())))
    outputs.file(file, "--out", file == a.out ? OutputKind::movie() : OutputKind::png());
  std::unique_ptr<viz::Offscreen> target;
  if (a.of != "timeline") {  // complains about a missing display before the long work
    Outcome<std::unique_ptr<viz::Offscreen>> display = viz::Offscreen::create(format.width, format.height);
    if (!display) throw CannotAnswer{display.failure()};
    target = std::move(*display);
  }
  const auto inspection = std::make_shared<const Inspection>(inspect(opened.scene, opened.request, context.progress()));
  const auto write = [&](const Reel& reel) { viz::writeMovie(a.out, format, reel.count, reel.picture, context.progress()); };
  if (a.of == "timeline") {
    viz::PictureOptions options;
    options.models = opened.models;
    options.dark = a.dark();
    write(timeline(inspection, frames, format, options));
  } else {
    viz::SceneView view;
    a.apply(view, opened, inspection);
    if (turning) view.setSelection({firstHeldOut(*inspection), opened.saved.model, opened.saved.highlight});
    write(turning ? turntable(view, *target, turns) : lookThrough(view, *target, inspection, frames, opened.saved.model));
  }
  context.wrote(a.out);
  return kDone;
}

}  // namespace

Command movieCommand() {
  const auto a = std::make_shared<MovieArguments>();
  Command c;
  c.name = "movie";
  c.summary = "Write a movie: timeline, look-through or turntable";
  c.description =
      "Computes a scene or session and draws it as a movie without opening a window.\n"
      "  timeline      every frame with the observed contour and each model's prediction, errors below; needs no display\n"
      "  look-through  the 3D scene through the camera of each frame, overlaid with its photograph\n"
      "  turntable     the 3D scene, rotated once about its vertical axis\n"
      "The file extension selects the format: .mp4, .webm, .avi, .mkv, or .png for a numbered sequence of pictures.\n"
      "look-through and turntable start a private virtual display, like `glint render`.";
  c.examples =
      "  glint movie run.glint -o timeline.mp4                              all frames, 5 per second\n"
      "  glint movie run.glint --of turntable --seconds 10 -o turn.webm     one full turn\n"
      "  glint movie scene.json --frames 6-20 --size 1920x1080 -o part.png  pictures part_0000.png ...\n";
  c.declare = [a](Options& o) {
    a->declare(o);
    o.required(a->out, "-o,--out", "MP4", "The movie to write");
    o.choice(a->of, "--of", {"timeline", "look-through", "turntable"}, "What the movie shows");
    o.option(a->frames, "--frames", "SPEC",
             "Frames for timeline and look-through: numbers, ids, ranges, first:K or spread:K (default: all)");
    o.option(a->size, "--size", "WxH", "Picture size, px; even numbers");
    o.option(a->framesPerSecond, "--fps", "F", "Pictures per second; 0 = default (turntable 25, others 5)");
    o.option(a->seconds, "--seconds", "T", "Duration of one turn of the turntable, s");
  };
  c.run = [a](const Context& context) { return run(*a, context); };
  return c;
}

}  // namespace glint::cli
