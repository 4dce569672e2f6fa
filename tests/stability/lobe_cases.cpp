// SPDX-License-Identifier: BSD-3-Clause
#include <boost/math/special_functions/erf.hpp>

#include "core/base/number_text.h"
#include "core/model/model.h"
#include "tests/stability/fifty_digits.h"
#include "tests/stability/real_lobe.h"
#include "tests/stability/reflectance_cases.h"

namespace glint::stability {
namespace {

constexpr double kMarginPx = 0.65 * 640;  // how far beyond the picture a contour is followed
constexpr double kLevels[] = {0.02, 0.1, 0.5, 0.9, 0.98};

/// Contours of one lobe at all levels: the worst relative error of the radiance, over the peak's, of a vertex against the level.
Outcome<Measured> levelsCase(Lobe lobe, double m, double lowest) {
  const bool wide = m > 0.2;  // on a sphere such a highlight ends at the horizon
  const double k = wide ? 0 : 0.8, focal = std::clamp(wide ? 20 / m : 80 / m, 20.0, 8e4);
  const Light light = Light::at(2 * obliqueDirection());
  const Lit<Real> lit{{Real(k), !wide}, lampOf<Real>(light), lobe, Real(m)};
  const RealView<Real> view = mirrorView(lit.surface, lit.lamp, 0.05, 0.03, 1.5, focal);
  const auto [u, v] = lit.peak(view.u0, view.v0, view.eye, Real(0.5 * m));
  const Real top = lit.at(u, v, view.eye);
  const auto surface = makeAnalytic(specOf(k, !wide));
  double worst = 0;
  int checked = 0;
  for (const double q : kLevels) {
    if (q < lowest) continue;
    ModelFit fit;
    fit.lightEstimate = light;
    fit.family = ReflectanceFit{lobe, m, q};
    const Prediction prediction = modelByName("reflectance").predict(fit, view.camera, surface.get(), Settings());
    if (prediction.highlights().empty()) return *prediction.failure();
    const PredictedHighlight& h = prediction.highlights().front();
    if (h.coverage < (wide ? 0.5 : 0.999)) {
      return Failure{Reason::SurfaceEnded, formatted("coverage too low at level %g", q)};
    }
    const std::size_t stride = std::max<std::size_t>(1, h.contour.points.size() / 24);
    for (std::size_t i = 0; i < h.contour.points.size(); i += stride) {
      // A wide tail leaves the picture and its margin; the rest of its contour is as exact.
      const Pixel beyond = (h.contour.points[i] - Pixel(319.5, 239.5)).cwiseAbs() - Pixel(319.5, 239.5);
      if (beyond.maxCoeff() > kMarginPx - 1) continue;
      ++checked;
      const Real radiance = exp(Real(lit.atPixel(h.contour.points[i], view) - top));
      worst = worstOf({worst, static_cast<double>(abs(radiance / Real(q) - 1))});
    }
  }
  if (checked < 60) return Failure{Reason::TooFewPoints, "most of the contours are cut"};
  return Measured{worst};
}

}  // namespace

void addLobeCases(Cases& cases) {
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong})
    for (const double m : {1e-3, 1e-2, 0.1, 0.3, 0.5, 0.7}) {
      // GGX's tail of 0.7 falls below 0.02 behind the camera only.
      const double lowest = lobe == Lobe::Ggx && m > 0.6 ? 0.1 : 0.02;
      const std::string name = formatted("%s, roughness %g, levels %g to 0.98", nameOf(lobe), m, lowest);
      cases.push_back(answerCase("lobe contour", name, m, 1e-8,
                                 "the peak is found to 1e-4 px, its value to the square of that over the width",
                                 [lobe, m, lowest] { return levelsCase(lobe, m, lowest); }));
    }
}

}  // namespace glint::stability
