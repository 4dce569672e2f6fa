// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/pipeline/corrected_depth.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// What the contours of a light say of the surface that they lie on (light.refine_depth, light.refine_normals), while an inspection is made: corrects the training
/// views of the inspection and serves corrected surfaces to its predictions.
class SurfaceCorrections {
 public:
  /// @param inspection  with scene, surfaces and request; its depthCorrections and refinedNormals are read and filled. It must outlive this.
  explicit SurfaceCorrections(Inspection& inspection) : r_(inspection) {}

  /// The surface that a frame shows under a light: corrected where there is a correction of it, else as given; null where there is none. Thread-safe.
  std::shared_ptr<const Surface> surfaceOf(int frame, const FitKey& key);
  /// Estimates what the settings ask for and corrects the views and the light with it, where it is worth it.
  /// @param views  of this light: indices into Inspection::views.
  void refine(const std::vector<int>& views, const FitKey& key, LightEstimate& light);
  /// Puts the views on their corrected surfaces, where there are any.
  void correctViews(const std::vector<int>& views, const FitKey& key);
  bool any(const FitKey& key) const { return r_.depthCorrections.count(key) + r_.refinedNormals.count(key) > 0; }

 private:
  void refineDepth(const std::vector<int>& views, const FitKey& key, LightEstimate& light);
  void refineNormals(const std::vector<int>& views, const FitKey& key, LightEstimate& light);
  std::vector<TrainingView> of(const std::vector<int>& views) const;

  Inspection& r_;
  CorrectedDepthMaps depthMaps_;
};

}  // namespace glint
