// SPDX-License-Identifier: BSD-3-Clause
#include "viz/pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/inspect/photograph.h"
#include "core/what_if/knobs.h"
#include "viz/annotations.h"
#include "viz/error_text.h"
#include "viz/missed.h"

namespace glint::viz {
namespace {

constexpr Colour kHalo{0.05, 0.05, 0.05};

struct Theme {
  Colour background, panel, ink, faint;
};
Theme themeOf(bool dark) {
  if (dark) return {kDarkBackground, {0.15, 0.16, 0.18}, kTextOnDark, {0.35, 0.36, 0.38}};
  return {{1, 1, 1}, {0.95, 0.95, 0.95}, kTextOnLight, {0.80, 0.80, 0.80}};
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
                canvas.fitted(photograph.failure().message(), font, box.width - font), font, kFailed, Align::Centre);
  }
}

/// What the frame view hides by default stays out of pictures too.
std::set<OverlayRole> hiddenRoles(const PictureOptions& options) {
  std::set<OverlayRole> hidden = options.hidden;
  for (const OverlayLayer& layer : overlayLayers())
    if (!layer.onByDefault) hidden.insert(layer.role);
  return hidden;
}

}  // namespace

void drawOverlay(Canvas& canvas, const FrameOverlay& overlay, const Crop& crop, const Box& box, double inkScale) {
  const auto place = [&](const Pixel& p) {
    return Eigen::Vector2d(box.x + (p.x() - crop.x) * box.width / crop.width,
                           box.y + (p.y() - crop.y) * box.height / crop.height);
  };
  for (const OverlayLine& line : overlay.lines) {
    std::vector<Eigen::Vector2d> points;
    points.reserve(line.points.size());
    for (const Pixel& p : line.points) points.push_back(place(p));
    if (line.halo) canvas.stroke(points, line.closed, kHalo, inkScale * (line.width + 2), Dash::Solid, box);
    canvas.stroke(points, line.closed, line.colour, inkScale * line.width, line.dash, box);
  }
  for (const OverlayMark& mark : overlay.marks) {
    const Eigen::Vector2d c = place(mark.at);
    const double r = inkScale * mark.size;
    const auto draw = [&](const Colour& colour, double width, double reach) {
      if (mark.shape == MarkShape::Cross) {
        canvas.stroke({c - Eigen::Vector2d(reach, 0), c + Eigen::Vector2d(reach, 0)}, false, colour, width, Dash::Solid, box);
        canvas.stroke({c - Eigen::Vector2d(0, reach), c + Eigen::Vector2d(0, reach)}, false, colour, width, Dash::Solid, box);
      } else {
        std::vector<Eigen::Vector2d> ring;
        for (int i = 0; i < 24; ++i)
          ring.push_back(c + reach * Eigen::Vector2d(std::cos(i * 0.2617993878), std::sin(i * 0.2617993878)));
        canvas.stroke(ring, true, colour, width, Dash::Solid, box);
      }
    };
    if (mark.halo) draw(kHalo, inkScale * (mark.width + 1.5), mark.shape == MarkShape::Cross ? r + inkScale : r);
    draw(mark.colour, inkScale * mark.width, r);
  }
}

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
  if (!observed.isEmpty()) {  // a model that went astray must not shrink the others to dots
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

  const double head = 2 * font, foot = (0.8 + 1.45 * static_cast<double>(overlay.captions.size())) * font;
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
  drawOverlay(canvas, overlay, whole, main, ink * (part ? 0.6 : 1.0));
  if (part) {
    drawPhotograph(canvas, photograph, given, *part, zoom, font, theme);
    drawOverlay(canvas, overlay, *part, zoom, ink);
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
  for (const OverlayCaption& caption : overlay.captions) {
    canvas.fill({0.8 * font, y - 0.75 * font, 1.6 * font, 0.6 * font}, caption.colour);
    canvas.text({3 * font, y}, canvas.fitted(caption.text, font, width - 4 * font), font, caption.problem ? kFailed : theme.ink);
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
  canvas.text({0.8 * font, 1.4 * font},
              canvas.fitted(titleOf(inspection, frame) + ": from simplest to richest", 1.1 * font, width - 1.6 * font),
              1.1 * font, theme.ink);
  const std::vector<std::string> models = modelsInOrder(inspection, options.models);
  if (models.empty()) {
    canvas.text({0.8 * font, 4 * font}, "no models computed", font, kFailed);
    return canvas.image();
  }
  // What stands below a tile: the numbers in one line, or the whole reason why there are none.
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
    drawOverlay(canvas, overlay, crop, box, ink);
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
                  canvas.fitted(reason[std::size_t(k)] + (more ? "\u2026" : ""), font, tile.width), font, kFailed, Align::Centre);
    }
  }
  return canvas.image();
}

Image plotsPicture(const Inspection& inspection, int width, int height, const PictureOptions& options) {
  require(inspection.scene != nullptr, "picture: no scene");
  const Theme theme = themeOf(options.dark);
  Canvas canvas(width, height, theme.background);
  const double font = std::clamp(height / 38.0, 10.0, 40.0), ink = std::max(1.0, height / 700.0);
  const int frames = static_cast<int>(inspection.scene->frames.size());
  const std::vector<std::string> models = modelsInOrder(inspection, options.models);
  struct Series {
    std::string model;
    std::vector<FrameScore> scores;
    std::vector<std::optional<double>> pct;  // none where a highlight was missed, and in excluded frames
    double sum = 0;
    int answered = 0, asked = 0;
  };
  const auto isExcluded = [&](int frame) { return !inspection.isTraining(frame) && !inspection.isHeldOut(frame); };
  std::vector<Series> all;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const std::string& model : models) {
    Series series;
    series.model = model;
    for (int frame = 0; frame < frames; ++frame) {
      series.scores.push_back(frameScore(inspection.models.at(model), frame));
      const bool counts = inspection.isHeldOut(frame);
      series.asked += counts ? 1 : 0;
      series.pct.push_back(isExcluded(frame) ? std::nullopt : wholeErrorPct(series.scores.back()));
      const std::optional<double>& pct = series.pct.back();
      if (!pct) continue;
      if (counts) {
        series.sum += *pct;
        ++series.answered;
      }
      high = std::max(high, *pct);
      if (*pct > 0) low = std::min(low, *pct);
    }
    all.push_back(std::move(series));
  }
  canvas.text({0.8 * font, 1.5 * font}, inspection.scene->name + ": contour error over frames", 1.2 * font, theme.ink);
  if (!(high > 0) || frames == 0) {
    canvas.text({0.8 * font, 4 * font}, models.empty() ? "no models computed" : "no errors to plot", font, kFailed);
    return canvas.image();
  }
  const bool logarithmic = high / low > 30;
  double bottom = 0, top = 1.08 * high;
  if (logarithmic) {
    bottom = std::log10(std::max(low, 1e-5 * high)) - 0.05;
    top = std::log10(high) + 0.05;
  }
  const double rowsOfLegend = static_cast<double>(all.size());
  const Box plot{5.2 * font, (3.4 + 1.4 * rowsOfLegend) * font, width - 7 * font, height - (7.6 + 1.4 * rowsOfLegend) * font};
  const auto xOf = [&](double frame) { return plot.x + (frame + 0.5) / frames * plot.width; };
  const auto yOf = [&](double pct) {
    const double v = logarithmic ? std::log10(std::max(pct, 1e-300)) : pct;
    return plot.y + plot.height * (1 - std::clamp((v - bottom) / (top - bottom), 0.0, 1.0));
  };
  canvas.fill(plot, theme.panel);
  bool anyTraining = false;
  if (!inspection.train.perSurface) {
    for (int frame = 0; frame < frames; ++frame) {
      if (!inspection.isTraining(frame)) continue;
      canvas.fill({xOf(frame - 0.5), plot.y, plot.width / frames, plot.height}, kTraining, 0.22);
      anyTraining = true;
    }
  }
  bool anyExcluded = false;
  for (int frame = 0; frame < frames; ++frame) {
    if (!isExcluded(frame)) continue;
    canvas.fill({xOf(frame - 0.5), plot.y, plot.width / frames, plot.height}, kExcluded, 0.4);
    anyExcluded = true;
  }
  // Error axis.
  std::vector<double> ticks;
  if (logarithmic) {
    const bool sparse = top - bottom > 2.5;
    for (int decade = static_cast<int>(std::floor(bottom)); decade <= static_cast<int>(std::ceil(top)); ++decade) {
      for (const double factor : {1.0, 2.0, 5.0}) {
        if (sparse && factor > 1) continue;
        const double v = factor * std::pow(10.0, decade);
        if (std::log10(v) >= bottom && std::log10(v) <= top) ticks.push_back(v);
      }
    }
  } else {
    const double step = roundLength(top / 4);
    for (int i = 0; i * step <= top; ++i) ticks.push_back(i * step);
  }
  for (const double v : ticks) {
    canvas.stroke({{plot.x, yOf(v)}, {plot.x + plot.width, yOf(v)}}, false, theme.faint, 1);
    canvas.text({plot.x - 0.5 * font, yOf(v) + 0.35 * font}, formatted("%.4g", v), font, theme.ink, Align::Right);
  }
  canvas.text({1.3 * font, plot.y + 0.5 * plot.height}, logarithmic ? "contour error, % (log)" : "contour error, %", font,
              theme.ink, Align::Centre, true);
  // Frame axis.
  const double perLabel = std::max(1.0, std::ceil(2.2 * font * frames / plot.width));
  const int step = std::max(1, static_cast<int>(perLabel <= 1   ? 1
                                                : perLabel <= 2 ? 2
                                                : perLabel <= 5 ? 5
                                                                : 10 * std::ceil(perLabel / 10)));
  for (int frame = 0; frame < frames; frame += step) {
    canvas.stroke({{xOf(frame), plot.y + plot.height}, {xOf(frame), plot.y + plot.height + 0.3 * font}}, false, theme.ink, 1);
    canvas.text({xOf(frame), plot.y + plot.height + 1.4 * font}, std::to_string(frame), font, theme.ink, Align::Centre);
  }
  bool anyMissing = false;
  const auto isMissing = [&](const Series& series, int frame) {
    return series.answered > 0 && !isExcluded(frame) && !series.pct[static_cast<std::size_t>(frame)];
  };
  for (const Series& series : all)
    for (int frame = 0; frame < frames; ++frame) anyMissing = anyMissing || isMissing(series, frame);
  canvas.text({plot.x + 0.5 * plot.width, plot.y + plot.height + 2.9 * font},
              std::string("frame") + (anyTraining ? ", shaded blue: training" : "") + (anyExcluded ? ", brown: excluded" : "") +
                  (anyMissing ? ", strokes above: missed highlight or no prediction" : ""),
              font, theme.ink, Align::Centre);
  // Lines, broken where a frame has no error.
  double legendY = 3.2 * font;
  for (const Series& series : all) {
    const Colour colour = modelColour(series.model);
    std::vector<Eigen::Vector2d> run;
    for (int frame = 0; frame <= frames; ++frame) {
      if (frame < frames && series.pct[static_cast<std::size_t>(frame)]) {
        run.push_back({xOf(frame), yOf(*series.pct[static_cast<std::size_t>(frame)])});
        continue;
      }
      canvas.stroke(run, false, colour, 1.8 * ink);
      run.clear();
    }
    for (int frame = 0; frame < frames; ++frame) {
      const std::optional<double>& pct = series.pct[static_cast<std::size_t>(frame)];
      if (pct) canvas.disc({xOf(frame), yOf(*pct)}, (frames > 100 ? 1.5 : 2.8) * ink, colour);
    }
    canvas.stroke({{plot.x, legendY - 0.35 * font}, {plot.x + 1.8 * font, legendY - 0.35 * font}}, false, colour, 3 * ink);
    std::string text = series.model;
    if (series.answered > 0) {
      text += ":  mean " + formatted("%.3g %%", series.sum / series.answered) + " over " + std::to_string(series.answered) +
              " of " + std::to_string(series.asked) + (inspection.train.perSurface ? " frames" : " held-out frames");
    } else {
      text += ":  no prediction in any held-out frame";
      for (const FrameScore& score : series.scores) {
        if (!score.reason.empty()) {
          text += " (" + score.reason + ")";
          break;
        }
      }
    }
    canvas.text({plot.x + 2.4 * font, legendY}, canvas.fitted(text, font, plot.width - 2.4 * font), font,
                series.answered > 0 ? theme.ink : kFailed);
    legendY += 1.4 * font;
  }
  // Frames that a model left out: a short stroke above the plot in its colour, one row for each model.
  const double room = 0.9 * font, rowHeight = room / std::max<double>(1, static_cast<double>(all.size()));
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (int frame = 0; frame < frames; ++frame) {
      if (!isMissing(all[i], frame)) continue;
      canvas.fill(
          {xOf(frame - 0.35), plot.y - room + static_cast<double>(i) * rowHeight, 0.7 * plot.width / frames, 0.7 * rowHeight},
          modelColour(all[i].model));
    }
  }
  outlineBox(canvas, plot, theme.faint, 1);
  return canvas.image();
}

}  // namespace glint::viz
