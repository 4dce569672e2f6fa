// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/image.h"
#include "core/draw/plot_view.h"
#include "viz/style.h"

namespace glint::viz {

/// The text under an exported plot, inside its size.
struct PlotCaption {
  std::string text;    ///< "" = none
  double sizePx = 12;  ///< of its letters, device px
};

/// A picture of a plot of `width` x `height` device px, 3 channels; needs no display. std::invalid_argument unless
/// 16 <= width, height <= 16384.
Image plotImage(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height,
                const PlotCaption& caption = {});

/// The same as SVG by SvgPainter, the caption as text and description; all or nothing. InputError if it cannot be written.
void writePlotSvg(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height,
                  const std::string& file, const PlotCaption& caption = {});

/// InputError if it cannot be written.
void writePlotCsv(const PlotData& plot, const std::string& file);

}  // namespace glint::viz
