// SPDX-License-Identifier: BSD-3-Clause
#include "viz/plot_export.h"

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"
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

}  // namespace

Image plotImage(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height) {
  PlotView view = viewOf(plot, style, selection, width, height);
  Canvas canvas(width, height, style.dark ? kDarkBackground : kLightBackground);
  view.paint(canvas, width, height);
  return canvas.image();
}

void writePlotSvg(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height,
                  const std::string& file) {
  PlotView view = viewOf(plot, style, selection, width, height);
  SvgPainter painter(width, height);
  view.paint(painter, width, height);
  atomicWrite(file, painter.document(plot.title));
}

void writePlotCsv(const PlotData& plot, const std::string& file) { atomicWrite(file, plotCsv(plot)); }

}  // namespace glint::viz
