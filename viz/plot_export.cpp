// SPDX-License-Identifier: BSD-3-Clause
#include "viz/plot_export.h"

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"
#include "core/draw/painter.h"
#include "core/draw/svg_painter.h"
#include "viz/canvas.h"
#include "viz/style.h"

namespace glint::viz {
namespace {

PlotView viewOf(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height) {
  require(width >= 16 && height >= 16 && width <= 16384 && height <= 16384,
          "plot: width and height must be between 16 and 16384 pixels");
  PlotView view;
  view.setStyle(style);
  view.show(plot);
  view.setSelection(selection);
  return view;
}

/// Plot and caption below each other. A caption takes half of the height at most: the plot keeps its axes.
void paintWithCaption(Painter& painter, PlotView& view, const PlotStyle& style, int width, int height,
                      const PlotCaption& caption) {
  const Caption below = captionOf(painter, caption.text, caption.sizePx, width, 0.5 * height);
  const double top = height - below.height;
  view.paint(painter, width, top);
  if (below.lines.empty()) return;
  painter.fill({0, top, double(width), below.height}, style.dark ? kDarkBackground : kLightBackground);
  paintCaption(painter, below, top, style.dark ? kTextOnDark : kTextOnLight);
}

}  // namespace

Image plotImage(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height,
                const PlotCaption& caption) {
  PlotView view = viewOf(plot, style, selection, width, height);
  Canvas canvas(width, height, style.dark ? kDarkBackground : kLightBackground);
  paintWithCaption(canvas, view, style, width, height, caption);
  return canvas.image();
}

void writePlotSvg(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height,
                  const std::string& file, const PlotCaption& caption) {
  PlotView view = viewOf(plot, style, selection, width, height);
  SvgPainter painter(width, height);
  paintWithCaption(painter, view, style, width, height, caption);
  atomicWrite(file, painter.document(plot.title, caption.text));
}

void writePlotCsv(const PlotData& plot, const std::string& file) { atomicWrite(file, plotCsv(plot)); }

}  // namespace glint::viz
