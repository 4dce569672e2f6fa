// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>
#include <vector>

#include "core/advise/conditioning.h"
#include "core/advise/influence.h"
#include "core/advise/lobe_comparison.h"
#include "core/advise/lobe_samples.h"
#include "core/advise/polar_residual.h"
#include "core/choice/tradeoff.h"
#include "core/draw/plot_data.h"

namespace glint::draw {

/// All plots, in the order of a list to choose from.
struct PlotKind {
  const char* id;
  const char* title;
  const char* help;  ///< one sentence
};
const std::vector<PlotKind>& plotKinds();

/// Samples of a frame's image and surface, read off the interface thread.
struct FrameSamples {
  int frame = -1;
  std::string frameId;
  std::string model;
  std::set<std::string> poorLights{};  ///< for which the model's fit is poor
  std::vector<AngleByDirection> angles;
  struct Lobe {
    int observed = -1;
    std::string light;
    double level = 0;                    ///< contour level, fraction of the peak
    std::optional<LobeSamples> samples;  ///< exactly one of samples and failure
    std::optional<Failure> failure;
    std::optional<double> roughness;             ///< m of the model, where it has one
    std::optional<LobeComparison> comparison{};  ///< of samples; none if `comparisonFailure` or `failure` says why
    std::optional<Failure> comparisonFailure{};
  };
  std::vector<Lobe> lobes;
  std::string failure;  ///< why there are no samples; "" if there are some
};
/// Reads the frame's linear image, mask and surface, and samples its highlights for the model's light. Slow: tens of milliseconds
/// and more.
/// @param frame  an index of the inspection's scene.
FrameSamples frameSamples(const Inspection& inspection, int frame, const std::string& model);

/// Contour error of every frame, one series per model, training and excluded frames tinted; logarithmic where errors span more
/// than a factor of 30. A frame where a model missed a highlight has a cross and no error, an excluded frame neither.
struct ErrorPlotOptions {
  std::set<std::string> models{};  ///< empty = all
  bool means = false;              ///< the legend tells each model's mean over the held-out frames that have an error
};
PlotData errorPlot(const Inspection& inspection, const ErrorPlotOptions& options = {});
/// log(I/K') against alpha of one highlight's pixels, the lobe fitted to them and the model's own. @param highlight  -1 = the
/// first.
PlotData lobePlot(const FrameSamples& samples, int highlight);
/// Radiance over its peak against alpha: mean and spread of one highlight's pixels, and every lobe fitted to them, with roughness
/// and residual. @param highlight  -1 = the first.
PlotData lobesPlot(const FrameSamples& samples, int highlight);
/// The samples of one highlight; -1 = the first; null without samples.
const FrameSamples::Lobe* lobeOfHighlight(const FrameSamples& samples, int highlight);
/// Semi-axes of every model's ellipsoid, longest first, with one standard deviation where the fit tells one.
PlotData semiAxesPlot(const Inspection& inspection);
/// Signed distance predicted minus observed by direction, every model of the frame. @param highlight  -1 = the first matched one.
PlotData residualDial(const Inspection& inspection, int frame, int highlight);
/// alpha along the observed and the predicted contour by direction.
PlotData limitAnglePlot(const FrameSamples& samples, int highlight);
/// Singular values of the linear systems for Q*, relative to the first.
PlotData singularValuePlot(const std::vector<Conditioning>& conditioning);
/// Ranked error over time per frame of every measured setting.
PlotData tradeoffPlot(const Tradeoff& tradeoff);
/// What every training frame does for the models; see influenceOf. Where nothing can be answered, `empty` says why.
/// @param model  "" = all.
PlotData influencePlot(const Inspection& inspection, const Influence& influence, const std::string& model);

}  // namespace glint::draw
