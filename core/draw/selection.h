// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint::draw {

/// What is selected; one for all views. A camera is selected as its frame, an ellipsoid as its model and light, a contour point
/// as frame, highlight and direction, a sample of a plot as whatever of these it stands for.
struct Selection {
  int frame = 0;
  std::string model;    ///< "" = all models
  int highlight = -1;   ///< index in the frame's evidence, -1 = none
  std::string light{};  ///< id of the light whose ellipsoid or highlight is selected, "" = any
  /// A point of the contours of this frame: its direction in the photograph, seen from the centroid of the observed contour (its
  /// peak where there is no contour), rad in (-pi, pi], 0 = right, pi/2 = down. The same direction is marked on observed and
  /// predicted contours, dials and plots.
  std::optional<double> direction{};
  /// A spurious highlight: index in what `model` predicts for `light` in this frame; `highlight` is -1 then. -1 = none.
  int predicted = -1;

  friend bool operator==(const Selection&, const Selection&) = default;
};

// What has no partner: observed highlights that a model misses, and predicted ones that were not observed (spurious).

/// Whether a predicted highlight of a comparison is spurious. Not outside of the image, or where a person ignores a highlight.
bool isSpurious(const FrameComparison& comparison, int predicted);
/// Which of the models miss an observed highlight, from simple to rich. A model that predicts nothing anywhere is left out: its
/// fit says why.
/// @param observed  index into FrameEvidence::scored()
/// @param counts    whether a model is asked
std::vector<std::string> missedBy(const Inspection& inspection, int frame, int observed,
                                  const std::function<bool(const std::string&)>& counts);
/// What has no partner in one frame.
struct FrameUnmatched {
  std::map<int, std::vector<std::string>> missedBy;  ///< by index into FrameEvidence::scored(), as missedBy() says
  struct Spurious {
    std::string model, light;
    int predicted = -1;  ///< index in what the model predicts for this light
    friend bool operator==(const Spurious&, const Spurious&) = default;
  };
  std::vector<Spurious> spurious;  ///< models from simple to rich
  friend bool operator==(const FrameUnmatched&, const FrameUnmatched&) = default;
};
/// Those of all models, by frame; leaves out frames in which all have a partner. One pass, for lists of long sequences.
std::map<int, FrameUnmatched> unmatchedByFrame(const Inspection& inspection);
/// The spurious highlight that is selected; null if nothing is, or if it is no longer spurious.
const PredictedHighlight* selectedSpurious(const Inspection& inspection, const Selection& selection);
/// The comparison of the selected model that a missed or spurious selection is a row of, and that row; nulls without one.
struct UnmatchedRow {
  const FrameComparison* comparison = nullptr;
  const FrameComparison::Row* row = nullptr;
};
/// @param model  asked where the selection names none
UnmatchedRow selectedUnmatched(const Inspection& inspection, const Selection& selection, const std::string& model);

}  // namespace glint::draw
