// SPDX-License-Identifier: BSD-3-Clause
#include "viz/plots/plot_export.h"

#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSVGExporter.h>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"
#include "viz/convert.h"

namespace glint::viz {
namespace {

/// A window that is never shown, with the plot drawn in it once.
class Drawn {
 public:
  Drawn(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height) {
    require(width >= 64 && height >= 64 && width <= 16384 && height <= 16384,
            "plot: width and height must be between 64 and 16384 pixels");
    view_.setStyle(style);
    view_.show(plot);
    view_.setSelection(selection);
    window_->SetShowWindow(false);
    window_->SetOffScreenRendering(1);
    window_->SetMultiSamples(8);
    window_->SetDPI(72);  // text sizes are pixels
    window_->SetSize(width, height);
    window_->AddRenderer(view_.renderer());
    window_->Render();
  }
  ~Drawn() {
    window_->RemoveRenderer(view_.renderer());
    window_->Finalize();
  }
  vtkRenderWindow* window() const { return window_; }

 private:
  PlotView view_;
  vtkNew<vtkRenderWindow> window_;
};

}  // namespace

Image plotImage(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height) {
  const Drawn drawn(plot, style, selection, width, height);
  return pictureOf(drawn.window());
}

void writePlotSvg(const PlotData& plot, const PlotStyle& style, const Selection& selection, int width, int height,
                  const std::string& file) {
  const Drawn drawn(plot, style, selection, width, height);
  atomicWrite(file, [&](const std::filesystem::path& temporary) {
    vtkNew<vtkSVGExporter> exporter;
    exporter->SetRenderWindow(drawn.window());
    exporter->SetFileName(temporary.c_str());
    exporter->SetTitle(plot.title.c_str());
    exporter->SetTextAsPath(true);  // the same letters everywhere
    exporter->Write();
  });
}

void writePlotCsv(const PlotData& plot, const std::string& file) { atomicWrite(file, plotCsv(plot)); }

}  // namespace glint::viz
