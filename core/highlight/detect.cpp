// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "core/base/numeric.h"
#include "core/highlight/background.h"
#include "core/highlight/clipped_flank.h"
#include "core/highlight/diffuse.h"
#include "core/highlight/frame_blur.h"
#include "core/highlight/highlight.h"
#include "core/highlight/iso_contour.h"
#include "core/highlight/peak.h"

namespace glint {
namespace {

constexpr double kCandidateShare = 0.8;    // candidates are searched somewhat below the level: their own background moves it
constexpr int kClippedPixels = 3;          // fewer saturated pixels are single hot ones
constexpr int kRoiMargin = 3;              // px around a candidate's box
constexpr double kFirstRung = 0.9;         // of the strongest value: separate peaks are searched from here down,
constexpr double kNextRung = 0.75;         // by steps small enough that a peak shows before it merges with a stronger one,
constexpr double kLastRung = 0.02;         // to here; weaker ones drown in the tails of the strongest
constexpr std::size_t kMostPeaks = 48;     // that are followed up: noise has many
constexpr double kSamePeakPx = 1.5;        // of the same peak, found again
constexpr std::size_t kMostRejected = 32;  // that are listed: noise has many
constexpr double kNarrowPiece =
    0.1;  // of the disc inside a clipped highlight: radius of a piece of its streaks, as withoutStreaks cuts them
constexpr double kBesidePx = 1.0;           // in discs inside a clipped highlight: its streaks end within that
constexpr int kFlankShare = 1;              // of a clipped candidate's box, on each side: its slope down to a tenth lies within
constexpr double kBackgroundShare = 0.01;   // of the clip height: by that much a quadratic in the pixel misses real shading
constexpr int kBackgroundRounds = 3;        // with the tail that the slope shows: it settles in two
constexpr double kSettledBackground = 0.1;  // of its standard deviation
constexpr double kWorseBackground = 1.1;    // of the spread around it: that much more is another background, no better one
constexpr double kOnBorderPx = 0.01, kPeakAtBorderPx = 0.5;  // contours run along it; a peak that one side holds is no surer
constexpr double kBadReachPx = 1.5;                          // an unusable pixel this near to a contour decides on its course

/// One channel, with what may and may not be used of it.
struct Prepared {
  Image value;               ///< unusable pixels are 0
  std::vector<char> usable;  ///< finite, not negative, on the glossy object
  std::vector<char> bad;     ///< not finite or negative
  std::vector<char> saturated;
  int badCount = 0, usableCount = 0;
};

Prepared prepare(const Image& linear, const Image* mask, double clipValue) {
  Prepared p;
  p.value = Image(linear.width, linear.height, 1);
  const std::size_t n = p.value.data.size();
  p.usable.assign(n, 0);
  p.bad.assign(n, 0);
  p.saturated.assign(n, 0);
  const int channels = linear.channels;
  // Just outside the mask the image's own values are kept, so that no contour follows the border of a binary mask.
  cv::Mat near;
  if (mask) {
    cv::Mat on(linear.height, linear.width, CV_8U);
    for (int y = 0; y < linear.height; ++y)
      for (int x = 0; x < linear.width; ++x) on.at<unsigned char>(y, x) = mask->at(x, y) != 0.f ? 255 : 0;
    cv::dilate(on, near, cv::Mat());
  }
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0;
    bool good = true, full = false;
    for (int c = 0; c < channels; ++c) {
      const float v = linear.data[i * static_cast<std::size_t>(channels) + static_cast<std::size_t>(c)];
      good = good && std::isfinite(v) && v >= 0;
      full = full || (clipValue > 0 && v >= clipValue);
      sum += v;
    }
    p.bad[i] = !good;
    p.badCount += !good;
    if (!good) continue;
    const std::size_t pixel = i;
    const bool on = !mask || mask->data[pixel * static_cast<std::size_t>(mask->channels)] != 0.f;
    p.usable[i] = on;
    p.usableCount += on;
    p.saturated[i] = full;
    if (!mask || near.data[pixel]) p.value.data[i] = static_cast<float>(sum / channels);
  }
  return p;
}

/// Median and 1.4826 MAD of the usable pixels (every k-th of a big image).
struct Level {
  double median = 0, spread = 0;
};
Level robustLevel(const Prepared& p) {
  std::vector<float> values;
  const std::size_t stride = std::max<std::size_t>(1, p.usable.size() / 100000);
  for (std::size_t i = 0; i < p.usable.size(); i += stride)
    if (p.usable[i]) values.push_back(p.value.data[i]);
  if (values.empty()) return {};
  Level level;
  level.median = ranked(values, values.size() / 2);
  for (float& v : values) v = std::abs(v - static_cast<float>(level.median));
  level.spread = 1.4826 * ranked(values, values.size() / 2);
  return level;
}

/// A connected region that may hold one or more highlights, with its background removed.
struct Candidate {
  int label = 0;
  cv::Rect box;  ///< in the image
  Background background;
  Image corrected;                    ///< I - b inside `box`; 0 on unusable pixels
  double top = 0;                     ///< strongest value: of the fitted peak, else of the pixels
  std::optional<ClippedFlank> flank;  ///< of a clipped one
  int clippedPixels = 0;
};

/// A view of an image of one channel.
cv::Mat valuesOf(const Image& image) { return {image.height, image.width, CV_32F, const_cast<float*>(image.data.data())}; }

/// Position of the largest 3x3 mean inside the box-local region; hot pixels do not win.
cv::Point strongestPixel(const cv::Mat& values, const cv::Mat& region) {
  cv::Mat smooth;
  cv::GaussianBlur(values, smooth, cv::Size(3, 3), 0, 0, cv::BORDER_REPLICATE);
  cv::Point at(0, 0);
  cv::minMaxLoc(smooth, nullptr, nullptr, nullptr, &at, region);
  return at;
}

Footprint footprintOf(const cv::Mat& labels, int label, const cv::Rect& box, double level) {
  Eigen::Vector2d mean(0, 0);
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  double n = 0;
  for (int y = box.y; y < box.y + box.height; ++y)
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (labels.at<int>(y, x) != label) continue;
      const Eigen::Vector2d p(x, y);
      mean += p;
      square += p * p.transpose();
      n += 1;
    }
  mean /= n;
  Footprint footprint;
  footprint.centre = mean;
  // A uniform ellipse has second moments of a quarter of its squared semi-axes; 1/12 is a pixel's own.
  footprint.shape = 4 * (square / n - mean * mean.transpose()) + (1.0 / 3.0) * Eigen::Matrix2d::Identity();
  footprint.level = level;
  return footprint;
}

cv::Rect grown(const cv::Rect& box, int margin, int width, int height) {
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
         cv::Rect(0, 0, width, height);
}

Image correctedRoi(const Prepared& p, const Background& background, const cv::Rect& box) {
  Image roi(box.width, box.height, 1);
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x) {
      if (p.bad[static_cast<std::size_t>(y + box.y) * p.value.width + x + box.x]) continue;
      roi.at(x, y) = static_cast<float>(p.value.at(x + box.x, y + box.y) - background.at(x + box.x, y + box.y));
    }
  return roi;
}

/// Pixels of the region inside a contour given in ROI coordinates.
cv::Mat filled(const Polyline& line, int width, int height) {
  cv::Mat region = cv::Mat::zeros(height, width, CV_8U);
  std::vector<cv::Point> corners;
  corners.reserve(line.points.size());
  constexpr int kShift = 8;  // fractional bits of fillPoly
  for (const Pixel& q : line.points)
    corners.emplace_back(static_cast<int>(std::lround(q.x() * (1 << kShift))),
                         static_cast<int>(std::lround(q.y() * (1 << kShift))));
  cv::fillPoly(region, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255), cv::LINE_8, kShift);
  return region;
}

/// An unusable pixel inside a contour, or so near that it bends it.
bool touchesBad(const Prepared& p, const cv::Rect& box, const cv::Mat& region) {
  cv::Mat reach;
  const int r = static_cast<int>(std::ceil(kBadReachPx));
  cv::dilate(region, reach, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * r + 1, 2 * r + 1)));
  for (int y = 0; y < box.height; ++y)
    for (int x = 0; x < box.width; ++x)
      if (reach.at<unsigned char>(y, x) && p.bad[static_cast<std::size_t>(y + box.y) * p.value.width + x + box.x]) return true;
  return false;
}

class Detector {
 public:
  Detector(const Prepared& prepared, const DetectOptions& options) : p_(prepared), options_(options) {}

  std::vector<RejectedCandidate> rejected() {
    std::stable_sort(rejected_.begin(), rejected_.end(), [](const auto& a, const auto& b) { return a.areaPx2 > b.areaPx2; });
    if (rejected_.size() > kMostRejected) rejected_.resize(kMostRejected);
    return std::move(rejected_);
  }

  Outcome<std::vector<Highlight>> run() {
    level_ = robustLevel(p_);
    noise_ = pixelNoise(p_.value, p_.usable);
    base_ = options_.removeBackground ? level_.median : 0.0;
    if (options_.separatePeaks) {
      if (const std::optional<Failure> failure = findSeparately()) return *failure;
    } else {
      findCandidates();
      if (candidates_.empty()) return Failure{Reason::NoHighlight, "nothing rises above the background"};
      raiseClippedTop();
      reference_ = 0;
      for (const Candidate& c : candidates_) reference_ = std::max(reference_, c.top);
      if (options_.reference) reference_ = *options_.reference;
      if (!(reference_ > 0)) return Failure{Reason::NoHighlight, "nothing rises above the local background"};
      for (const Candidate& c : candidates_) trace(c);
    }
    removeRepeats();
    rejectNarrowPieces();
    std::erase_if(found_, [&](const Highlight& h) {
      if (h.clipped || h.peakValue >= options_.minRelativePeak * reference_) return false;
      reject(h.contour, "much weaker than the strongest highlight");
      return true;
    });
    if (found_.empty()) {
      if (failedByBadPixels_ > 0)
        return Failure{Reason::NotFinite,
                       std::to_string(p_.badCount) + " pixels are negative or not finite, and the highlight touches them"};
      return Failure{Reason::NoHighlight, "no region is large and bright enough"};
    }
    return std::move(found_);
  }

 private:
  /// Values of the brightest 3x3 median (single hot pixels do not set the level); nothing if none is above the base.
  std::optional<double> brightestMedian() const {
    cv::Mat median;
    cv::medianBlur(valuesOf(p_.value), median, 3);
    const cv::Mat usable(median.size(), CV_8U, const_cast<char*>(p_.usable.data()));
    double top = 0;
    cv::minMaxLoc(median, nullptr, &top, nullptr, nullptr, usable);
    return top - base_ > 0 ? std::optional<double>(top) : std::nullopt;
  }

  /// Connected regions at or above a value, as boxes by label; those too small to hold a highlight are empty.
  std::vector<cv::Rect> regionsAbove(double threshold) {
    cv::Mat above = valuesOf(p_.value) >= threshold, stats, centroids;
    const int count = cv::connectedComponentsWithStats(above, labels_, stats, centroids, 4, CV_32S);
    std::vector<cv::Rect> boxes(static_cast<std::size_t>(count));
    for (int label = 1; label < count; ++label) {
      if (stats.at<int>(label, cv::CC_STAT_AREA) < 0.5 * options_.minAreaPx2) continue;
      boxes[static_cast<std::size_t>(label)] =
          cv::Rect(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                   stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    }
    return boxes;
  }

  struct Top {
    Pixel at;
    double value;
  };
  /// A region of labels_ with its background removed, and its peak.
  std::pair<Candidate, Top> candidateOf(int label, const cv::Rect& tight) const {
    Candidate c;
    c.label = label;
    c.box = grown(tight, kRoiMargin, p_.value.width, p_.value.height);
    c.background.coefficients[0] = base_;
    if (options_.removeBackground)
      c.background =
          fitBackground(p_.value, p_.usable, footprintOf(labels_, label, tight, kCandidateShare * options_.level), base_);
    c.corrected = correctedRoi(p_, c.background, c.box);
    cv::Mat region = labels_(c.box) == label;
    const cv::Point at = strongestPixel(valuesOf(c.corrected), region);
    const Outcome<PeakFit> peak = fitPeak(c.corrected, at.x, at.y, options_.peakWindowLevel);
    const bool clipped = saturatedNear(c.box, region);
    c.top = peak && !clipped ? peak->value : c.corrected.at(at.x, at.y);
    if (clipped) addFlank(c, tight, at);
    const Pixel where = (peak ? peak->at : Pixel(at.x, at.y)) + Pixel(c.box.x, c.box.y);
    const double top = c.top;
    return {std::move(c), Top{where, top}};
  }

  /// The slope of a clipped candidate, and the background again with the tail that it shows: the first fit has a Gaussian's
  /// below half of the clip value, and takes a longer one for shading.
  void addFlank(Candidate& c, const cv::Rect& tight, const cv::Point& top) const {
    const Footprint footprint = footprintOf(labels_, c.label, tight, kCandidateShare * options_.level);
    const Background longTail =
        options_.removeBackground ? fitBackground(p_.value, p_.usable, footprint, base_, Tail::Ggx) : c.background;
    const Pixel at(top.x + c.box.x, top.y + c.box.y);
    traceSlope(c, tight, at, longTail);
    const double unit = M_PI * std::sqrt(footprint.shape.determinant());  // area of the footprint, px^2
    for (int round = 0; round < kBackgroundRounds && options_.removeBackground && c.flank->trusted; ++round) {
      Candidate next = c;
      const FlankPeak& peak = *c.flank->peak;
      next.background =
          fitBackground(p_.value, p_.usable, footprint, base_, [&](double rho2) { return peak.fallAt(unit * rho2); });
      if (next.background.spread > kWorseBackground * c.background.spread) return;
      next.corrected = correctedRoi(p_, next.background, next.box);
      next.top = next.corrected.at(top.x, top.y);
      traceSlope(next, tight, at, longTail);
      const double moved = std::abs(next.background.at(at.x(), at.y()) - c.background.at(at.x(), at.y()));
      const bool settled = moved < kSettledBackground * c.flank->backgroundSigma;
      c = std::move(next);
      if (settled) return;
    }
  }

  /// The slope at several levels, in a view wide enough for its lowest ones.
  void traceSlope(Candidate& c, const cv::Rect& tight, const Pixel& top, const Background& longTail) const {
    const cv::Rect box =
        grown(tight, kFlankShare * std::max(tight.width, tight.height) + kRoiMargin, p_.value.width, p_.value.height);
    FlankView view;
    view.corrected = correctedRoi(p_, c.background, box);
    view.noise = noise_;
    view.minAreaPx2 = options_.minAreaPx2;
    c.clippedPixels = 0;
    for (int y = box.y; y < box.y + box.height; ++y)
      for (int x = box.x; x < box.x + box.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * p_.value.width + x;
        const bool saturated = p_.saturated[i] && labels_.at<int>(y, x) == c.label;
        view.usable.push_back(p_.usable[i]);
        view.saturated.push_back(saturated);
        c.clippedPixels += saturated;
      }
    // How far the background may be off: what GGX's tail would leave of it, and a little of what no model of it follows.
    view.backgroundSigma =
        std::max(kBackgroundShare * c.top, std::abs(longTail.at(top.x(), top.y()) - c.background.at(top.x(), top.y())));
    c.flank = traceFlank(view);
    const Pixel origin(box.x, box.y);
    for (FlankLevel& level : c.flank->levels) {
      level.contour = moved(std::move(level.contour), box);
      if (level.ellipse) level.ellipse->centre += origin;
    }
  }

  /// The peak that the slope of the largest clipped candidate continues sets the level; those of small ones do not.
  void raiseClippedTop() {
    const auto largest = std::max_element(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
      return a.clippedPixels < b.clippedPixels;
    });
    if (largest != candidates_.end() && largest->flank && reachesLevel(*largest->flank, options_.level))
      largest->top = std::max(largest->top, largest->flank->peak->value);
  }

  /// Regions above a little less than the level of the brightest value.
  void findCandidates() {
    const std::optional<double> top = brightestMedian();
    if (!top) return;
    const std::vector<cv::Rect> boxes = regionsAbove(base_ + kCandidateShare * options_.level * (*top - base_));
    for (std::size_t label = 1; label < boxes.size(); ++label)
      if (!boxes[label].empty()) candidates_.push_back(candidateOf(static_cast<int>(label), boxes[label]).first);
  }

  struct Seed {
    cv::Point at;
    double value;
  };

  /// Every peak with a contour of its own, strongest first: one that is separate at some value has its own region at its level.
  std::optional<Failure> findSeparately() {
    const std::optional<double> top = brightestMedian();
    if (!top) return Failure{Reason::NoHighlight, "nothing rises above the background"};
    const std::vector<Seed> seeds = findSeeds(*top);
    for (const Seed& s : seeds) traceAround(s, seeds);
    reference_ = 0;
    for (const Highlight& h : found_) reference_ = std::max(reference_, h.peakValue);
    return std::nullopt;
  }

  /// The peak of every region that appears while the threshold falls, strongest first.
  std::vector<Seed> findSeeds(double top) {
    std::vector<Seed> seeds;
    const cv::Mat values = valuesOf(p_.value);
    for (double share = kFirstRung; share >= kLastRung; share *= kNextRung) {
      const double threshold = base_ + share * (top - base_);
      if (threshold - base_ < options_.minContrast * noise_) break;
      const std::vector<cv::Rect> boxes = regionsAbove(threshold);
      std::vector<char> known(boxes.size(), 0);
      for (const Seed& s : seeds) known[static_cast<std::size_t>(labels_.at<int>(s.at))] = 1;
      for (std::size_t label = 1; label < boxes.size(); ++label) {
        if (known[label] || boxes[label].empty()) continue;
        const cv::Rect& box = boxes[label];
        const cv::Point at = strongestPixel(values(box).clone(), labels_(box) == static_cast<int>(label)) + box.tl();
        seeds.push_back({at, values.at<float>(at)});
      }
    }
    std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.value > b.value; });
    if (seeds.size() > kMostPeaks) seeds.resize(kMostPeaks);
    return seeds;
  }

  /// The contour around one peak, at the level of its own value.
  void traceAround(const Seed& s, const std::vector<Seed>& seeds) {
    const std::vector<cv::Rect> boxes = regionsAbove(base_ + kCandidateShare * options_.level * (s.value - base_));
    const int label = labels_.at<int>(s.at);
    if (label == 0 || boxes[static_cast<std::size_t>(label)].empty()) return;
    Pixel peak(s.at.x, s.at.y);
    // A region that reaches a stronger peak has that one's background and top, not its own.
    const bool alone = std::none_of(seeds.begin(), seeds.end(),
                                    [&](const Seed& o) { return o.value > s.value && labels_.at<int>(o.at) == label; });
    auto [candidate, found] = candidateOf(label, boxes[static_cast<std::size_t>(label)]);
    if (!alone)
      found.value = s.value - candidate.background.at(s.at.x, s.at.y);
    else
      peak = found.at;
    if (!(found.value > 0)) return;
    reference_ = found.value;
    if (alone && candidate.flank && reachesLevel(*candidate.flank, options_.level))
      reference_ = std::max(reference_, candidate.flank->peak->value);
    for (const PeakReference& r : options_.references)
      if ((r.peak - peak).norm() <= kSamePeakPx) reference_ = r.value;
    const std::size_t before = found_.size();
    trace(candidate);
    // At this level only the contour around the peak is its own, and only if no stronger peak owns it.
    for (std::size_t i = found_.size(); i-- > before;) {
      const bool own = contains(found_[i].contour, peak);
      const bool taken = own && std::any_of(seeds.begin(), seeds.end(), [&](const Seed& o) {
                           return o.value > s.value && contains(found_[i].contour, Pixel(o.at.x, o.at.y));
                         });
      if (own && !taken) continue;
      found_.erase(found_.begin() + static_cast<std::ptrdiff_t>(i));
      strength_.erase(strength_.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  bool saturatedNear(const cv::Rect& box, const cv::Mat& region) const {
    int count = 0;
    for (int y = 0; y < box.height; ++y)
      for (int x = 0; x < box.width; ++x)
        count += region.at<unsigned char>(y, x) && p_.saturated[static_cast<std::size_t>(y + box.y) * p_.value.width + x + box.x];
    return count >= kClippedPixels;
  }

  /// All highlights of one candidate at the common level.
  void trace(const Candidate& candidate) {
    const double level = options_.level * reference_;
    cv::Rect box = candidate.box;
    Image roi = candidate.corrected;
    std::vector<IsoContour> contours = isoContours(roi, level);
    // The box may cut the region when its own background is lower than the common one: widen it until it does not.
    while (leavesBox(contours, box)) {
      box = grown(box, std::max(box.width, box.height) / 2, p_.value.width, p_.value.height);
      roi = correctedRoi(p_, candidate.background, box);
      contours = isoContours(roi, level);
    }
    std::vector<const Polyline*> outer;
    for (const IsoContour& contour : contours) {
      // Holes are negative, lines without area none.
      if (signedArea(contour.line) < std::max(options_.minAreaPx2, 1e-9)) continue;
      const Pixel& any = contour.line.points.front();
      if (std::any_of(outer.begin(), outer.end(), [&](const Polyline* o) { return contains(*o, any); })) continue;
      outer.push_back(&contour.line);
      keep(candidate, box, roi, contour);
    }
  }

  bool leavesBox(const std::vector<IsoContour>& contours, const cv::Rect& box) const {
    if (box.width == p_.value.width && box.height == p_.value.height) return false;
    for (const IsoContour& contour : contours) {
      if (!contour.touchesBorder || signedArea(contour.line) < options_.minAreaPx2) continue;
      for (const Pixel& q : contour.line.points) {
        const bool left = q.x() < 0.01 && box.x > 0, top = q.y() < 0.01 && box.y > 0;
        const bool right = q.x() > box.width - 1.01 && box.x + box.width < p_.value.width;
        const bool bottom = q.y() > box.height - 1.01 && box.y + box.height < p_.value.height;
        if (left || top || right || bottom) return true;
      }
    }
    return false;
  }

  void keep(const Candidate& candidate, const cv::Rect& box, const Image& roi, const IsoContour& contour) {
    const cv::Mat region = filled(contour.line, box.width, box.height);
    const cv::Point at = strongestPixel(valuesOf(roi), region);
    if (!p_.usable[static_cast<std::size_t>(at.y + box.y) * p_.value.width + at.x + box.x] &&
        !p_.bad[static_cast<std::size_t>(at.y + box.y) * p_.value.width + at.x + box.x])
      return reject(moved(contour.line, box), "outside of the mask");
    if (touchesBad(p_, box, region)) {
      ++failedByBadPixels_;
      return reject(moved(contour.line, box), "touches pixels that are negative or not finite");
    }
    Highlight h;
    h.level = options_.level;
    const Pixel origin(box.x, box.y);
    h.contour = moved(contour.line, box);
    h.touchesBorder = onImageBorder(h.contour.points, kOnBorderPx);
    h.clipped = saturatedNear(box, region);
    if (h.clipped) {
      StreakCut cut = withoutStreaks(h.contour);
      h.contour = std::move(cut.line);
      h.cutPx2 = cut.cutPx2;
    }
    h.areaPx2 = signedArea(h.contour);
    // A candidate may hold several highlights; its slope is that of one.
    const bool itsSlope = candidate.flank && (candidate.flank->levels.empty() ||
                                              contains(h.contour, centroid(candidate.flank->levels.front().contour)));
    if (h.clipped && itsSlope) {
      auto flank = std::make_shared<ClippedFlank>(*candidate.flank);
      noteContour(*flank, options_.level, reference_, h.contour);
      h.flank = std::move(flank);
    }
    if (const Outcome<Ellipse> ellipse = fitEllipse(h.contour.points)) h.ellipse = *ellipse;
    const Outcome<PeakFit> peak = fitPeak(roi, at.x, at.y, options_.peakWindowLevel);
    if (h.clipped) {
      h.peak = h.ellipse ? h.ellipse->centre : centroid(h.contour);
    } else if (peak) {
      h.peak = peak->at + origin;
      h.peakValue = peak->value;
    } else {
      h.peak = Pixel(at.x, at.y) + origin;
      h.peakValue = roi.at(at.x, at.y);  // a plateau or a ridge on the border: the pixel is the best
    }
    h.peakCut = h.touchesBorder && (h.clipped || !peak || onImageBorder({h.peak}, kPeakAtBorderPx));
    const double spread = std::max(noise_, options_.removeBackground ? candidate.background.spread : 0.0);
    if (!h.clipped && h.peakValue < options_.minContrast * spread)
      return reject(h.contour, "stands out of the background's noise or texture by too little");
    strength_.push_back(roi.at(at.x, at.y));
    found_.push_back(std::move(h));
  }

  static Polyline moved(Polyline line, const cv::Rect& box) {
    for (Pixel& q : line.points) q += Pixel(box.x, box.y);
    return line;
  }

  void reject(const Polyline& contour, const char* reason) {
    rejected_.push_back({centroid(contour), std::abs(signedArea(contour)), reason});
  }

  /// Pieces of the streaks, grooves and reflections around a clipped highlight, which join it at another level.
  void rejectNarrowPieces() {
    std::vector<double> inside(found_.size());
    for (std::size_t i = 0; i < found_.size(); ++i) inside[i] = largestDiscInside(found_[i].contour);
    const auto isPieceOf = [&](std::size_t i, std::size_t core) {
      return i != core && found_[core].clipped && inside[i] < kNarrowPiece * inside[core] &&
             distance(found_[core].contour, centroid(found_[i].contour)) < kBesidePx * inside[core];
    };
    std::vector<Highlight> kept;
    for (std::size_t i = 0; i < found_.size(); ++i) {
      bool piece = false;
      for (std::size_t core = 0; core < found_.size(); ++core) piece = piece || isPieceOf(i, core);
      if (piece)
        reject(found_[i].contour, "narrow piece beside a clipped highlight: streak, groove or reflection");
      else
        kept.push_back(found_[i]);
    }
    found_ = std::move(kept);
  }

  bool onImageBorder(const std::vector<Pixel>& points, double px) const {
    return std::any_of(points.begin(), points.end(), [&](const Pixel& q) {
      return q.x() < px || q.y() < px || q.x() > p_.value.width - 1 - px || q.y() > p_.value.height - 1 - px;
    });
  }

  /// Strongest first; a region found from two candidates (their boxes overlap) is kept once.
  void removeRepeats() {
    std::vector<std::size_t> order(found_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return strength_[a] > strength_[b]; });
    std::vector<Highlight> kept;
    for (const std::size_t i : order) {
      const Highlight& h = found_[i];
      const bool repeated = std::any_of(kept.begin(), kept.end(), [&](const Highlight& k) {
        return contains(k.contour, centroid(h.contour)) || contains(h.contour, k.peak);
      });
      if (!repeated) kept.push_back(h);
    }
    found_ = std::move(kept);
  }

  const Prepared& p_;
  const DetectOptions& options_;
  Level level_;
  double noise_ = 0, base_ = 0, reference_ = 0;
  cv::Mat labels_;
  std::vector<Candidate> candidates_;
  std::vector<Highlight> found_;
  std::vector<double> strength_;  // one per entry of found_
  std::vector<RejectedCandidate> rejected_;
  int failedByBadPixels_ = 0;
};

}  // namespace

Outcome<std::vector<Highlight>> detectHighlights(const Image& linear, const Image* mask, const DetectOptions& options,
                                                 std::vector<RejectedCandidate>* rejected) {
  require(linear.width > 0 && linear.height > 0 && (linear.channels == 1 || linear.channels == 3),
          "detectHighlights: 1 or 3 channels, not empty");
  require(!mask || (mask->width == linear.width && mask->height == linear.height), "detectHighlights: mask of another size");
  require(options.level > 0 && options.level < 1, "detectHighlights: level between 0 and 1");
  Prepared prepared = prepare(linear, mask, options.clipValue);
  if (options.under) prepared.usableCount = takeOff(*options.under, prepared.value, prepared.usable);
  if (prepared.usableCount == 0) {
    if (prepared.badCount > 0)
      return Failure{Reason::NotFinite, std::to_string(prepared.badCount) + " pixels are negative or not finite"};
    return Failure{Reason::NoHighlight, "the mask is empty"};
  }
  Detector detector(prepared, options);
  Outcome<std::vector<Highlight>> found = detector.run();
  if (rejected) *rejected = detector.rejected();
  return found;
}

}  // namespace glint
