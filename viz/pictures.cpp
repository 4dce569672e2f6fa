// SPDX-License-Identifier: BSD-3-Clause
#include "viz/pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/draw/contrast.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/plots.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/photograph.h"
#include "core/pipeline/what_if_knobs.h"
#include "viz/plot_export.h"
#include "viz/style.h"

namespace glint::viz {
namespace {

struct Theme {
  Colour background, panel, ink, faint;
  Colour problem;  ///< what failed, as text
};
Theme themeOf(bool dark) {
  const Colour panel = dark ? Colour{0.15, 0.16, 0.18} : Colour{0.95, 0.95, 0.95};
  const Colour problem = draw::readableOn(panel, kFailed);
  if (dark) return {kDarkBackground, panel, kTextOnDark, {0.35, 0.36, 0.38}, problem};
  return {{1, 1, 1}, panel, kTextOnLight, {0.80, 0.80, 0.80}, problem};
}

/// The largest box of an aspect ratio inside another, centred.
Box inscribed(const Box& outer, double aspect) {
  Box box = outer;
  if (outer.width > aspect * outer.height) {
    box.width = aspect * outer.height;
  } else {
    box.height = outer.width / aspect;
  }
  box.x += 0.5 * (outer.width - box.width);
  box.y += 0.5 * (outer.height - box.height);
  return box;
}

void outlineBox(Canvas& canvas, const Box& box, const Colour& colour, double width) {
  canvas.stroke(
      {{box.x, box.y}, {box.x + box.width, box.y}, {box.x + box.width, box.y + box.height}, {box.x, box.y + box.height}}, true,
      colour, width);
}

std::string titleOf(const Inspection& inspection, int frame) {
  const std::string use = inspection.isTraining(frame) ? "training" : inspection.isHeldOut(frame) ? "held out" : "excluded";
  const std::string note = frameNote(inspection.request.whatIf, frame);
  return inspection.scene->name + ", frame " + inspection.scene->frames[static_cast<std::size_t>(frame)].id + " (" + use + ")" +
         (note.empty() ? "" : ": " + note);
}

const Camera& cameraOf(const Inspection& inspection, int frame) {
  require(inspection.scene && frame >= 0 && frame < static_cast<int>(inspection.scene->frames.size()), "picture: no such frame");
  return inspection.scene->frames[static_cast<std::size_t>(frame)].camera;
}

/// @param given  false for a frame that has contours and no photograph: no fault, the box stays empty behind the contours
void drawPhotograph(Canvas& canvas, const Outcome<Image>& photograph, bool given, const Crop& crop, const Box& box, double font,
                    const Theme& theme) {
  if (photograph) {
    canvas.picture(*photograph, crop, box);
  } else if (!given) {
    canvas.fill(box, theme.panel);
    canvas.text({box.x + 0.4 * font, box.y + box.height - 0.6 * font},
                canvas.fitted("no photograph", 0.9 * font, box.width - font), 0.9 * font, theme.ink);
  } else {
    canvas.fill(box, theme.panel);
    canvas.text({box.x + 0.5 * box.width, box.y + 0.5 * box.height},
                canvas.fitted(photograph.failure().message(), font, box.width - font), font, theme.problem, Align::Centre);
  }
}

/// What the frame view hides by default stays out of pictures too.
std::set<OverlayRole> hiddenRoles(const PictureOptions& options) {
  std::set<OverlayRole> hidden = options.hidden;
  for (const OverlayLayer& layer : overlayLayers())
    if (!layer.onByDefault) hidden.insert(layer.role);
  return hidden;
}

bool showsObserved(const FrameOverlay& overlay) {
  return std::any_of(overlay.lines.begin(), overlay.lines.end(),
                     [](const OverlayLine& line) { return line.role == OverlayRole::ObservedContour && line.highlight >= 0; });
}

/// A swatch with an edge, which it needs on a light page, and the word. @param at  where the word's line begins
void drawObservedKey(Canvas& canvas, const Eigen::Vector2d& at, double font, const Theme& theme) {
  const Box swatch{at.x(), at.y() - 0.75 * font, 1.6 * font, 0.6 * font};
  canvas.fill(swatch, kObserved);
  outlineBox(canvas, swatch, theme.ink, 1);
  canvas.text({at.x() + 2.2 * font, at.y()}, "observed", font, theme.ink);
}

}  // namespace

std::optional<Crop> highlightCrop(const Inspection& inspection, int frame, const std::set<std::string>& models, double aspect) {
  const Camera& camera = cameraOf(inspection, frame);
  OverlayOptions options;
  options.models = models;
  options.hidden = {OverlayRole::ObservedEllipse, OverlayRole::PredictedEllipse, OverlayRole::CanonicalEllipse,
                    OverlayRole::UncertaintyBand, OverlayRole::ResidualArrows,   OverlayRole::LimitDirections};
  const FrameOverlay overlay = frameOverlay(inspection, frame, options);
  Eigen::AlignedBox2d observed, all;
  for (const OverlayLine& line : overlay.lines) {
    for (const Pixel& p : line.points) {
      if (!p.allFinite()) continue;
      all.extend(p);
      if (line.role == OverlayRole::ObservedContour) observed.extend(p);
    }
  }
  if (all.isEmpty()) return {};
  if (!observed.isEmpty()) {  // a very wrong model must not shrink the others to dots
    const Eigen::Vector2d room = observed.sizes().cwiseMax(8.0);
    all = all.intersection(Eigen::AlignedBox2d(observed.min() - room, observed.max() + room));
  }
  const Eigen::Vector2d centre = all.center();
  const double w = std::max(1.35 * all.sizes().x() + 4, 24.0), h = std::max(1.35 * all.sizes().y() + 4, 24.0);
  const Crop tight{centre.x() - 0.5 * w, centre.y() - 0.5 * h, w, h};
  return aspect > 0 ? grownTo(tight, aspect, camera) : tight;
}

Crop grownTo(const Crop& crop, double aspect, const Camera& camera) {
  Crop grown = crop;
  grown.width = std::max(crop.width, aspect * crop.height);
  grown.height = grown.width / aspect;
  const auto place = [](double from, double size, double wanted, double room) {
    const double start = from + 0.5 * (size - wanted);
    if (wanted >= room) return 0.5 * (room - wanted) - 0.5;  // larger than the photograph: centred on it
    return std::clamp(start, -0.5, room - wanted - 0.5);
  };
  grown.x = place(crop.x, crop.width, grown.width, camera.width);
  grown.y = place(crop.y, crop.height, grown.height, camera.height);
  return grown;
}

int ladderColumns(int tiles, double width, double height, double foot, double aspect) {
  int columns = 1;
  double best = 0;
  for (int c = 1; c <= tiles; ++c) {
    const int rows = (tiles + c - 1) / c;
    const double scale = std::min(width / c / aspect, height / rows - foot);
    if (scale > best) {
      best = scale;
      columns = c;
    }
  }
  return columns;
}

Image framePicture(const Inspection& inspection, int frame, const Outcome<Image>& photograph, int width, int height,
                   const PictureOptions& options) {
  const Camera& camera = cameraOf(inspection, frame);
  const Theme theme = themeOf(options.dark);
  Canvas canvas(width, height, theme.background);
  const double font = std::clamp(height / 48.0, 10.0, 40.0), ink = std::max(1.0, height / 900.0);
  OverlayOptions overlayOptions;
  overlayOptions.models = options.models;
  overlayOptions.hidden = hiddenRoles(options);
  const FrameOverlay overlay = frameOverlay(inspection, frame, overlayOptions);

  const bool observed = showsObserved(overlay);
  const double head = 2 * font, foot = (0.8 + 1.45 * static_cast<double>(overlay.captions.size() + (observed ? 1 : 0))) * font;
  const Box room{0.5 * font, head, width - font, std::max(16.0, height - head - foot)};
  canvas.text({0.8 * font, 1.4 * font}, canvas.fitted(titleOf(inspection, frame), 1.1 * font, width - 1.6 * font), 1.1 * font,
              theme.ink);

  const Crop whole{-0.5, -0.5, static_cast<double>(camera.width), static_cast<double>(camera.height)};
  const double aspect = whole.width / whole.height;
  // A highlight that is a small part of the picture is shown enlarged as well, beside it or below.
  std::optional<Crop> part = highlightCrop(inspection, frame, options.models, 1.0);
  if (part && part->width > 0.4 * whole.width) part.reset();
  Box main = inscribed(room, aspect), zoom;
  if (part) {
    const double gap = 0.5 * font;
    const Box beside = inscribed({room.x, room.y, 0.58 * room.width - gap, room.height}, aspect);
    const Box above = inscribed({room.x, room.y, room.width, 0.58 * room.height - gap}, aspect);
    const bool sideBySide = beside.width * beside.height >= above.width * above.height;
    main = sideBySide ? beside : above;
    zoom = sideBySide ? Box{room.x + 0.58 * room.width, room.y, 0.42 * room.width, room.height}
                      : Box{room.x, room.y + 0.58 * room.height, room.width, 0.42 * room.height};
    if (sideBySide) {
      main.x = room.x;
      zoom.x = main.x + main.width + gap;
      zoom.width = room.x + room.width - zoom.x;
      zoom.y = main.y;
      zoom.height = std::min(main.height, zoom.width);
      part = highlightCrop(inspection, frame, options.models, zoom.width / zoom.height);
    } else {
      part = highlightCrop(inspection, frame, options.models, zoom.width / zoom.height);
    }
  }
  const bool given = hasPhotograph(inspection, frame);
  drawPhotograph(canvas, photograph, given, whole, main, font, theme);
  paintOverlay(canvas, overlay, whole, main, ink * (part ? 0.6 : 1.0));
  if (part) {
    drawPhotograph(canvas, photograph, given, *part, zoom, font, theme);
    paintOverlay(canvas, overlay, *part, zoom, ink);
    outlineBox(canvas, zoom, theme.faint, 1);
    const double sx = main.width / whole.width;
    outlineBox(canvas,
               {main.x + (part->x - whole.x) * sx, main.y + (part->y - whole.y) * sx, part->width * sx, part->height * sx},
               theme.ink, 1);
    const std::string times = formatted("%.1f", zoom.width / part->width / sx) + " times larger";
    canvas.text({zoom.x + zoom.width - 0.4 * font, zoom.y + zoom.height - 0.6 * font}, times, 0.9 * font, kTextOnDark,
                Align::Right);
  }
  double y = height - foot + 1.3 * font;
  if (observed) {
    drawObservedKey(canvas, {0.8 * font, y}, font, theme);
    y += 1.45 * font;
  }
  for (const OverlayCaption& caption : overlay.captions) {
    canvas.fill({0.8 * font, y - 0.75 * font, 1.6 * font, 0.6 * font}, caption.colour);
    canvas.text({3 * font, y}, canvas.fitted(caption.text, font, width - 4 * font), font,
                caption.problem ? theme.problem : theme.ink);
    y += 1.45 * font;
  }
  return canvas.image();
}

Image ladderPicture(const Inspection& inspection, int frame, const Outcome<Image>& photograph, int width, int height,
                    const PictureOptions& options) {
  const Camera& camera = cameraOf(inspection, frame);
  const Theme theme = themeOf(options.dark);
  Canvas canvas(width, height, theme.background);
  const double font = std::clamp(height / 42.0, 10.0, 40.0), ink = std::max(1.0, height / 900.0);
  constexpr double kKeyWidth = 8;  // of "observed" and its swatch, in heights of the text
  OverlayOptions all;
  all.hidden = hiddenRoles(options);
  const bool observed = width > 4 * kKeyWidth * font && showsObserved(frameOverlay(inspection, frame, all));
  if (observed) drawObservedKey(canvas, {width - kKeyWidth * font, 1.4 * font}, font, theme);
  canvas.text({0.8 * font, 1.4 * font},
              canvas.fitted(titleOf(inspection, frame) + ": from simplest to richest", 1.1 * font,
                            width - (observed ? kKeyWidth + 1.6 : 1.6) * font),
              1.1 * font, theme.ink);
  const std::vector<std::string> models = modelsInOrder(inspection, options.models);
  if (models.empty()) {
    canvas.text({0.8 * font, 4 * font}, "no models computed", font, theme.problem);
    return canvas.image();
  }
  // The text below a tile: the numbers in one line, or the whole reason why they are missing.
  struct Below {
    std::string numbers, reason;
  };
  std::vector<Below> below(models.size());
  for (std::size_t i = 0; i < models.size(); ++i) {
    const FrameScore score = frameScore(inspection.models.at(models[i]), frame);
    if (score.missed > 0 && score.matched > 0) {
      below[i].reason = missedText(score);
      continue;
    }
    if (score.errorPct) {
      below[i].numbers = errorText(*score.errorPct) + " %   " + errorText(*score.errorPx) + " px" +
                         (score.iou ? "   IoU " + formatted("%.3f", *score.iou) : "");
      continue;
    }
    OverlayOptions captionsOnly;
    captionsOnly.models = {models[i]};
    for (const OverlayCaption& caption : frameOverlay(inspection, frame, captionsOnly).captions)
      if (caption.model == models[i]) below[i].reason = caption.text.substr(std::min(caption.text.size(), models[i].size() + 2));
  }
  const double gap = 0.5 * font, head = 2 * font, line = 1.4 * font;
  Crop crop{-0.5, -0.5, static_cast<double>(camera.width), static_cast<double>(camera.height)};
  const std::optional<Crop> part = highlightCrop(inspection, frame, options.models, 0);
  if (part) crop = *part;
  const int count = static_cast<int>(models.size());
  int columns = 1, lines = 1;
  double foot = 0, tileWidth = 0, tileHeight = 0;
  const auto arrange = [&] {
    foot = 1.7 * font + lines * line;
    columns = ladderColumns(count, width - gap, height - head - gap, foot + gap, crop.width / crop.height);
    const int rows = (count + columns - 1) / columns;
    tileWidth = (width - gap) / columns - gap;
    tileHeight = (height - head - gap) / rows - gap;
  };
  arrange();
  for (int again = 0; again < 3; ++again) {  // more lines may mean other columns, and these other lines
    int needed = 1;
    for (const Below& b : below) needed = std::max(needed, int(canvas.wrapped(b.reason, font, tileWidth).size()));
    const int most = std::max(1, int((0.6 * tileHeight - 1.7 * font) / line));  // the pictures are what it is about
    if (std::min(needed, most) <= lines) break;
    lines = std::min(needed, most);
    arrange();
  }
  // Every tile is filled: the part of the photograph grows to its shape.
  const Box picture{0, 0, tileWidth, std::max(16.0, tileHeight - foot)};
  crop = grownTo(crop, picture.width / picture.height, camera);
  for (std::size_t i = 0; i < models.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    const Box tile{gap + column * (tileWidth + gap), head + gap + row * (tileHeight + gap), tileWidth, tileHeight};
    const Box box{tile.x, tile.y, picture.width, picture.height};
    OverlayOptions overlayOptions;
    overlayOptions.models = {models[i]};
    overlayOptions.hidden = hiddenRoles(options);
    const FrameOverlay overlay = frameOverlay(inspection, frame, overlayOptions);
    drawPhotograph(canvas, photograph, hasPhotograph(inspection, frame), crop, box, font, theme);
    paintOverlay(canvas, overlay, crop, box, ink);
    canvas.fill({box.x, box.y + box.height, box.width, 0.25 * font}, modelColour(models[i]));
    const double middle = box.x + 0.5 * box.width, top = box.y + box.height + 1.4 * font;
    canvas.text({middle, top}, models[i], 1.1 * font, theme.ink, Align::Centre);
    if (below[i].reason.empty()) {
      canvas.text({middle, top + line}, canvas.fitted(below[i].numbers, font, tile.width), font, theme.ink, Align::Centre);
      continue;
    }
    const std::vector<std::string> reason = canvas.wrapped(below[i].reason, font, tile.width);
    for (int k = 0; k < std::min(lines, int(reason.size())); ++k) {
      const bool more = k + 1 == lines && int(reason.size()) > lines;
      canvas.text({middle, top + (k + 1) * line},
                  canvas.fitted(reason[std::size_t(k)] + (more ? "\u2026" : ""), font, tile.width), font, theme.problem,
                  Align::Centre);
    }
  }
  return canvas.image();
}

Image plotsPicture(const Inspection& inspection, int width, int height, const PictureOptions& options) {
  require(inspection.scene != nullptr, "picture: no scene");
  ErrorPlotOptions shown;
  shown.models = options.models;
  shown.means = true;
  PlotData plot = errorPlot(inspection, shown);
  plot.title = inspection.scene->name + ": contour error over frames";
  constexpr double kScreenHeight = 460;  // of a plot whose texts have their usual size, px
  Selection none;
  none.frame = -1;
  return plotImage(plot, {options.dark, std::clamp(height / kScreenHeight, 0.85, 3.5)}, none, width, height);
}

}  // namespace glint::viz
