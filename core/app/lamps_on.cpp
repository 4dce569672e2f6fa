// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/lamps_on.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/base/numeric.h"
#include "core/base/progress.h"
#include "core/highlight/frame_blur.h"
#include "core/pipeline/evidence.h"
#include "core/pipeline/highlight_motion.h"
#include "core/pipeline/live_prediction.h"

namespace glint {
namespace {

constexpr double kRingFrom = 1.6, kRingTo = 2.6;  // of the contour's size: beyond the lobe's flank, and still its surroundings
constexpr std::size_t kLeastInside = 6, kLeastRing = 20;  // px: fewer have no mean and no spread
constexpr double kLeastShown = 0.5;  // of the contour: the rest lies outside of the image or of what may be used
constexpr double kCorrelated = 3;    // a spread over this is the deviation of a mean: texture has no independent pixels
constexpr double kLeak = 0.05;       // of the expected contrast: other lamps' tails and reflections
constexpr double kLobeChange = 0.4;  // of the expected contrast: over views at different incidence
constexpr double kSureProbability = 0.95;
constexpr double kUnexpectedShare = 0.3;  // of the weakest lamp's contrast
constexpr double kUnexpectedNoise = 5;    // standard deviations
constexpr double kNearby = 1.6;           // of a predicted contour's size: a highlight there is that lamp's

Polyline scaled(const Polyline& line, const Pixel& about, double factor) {
  Polyline result = line;
  for (Pixel& p : result.points) p = about + factor * (p - about);
  return result;
}

/// A contour in measured pixels; none if the lens does not show all of it.
std::optional<Polyline> onImage(Polyline line, const Camera& camera) {
  for (Pixel& p : line.points) {
    p = camera.distorted(p);
    if (!p.allFinite()) return std::nullopt;
  }
  return line;
}

/// 255 inside of the line, in a box of the image around it.
cv::Mat maskOf(const Polyline& line, const cv::Rect& box) {
  cv::Mat mask = cv::Mat::zeros(box.height, box.width, CV_8U);
  std::vector<cv::Point> corners;
  constexpr int kShift = 4;     // fractional bits of fillPoly
  constexpr double kFar = 1e5;  // px: beyond it fillPoly's integers overflow
  for (const Pixel& p : line.points)
    corners.emplace_back(static_cast<int>(std::lround(std::clamp(p.x() - box.x, -kFar, kFar) * (1 << kShift))),
                         static_cast<int>(std::lround(std::clamp(p.y() - box.y, -kFar, kFar) * (1 << kShift))));
  cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{corners}, cv::Scalar(255), cv::LINE_8, kShift);
  return mask;
}

struct Contrast {
  double value = 0, noise = 0;
};

/// One frame's pixels, and the contours that lamps would show in it.
class LookedAtFrame {
 public:
  LookedAtFrame(const Frame& frame, LinearPixels pixels)
      : camera_(frame.camera), pixels_(std::move(pixels)), noise_(pixelNoise(pixels_.value, pixels_.usable)) {}

  /// Contrast of what a contour encloses. OutsideImage, TooFewPoints.
  Outcome<Contrast> contrastOf(const Polyline& ideal, const std::vector<Polyline>& others) const {
    const std::optional<Polyline> line = onImage(ideal, camera_);
    if (!line) return Failure{Reason::OutsideImage, "the lens does not show it"};
    const Pixel middle = centroid(*line);
    const Polyline from = scaled(*line, middle, kRingFrom), to = scaled(*line, middle, kRingTo);
    Eigen::AlignedBox2d around;
    for (const Pixel& p : to.points) around.extend(p);
    const cv::Rect whole(0, 0, pixels_.value.width, pixels_.value.height);
    const Eigen::AlignedBox2d shown =
        around.intersection(Eigen::AlignedBox2d(Pixel(0, 0), Pixel(whole.width - 1, whole.height - 1)));
    if (shown.isEmpty()) return Failure{Reason::OutsideImage, "outside of the image"};
    const cv::Rect box = cv::Rect(static_cast<int>(shown.min().x()), static_cast<int>(shown.min().y()),
                                  static_cast<int>(shown.sizes().x()) + 2, static_cast<int>(shown.sizes().y()) + 2) &
                         whole;
    const cv::Mat inside = maskOf(*line, box);
    cv::Mat ring = maskOf(to, box) & ~maskOf(from, box);
    for (const Polyline& other : others)
      if (const std::optional<Polyline> o = onImage(other, camera_)) ring &= ~maskOf(scaled(*o, centroid(*o), kRingFrom), box);
    std::vector<double> in, out;
    for (int y = 0; y < box.height; ++y)
      for (int x = 0; x < box.width; ++x) {
        const std::size_t i = static_cast<std::size_t>(y + box.y) * pixels_.value.width + x + box.x;
        const bool usable = pixels_.usable[i];
        if (inside.at<unsigned char>(y, x) && (usable || pixels_.clipped[i])) in.push_back(pixels_.value.data[i]);
        if (ring.at<unsigned char>(y, x) && usable) out.push_back(pixels_.value.data[i]);
      }
    if (static_cast<double>(in.size()) < kLeastShown * std::abs(signedArea(*line)))
      return Failure{Reason::OutsideImage, "less than half of it lies on the image and its mask"};
    if (in.size() < kLeastInside || out.size() < kLeastRing)
      return Failure{Reason::TooFewPoints, "too few pixels inside of it or around it"};
    double sum = 0;
    for (const double v : in) sum += v;
    const double usual = upperMedian(out);
    for (double& v : out) v = std::abs(v - usual);
    return Contrast{sum / static_cast<double>(in.size()) - usual,
                    std::max(noise_, 1.4826 * upperMedian(std::move(out))) / kCorrelated};
  }

 private:
  const Camera& camera_;
  LinearPixels pixels_;
  double noise_;
};

/// The probability that a lamp is on, see lampsOnIn().
double probabilityOn(const Contrast& seen, double expected) {
  const double off = std::hypot(seen.noise, kLeak * expected), on = std::hypot(seen.noise, kLobeChange * expected);
  const double value = std::clamp(seen.value, 0.0, expected);  // darker than nothing is off, brighter than expected is on
  const auto logDensity = [](double d, double sigma) { return -0.5 * d * d / (sigma * sigma) - std::log(sigma); };
  return 1 / (1 + std::exp(logDensity(value, off) - logDensity(value - expected, on)));
}

struct PredictedLamp {
  LampInFrame answer;
  std::vector<Polyline> contours;
  std::optional<Contrast> seen;
};

/// What a frame shows at the places of all lamps.
struct FrameAnswer {
  std::vector<PredictedLamp> lamps;
  std::vector<UnexpectedHighlight> unexpected;  ///< all that no lamp explains; weak ones too
  std::string warning;
};

PredictedLamp predicted(const Inspection& r, const ModelResult::Fit& fit, int frame) {
  const HighlightModel& model = levelSetModel();
  const Frame& f = r.scene->frames[static_cast<std::size_t>(frame)];
  PredictedLamp lamp;
  lamp.answer.frame = frame;
  lamp.answer.light = fit.light;
  if (!f.lightsOn.empty()) lamp.answer.stated = std::find(f.lightsOn.begin(), f.lightsOn.end(), fit.light) != f.lightsOn.end();
  const std::shared_ptr<const Surface> surface = surfaceOfModel(r, model, frame, fit.light);
  const Prediction p = predictionFor(r, fit, model, frame, r.cameraFor(frame, fit.light), surface.get());
  for (const PredictedHighlight& h : p.highlights())
    if (h.contour.points.size() >= 3 && std::abs(signedArea(h.contour)) > 0) lamp.contours.push_back(h.contour);
  if (!lamp.contours.empty()) {
    lamp.answer.place = centroid(lamp.contours.front());
    return lamp;
  }
  const bool fitted = static_cast<bool>(fit.fit);
  lamp.answer.state = fitted && p.failure() && p.failure()->reason != Reason::NoSurface ? LampIs::CannotBeSeen : LampIs::Unsure;
  lamp.answer.reason = p.failure() ? p.failure()->message() : "no contour is predicted";
  return lamp;
}

FrameAnswer lookAt(const Inspection& r, const std::vector<const ModelResult::Fit*>& fits, int frame) {
  const Frame& f = r.scene->frames[static_cast<std::size_t>(frame)];
  FrameAnswer result;
  for (const ModelResult::Fit* fit : fits)
    if (!fit->surface || *fit->surface == r.surfaces->keyOf(frame)) result.lamps.push_back(predicted(r, *fit, frame));
  Outcome<LinearPixels> pixels = pixelsOf(f, r.request.source, r.request.settings);
  if (!pixels) {
    for (PredictedLamp& lamp : result.lamps)
      if (lamp.answer.state == LampIs::Unsure) lamp.answer.reason = pixels.failure().message();
    result.warning = "frame " + f.id + ": " + pixels.failure().message();
    return result;
  }
  const LookedAtFrame image(f, *std::move(pixels));
  for (PredictedLamp& lamp : result.lamps) {
    std::vector<Polyline> others;
    for (const PredictedLamp& other : result.lamps)
      if (&other != &lamp) others.insert(others.end(), other.contours.begin(), other.contours.end());
    for (const Polyline& contour : lamp.contours) {  // the clearest of several highlights of one lamp
      const Outcome<Contrast> seen = image.contrastOf(contour, others);
      if (!seen && !lamp.seen) lamp.answer.reason = seen.failure().message();
      if (!seen || (lamp.seen && lamp.seen->value >= seen->value)) continue;
      lamp.seen = *seen;
      lamp.answer.place = centroid(contour);
      lamp.answer.reason.clear();
    }
    if (!lamp.seen && !lamp.contours.empty()) lamp.answer.state = LampIs::CannotBeSeen;
  }
  SeparateLights separate;
  separate.separate = true;
  FrameEvidence apart = gatherEvidence(*r.scene, frame, r.request.source, r.request.settings, separate);
  dropTextures(apart, r.evidence[static_cast<std::size_t>(frame)].textures);
  for (const Highlight& h : apart.highlights) {
    const Pixel middle = centroid(h.contour);
    const bool known = std::any_of(result.lamps.begin(), result.lamps.end(), [&](const PredictedLamp& lamp) {
      return std::any_of(lamp.contours.begin(), lamp.contours.end(), [&](const Polyline& c) {
        return contains(scaled(c, centroid(c), kNearby), middle) || contains(h.contour, centroid(c));
      });
    });
    if (known || h.contour.points.size() < 3) continue;
    if (const Outcome<Contrast> seen = image.contrastOf(h.contour, {}))
      result.unexpected.push_back({frame, middle, seen->value, seen->noise});
  }
  return result;
}

/// Each lamp's median contrast in frames that state that it is on.
std::map<std::string, double> expectedContrasts(const std::vector<FrameAnswer>& frames) {
  std::map<std::string, std::vector<double>> seen;
  for (const FrameAnswer& f : frames)
    for (const PredictedLamp& lamp : f.lamps)
      if (lamp.seen && lamp.answer.stated.value_or(false)) seen[lamp.answer.light].push_back(lamp.seen->value);
  std::map<std::string, double> result;
  for (const auto& [light, values] : seen)
    if (const double median = upperMedian(values); median > 0) result[light] = median;
  return result;
}

/// Whether the highlights of two lamps fall together.
bool together(const PredictedLamp& a, const PredictedLamp& b) {
  for (const Polyline& p : a.contours)
    for (const Polyline& q : b.contours)
      if (contains(p, centroid(q)) || contains(q, centroid(p))) return true;
  return false;
}

void decide(FrameAnswer& frame, const std::map<std::string, double>& expected) {
  for (PredictedLamp& lamp : frame.lamps) {
    LampInFrame& a = lamp.answer;
    if (!lamp.seen) continue;
    a.contrast = lamp.seen->value;
    a.noise = lamp.seen->noise;
    const auto known = expected.find(a.light);
    if (known == expected.end()) {
      a.reason = "no frame that names this lamp shows how bright it is";
      continue;
    }
    a.expected = known->second;
    const double on = probabilityOn(*lamp.seen, a.expected);
    a.confidence = std::max(on, 1 - on);
    a.state = on >= kSureProbability ? LampIs::On : on <= 1 - kSureProbability ? LampIs::Off : LampIs::Unsure;
    if (a.state == LampIs::Unsure) a.reason = "the contrast lies between that of a lamp that is off and one that is on";
    for (const PredictedLamp& other : frame.lamps)
      if (&other != &lamp && a.state != LampIs::Off && together(lamp, other)) {
        a.state = LampIs::Unsure;
        a.reason = "its highlight falls together with that of " + other.answer.light;
      }
    if (a.stated && a.reason.empty() && ((*a.stated && a.state == LampIs::Off) || (!*a.stated && a.state == LampIs::On)))
      a.reason = *a.stated ? "the scene says on" : "the scene says off";
  }
}

}  // namespace

const char* wordOf(LampIs state) {
  switch (state) {
    case LampIs::On: return "on";
    case LampIs::Off: return "off";
    case LampIs::CannotBeSeen: return "cannot be seen";
    case LampIs::Unsure: break;
  }
  return "unsure";
}

LampsOn lampsOnIn(const Inspection& inspection, const ProgressFn& progress) {
  LampsOn result;
  std::vector<const ModelResult::Fit*> fits;
  const auto model = inspection.models.find(levelSetModel().id());
  require(model != inspection.models.end(), "lampsOnIn: the inspection has no level sets");
  for (const ModelResult::Fit& fit : model->second.fits) {
    if (fit.fit)
      fits.push_back(&fit);
    else
      result.warnings.push_back("lamp " + fit.light + ": " + fit.fit.failure().message());
  }
  if (fits.empty()) return result;
  std::vector<FrameAnswer> frames(inspection.scene->frames.size());
  parallelFor(
      static_cast<int>(frames.size()), [&](int i) { frames[static_cast<std::size_t>(i)] = lookAt(inspection, fits, i); },
      progress, "lamps on");
  const std::map<std::string, double> expected = expectedContrasts(frames);
  double weakest = 0;
  for (const auto& [light, value] : expected) weakest = weakest > 0 ? std::min(weakest, value) : value;
  for (FrameAnswer& f : frames) {
    decide(f, expected);
    for (PredictedLamp& lamp : f.lamps) result.lamps.push_back(std::move(lamp.answer));
    for (const UnexpectedHighlight& h : f.unexpected)
      if (weakest > 0 && h.contrast >= kUnexpectedShare * weakest && h.contrast > kUnexpectedNoise * h.noise)
        result.unexpected.push_back(h);
    if (!f.warning.empty()) result.warnings.push_back(f.warning);
  }
  return result;
}

}  // namespace glint
