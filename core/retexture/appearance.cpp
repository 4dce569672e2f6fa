// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/appearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/highlight/background.h"
#include "core/light/directed_limit.h"
#include "core/model/reflectance_settings.h"
#include "core/reflectance/pixel_fit.h"
#include "core/reflectance/radiance_field.h"
#include "core/retexture/pixels.h"

namespace glint {
namespace {

constexpr std::size_t kSectors = 720;  // of a star: half a degree, 0.5 px on a contour 60 px away
constexpr double kOthersReach =
    2.5;                             // contours of another light's highlight that are left out, as core/reflectance/pixel_patch.h
constexpr int kMostSamples = 20000;  // per view: a denser grid changes medians by less than their noise
constexpr double kNearContour = 0.1;  // of rho: pixels that count as being on the contour
constexpr int kLeastNearContour = 5;
constexpr double kStrengthUntil = 1.5;  // rho up to which pixels tell the strength: beyond, the background matters more
constexpr double kSpreadWorthSaying = 0.15;
constexpr double kUncertainWorthSaying = 0.25;  // % of the diameter: as `glint detect` warns
constexpr double kTailWorthSaying = 0.01;

Image channelOf(const Image& image, int channel) {
  Image one(image.width, image.height, 1);
  for (std::size_t i = 0; i < one.data.size(); ++i)
    one.data[i] = image.data[i * std::size_t(image.channels) + std::size_t(channel)];
  return one;
}

std::vector<Highlight> othersIn(const Inspection& in, const TrainingView& view) {
  std::vector<Highlight> others;
  for (const Highlight& h : in.evidence[std::size_t(view.frame)].highlights)
    if (h.light != view.highlight.light) others.push_back(h);
  return others;
}

/// Measured pixels around a highlight's ellipse, as far as its background is told from.
struct Surroundings {
  Footprint footprint;
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1, stride = 1;
};
Outcome<Surroundings> surroundings(const TrainingView& v) {
  const Highlight& h = v.highlight;
  if (!h.ellipse || !(h.level > 0 && h.level < 1)) return Failure{Reason::NotSupported, "a highlight without ellipse or level"};
  Surroundings s;
  s.footprint.centre = v.camera.distorted(h.ellipse->centre);
  s.footprint.level = h.level;
  const Eigen::Matrix2d axes = Eigen::Rotation2Dd(h.ellipse->angle).toRotationMatrix();
  s.footprint.shape = axes * h.ellipse->semiAxes.cwiseAbs2().asDiagonal() * axes.transpose();
  const Pixel reach = FallProfile::kEnd * s.footprint.shape.diagonal().cwiseSqrt();
  if (!s.footprint.centre.allFinite() || !reach.allFinite()) return Failure{Reason::NotFinite, "the highlight's surroundings"};
  const auto within = [](double v, int size) { return int(std::clamp(v, 0.0, double(size - 1))); };
  s.x0 = within(s.footprint.centre.x() - reach.x(), v.camera.width);
  s.x1 = within(s.footprint.centre.x() + reach.x() + 1, v.camera.width);
  s.y0 = within(s.footprint.centre.y() - reach.y(), v.camera.height);
  s.y1 = within(s.footprint.centre.y() + reach.y() + 1, v.camera.height);
  const double cells = double(s.x1 - s.x0 + 1) * (s.y1 - s.y0 + 1);
  s.stride = std::max(1, int(std::sqrt(cells / kMostSamples)));
  return s;
}

void leaveOut(std::vector<char>& usable, const std::vector<Highlight>& others, const Camera& camera) {
  for (const Highlight& h : others) {
    if (!h.ellipse) continue;
    const Pixel centre = camera.distorted(h.ellipse->centre);
    const double reach = kOthersReach * h.ellipse->semiAxes.maxCoeff();
    if (!centre.allFinite() || !std::isfinite(reach)) continue;
    for (int y = std::max(0, int(centre.y() - reach)); y <= std::min(camera.height - 1., centre.y() + reach); ++y)
      for (int x = std::max(0, int(centre.x() - reach)); x <= std::min(camera.width - 1., centre.x() + reach); ++x)
        if ((Pixel(x, y) - centre).norm() < reach) usable[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)] = 0;
  }
}

/// Pixels of one training view: rho, and the radiance above the background per channel.
struct ViewSamples {
  struct One {
    double rho;
    Eigen::Vector3d value;
  };
  std::vector<One> all;
  double onContour = 0;  ///< mean of the channels there
  bool clipped = false;
  double uncertainPct = 0;  ///< of the contour, because what surrounds it may be the highlight's own tail
};

using RhoOf = std::function<std::optional<double>(const Pixel& ideal)>;

Outcome<ViewSamples> samplesOf(const TrainingView& v, const FramePixels& pixels, const std::vector<Highlight>& others,
                               const RhoOf& rhoOf) {
  const Outcome<Surroundings> s = surroundings(v);
  if (!s) return s.failure();
  std::vector<char> usable = pixels.usable;
  leaveOut(usable, others, v.camera);
  std::array<Background, 3> background;
  for (int c = 0; c < 3; ++c) background[std::size_t(c)] = fitBackground(channelOf(pixels.linear, c), usable, s->footprint, 0);
  ViewSamples result;
  std::vector<double> near;
  for (int y = s->y0; y <= s->y1; y += s->stride)
    for (int x = s->x0; x <= s->x1; x += s->stride) {
      if (!usable[std::size_t(y) * std::size_t(v.camera.width) + std::size_t(x)]) continue;
      const Pixel ideal = v.camera.undistorted(Pixel(x, y));
      const std::optional<double> rho = ideal.allFinite() ? rhoOf(ideal) : std::nullopt;
      if (!rho || !(*rho < FallProfile::kEnd)) continue;
      ViewSamples::One one{*rho, {}};
      for (int c = 0; c < 3; ++c) one.value(c) = pixels.linear.at(x, y, c) - background[std::size_t(c)].at(x, y);
      if (std::abs(*rho - 1) < kNearContour) near.push_back(one.value.mean());
      result.all.push_back(one);
    }
  if (int(near.size()) < kLeastNearContour) return Failure{Reason::TooFewPoints, "too few unclipped pixels on the contour"};
  result.onContour = upperMedian(near);
  result.clipped = v.highlight.clipped;
  Image mean(pixels.linear.width, pixels.linear.height, 1);
  for (std::size_t i = 0; i < mean.data.size(); ++i)
    mean.data[i] = (pixels.linear.data[3 * i] + pixels.linear.data[3 * i + 1] + pixels.linear.data[3 * i + 2]) / 3;
  if (result.onContour > 0)
    result.uncertainPct = backgroundUncertaintyPct(mean, usable, s->footprint, result.onContour / v.highlight.level);
  if (!(result.onContour > 0)) return Failure{Reason::NoHighlight, "the contour is no brighter than its background"};
  return result;
}

/// Least squares over the pixels well inside: value = strength f(rho).
std::optional<Eigen::Vector3d> strengthIn(const ViewSamples& view, const FallProfile& profile) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0;
  for (const ViewSamples::One& s : view.all) {
    if (s.rho > kStrengthUntil) continue;
    const double f = profile.at(s.rho);
    sum += f * s.value;
    squares += f * f;
  }
  const Eigen::Vector3d strength = squares > 0 ? Eigen::Vector3d(sum / squares) : Eigen::Vector3d::Zero();
  return squares > 0 && strength.allFinite() && strength.mean() > 0 ? std::optional(strength) : std::nullopt;
}

/// Median per channel over the views, with what the user must know of it.
void combine(const std::vector<Eigen::Vector3d>& strengths, HighlightAppearance& appearance) {
  std::vector<double> means;
  for (const Eigen::Vector3d& s : strengths) means.push_back(s.mean());
  for (int c = 0; c < 3; ++c) {
    std::vector<double> values;
    for (const Eigen::Vector3d& s : strengths) values.push_back(s(c));
    appearance.strength(c) = std::max(0.0, upperMedian(values));
  }
  appearance.views = int(strengths.size());
  const auto [least, most] = std::minmax_element(means.begin(), means.end());
  appearance.spread = (*most - *least) / upperMedian(means);
  if (appearance.spread > kSpreadWorthSaying)
    appearance.remarks.push_back(formatted(
        "the highlight's strength differs by %.0f %% between the %d training views (a changing exposure, or a model that "
        "does not know how the peak depends on the view); their median is used",
        100 * appearance.spread, appearance.views));
  if (appearance.views == 1) appearance.remarks.push_back("one training view alone tells the highlight's strength");
}

/// rho of the pixels of a training view, as the model has it.
Outcome<RhoOf> rhoIn(const TrainingView& v, const ModelFit& fit) {
  const LimitAngleFit* const angle = fit.as<LimitAngleFit>();
  if (!angle || !fit.lightEstimate) {
    Outcome<ContourStar> star = ContourStar::of(v.highlight.contour, v.highlight.peak);
    if (!star) return star.failure();
    return RhoOf([star = *std::move(star)](const Pixel& p) { return std::optional<double>(star.rho(p)); });
  }
  if (!v.surface) return Failure{Reason::NoSurface, ""};
  return RhoOf([&v, angle, light = *fit.lightEstimate, eye = v.camera.centreInWorld()](const Pixel& p) -> std::optional<double> {
    const Outcome<SurfacePoint> hit = v.surface->firstHit(v.camera.ray(p));
    return hit ? angleRho(*angle, light, facing(*hit, eye), eye) : std::nullopt;
  });
}

Outcome<HighlightAppearance> learnProfile(const Inspection& in, const ModelFit& fit,
                                          const std::map<int, std::vector<const TrainingView*>>& views) {
  std::optional<Failure> why;
  std::vector<ViewSamples> seen;
  for (const auto& [frame, ofFrame] : views) {
    const Outcome<FramePixels> pixels = framePixels(in, frame);
    if (!pixels) why = pixels.failure();
    if (!pixels) continue;
    for (const TrainingView* const v : ofFrame) {
      const Outcome<RhoOf> rho = rhoIn(*v, fit);
      Outcome<ViewSamples> samples = rho ? samplesOf(*v, *pixels, othersIn(in, *v), *rho) : rho.failure();
      if (samples)
        seen.push_back(*std::move(samples));
      else
        why = samples.failure();
    }
  }
  if (seen.empty()) return why.value_or(Failure{Reason::TooFewViews, "no training view shows the highlight"});
  // Contours of clipped highlights lie at another share of the true peak, so they blur the profile of the others.
  const bool allClipped = std::all_of(seen.begin(), seen.end(), [](const ViewSamples& v) { return v.clipped; });
  if (!allClipped) std::erase_if(seen, [](const ViewSamples& v) { return v.clipped; });
  std::vector<FallProfile::Sample> samples;
  for (const ViewSamples& v : seen)
    for (const ViewSamples::One& s : v.all) samples.push_back({s.rho, s.value.mean() / v.onContour});
  Outcome<FallProfile> profile = FallProfile::learn(samples);
  if (!profile) return profile.failure();
  HighlightAppearance a;
  a.kind = fit.as<LimitAngleFit>() && fit.lightEstimate ? HighlightAppearance::Kind::Angle : HighlightAppearance::Kind::Contour;
  a.profile = *profile;
  std::vector<Eigen::Vector3d> strengths;
  for (const ViewSamples& v : seen)
    if (const std::optional<Eigen::Vector3d> s = strengthIn(v, *profile)) strengths.push_back(*s);
  if (strengths.empty()) return Failure{Reason::NoHighlight, "the training frames show no strength above their background"};
  combine(strengths, a);
  double uncertain = 0;
  for (const ViewSamples& v : seen) uncertain = std::max(uncertain, v.uncertainPct);
  if (uncertain > kUncertainWorthSaying)
    a.remarks.emplace_back(
        "what surrounds the highlight may be its own tail, which then counts as background: the highlight may be too narrow and "
        "too "
        "dim; reflectance, which knows its lobe, tells them apart");
  if (profile->observedFrom() > 0)
    a.remarks.push_back(
        formatted("the core is clipped in the training frames: inside %.0f %% of the contour its brightness continues "
                  "what is around it",
                  100 * profile->observedFrom()));
  if (profile->beforeEnd() > kTailWorthSaying)
    a.remarks.push_back(
        formatted("the highlight still has %.1f %% of its peak where its learned profile ends; it fades out there",
                  100 * profile->beforeEnd()));
  return a;
}

/// log I at the brightest cell of the patches, whether used or not: what is used of a clipped core lies around it.
double logPeakOf(const RadianceField& field, const std::vector<PixelPatch>& patches, double least) {
  for (const PixelPatch& patch : patches)
    for (std::size_t i = 0; i < patch.size(); ++i) {
      if (!patch.onSurface[i]) continue;
      const std::optional<double> log = field.at(SurfacePoint{patch.seen[i].position, patch.seen[i].axes.normal});
      if (log && *log > least) least = *log;
    }
  return least;
}

/// Strengths of a lobe in the patches of one training frame: I = strength x S + background, per channel.
Outcome<Eigen::Vector3d> lobeStrength(const Inspection& in, const std::vector<const TrainingView*>& views, const LobeModel& model,
                                      BackgroundKind background, const FramePixels& pixels, double& logTop) {
  Eigen::Vector3d strength;
  for (int c = 0; c < 3; ++c) {
    LinearPixels one{channelOf(pixels.linear, c), pixels.usable, {}};
    one.clipped.assign(one.usable.size(), 0);
    for (std::size_t i = 0; i < one.usable.size(); ++i) one.clipped[i] = !one.usable[i];
    std::vector<PixelPatch> patches;
    std::optional<Failure> why;
    for (const TrainingView* const v : views) {
      Outcome<PixelPatch> patch = pixelPatch(one, v->camera, *v->surface, v->frame, v->highlight, othersIn(in, *v));
      if (patch)
        patches.push_back(*std::move(patch));
      else
        why = patch.failure();
    }
    if (patches.empty()) return why.value_or(Failure{Reason::TooFewPoints, ""});
    std::vector<const PixelPatch*> pointers;
    for (const PixelPatch& p : patches) pointers.push_back(&p);
    const Outcome<std::vector<PatchSolution>> solved = solvePatches(pointers, model, background);
    if (!solved) return solved.failure();
    const TrainingView& v = *views.front();
    const RadianceField field(*v.surface, v.camera, model.lobe, model.roughness, model.lamp);
    const std::optional<double> log = field.at(solved->front().topPoint);
    if (!log) return Failure{Reason::Occluded, "the highlight's brightest place is not lit"};
    if (c == 0) logTop = logPeakOf(field, patches, *log);
    strength(c) = solved->front().strength * std::exp(logTop - *log);
  }
  return strength;
}

Outcome<HighlightAppearance> learnLobe(const Inspection& in, const ModelFit& fit, const ReflectanceFit& fitted, const FitKey& key,
                                       const std::map<int, std::vector<const TrainingView*>>& views) {
  LobeModel model{fitted.lobe, fitted.roughness, *fit.lamp(), 0};
  if (fitted.blurPx) model.blurVariance = *fitted.blurPx * *fitted.blurPx;
  const auto pixelFit = in.pixelFits.find(key);
  const BackgroundKind background =
      pixelFit != in.pixelFits.end() && pixelFit->second ? (*pixelFit->second)->background : BackgroundKind::Quadratic;
  HighlightAppearance a;
  a.kind = HighlightAppearance::Kind::Lobe;
  std::vector<Eigen::Vector3d> strengths;
  std::optional<Failure> why;
  for (const auto& [frame, ofFrame] : views) {
    const Outcome<FramePixels> pixels = framePixels(in, frame);
    double logTop = 0;
    const Outcome<Eigen::Vector3d> s =
        pixels ? lobeStrength(in, ofFrame, model, background, *pixels, logTop) : Outcome<Eigen::Vector3d>(pixels.failure());
    if (!s) {
      why = s.failure();
      continue;
    }
    if (strengths.empty()) a.logReference = logTop;
    const Eigen::Vector3d common = *s * std::exp(a.logReference - logTop);
    if (common.allFinite() && common.mean() > 0) strengths.push_back(common);
  }
  if (strengths.empty()) return why.value_or(Failure{Reason::TooFewViews, "no training view shows the highlight"});
  combine(strengths, a);
  return a;
}

}  // namespace

const char* nameOf(HighlightAppearance::Kind kind) {
  switch (kind) {
    case HighlightAppearance::Kind::Lobe: return "lobe";
    case HighlightAppearance::Kind::Angle: return "level sets of alpha";
    case HighlightAppearance::Kind::Contour: return "contour";
  }
  return "";
}

Outcome<ContourStar> ContourStar::of(const Polyline& contour, const Pixel& around, const std::vector<std::pair<int, int>>& gaps) {
  ContourStar star;
  const Failure none{Reason::NotReached, "no place inside of the contour"};
  if (contour.points.size() < 3) return none;
  star.centre_ = contains(contour, around) ? around : centroid(contour);
  if (!star.centre_.allFinite() || !contains(contour, star.centre_)) return none;
  star.reach_.resize(kSectors);
  star.gap_.assign(kSectors, 0);
  for (std::size_t i = 0; i < kSectors; ++i) {
    const std::optional<double> r = reach(contour, star.centre_, 2 * M_PI * double(i) / kSectors);
    if (!r || !(*r > 0)) return Failure{Reason::NotReached, "the contour does not surround its brightest place"};
    star.reach_[i] = *r;
  }
  const std::size_t n = contour.points.size();
  for (const auto& [from, to] : gaps) {
    if (from < 0 || to < 0 || std::size_t(from) >= n || std::size_t(to) >= n) continue;
    // The shorter way round: a gap is one chord of the contour, seen from inside.
    const std::size_t a = star.sector(contour.points[std::size_t(from)]), b = star.sector(contour.points[std::size_t(to)]);
    const std::size_t forward = (b + kSectors - a) % kSectors;
    const bool ahead = forward <= kSectors / 2;
    for (std::size_t k = 0; k <= (ahead ? forward : kSectors - forward); ++k) star.gap_[((ahead ? a : b) + k) % kSectors] = 1;
  }
  return star;
}

std::size_t ContourStar::sector(const Pixel& p) const {
  const Pixel d = p - centre_;
  const double turn = std::atan2(d.y(), d.x()) / (2 * M_PI);
  return std::size_t(std::lround((turn < 0 ? turn + 1 : turn) * kSectors)) % kSectors;
}

double ContourStar::rho(const Pixel& p) const {
  const Pixel d = p - centre_;
  const double turn = std::atan2(d.y(), d.x()) / (2 * M_PI), place = (turn < 0 ? turn + 1 : turn) * kSectors;
  const std::size_t i = std::size_t(place) % kSectors;
  const double share = place - std::floor(place);
  return d.norm() / ((1 - share) * reach_[i] + share * reach_[(i + 1) % kSectors]);
}

bool ContourStar::inGap(const Pixel& p) const { return gap_[sector(p)] != 0; }

std::optional<double> angleRho(const LimitAngleFit& fit, const Light& light, const SurfacePoint& p, const Eigen::Vector3d& eye) {
  const Eigen::Vector3d l = light.directionFrom(p.position), v = (eye - p.position).normalized();
  if (!(p.normal.dot(l) > 0)) return std::nullopt;
  const double alpha = incidentAngle(p.normal, l, v);
  const double limit =
      fit.extent ? directedLimit(fit.limitAngle, *fit.extent, p.position, p.normal, v, light.homogeneous()) : fit.limitAngle;
  const double rho = alpha / limit;
  return std::isfinite(rho) ? std::optional<double>(rho) : std::nullopt;
}

Outcome<HighlightAppearance> learnAppearance(const Inspection& in, const ModelFit& fit, const FitKey& key) {
  require(in.scene && in.given, "learnAppearance: an inspection of a scene");
  const ReflectanceFit* const lobe = fit.lightEstimate ? fit.as<ReflectanceFit>() : nullptr;
  std::map<int, std::vector<const TrainingView*>> views;
  for (const TrainingView& v : in.views) {
    if (in.keyFor(v.frame, v.highlight.light) != key) continue;
    if (lobe && (!v.seen || !v.surface)) continue;
    views[v.frame].push_back(&v);
  }
  if (views.empty()) return Failure{Reason::TooFewViews, "no training view shows the highlight"};
  return lobe ? learnLobe(in, fit, *lobe, key, views) : learnProfile(in, fit, views);
}

Outcome<HighlightAppearance> LearnedAppearances::of(const Inspection& in, const std::string& model, const ModelResult::Fit& fit) {
  const bool same = in.given == given_ && in.inputs.same(Stage::Lobes, inputs_) && in.inputs.same(Stage::Fits, inputs_);
  if (!same) known_.clear(), given_ = in.given, inputs_ = in.inputs;
  const auto key = std::pair(model, fit.key());
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  return known_.emplace(key, learnAppearance(in, *fit.fit, fit.key())).first->second;
}

}  // namespace glint
