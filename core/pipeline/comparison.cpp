// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/comparison.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/camera.h"
#include "core/model/band.h"
#include "core/model/view_effects.h"

namespace glint {
namespace {

bool leavesImage(const Polyline& line, const Camera& camera) {
  return std::any_of(line.points.begin(), line.points.end(), [&](const Pixel& p) { return !isInPhotograph(camera, p); });
}

/// Points of an observed contour that are its own, and not the image's border.
std::vector<Pixel> seenPoints(const Highlight& h, const Camera& camera) {
  std::vector<Pixel> points = h.contour.points;
  if (h.touchesBorder)
    std::erase_if(points, [&](const Pixel& p) { return onImageBorder(camera, p) || !isInPhotograph(camera, p); });
  return points;
}

/// Standard deviation of what an observed contour has of its own, px: what remains of its distances from the predicted one once
/// the smooth shapes are taken out by which a whole view may be off. No prediction can know it.
double noiseOf(const std::vector<ContourFoot>& feet) {
  std::vector<Pixel> normals;
  std::vector<double> arcs;
  Eigen::VectorXd d(Eigen::Index(feet.size()));
  for (const ContourFoot& foot : feet) {
    d(Eigen::Index(normals.size())) = foot.distance;
    normals.push_back(foot.normal);
    arcs.push_back(foot.arc);
  }
  const Eigen::MatrixXd shapes = contourShapes(normals, arcs).columns;
  const double freedom = double(d.size() - shapes.cols());
  return freedom > 0 ? std::sqrt((d - shapes * (shapes.transpose() * d)).squaredNorm() / freedom) : 0;
}

std::optional<BandScore> bandScore(const std::vector<Pixel>& observed, const PredictedHighlight& h) {
  constexpr double kNormal95 = 1.959964;
  BandScore score;
  double count = 0;
  for (const double sigma : h.sigmaPx)
    if (sigma > 0) count += 1, score.sigmaPx += sigma;
  if (!(count > 0)) return std::nullopt;
  score.sigmaPx /= count;
  std::vector<ContourFoot> feet;
  for (const ContourFoot& foot : feetOn(h.contour, observed))
    if (h.sigmaPx[foot.from] > 0 && h.sigmaPx[foot.to] > 0 && foot.normal.allFinite()) feet.push_back(foot);
  if (feet.empty()) return std::nullopt;
  const double noise = noiseOf(feet);
  for (const ContourFoot& foot : feet) {
    const double sigma = (1 - foot.share) * h.sigmaPx[foot.from] + foot.share * h.sigmaPx[foot.to];
    score.coverage += std::abs(foot.distance) <= kNormal95 * std::hypot(sigma, noise);
  }
  score.coverage /= double(feet.size());
  return score;
}

/// Whether a predicted contour overlaps a highlight that a person ignores.
bool isIgnored(const FrameEvidence& evidence, const std::string& light, const Polyline& predicted) {
  return std::any_of(evidence.ignored.begin(), evidence.ignored.end(),
                     [&](const Highlight& h) { return h.light == light && regionIou({h.contour}, {predicted}) > 0; });
}

/// A row for each predicted contour without a partner.
/// @return the predicted contours without those where a person ignores a highlight
std::vector<Polyline> addSpurious(const FrameEvidence& evidence, const Camera& camera, const std::vector<Polyline>& predicted,
                                  const std::vector<char>& used, FrameComparison& c) {
  std::vector<Polyline> compared;
  for (std::size_t p = 0; p < predicted.size(); ++p) {
    if (!used[p] && isIgnored(evidence, c.light, predicted[p])) continue;
    compared.push_back(predicted[p]);
    const PredictedHighlight& h = c.prediction.highlights()[p];
    if (used[p] || partInImage(h.contour, {}, camera).region.points.empty()) continue;  // it could not be seen
    FrameComparison::Row row;
    row.predicted = static_cast<int>(p);
    c.rows.push_back(row);
  }
  return compared;
}

}  // namespace

ContourMetrics comparedHighlights(const Highlight& observed, const PredictedHighlight& predicted, const Camera& camera, bool cut,
                                  std::optional<double> iou) {
  if (cut)
    return compareContours(partInImage(observed.contour, {}, camera), partInImage(predicted.contour, predicted.gaps, camera),
                           observed.peak, predicted.brightest.pixel, iou);
  return compareContours(observed.contour, predicted.contour, predicted.gaps, predicted.ellipse, observed.peak,
                         predicted.brightest.pixel, iou);
}

FrameComparison compareFrame(const FrameEvidence& evidence, const std::string& light, const Camera& camera,
                             Prediction prediction) {
  FrameComparison c;
  c.frame = evidence.frame;
  c.light = light;
  c.prediction = std::move(prediction);
  const std::optional<Failure>& unscored = evidence.scoringFailure();
  if (unscored && unscored->reason != Reason::NoHighlight && evidence.scored().empty()) {
    FrameComparison::Row row;
    row.failure = unscored;
    c.rows.push_back(row);
    return c;
  }
  std::vector<int> observedIndex;
  std::vector<Polyline> observed, predicted;
  std::vector<std::optional<ContourPart>> parts, predictedParts;  // of those that the image's border cuts
  for (int i = 0; i < static_cast<int>(evidence.scored().size()); ++i) {
    const Highlight& h = evidence.scored()[i];
    if (h.light != light || h.contour.points.size() < 3) continue;
    std::optional<ContourPart> part = h.touchesBorder ? std::optional(partInImage(h.contour, {}, camera)) : std::nullopt;
    if (part && part->region.points.empty()) continue;  // the image shows nothing of it
    observedIndex.push_back(i);
    observed.push_back(part ? part->region : h.contour);
    parts.push_back(std::move(part));
  }
  const bool cut = std::any_of(parts.begin(), parts.end(), [](const auto& part) { return part.has_value(); });
  for (const PredictedHighlight& h : c.prediction.highlights()) {
    predictedParts.push_back(cut && leavesImage(h.contour, camera) ? std::optional(partInImage(h.contour, h.gaps, camera))
                                                                   : std::nullopt);
    predicted.push_back(predictedParts.back() ? predictedParts.back()->region : h.contour);
  }
  std::vector<double> ious;
  const std::vector<std::pair<int, int>> pairs = matchByOverlap(observed, predicted, &ious);
  std::vector<char> used(predicted.size(), 0);
  for (int o = 0; o < static_cast<int>(observed.size()); ++o) {
    FrameComparison::Row row;
    row.observed = observedIndex[o];
    const auto pair = std::find_if(pairs.begin(), pairs.end(), [&](const auto& p) { return p.first == o; });
    if (pair == pairs.end()) {
      row.failure =
          c.prediction.failure() ? *c.prediction.failure() : Failure{Reason::NotReached, "no prediction overlaps this highlight"};
    } else {
      row.predicted = pair->second;
      used[pair->second] = 1;
      const PredictedHighlight& h = c.prediction.highlights()[row.predicted];
      const Highlight& seen = evidence.scored()[row.observed];
      row.metrics = comparedHighlights(seen, h, camera, parts[o] || predictedParts[row.predicted], ious[pair - pairs.begin()]);
      row.band = bandScore(seenPoints(seen, camera), h);
    }
    c.rows.push_back(std::move(row));
  }
  const std::vector<Polyline> compared = addSpurious(evidence, camera, predicted, used, c);
  c.iou = observed.size() == 1 && predicted.size() == 1 && ious.size() == 1 ? ious[0] : regionIou(observed, compared);
  return c;
}

}  // namespace glint
