// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/number_text.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/model/reflectance_settings.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/known_lamps.h"
#include "core/pipeline/training.h"

namespace glint {
namespace {

using CameraChange = std::function<Camera(const Camera&)>;

constexpr double kVisiblePx = 0.05;   // errors of whole views below this are not worth a word
constexpr double kDominates = 2;      // times the noise of a point
constexpr double kPoorShare = 0.1;    // of the contour's radius: a model that is off by more explains nothing
constexpr double kLeastShare = 0.02;  // of the evidence: below, an alternative is not predicted
// A tolerance +-t is a uniform error of variance t^2 / 3 (JCGM 100:2008, 4.3.7), half per end. A little more, t^2 / 2.5, so
// that the band still holds an input at the very end of its tolerance when noise comes on top: 1.96 sigma is then 1.24 d.
constexpr double kToleranceShare = 0.2;

/// Sizes of everything but the cameras' distances: a surface that is larger by `factor` about the origin, seen from the same
/// cameras, looks as the given one does from cameras nearer to the origin by as much.
CameraChange scaled(double factor) {
  return [factor](const Camera& c) {
    Camera moved = c;
    moved.camFromWorld.translation() /= factor;
    return moved;
  };
}
CameraChange zoomed(double factor) {
  return [factor](const Camera& c) {
    Camera other = c;
    other.pixelFromRay.topLeftCorner<2, 2>() *= factor;
    return other;
  };
}

/// The fit as it would be with other cameras, all derived quantities anew.
Outcome<ModelFit> fitWith(const FitInput& input, const CameraChange& change, const HighlightModel& model,
                          const Settings& settings, PoorFits poor) {
  std::vector<TrainingView> views;
  for (const TrainingView& v : input.views)
    if (v.seen) views.push_back(seenAgain(v, change(v.camera), v.surface));
  const std::optional<Outcome<LightEstimate>> light =
      model.needsLight() ? std::optional(estimateLight(views, settings)) : std::nullopt;
  return accepted(fitModel(model, std::move(views), light, settings), poor);
}

/// Mean square of the distances of the training contours' points from the contours that a fit predicts there, px^2: the same
/// measure for every model. NaN where it predicts none.
double meanSquare(const HighlightModel& model, const ModelFit& fit, const FitInput& input, const Settings& settings) {
  double sum = 0, count = 0;
  for (const TrainingView& v : input.views) {
    if (!v.seen) continue;
    const Prediction p = model.predict(fit, v.camera, v.surface.get(), settings);
    const std::vector<Pixel> points = levelSetPoints(v, settings.integer("light.bundle_points"));
    double best = std::numeric_limits<double>::infinity();
    for (const PredictedHighlight& h : p.highlights()) {
      double squares = 0;
      for (const Pixel& at : points) squares += std::pow(distance(h.contour, at), 2);
      best = std::min(best, squares);
    }
    if (!std::isfinite(best)) return std::nan("");
    sum += best;
    count += double(points.size());
  }
  return count > 0 ? sum / count : std::nan("");
}

/// How much of the evidence each fit has: the likelihood of that many independent residuals of unknown variance.
std::vector<double> sharesOf(const std::vector<double>& meanSquares, double freedom) {
  const double best = std::max(*std::min_element(meanSquares.begin(), meanSquares.end()), 1e-300);  // no division by zero
  std::vector<double> shares;
  double sum = 0;
  for (const double s : meanSquares) {
    shares.push_back(std::pow(std::max(s, 1e-300) / best, -0.5 * freedom));  // no division by zero
    sum += shares.back();
  }
  for (double& s : shares) s /= sum;
  return shares;
}

/// Beside a fit that explains its views, one that does not is no alternative.
PoorFits alternativesMayBe(const ModelFit& fit) { return fit.poor.empty() ? PoorFits::Refuse : PoorFits::Take; }

}  // namespace

std::vector<OtherFit> otherFits(const HighlightModel& model, const ModelFit& fit, const FitInput& input,
                                const Settings& settings) {
  std::vector<OtherFit> others;
  FitInput anew = input;
  anew.pixels.fit.reset();  // it is that of the lobe chosen
  const auto tryOther = [&](const HighlightModel& m, const Settings& with, const std::string& name) {
    Outcome<ModelFit> other = accepted(m.fit(anew, with), alternativesMayBe(fit));
    if (other) others.push_back({&m, std::move(*other), name});
  };
  if (const ReflectanceFit* const fitted = fit.as<ReflectanceFit>()) {
    for (const std::string& lobe : paramSpec("fit.lobe").choices) {
      if (lobe == "auto" || lobe == nameOf(fitted->lobe)) continue;
      Settings with = settings;
      with.set("fit.lobe", lobe);
      // Under a lamp of the same shape: a wrong lobe would take long to find one that makes up for it.
      with.set("fit.light_size", std::string(nameOf(fitted->shape)));
      tryOther(model, with, "the lobe " + lobe);
    }
  } else if (fit.as<LimitAngleFit>()) {
    Settings free = settings;
    free.set("fit.lobe", std::string("auto"));  // a lobe that was asked for is not one that the limit angle is judged by
    tryOther(radianceModel(), free, radianceModel().id());
  }
  return others;
}

FittedBand bandOf(const HighlightModel& model, const ModelFit& fit, const FitInput& input, const Settings& settings,
                  const std::vector<OtherFit>& others, bool surfaceRefined) {
  FittedBand result;
  const std::shared_ptr<Band> band = Band::of(model, fit, input.views, settings);
  if (!band) {
    result.remarks.push_back("the fit has no uncertainty, so its predictions have no band");
    return result;
  }
  result.band = band;
  const PoorFits poor = alternativesMayBe(fit);
  if (surfaceRefined) band->addOwnCovariance();
  if (!input.views.empty() && input.views.front().known)
    if (std::optional<ModelFit> stated = movedAsStated(fit, *input.views.front().known)) band->addStated(*std::move(stated));

  std::vector<const OtherFit*> counted;
  std::vector<double> squares{meanSquare(model, fit, input, settings)};
  for (const OtherFit& other : others) {
    const double square = meanSquare(*other.model, other.fit, input, settings);
    if (!std::isfinite(square)) continue;
    squares.push_back(square);
    counted.push_back(&other);
  }
  if (std::isfinite(squares[0])) {
    const std::vector<double> shares = sharesOf(squares, fit.uncertainty->degreesOfFreedom);
    for (std::size_t i = 0; i < counted.size(); ++i) {
      const double share = shares[i + 1];
      if (share < kLeastShare) continue;
      if (share > 0.5)
        result.remarks.push_back(counted[i]->name + " explains the contours better" +
                                 formatted(": %.3g px remain instead of %.3g", std::sqrt(squares[i + 1]), std::sqrt(squares[0])));
      // One that the evidence prefers is away by d for certain: uniform between -d and d; several that it likes alike are a
      // mixture, whose variance is d^2 times the share.
      band->add({counted[i]->model, counted[i]->fit, {}, nullptr, share / (1 + 2 * share)});
    }
  }

  // Pixels are not carried to other cameras: what a tolerance moves is then told by contours, before and after.
  std::shared_ptr<const ModelFit> reference;
  if (const ReflectanceFit* const fitted = fit.as<ReflectanceFit>(); fitted && fitted->evidence == "pixels") {
    const Outcome<ModelFit> fromContours = fitWith(
        input, [](const Camera& c) { return c; }, model, settings, poor);
    if (fromContours) reference = std::make_shared<const ModelFit>(*fromContours);
  }
  const auto tolerance = [&](const char* key, const char* what, CameraChange (*change)(double)) {
    const double t = settings.number(key);
    if (!(t > 0)) return;
    for (const double factor : {1 + t, 1 / (1 + t)}) {
      const CameraChange moved = change(factor);
      const Outcome<ModelFit> other = fitWith(input, moved, model, settings, poor);
      if (other)
        band->add({&model, *other, moved, reference, kToleranceShare});
      else
        result.remarks.push_back(std::string("no fit with the ") + what + formatted(" changed by %.3g %%: ", 100 * (factor - 1)) +
                                 other.failure().message());
    }
    result.remarks.push_back(std::string("the band allows for a ") + what +
                             formatted(" off by up to %.3g %%, as stated", 100 * t));
  };
  tolerance("input.scale_tolerance", "scale of the surface", scaled);
  tolerance("input.focal_tolerance", "focal length", zoomed);

  const ViewEffects& effects = band->effects();
  if (band->clipped())
    result.remarks.push_back(
        "a training highlight is clipped: its contour lies at a level of the clipped peak, which may be far from that of the "
        "true peak");
  if (effects.viewPx() > kPoorShare * band->radiusPx())
    result.remarks.push_back(
        formatted("the model does not explain its own contours: whole views are off by %.3g px", effects.viewPx()));
  else if (effects.viewPx() > std::max(kVisiblePx, kDominates * effects.noisePx()))
    result.remarks.push_back(
        formatted("whole views are off by %.3g px besides %.3g px of noise: poses, surface or model are inaccurate, and the band "
                  "covers what "
                  "the training views show of it",
                  effects.viewPx(), effects.noisePx()));
  return result;
}

}  // namespace glint
