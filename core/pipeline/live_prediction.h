// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/settings.h"
#include "core/geometry/camera.h"
#include "core/model/band.h"
#include "core/model/model.h"
#include "core/pipeline/inspection.h"
#include "core/surface/surface.h"

namespace glint {

/// The surface that a model's predictions of a light use in a frame. Null without a surface, and for a model that needs nothing
/// but the camera (method.md section 11).
std::shared_ptr<const Surface> surfaceOfModel(const Inspection& inspection, const HighlightModel& model, int frame,
                                              const std::string& light);

/// What one fit predicts in a camera, on the surface of a frame of the scene; highlights that are too small to be told are
/// dropped. `timeUs` is the model's own time, 0 of a failure. `inspect` and LivePredictor make every prediction here.
/// @param frame    whose surface it is; < 0 = none is known: models that need one fail with NoSurface
/// @param camera   the frame's own, or another one
/// @param surface  surfaceOfModel(), which outlives the call
Prediction predictionFor(const Inspection& inspection, const ModelResult::Fit& fit, const HighlightModel& model, int frame,
                         const Camera& camera, const Surface* surface);

/// Whether a light is predicted in a frame: one that the request names, or else one that is on there.
/// @param frame  nothing = a view of no frame
bool isPredicted(const Scene& scene, const InspectionRequest& request, std::optional<int> frame, const std::string& light);

/// Predictions of one fit in a camera that came live.
struct LiveHighlights {
  std::string model, light;
  Prediction prediction;
  std::string poor{};  ///< why its fit is poor; "" if it is ok
};

struct LiveAnswer {
  Camera camera;                           ///< that was predicted for, in the coordinates of Inspection::scene
  std::optional<int> frame;                ///< of the scene, whose id was given
  std::vector<LiveHighlights> highlights;  ///< by model and light, those that failed too
};

/// Fits once, and predicts for poses that are in no scene, one after another: what a SLAM or AR program asks for.
class LivePredictor {
 public:
  /// Fits the models of the request from its training frames; with predict.band also the bands of their predictions, which take
  /// their time at each pose. InputError as `inspect`; Stopped.
  LivePredictor(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress = {});

  const Inspection& inspection() const { return inspection_; }
  /// Why no pose can be answered: no model was fitted. Nothing if one was.
  std::optional<Failure> failure() const;

  /// @param id      of a frame of the scene: its surface and the lights that are on in it count, and its intrinsics. Another id:
  ///                all fitted lights, and the surface and intrinsics that all frames share
  /// @param camera  intrinsics and size, where they are given; ignores its pose
  /// @param worldFromObject  where the object stands, if it moves; else where the frame of this id has it, or at its own place
  /// @return  NotSupported if the intrinsics are not known. That a surface is not known is the failure of a prediction.
  Outcome<LiveAnswer> predict(const std::string& id, const Eigen::Isometry3d& cameraFromWorld,
                              const std::optional<Camera>& camera,
                              const std::optional<Eigen::Isometry3d>& worldFromObject = {}) const;

 private:
  Inspection inspection_;
  std::map<std::string, int> frames_;                                            ///< by id
  std::optional<Camera> sharedCamera_;                                           ///< of all frames, but for the pose
  std::optional<int> anyFrameOfSurface_;                                         ///< a frame, where all see the same surface
  std::map<std::pair<std::string, FitKey>, std::shared_ptr<const Band>> bands_;  ///< by model and fit; none without predict.band
};

/// Moves what the settings exclude from a prediction to Prediction::filtered, each with its reason; if nothing is left, the
/// first reason is the answer (NoHighlight).
///   predict.filter_area        smaller than detection takes: detect.min_area, px^2. Counts the contour beyond the image, too
///   predict.filter_brightness  fainter than this share of the brightest one of the same prediction. I falls with the angle alpha
///                              between normal and half vector at the brightest point as a Gaussian lobe does,
///                              log I = log(q) (tan alpha / tan alpha_lim)^2 with the level q (method.md section 5), or by the
///                              lobe of `reflectance`
///   predict.filter_shadow      the surface itself hides the light from the middle of the contour
/// The last two need the fit's light and, of brightness, its limit angle or lobe; models without them keep everything.
/// @param surface  may be null
void filterPrediction(Prediction& prediction, const ModelFit& fit, const Camera& camera, const Surface* surface,
                      const Settings& settings);

}  // namespace glint
