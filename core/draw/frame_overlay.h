// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/draw/colours.h"
#include "core/draw/painter.h"
#include "core/draw/selection.h"
#include "core/geometry/camera.h"
#include "core/pipeline/frame_score.h"

namespace glint::draw {

/// What a stroke of the overlay shows; the views toggle by it.
enum class OverlayRole {
  ObservedContour,
  ObservedEllipse,
  ObservedPeak,
  PredictedContour,
  PredictedEllipse,
  PredictedPeak,
  CanonicalEllipse,
  UncertaintyBand,
  LimitDirections,
  ResidualArrows,
  SelectedPoint,
  Unmatched,
  EpipolarLine,
  Lobes
};

struct FrameSamples;

/// What can be shown and hidden in the frame view, in the order of its legend.
struct OverlayLayer {
  OverlayRole role;
  const char* name;   ///< "frame/observed"
  const char* title;  ///< short
  const char* tip;    ///< one sentence
  bool onByDefault;
};
const std::vector<OverlayLayer>& overlayLayers();

/// One polyline over the photograph. Points are photograph pixels as stored in the file (lens distortion applied),
/// (0, 0) = centre of the top-left pixel; the view scales them. Widths are screen pixels and do not scale with the zoom.
struct OverlayLine {
  OverlayRole role = OverlayRole::ObservedContour;
  std::vector<Pixel> points;
  bool closed = false;
  Colour colour{1, 1, 1};
  double width = 2;   ///< screen px
  bool halo = false;  ///< draw a dark stroke, 2 screen px wider, beneath
  Dash dash = Dash::Solid;
  std::string label;  ///< short text for a tool tip or a legend: "canonical 0.42 %"; may be empty
  std::string model;  ///< "" for observed
  std::string light;
  int highlight = -1;      ///< observed: index into FrameEvidence::scored(); predicted: into the prediction's highlights
  bool unmatched = false;  ///< observed and missed, or predicted and spurious: has no partner
};

enum class MarkShape { Cross, Circle, Square, Triangle };

/// One mark at a pixel (peak, brightest point).
struct OverlayMark {
  OverlayRole role = OverlayRole::ObservedPeak;
  Pixel at{0, 0};
  MarkShape shape = MarkShape::Cross;
  Colour colour{1, 1, 1};
  double size = 5;     ///< half size, screen px
  double width = 1.5;  ///< screen px
  bool halo = true;
  std::string label, model, light;
  int highlight = -1;
};

/// One line of text under or beside the photograph: a model's error, or the reason why it did not answer.
struct OverlayCaption {
  Colour colour{1, 1, 1};
  std::string model;     ///< "" for the observation
  std::string text;      ///< "canonical  0.42 %  0.31 px  IoU 0.981"
  bool problem = false;  ///< a failure, a missed or a spurious highlight
  FrameScore score;      ///< the same as numbers, for a table; `reason` also says why there is no answer
};

/// Everything that is drawn over one photograph, in drawing order (later on top). Plain data: no VTK, no Qt.
struct FrameOverlay {
  std::vector<OverlayLine> lines;
  std::vector<OverlayMark> marks;
  std::vector<OverlayCaption> captions;
};

struct OverlayOptions {
  std::set<std::string> models;                   ///< models to draw; empty = all
  std::set<std::string> hiddenModels;             ///< of these only the caption
  std::set<OverlayRole> hidden;                   ///< roles left out
  int ellipseSegments = 96;                       ///< samples per ellipse, >= 8
  bool colourByRole = false;                      ///< predictions in the colour of the frame's role instead of the model's
  bool predictionsEarlier = false;                ///< of an older request than what is observed: pale, and their labels say so
  double residualScale = 1;                       ///< residual arrows are drawn so many times their length
  std::optional<Selection> selection{};           ///< drawn thicker, its contour point marked, when it is of this frame
  std::shared_ptr<const FrameSamples> samples{};  ///< of the layer of lobes, which is empty without them; ignored in other frames
};

/// Overlay of one frame: observed contours (white with halo), their least-squares ellipses (thin, dashed) and peaks
/// (crosses); per model in its fixed colour the predicted contours (dashed in frames that do not train, bridged gaps dotted),
/// their 95 % bands, ellipses (dashed), brightest points (circles), arrows from observed to predicted contour every 10 degrees,
/// and the walks of the limit angles (to the end on S, dotted on to the end on T). Empty lines and marks for a frame without
/// evidence; the captions then say why. Highlights without a partner look different: an observed highlight that the selected
/// model misses (any drawn one, where none is selected) is dashed with a crossed square at its peak; a spurious prediction has
/// dashes and dots and a triangle at its middle; one that a filter took out is thin and dotted.
/// @param frame  index into scene->frames; std::invalid_argument if it does not exist.
FrameOverlay frameOverlay(const Inspection& inspection, int frame, const OverlayOptions& options = {});

/// Extent of the closed lines of a role around a pixel, photograph px; empty without such a line.
Eigen::AlignedBox2d extentAround(const FrameOverlay& overlay, OverlayRole role, const Pixel& pixel);

/// A run of a predicted contour, in ideal pixels: predicted, or only bridging failed directions.
struct ContourRun {
  std::vector<Pixel> points;
  bool closed = false;
  bool gap = false;
};
std::vector<ContourRun> contourRuns(const PredictedHighlight& highlight);

/// The highlight under every lobe that is fitted to its pixels: the contour at the level of the best lobe's peak, and in thinner
/// lines the contour at kTailShare of that level, where lobes differ most. Lines look as in the plot "Every lobe". Each lobe has
/// a caption, or the reason why it is missing.
/// @param highlight  index into FrameEvidence::scored(); -1 = the first
void addLobes(const FrameSamples& samples, int highlight, FrameOverlay& overlay);

/// Share of the level: low enough to tell a long tail, high enough for LobeOptions::reach (GGX: 1.95 of 2.2 times the contour).
inline constexpr double kTailShare = 0.3;

/// Paints an overlay: photograph pixels of `crop` are stretched over `box` and cut at its border; marks are in or out by their
/// place. Marks and widths keep their screen size times `inkScale`. @param hints  labels answer the mouse (Painter::hint)
void paintOverlay(Painter& painter, const FrameOverlay& overlay, const Crop& crop, const Box& box, double inkScale = 1,
                  bool hints = false);

}  // namespace glint::draw
