// SPDX-License-Identifier: BSD-3-Clause
#include "core/pipeline/comparison.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/camera.h"
#include "core/model/band.h"
#include "core/model/view_effects.h"

namespace glint {
namespace {

/// A line as the photograph measures it, without places that the lens shows nowhere.
Polyline measured(const Polyline& ideal, const Camera& camera) {
  Polyline line{{}, ideal.closed};
  for (const Pixel& p : ideal.points)
    if (const Pixel q = camera.distorted(p); q.allFinite()) line.points.push_back(q);
  return line;
}

/// Sutherland-Hodgman against the rectangle of measured pixel centres [0, w-1] x [0, h-1], where detection's contours end.
Polyline clippedToImage(const Polyline& line, const Camera& camera) {
  Polyline result = camera.hasDistortion() ? measured(line, camera) : line;
  const double edges[4] = {0, -(camera.width - 1.0), 0, -(camera.height - 1.0)};
  for (int side = 0; side < 4; ++side) {
    const int axis = side / 2;
    const double sign = side % 2 == 0 ? 1 : -1;
    const auto value = [&](const Pixel& p) { return sign * p[axis] - edges[side]; };
    Polyline next{{}, true};
    const auto& p = result.points;
    for (std::size_t i = 0; i < p.size(); ++i) {
      const Pixel &a = p[i], &b = p[(i + 1) % p.size()];
      const double fa = value(a), fb = value(b);
      if (fa >= 0) next.points.push_back(a);
      if ((fa >= 0) != (fb >= 0)) next.points.push_back(a + fa / (fa - fb) * (b - a));
    }
    result = std::move(next);
  }
  if (camera.hasDistortion())
    for (Pixel& p : result.points) p = camera.undistorted(p);
  return result;
}

bool leavesImage(const Polyline& line, const Camera& camera) {
  return std::any_of(line.points.begin(), line.points.end(), [&](const Pixel& p) { return !isInPhotograph(camera, p); });
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

std::optional<BandScore> bandScore(const Polyline& observed, const PredictedHighlight& h) {
  constexpr double kNormal95 = 1.959964;
  BandScore score;
  double count = 0;
  for (const double sigma : h.sigmaPx)
    if (sigma > 0) count += 1, score.sigmaPx += sigma;
  if (!(count > 0)) return std::nullopt;
  score.sigmaPx /= count;
  std::vector<ContourFoot> feet;
  for (const ContourFoot& foot : feetOn(h.contour, observed.points))
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
    if (used[p] || clippedToImage(c.prediction.highlights()[p].contour, camera).points.empty()) continue;  // it could not be seen
    FrameComparison::Row row;
    row.predicted = static_cast<int>(p);
    c.rows.push_back(row);
  }
  return compared;
}

}  // namespace

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
  for (int i = 0; i < static_cast<int>(evidence.scored().size()); ++i) {
    const Highlight& h = evidence.scored()[i];
    if (h.light != light || h.contour.points.size() < 3) continue;
    observedIndex.push_back(i);
    observed.push_back(h.contour);
  }
  const bool cut = std::any_of(observedIndex.begin(), observedIndex.end(),
                               [&](int i) { return evidence.scored()[i].touchesBorder && !evidence.scored()[i].fromScene; });
  std::vector<char> clipped(c.prediction.highlights().size(), 0);
  for (std::size_t i = 0; i < c.prediction.highlights().size(); ++i) {
    const PredictedHighlight& h = c.prediction.highlights()[i];
    clipped[i] = cut && leavesImage(h.contour, camera);
    predicted.push_back(clipped[i] ? clippedToImage(h.contour, camera) : h.contour);
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
      row.metrics = compareContours(observed[o], predicted[row.predicted],
                                    clipped[row.predicted] ? std::vector<std::pair<int, int>>{} : h.gaps, h.ellipse,
                                    evidence.scored()[row.observed].peak, h.brightest.pixel, ious[pair - pairs.begin()]);
      row.band = bandScore(observed[o], h);
    }
    c.rows.push_back(std::move(row));
  }
  const std::vector<Polyline> compared = addSpurious(evidence, camera, predicted, used, c);
  c.iou = observed.size() == 1 && predicted.size() == 1 && ious.size() == 1 ? ious[0] : regionIou(observed, compared);
  return c;
}

}  // namespace glint
