// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/progress.h"
#include "core/base/settings.h"
#include "core/base/uncertainty.h"
#include "core/geometry/ellipsoid.h"
#include "core/geometry/light.h"
#include "core/geometry/plane.h"
#include "core/highlight/highlight.h"
#include "core/model/reconstruct.h"
#include "core/reflectance/lamp.h"
#include "core/reflectance/lobe.h"
#include "core/surface/brightest_point.h"
#include "core/surface/surface.h"

namespace glint {

struct PixelPatch;
struct PixelFit;
struct UnexplainedPixels;
struct ModelFit;

/// One direction of the walk from the brightest point (method.md section 6): a point or a named reason.
struct DirectionResult {
  double azimuth = 0;                       ///< rad, in the tangent plane's basis
  std::optional<double> limitAngle;         ///< alpha at the end of the walk, rad
  Eigen::Vector3d onSurface{0, 0, 0};       ///< end of the walk on S (valid when limitAngle is set)
  Eigen::Vector3d onTangentPlane{0, 0, 0};  ///< canonical point on T
  std::optional<Failure> failure;
};

/// The contour carried to the tangent plane.
struct CanonicalContour {
  std::vector<DirectionResult> directions;
  std::vector<Pixel> pixels;       ///< canonical points of the directions that succeeded, in the photograph
  std::optional<Ellipse> ellipse;  ///< fitted to `pixels`
};

/// A highlight on its surface.
struct SeenOnSurface {
  BrightestPoint brightest;  ///< observed
  Plane tangentPlane;        ///< there; normal towards the camera
  Projection virtualCamera;  ///< P M
};

/// What serves as evidence of a highlight that the image's border cuts. Whole ones say more, and a peak that one side alone shows
/// is less certain, so cut ones serve only where whole ones are few.
enum class CutUse {
  None,
  Arc,    ///< the part of the contour that is a level set, where the peak is known
  Pixels  ///< the pixels that are seen, wherever the peak is
};

/// A lamp that the scene states as known, in the coordinates of a view.
struct KnownLamp {
  Lamp lamp;
  double sigma = 0;  ///< standard deviation of each coordinate of its place, m, or of its direction, rad
};

/// One observation used for training: one highlight of one light in one frame, with what was derived from it.
struct TrainingView {
  int frame = -1;
  std::string frameId;  ///< for people; "" where no scene names the frame
  Camera camera;
  std::shared_ptr<const Surface> surface;  ///< may be null only for `primal`
  Highlight highlight;
  std::vector<LevelContour> levels;  ///< contours at other levels than highlight.level; they share the frame's maximum
  CutUse cut = CutUse::None;
  std::shared_ptr<const PixelPatch> pixels;  ///< around the highlight, where pixels are evidence (core/reflectance/pixel_patch.h)
  std::optional<KnownLamp> known;            ///< the lamp of the highlight, where the scene states it
  /// From the scene's coordinates to those of camera, surface and lamp: not the identity where the view was carried to another
  /// known lamp (core/pipeline/known_lamps.h). `pixels` stay in the scene's.
  Eigen::Isometry3d fromScene = Eigen::Isometry3d::Identity();
  /// What was seen, or why this view cannot be used; only `primal`, which needs no surface, looks at the reason.
  Outcome<SeenOnSurface> seen = Failure{Reason::NotReached, "nothing was observed"};
  std::optional<CanonicalContour> canonical;  ///< of a view that was seen, once its light is known

  std::optional<Failure> failure() const { return seen ? std::nullopt : std::optional(seen.failure()); }
};

/// The light of a set of views, from section 4, with what the bundle adds.
struct LightEstimate {
  Light light;
  std::optional<Eigen::Matrix3d> covariance;  ///< m^2 of the position; none for a light at infinity
  double limitAngle = 0;                      ///< rad; robust mean over all contour points
  double condition = 0;                       ///< of the triangulation
  double rmsPx = 0;                           ///< of the bundle's residuals, 0 when triangulated
  std::vector<double> residualPx;             ///< per view that was used (those `seen`), in their order: rmsWithoutTail()
  std::string solver;                         ///< "triangulated", "bundle" or "known"
  std::optional<LampShape> known;             ///< shape of a lamp that the scene states: fits keep it and `light`
  /// Second moment of an extended light about `light`, m^2 (rad^2 for a light at infinity): widens the limit angle where the
  /// light is long. Empty for a limit angle that is one constant.
  std::optional<Eigen::Matrix3d> extent;
  /// Uncertainty of parameters::kLight, kLimitAngle and, with an extent, kExtent; bundle only.
  std::optional<ParameterUncertainty> uncertainty;
};

/// What fits to pixels have said already.
struct KnownPixels {
  std::shared_ptr<const PixelFit> fit{};  ///< of exactly these views
  /// A fit of these views and a few more: the search starts there, and keeps the lobe and the background.
  std::shared_ptr<const PixelFit> near{};
  /// A fit that failed: it answers the same question, or one of fewer views.
  std::shared_ptr<const UnexplainedPixels> unexplained{};
};

/// What a fit may use. Views are of one light (and one surface, when models are per surface).
struct FitInput {
  std::vector<TrainingView> views;      ///< those that were not `seen` are skipped
  std::optional<LightEstimate> light;   ///< for models with needsLight()
  std::optional<Failure> lightFailure;  ///< why `light` is empty
  KnownPixels pixels;                   ///< for models with takesPixels()
  /// A fit of the same model to nearly these views (cameras moved a little). `reflectance` starts from its lamp and keeps the
  /// lamp's shape.
  std::shared_ptr<const ModelFit> near;
  ProgressFn progress{};  ///< asked in long fits, which then throw Stopped
};

/// An ellipsoid about the light, fitted to outlines: primal, dual, canonical.
struct EllipsoidFit {
  DualQuadric quadric;                   ///< Q*
  std::optional<Ellipsoid> ellipsoid{};  ///< when Q* is one
  std::vector<double> singularValues{};  ///< of the linear system, descending
  double gapRatio = 0;                   ///< last / second last of them
  std::optional<double> limitAngle{};    ///< rad, of the light's contours; canonical only
};

/// The limit angle of a light's contours.
struct LimitAngleFit {
  double limitAngle = 0;                    ///< rad
  std::optional<Eigen::Matrix3d> extent{};  ///< see LightEstimate
};

/// A reflectance lobe and the shape of the lamp about ModelFit::lightEstimate.
struct ReflectanceFit {
  Lobe lobe = Lobe::TorranceSparrow;
  Roughness roughness;             ///< m of the lobe
  double level = 0;                ///< fraction q of the peak at which the contour lies
  LampShape shape{};               ///< of the lamp about ModelFit::lightEstimate
  std::string evidence{};          ///< what the fit saw, "contours", "levels" or "pixels"
  std::vector<double> levels{};    ///< of the contours that it saw; empty for pixels
  std::optional<double> blurPx{};  ///< standard deviation of the images' blur, where pixels show it
};

/// What fitting produced.
struct ModelFit {
  std::string model;
  std::string light;                   ///< id
  std::optional<std::string> surface;  ///< key, when the model belongs to one surface only
  std::variant<std::monostate, EllipsoidFit, LimitAngleFit, ReflectanceFit> family;  ///< empty for a model beyond these
  std::optional<Light> lightEstimate;
  std::optional<Eigen::Matrix3d> lightCovariance;  ///< m^2, of the position
  double condition = 0;                            ///< of an ellipsoid first / second last singular value, else as LightEstimate
  std::vector<double> residualPx;  ///< per training view, RMS contour distance; of the robust models without its tail
  std::string solver;              ///< "linear", "anchored", "refined", "bundle", ...
  std::vector<int> frames;         ///< frames used
  /// Brightest points of the views used, normals as observed; empty where a frame showed several.
  std::vector<SurfacePoint> hints;
  /// Uncertainty of the blocks in `parameters`, family by family; other models have their own blocks.
  std::optional<ParameterUncertainty> uncertainty;
  std::vector<std::string> remarks;  ///< warnings in words, for the user: what makes the answer doubtful
  std::string poor;  ///< why it explains its evidence badly, "" where it does not; it predicts and is scored all the same
  double timeUs = 0;

  const char* status() const { return poor.empty() ? "ok" : "poor"; }

  /// Null where the model is of another family.
  template <class Family>
  const Family* as() const {
    return std::get_if<Family>(&family);
  }
  /// The lamp that a lobe was fitted with; nothing for other models.
  std::optional<Lamp> lamp() const {
    const ReflectanceFit* const lobe = as<ReflectanceFit>();
    return lobe && lightEstimate ? std::optional(Lamp(lightEstimate->homogeneous(), lobe->shape)) : std::nullopt;
  }
  /// Null for a fit without an ellipsoid.
  const Ellipsoid* ellipsoid() const {
    const EllipsoidFit* const e = as<EllipsoidFit>();
    return e && e->ellipsoid ? &*e->ellipsoid : nullptr;
  }
  /// rad; nothing where neither ellipsoid nor contours know it.
  std::optional<double> limitAngle() const {
    if (const EllipsoidFit* const e = as<EllipsoidFit>()) return e->limitAngle;
    const LimitAngleFit* const contours = as<LimitAngleFit>();
    return contours ? std::optional(contours->limitAngle) : std::nullopt;
  }
};

/// One predicted highlight.
struct PredictedHighlight {
  Polyline contour;                       ///< the prediction: ideal pixels; closed over gaps for areas
  std::vector<std::pair<int, int>> gaps;  ///< contour segments (from vertex, to vertex) that bridge failed directions
  std::optional<Ellipse> ellipse;
  BrightestPoint brightest;
  std::optional<Plane> tangentPlane;
  std::optional<CanonicalContour> canonical;  ///< directions with their ends on S and T
  double coverage = 1;                        ///< share of directions that gave a point
  /// For predict.query = local-quadric alone, see `curvatureVariation` in core/model/star.h.
  std::optional<double> curvatureVariation;
  /// One per vertex of `contour`: standard deviation across the contour from the fit's uncertainty, px; 0 where the contour runs
  /// along the surface's edge. Empty unless asked for (predict.band) and known.
  std::vector<double> sigmaPx;
};

/// A highlight that a model predicts and a filter took out (core/pipeline/live_prediction.h). It is not compared, and views draw
/// it faintly.
struct FilteredHighlight {
  PredictedHighlight highlight;
  std::string reason;  ///< in words
};

/// Prediction of one light in one view: at least one highlight, or the reason why nothing is predicted.
class Prediction {
 public:
  Prediction() : answer_(Failure{Reason::NotReached, "nothing was predicted"}) {}
  Prediction(Failure reason) : answer_(std::move(reason)) {}
  /// @param why  the answer where `found` is empty
  Prediction(std::vector<PredictedHighlight> found, std::optional<Failure> why = std::nullopt);
  const std::vector<PredictedHighlight>& highlights() const;                 ///< empty where there is a failure
  std::span<PredictedHighlight> editable();                                  ///< the same, to add to them
  const Failure* failure() const { return std::get_if<Failure>(&answer_); }  ///< null where there are highlights
  /// Drops the highlights for which there is a reason; where none is left, the first reason is the answer.
  void drop(const std::function<std::optional<Failure>(const PredictedHighlight&)>& reasonFor);

  double timeUs = 0;
  std::vector<FilteredHighlight> filtered;  ///< not in highlights()

 private:
  std::variant<std::vector<PredictedHighlight>, Failure> answer_;
};

/// The parameters of ModelFit::uncertainty and LightEstimate::uncertainty, by family.
namespace parameters {
// The light and limit-angle: L homogeneous with |L| = 1; rad; xx yy zz xy xz yz where there is an extent.
inline constexpr ParameterBlock kLight{0, 4}, kLimitAngle{4, 1}, kExtent{5, 6};
// primal, dual, canonical: centre; S, xx yy zz xy xz yz; of canonical, whose light moves its predictions, L too.
inline constexpr ParameterBlock kCentre{0, 3}, kShape{3, 6}, kLampOfEllipsoid{9, 4};
// reflectance: after L the logarithm of the roughness, then the unknowns of the lamp's shape, then the logarithm of two
// widths' ratio.
inline constexpr ParameterBlock kLogRoughness{4, 1};
inline constexpr int kLampShape = 5;
}  // namespace parameters

/// What others must know of a model to show, check and compare it.
struct ModelTraits {
  /// The model's colour in every view and report, 8-bit sRGB; the colours together are colour-blind safe (Okabe and Ito, 2008).
  std::array<int, 3> rgb{};
  bool mirrored = true;         ///< it uses the virtual (mirrored) cameras, along reflected rays; else the cameras themselves
  bool stopsAtOutline = false;  ///< its predictions are an ellipsoid's outlines: no walk follows
  enum class Assumes { AnySurface, Plane, ConstantCurvature } surface = Assumes::AnySurface;
};

/// A model of the JOLIMAS family or beyond (method.md section 7). Stateless.
class HighlightModel {
 public:
  virtual ~HighlightModel() = default;
  virtual ModelTraits traits() const = 0;
  virtual std::string id() const = 0;                 ///< "canonical"
  virtual std::string title() const = 0;              ///< "Canonical JOLIMAS"
  virtual std::string assumption() const = 0;         ///< one sentence from method.md section 7
  virtual std::string reference() const = 0;          ///< paper or "method.md section 7"
  virtual bool needsLight() const = 0;                ///< the fit uses FitInput::light
  virtual bool needsCanonicalContours() const = 0;    ///< the fit uses TrainingView::canonical
  virtual bool takesPixels() const { return false; }  ///< the fit may use TrainingView::pixels, FitInput::pixels
  virtual bool walks() const { return false; }        ///< predictions follow predict.query: they can walk on local quadrics
  virtual bool hasOutlines() const { return false; }  ///< it reconstructs an ellipsoid from one outline in each view
  /// The outline that it takes from a view; empty where the view has none, or where the model takes none.
  virtual std::optional<ConicView> outlineIn(const TrainingView&) const { return std::nullopt; }
  /// Named failures: TooFewViews and what the solver or the light reports.
  virtual Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const = 0;
  /// @param surface  may be null for `primal`.
  virtual Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface,
                             const Settings& settings) const = 0;
  /// The same fit for a contour at its level of the radiance at `place`, an ideal pixel of this view, and not of the maximum:
  /// that of a highlight whose peak the image's border cuts off (Highlight::peakCut). Empty where the model does not tell.
  virtual std::optional<ModelFit> atLevelOf(const ModelFit&, const Pixel& /*place*/, const Camera&, const Surface&,
                                            const Settings&) const {
    return std::nullopt;
  }
  /// Shifts of a prediction's contour along its normals, px and positive outwards: one row per vertex, one column per column of
  /// the fit's ParameterUncertainty::root, each for one standard deviation. A row of zeros along the surface's own edge. Empty
  /// where the fit has no uncertainty.
  virtual Eigen::MatrixXd bandShiftsPx(const ModelFit&, const PredictedHighlight&, const Camera&, const Surface*,
                                       const Settings&) const {
    return {};
  }
  /// Norms of the rows of bandShiftsPx: the standard deviation that the noise in the residuals alone makes. core/model/band.h
  /// knows more.
  std::vector<double> bandSigmaPx(const ModelFit& fit, const PredictedHighlight& highlight, const Camera& camera,
                                  const Surface* surface, const Settings& settings) const {
    const Eigen::VectorXd norms = bandShiftsPx(fit, highlight, camera, surface, settings).rowwise().norm();
    return {norms.begin(), norms.end()};
  }
};

/// All models, from simple to rich. The only registration: one line each in registry.cpp, or addModel().
const std::vector<std::unique_ptr<HighlightModel>>& allModels();
/// Adds a model, as the richest. Not thread-safe: call it before anything else asks for models. std::invalid_argument for a name
/// that is taken.
void addModel(std::unique_ptr<HighlightModel> model);
/// InputError listing the known names for an unknown one.
const HighlightModel& modelByName(const std::string& id);
/// Null for an unknown name.
const HighlightModel* findModel(const std::string& id);
/// Ids of all models, in their order.
std::vector<std::string> modelIds();

/// The model that assumes least and is quickly computed: others are compared with it where nothing was observed.
const HighlightModel& levelSetModel();
/// The model that predicts radiance, with a lobe and the lamp's shape.
const HighlightModel& radianceModel();
/// The model whose ellipsoid makes the canonical contours on the tangent planes.
const HighlightModel& canonicalModel();

}  // namespace glint
