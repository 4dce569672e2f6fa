// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/settings.h"
#include "core/model/model.h"
#include "core/model/reconstruct.h"

namespace glint {

/// Where an ellipsoid's centre is expected, for `anchored` and as the prior of `refined`.
struct CentreAnchor {
  Eigen::Vector3d position;
  std::optional<Eigen::Matrix3d> covariance;  ///< m^2, of the noise only
  double distance = 0;  ///< m, typical distance from the surface (or the cameras); scale of the anchor's bias
};

/// The anchor at an estimated light; empty for a light at infinity. The distance is the mean one from the views' brightest
/// points.
std::optional<CentreAnchor> anchorAtLight(const FitInput& input);

/// The solver chosen by `fit.solver`, the same for the three ellipsoid models:
/// linear (centre free, >= 3 views), anchored (centre at the anchor, >= 2 views), refined (>= 3 views; starts at the anchored
/// solution or, without an anchor, at the linear one). The prior of `refined` on the centre is the anchor's covariance plus an
/// isotropic bias of `fit.prior_bias` (0 = one hundredth) times the anchor's distance: the covariance knows the noise only, but
/// the ellipsoid that explains a highlight is not centred exactly at the light, and the light of a simple lobe is itself off. A
/// contour point is weighed against it by what the residuals say it is worth: where the ellipsoid does not fit, the prior counts
/// more. A linear solution that is no ellipsoid is returned with its quadric alone, so that it can be shown and named; without an
/// anchor `refined` has no other start, and returns it too. TooFewViews; NoLight (anchored without an anchor); the solver's own.
Outcome<Reconstruction> fitEllipsoid(const std::vector<ConicView>& views, const std::optional<CentreAnchor>& anchor,
                                     const Settings& settings);

/// True when a view's ellipse is the outline of a whole highlight, which is all that `primal` needs: a view whose surface or
/// brightest point is missing still counts, one that the image border cuts does not.
bool hasWholeEllipse(const TrainingView& view);
/// Why a view that was seen has none: the image's border cuts its highlight, or no ellipse fits the contour. Empty if it has one.
std::optional<Failure> notWhole(const TrainingView& view);

/// Closest point to the viewing rays through the centres of the ellipses: the anchor of `primal`, which has no light.
/// Empty when the rays are parallel.
std::optional<CentreAnchor> anchorFromCentres(const std::vector<TrainingView>& views);

/// A view's contour as evidence for an ellipsoid: its ellipse, and 72 equally spaced points, more than an outline has degrees of
/// freedom.
/// @param projection  real or virtual camera. The view must have an ellipse.
ConicView conicViewOf(const TrainingView& view, const Projection& projection);

/// Copies a reconstruction into the fields of a fit.
void store(const Reconstruction& reconstruction, ModelFit& fit);
/// The ellipsoid of a fit; else NotAnEllipsoid, which says what Q* is instead.
Outcome<Ellipsoid> ellipsoidOf(const ModelFit& fit);

/// A model that fits one ellipsoid to an outline in every view that has one (outlineIn).
class EllipsoidModel : public HighlightModel {
 public:
  bool hasOutlines() const final { return true; }
  /// fitEllipsoid() with its failures; where views are too few, it says why others have no outline.
  Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const override;
  /// Predicts again with the centre, shape (and light) moved along each column of the uncertainty.
  Eigen::MatrixXd bandShiftsPx(const ModelFit& fit, const PredictedHighlight& highlight, const Camera& camera,
                               const Surface* surface, const Settings& settings) const final;

 private:
  virtual std::optional<CentreAnchor> anchor(const FitInput& input) const { return anchorAtLight(input); }
  /// Why a view has no outline; nothing where it has one.
  virtual std::optional<Failure> unused(const TrainingView& view) const = 0;
  /// UsedContour::unit
  virtual double unitOf(const ConicView&, const TrainingView&) const { return 1; }
  /// Adds what the fit holds beside the ellipsoid.
  virtual void complete(const FitInput&, ModelFit&) const {}
};

/// The ellipse as a polyline of `points` vertices, as a highlight without directions. @param brightest its peak.
PredictedHighlight highlightFromEllipse(const Ellipse& ellipse, const BrightestPoint& brightest, int points = 360);

}  // namespace glint
