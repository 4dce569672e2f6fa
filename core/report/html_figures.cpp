// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/base/html_text.h"
#include "core/codecs/codecs.h"
#include "core/draw/frame_overlay.h"
#include "core/draw/plot_painter.h"
#include "core/draw/plots.h"
#include "core/draw/svg_painter.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/photograph.h"
#include "core/report/html_parts.h"
#include "core/scene/frame_name.h"

namespace glint::html {
namespace {

constexpr double kPlotWidth = 920, kPlotHeight = 320, kFrameWidth = 290;  // px of the page

/// The part of a frame around its observed contours; the whole frame without contours.
draw::Crop aroundObserved(const draw::FrameOverlay& overlay, const Camera& camera) {
  Eigen::AlignedBox2d observed;
  for (const draw::OverlayLine& line : overlay.lines)
    if (line.role == draw::OverlayRole::ObservedContour)
      for (const Pixel& p : line.points)
        if (p.allFinite()) observed.extend(p);
  if (observed.isEmpty()) observed = Eigen::AlignedBox2d(Pixel(0, 0), Pixel(camera.width - 1, camera.height - 1));
  const double pad = std::max(12.0, 0.5 * observed.sizes().maxCoeff());
  const int x0 = std::clamp(int(observed.min().x() - pad), 0, camera.width - 1),
            y0 = std::clamp(int(observed.min().y() - pad), 0, camera.height - 1);
  const int x1 = std::clamp(int(observed.max().x() + pad), x0 + 1, camera.width),
            y1 = std::clamp(int(observed.max().y() + pad), y0 + 1, camera.height);
  // Integer coordinates are pixel centres, so the image starts half a pixel earlier.
  return {x0 - 0.5, y0 - 0.5, double(x1 - x0), double(y1 - y0)};
}

std::vector<unsigned char> pngOf(const Image& photo, const draw::Crop& crop) {
  const int x0 = int(crop.x + 0.5), y0 = int(crop.y + 0.5);
  cv::Mat part(int(crop.height), int(crop.width), CV_8UC3);
  for (int y = 0; y < part.rows; ++y)
    for (int x = 0; x < part.cols; ++x)
      for (int k = 0; k < 3; ++k)
        part.at<cv::Vec3b>(y, x)[2 - k] =
            cv::saturate_cast<unsigned char>(255 * photo.at(x0 + x, y0 + y, std::min(k, photo.channels - 1)));
  std::vector<unsigned char> png;
  encodeWithOpenCv(".png", part, png);
  return png;
}

/// Held-out frames by the error of a model that found everything in them, the worst first.
std::vector<std::pair<int, double>> byError(const Inspection& inspection, const std::string& model) {
  std::vector<std::pair<int, double>> sorted;
  const std::vector<FrameScore> scores = frameScores(inspection.models.at(model), int(inspection.scene->frames.size()));
  for (int frame = 0; frame < int(scores.size()); ++frame)
    if (const std::optional<double> pct = wholeErrorPct(scores[std::size_t(frame)]); pct && inspection.isHeldOut(frame))
      sorted.emplace_back(frame, *pct);
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  return sorted;
}

/// Held-out frames in which a model missed a highlight.
std::vector<int> framesMissed(const Inspection& inspection, const std::string& model) {
  std::vector<int> frames;
  const std::vector<FrameScore> scores = frameScores(inspection.models.at(model), int(inspection.scene->frames.size()));
  for (int frame = 0; frame < int(scores.size()); ++frame)
    if (scores[std::size_t(frame)].missed > 0 && inspection.isHeldOut(frame)) frames.push_back(frame);
  return frames;
}

}  // namespace

std::string frameFigure(const Inspection& inspection, int frame, const std::string& model, const std::string& title) {
  draw::OverlayOptions options;
  if (!model.empty()) options.models = {model};
  options.hidden = {draw::OverlayRole::PredictedPeak};
  for (const draw::OverlayLayer& layer : draw::overlayLayers())
    if (layer.role != draw::OverlayRole::ObservedContour && layer.role != draw::OverlayRole::PredictedContour)
      options.hidden.insert(layer.role);
  const draw::FrameOverlay overlay = draw::frameOverlay(inspection, frame, options);
  const draw::Crop crop = aroundObserved(overlay, inspection.scene->frames[std::size_t(frame)].camera);
  const draw::Box box{0, 0, kFrameWidth, kFrameWidth * crop.height / crop.width};
  draw::SvgPainter painter(box.width, box.height, draw::Colour{0, 0, 0});
  if (const Outcome<Image> photo = photographOf(inspection, frame)) painter.picture(pngOf(*photo, crop), "image/png", box);
  draw::paintOverlay(painter, overlay, crop, box);
  std::string caption;
  for (const draw::OverlayCaption& c : overlay.captions)
    caption += (c.model.empty() ? "" : swatch(c.model)) + escaped(c.text) + "<br>";
  const std::string name = "frame " + frameName(*inspection.scene, frame), named = "<b>" + escaped(name) + "</b>";
  return "<figure>" + painter.element("contours of " + name) + "<figcaption>" +
         (title.empty() ? named : "<b>" + escaped(title) + "</b>, " + named) + "<br>" + caption + "</figcaption></figure>\n";
}

std::string errorFigure(const Inspection& inspection) {
  const draw::PlotData plot = draw::errorPlot(inspection, {{}, true});
  if (!plot.empty.empty()) return "<p>" + escaped(plot.empty) + ".</p>\n";
  draw::SvgPainter painter(kPlotWidth, kPlotHeight);
  draw::paintPlot(painter, plot, {false, 1}, draw::rangeOf(plot), {}, kPlotWidth, kPlotHeight);
  return painter.element("contour error over frames") +
         "<p class=\"note\">Blue: training frames. On screen, hover over a point for its value.</p>\n";
}

std::string bestFigures(const Inspection& inspection, const std::string& model) {
  std::string html;
  const std::vector<std::pair<int, double>> sorted = byError(inspection, model);
  if (!sorted.empty()) {
    const int typical = sorted[sorted.size() / 2].first;
    if (typical != sorted[0].first) html += frameFigure(inspection, typical, model, "Typical frame");
    html += frameFigure(inspection, sorted[0].first, model, sorted.size() == 1 ? "The only frame" : "Worst frame");
  }
  if (const std::vector<int> missed = framesMissed(inspection, model); !missed.empty())
    html += frameFigure(inspection, missed[0], model, "Missed");
  return html.empty() ? html : "<div class=\"frames\">\n" + html + "</div>\n";
}

std::vector<int> worstFrames(const Inspection& inspection, std::size_t count) {
  std::vector<std::vector<std::pair<int, double>>> sorted;
  std::set<int> missed;
  for (const std::string& name : inspection.request.models) {
    if (!inspection.models.count(name)) continue;
    sorted.push_back(byError(inspection, name));
    for (const int frame : framesMissed(inspection, name)) missed.insert(frame);
  }
  std::vector<int> frames;
  std::set<int> seen;
  for (const int frame : missed)
    if (frames.size() < count / 3 && seen.insert(frame).second) frames.push_back(frame);
  for (std::size_t rank = 0; frames.size() < count; ++rank) {
    bool any = false;
    for (const auto& list : sorted) {
      if (rank >= list.size()) continue;
      any = true;
      if (frames.size() < count && seen.insert(list[rank].first).second) frames.push_back(list[rank].first);
    }
    if (!any) break;
  }
  return frames;
}

}  // namespace glint::html
