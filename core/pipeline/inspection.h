// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/base/settings.h"
#include "core/model/model.h"
#include "core/pipeline/comparison.h"
#include "core/pipeline/frame_evidence.h"
#include "core/pipeline/light_frame_choice.h"
#include "core/pipeline/stage_inputs.h"
#include "core/pipeline/surface_correction.h"
#include "core/pipeline/training.h"
#include "core/pipeline/what_if.h"
#include "core/scene/scene.h"

namespace glint {

class CorrectedDepthMaps;

/// Which frames train: parsed from --train SPEC (docs/formats.md, "Frame SPEC").
struct TrainSpec {
  std::string text = "first:6";
  bool perSurface = false;
  std::vector<int> frames;  ///< sorted, unique; all frames when perSurface
};
/// InputError (place "--train") if it does not parse or names a frame that does not exist.
TrainSpec parseTrainSpec(const std::string& text, const Scene& scene);
/// What trains, for a person: "0000-0003,0007" by ids, "first:6, 0000-0005", "per-surface".
std::string trainText(const TrainSpec& train, const Scene& scene);

/// What to compute. Plain data: the session file stores it, the inspector edits it.
struct InspectionRequest {
  std::vector<std::string> models = modelIds();
  std::string train = "first:6";
  std::vector<int> excluded;  ///< frames never used for training nor evaluated
  FrameSource source = FrameSource::Radiance;
  Settings settings;
  double noisePx = 0;  ///< Gaussian noise on training contours (72 points) and peaks
  unsigned seed = 1;
  std::vector<std::string> lights;  ///< predicted ones, on or not; empty = those that are on in each frame
  std::string truthFolder;          ///< --truth DIR, "" = own detection
  WhatIf whatIf;                    ///< changes to scene and evidence that the user tries out
  friend bool operator==(const InspectionRequest&, const InspectionRequest&) = default;
};

struct ModelResult {
  std::string model;
  struct Fit {
    std::string light;
    std::optional<std::string> surface;
    Outcome<ModelFit> fit = Failure{Reason::TooFewViews, "not fitted"};
    std::vector<std::string> bandRemarks;  ///< predict.band: what its band holds, and what makes it wide
    const Failure* failure() const { return fit ? nullptr : &fit.failure(); }
    FitKey key() const { return {light, surface}; }
  };
  std::vector<Fit> fits;
  std::vector<FrameComparison> frames;  ///< every frame, training ones too; `heldOut` tells which count
  bool oneFrame = false;                ///< `frames` has one frame's alone, see Question::Part::Frame
};

/// What one run of `inspect` computed itself; what it took over from an earlier run or did not need counts nothing.
struct WorkCounts {
  int framesDetected = 0;        ///< frames whose highlights were gathered
  int framesHeldAtOnce = 0;      ///< most frames whose images were in memory at the same time
  int pixelFits = 0;             ///< lobes fitted to pixels
  int framesContouredAgain = 0;  ///< with a lobe's background
  int trainingViews = 0;         ///< brightest points and tangent planes
  int lights = 0;                ///< lights estimated
  int canonicalContours = 0;
  int fits = 0;
  int predictions = 0;
  int comparisons = 0;
  int surfacesAsked = 0;  ///< predictions that asked for the surface of their frame
};

/// Everything that was computed; the viewer shows all of it.
struct Inspection {
  std::shared_ptr<const Scene> scene;  ///< with the request's what-if, in the coordinates in which its lights stand still
  std::shared_ptr<const Scene> world;  ///< the same in the world; the same object where the lights stand still there
  std::shared_ptr<const Scene> given;  ///< as it was read; the same object where the what-if leaves the scene alone
  std::shared_ptr<const SurfaceCache> surfaces;  ///< of `scene`
  LightFrameChoice lightFrame;                   ///< which coordinates `scene` has
  bool inScene = false;                          ///< everything is in the scene's coordinates of one frame, see inSceneAt()
  InspectionRequest request;
  TrainSpec train;
  std::vector<FrameEvidence> evidence;  ///< one per frame; `frame` is -1 where nobody looked
  /// As found, of frames whose highlights the what-if moved or whose lights it switched off.
  std::map<int, FrameEvidence> evidenceBefore;
  /// Where a lobe's background replaced the smooth one (detect.background = lobe): the evidence as first detected; else empty.
  std::vector<FrameEvidence> detected;
  std::vector<TrainingView> views;           ///< one per training highlight; on the corrected surface where there is a correction
  std::map<int, TrainingView> viewsAsGiven;  ///< by index into `views`: of those, on the surface as given; see viewAsGiven()
  std::map<std::pair<int, int>, std::shared_ptr<const PixelPatch>> patches;  ///< pixels by (training frame, highlight as found)
  std::map<FitKey, Outcome<std::shared_ptr<const PixelFit>>> pixelFits;      ///< the lobe of the training frames' pixels
  std::map<FitKey, std::shared_ptr<const UnexplainedPixels>> unexplained;    ///< what was asked where that failed
  std::map<FitKey, std::string> pixelDoubts;  ///< what pixels show that no fit says: another response, vignetting, a second lobe
  bool pixelsLeft = false;                    ///< patches and pixelFits are still to be made, see Question::Part::FirstLook
  std::map<FitKey, Outcome<LightEstimate>> lights;         ///< see lightOf(), lightFor()
  std::map<FitKey, SurfaceCorrection> corrections;         ///< of the views' and predictions' surfaces, where there is one
  std::shared_ptr<CorrectedDepthMaps> correctedDepthMaps;  ///< recently used ones, for surfaceFor(); never null after a run
  std::map<std::string, ModelResult> models;
  StageInputs inputs;  ///< of the stages that were computed: tells which of them a later run may take over
  WorkCounts work;
  /// A training view on its surface as given, without canonical contour: what another fit than the inspection's own starts from.
  TrainingView viewAsGiven(int view) const;
  /// The views that fits of a key see: those of its light, or of all known lamps that share its material, as views of this one
  /// (core/pipeline/known_lamps.h).
  /// @param asGiven  on the surfaces as given, see viewAsGiven()
  std::vector<TrainingView> viewsOf(const FitKey& key, bool asGiven = false) const;
  /// From the coordinates of `scene` to those in which a light stands still, in a frame: the identity, but where the light stands
  /// elsewhere (LightFrameChoice::elsewhere). Its views, estimates, fits and predictions are there.
  Eigen::Isometry3d lightFromScene(int frame, const std::string& light) const;
  /// A frame's camera in the coordinates of a light, as surfaceFor() has its surface.
  Camera cameraFor(int frame, const std::string& light) const;
  /// The evidence of a frame, gathered from these inputs of Stage::Evidence; null if it is of others, or was not gathered.
  const FrameEvidence* evidenceOf(int frame, const StageInputs& from) const;
  /// What a later run takes its evidence and lobes from, and computes everything else anew.
  Inspection evidenceAlone() &&;
  bool isTraining(int frame) const;
  bool isHeldOut(int frame) const;  ///< counts in summaries

  /// Whose estimate and fits serve a light in a frame. Without a surface where `surfaces` is not set.
  FitKey keyFor(int frame, const std::string& light) const;
  /// The estimate of a light, null if it failed or no model needs it.
  const LightEstimate* lightOf(const FitKey& key) const;
  const LightEstimate* lightFor(int frame, const std::string& light) const { return lightOf(keyFor(frame, light)); }
  /// What the surface of a light was corrected by, as other fits of some of its views take it; null if it was not estimated.
  const SurfaceCorrection* chosenFor(const FitKey& key) const;
  /// Why a light was not estimated; null if it was, or if no model needs it.
  const Failure* lightFailureFor(int frame, const std::string& light) const;
  /// Every estimate or failure that serves a frame, by light id.
  std::vector<std::pair<std::string, const Outcome<LightEstimate>*>> lightsFor(int frame) const;
};

/// The surface that predictions of a light in a frame use: the frame's own, corrected where the light's contours correct it
/// (light.smooth_mesh, light.refine_depth, light.refine_normals), in the coordinates of the light. Thread-safe. The failures of
/// correctedSurface(); NoSurface without a cache.
/// @param light  id.
Outcome<std::shared_ptr<const Surface>> surfaceFor(const Inspection& inspection, int frame, const std::string& light);

/// A highlight of a frame as evidence of its light, in the coordinates of the light. @param surface  of the frame, in the scene's
TrainingView trainingViewIn(const Inspection& inspection, const FrameEvidence& evidence, int highlight,
                            std::shared_ptr<const Surface> surface, CutUse cut);

/// The inspection with everything of one frame in the coordinates of its scene: lights that stand elsewhere are carried to where
/// they are in that frame, with their fits, whose uncertainty is left out; views and predictions are where their frames have
/// them. For what is drawn or asked of a single frame. The inspection itself where no light stands elsewhere.
std::shared_ptr<const Inspection> inSceneAt(std::shared_ptr<const Inspection> inspection, int frame);
/// The same of an inspection that somebody else holds, and outlives the answer.
std::shared_ptr<const Inspection> inSceneAt(const Inspection& inspection, int frame);

/// The answer to a single question for everything, see Pipeline (core/pipeline/pipeline.h), with its failures.
/// @param previous  result of an earlier run on the same scene: stages whose inputs did not change are taken from it.
Inspection inspect(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const ProgressFn& progress = {},
                   const Inspection* previous = nullptr);

}  // namespace glint
