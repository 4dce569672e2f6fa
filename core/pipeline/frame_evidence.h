// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/highlight/diffuse.h"
#include "core/highlight/highlight.h"
#include "core/highlight/specular_separation.h"

namespace glint {

/// A bright spot that was detected and is paint (core/pipeline/highlight_motion.h): no evidence.
struct WithheldTexture {
  int place = 0;  ///< index among the highlights as detected
  Highlight highlight;
  std::string reason;  ///< as in FrameEvidence::rejected
};

/// One frame's evidence.
struct FrameEvidence {
  int frame = -1;
  std::string id;                           ///< of the frame: what a person is told
  std::vector<Highlight> highlights;        ///< each with its light
  std::optional<Failure> failure;           ///< why there are no highlights: NoHighlight, FrameUnreadable, ...
  std::vector<RejectedCandidate> rejected;  ///< what detection saw and did not take, measured pixels
  std::vector<WithheldTexture> textures;    ///< taken out of `highlights`, by rising place
  /// detect.background = colours: why the colours do not tell what is specular; "" if they do, or were not asked.
  std::string notSeparated;
  std::vector<SeparatedRegion> separated;  ///< where they do: how, around each highlight that was detected; measured pixels
  FineStructure structure;                 ///< of the photograph, where detect.texture asks for it
  /// What lies under the highlights, where other views show it and it was taken off (core/pipeline/diffuse_texture.h).
  std::shared_ptr<const DiffuseLight> diffuse;
  std::shared_ptr<const FrameEvidence> asSeen;  ///< where `diffuse` is set: what was found before, by which motion judges
  bool againstTruth = false;                    ///< --truth is given: `truth` is scored, whatever was detected
  /// Where a what-if took some out or changed which there are: which of the highlights as found each one is; else empty.
  std::vector<int> found;
  std::vector<Highlight> ignored;  ///< by hand: neither evidence nor scored, and a prediction there is not spurious
  /// Index among the highlights as found, which is what a what-if names them by.
  int asFound(int highlight) const { return found.empty() ? highlight : found[static_cast<std::size_t>(highlight)]; }
  std::vector<Highlight> truth;
  std::optional<Failure> truthFailure;  ///< the frame has no truth, so it cannot be scored
  /// What predictions are compared with, and why there is nothing.
  const std::vector<Highlight>& scored() const { return againstTruth ? truth : highlights; }
  const std::optional<Failure>& scoringFailure() const { return againstTruth ? truthFailure : failure; }
};

}  // namespace glint
