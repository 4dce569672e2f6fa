// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/polyline.h"
#include "core/model/model.h"
#include "core/model/view_effects.h"

namespace glint {

/// Another fit that may equally be true: another lobe, or the same model under inputs that are off by their tolerance.
struct BandAlternative {
  const HighlightModel* model = nullptr;
  ModelFit fit;
  std::function<Camera(const Camera&)> camera;  ///< the view's camera as this alternative has it; empty: as given
  std::shared_ptr<const ModelFit> reference;    ///< what it differs from by its camera alone; null: the fit itself
  double share = 1;                             ///< of the squared distance to it that counts as variance
};

/// The uncertainty of a fit's predictions, from what its training views show: the noise of single points, errors that whole views
/// have in common (view_effects.h), and how far alternatives are away.
class Band {
 public:
  /// Predicts the training views and takes their residuals. Null where the fit has no uncertainty, or no view shows its contour.
  static std::shared_ptr<Band> of(const HighlightModel& model, const ModelFit& fit, const std::vector<TrainingView>& views,
                                  const Settings& settings);

  void add(BandAlternative alternative) { alternatives_.push_back(std::move(alternative)); }
  /// The parameters' own covariance counts beside the residuals: it contains a part (a refined depth or normals) that no residual
  /// shows.
  void addOwnCovariance() { own_ = true; }
  /// What the scene states of a known lamp: the parameters' changes count beside the residuals, of which they are no part.
  /// @param fit  whose uncertainty is the stated one
  void addStated(ModelFit fit) { stated_ = std::move(fit); }

  const ViewEffects& effects() const { return effects_; }
  double radiusPx() const { return radius_; }  ///< of the training contours, mean
  bool clipped() const { return clipped_; }    ///< contours at a level of a clipped peak: nothing tells the level

  /// One per vertex of the contour: 1.96 of it hold 95 %. It includes Student's factor for few degrees of freedom. 0 along the
  /// surface's own edge.
  std::vector<double> sigmaPx(const PredictedHighlight& highlight, const Camera& camera, const Surface* surface) const;

 private:
  Band(const HighlightModel& model, ModelFit fit, const Settings& settings, ViewEffects effects)
      : model_(model), fit_(std::move(fit)), settings_(settings), effects_(std::move(effects)) {}

  const HighlightModel& model_;
  ModelFit fit_;
  Settings settings_;
  ViewEffects effects_;
  std::vector<BandAlternative> alternatives_;
  bool own_ = false, clipped_ = false;
  std::optional<ModelFit> stated_;
  double radius_ = 0, unit_ = 1;
};

/// The nearest place on a closed predicted contour to a point of an observed one.
struct ContourFoot {
  double distance = 0;           ///< px, positive outside the predicted contour
  Pixel normal{0, 0};            ///< unit, outwards, of the predicted contour; not finite where it has none
  double arc = 0;                ///< arc length, as a share of the whole, in [0, 1]
  std::size_t from = 0, to = 0;  ///< vertices on both sides
  double share = 0;              ///< of the way from one to the other
};

/// One foot for every point; empty for a contour of fewer than three vertices.
std::vector<ContourFoot> feetOn(const Polyline& predicted, const std::vector<Pixel>& points);

/// Arc length at every vertex of a closed contour, as a share of the whole.
std::vector<double> arcOf(const Polyline& line);

}  // namespace glint
