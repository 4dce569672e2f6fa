// SPDX-License-Identifier: BSD-3-Clause
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdio>

#include "core/model/model.h"
#include "core/stability/real_lobe.h"
#include "core/stability/reflectance_cases.h"

namespace glint::stability {
namespace {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

constexpr double kLevels[] = {0.02, 0.1, 0.5, 0.9, 0.98};

/// Contours of one lobe at all levels: the worst relative error of the radiance, over the peak's, of a vertex against the level.
Outcome<Measured> levelsCase(Lobe lobe, double m) {
  const bool wide = m > 0.2;  // on a sphere such a highlight ends at the horizon
  const double k = wide ? 0 : 0.8, focal = std::clamp(80 / m, 120.0, 8e4);
  const Light light = Light::at(2 * obliqueDirection());
  const Lit<Real> lit{{Real(k), !wide}, lampOf<Real>(light), lobe, Real(m)};
  const RealView<Real> view = mirrorView(lit.surface, lit.lamp, 0.05, 0.03, 1.5, focal);
  const auto [u, v] = lit.peak(view.u0, view.v0, view.eye, Real(0.5 * m));
  const Real top = lit.at(u, v, view.eye);
  const auto surface = makeAnalytic(specOf(k, !wide));
  double worst = 0;
  for (const double q : kLevels) {
    ModelFit fit;
    fit.lightEstimate = light;
    fit.lobe = nameOf(lobe);
    fit.roughness = m;
    fit.level = q;
    const Prediction prediction = modelByName("reflectance").predict(fit, view.camera, surface.get(), Settings());
    if (prediction.highlights.empty()) return prediction.failure.value_or(Failure{Reason::NoHighlight, ""});
    const PredictedHighlight& h = prediction.highlights.front();
    if (h.coverage < 0.999) return Failure{Reason::SurfaceEnded, "coverage below 1 at level " + std::to_string(q)};
    const std::size_t stride = std::max<std::size_t>(1, h.contour.points.size() / 24);
    for (std::size_t i = 0; i < h.contour.points.size(); i += stride) {
      const Real radiance = exp(Real(lit.atPixel(h.contour.points[i], view) - top));
      worst = worstOf({worst, static_cast<double>(abs(radiance / Real(q) - 1))});
    }
  }
  return Measured{worst};
}

}  // namespace

void addLobeCases(Cases& cases) {
  for (const Lobe lobe : {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong})
    for (const double m : {1e-3, 1e-2, 0.1, 0.3, 0.5, 0.7}) {
      char name[96];
      std::snprintf(name, sizeof name, "%s, roughness %g, levels 0.02 to 0.98", nameOf(lobe), m);
      cases.push_back(answerCase("lobe contour", name, m, 1e-8, "the peak is found to 1e-4 px, its value to the square of that over the width",
                                 [lobe, m] { return levelsCase(lobe, m); }));
    }
}

}  // namespace glint::stability
