// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"

namespace glint::stability {

/// What a case measured.
struct Measured {
  double error;          ///< relative, against the reference
  double condition = 1;  ///< of the problem, see StabilityResult
};

/// What may come back.
enum class Expect {
  Answer,           ///< an answer within the tolerance; a failure is wrong
  Failure,          ///< one of `reasons`: no unique answer exists, so any answer is wrong
  AnswerOrFailure,  ///< either: beyond the limit that `note` derives
};

struct Case {
  std::string stage, name;
  double parameter = 0;
  double tolerance = 1e-9;  ///< that of issue and method: a part in 1e9, unless `note` derives another
  std::string note;
  Expect expect = Expect::Answer;
  std::vector<Reason> reasons;  ///< allowed ones
  std::function<Outcome<Measured>()> run;
};
using Cases = std::vector<Case>;

/// A case whose answer must lie within the tolerance.
inline Case answerCase(std::string stage, std::string name, double parameter, double tolerance, std::string note,
                       std::function<Outcome<Measured>()> run) {
  Case c;
  c.stage = std::move(stage);
  c.name = std::move(name);
  c.parameter = parameter;
  c.tolerance = tolerance;
  c.note = std::move(note);
  c.run = std::move(run);
  return c;
}

/// The largest of several errors; NaN when one is, which std::max would swallow.
inline double worstOf(std::initializer_list<double> errors) {
  double worst = 0;
  for (const double e : errors) {
    if (std::isnan(e)) return e;
    if (e > worst) worst = e;
  }
  return worst;
}

/// Round-off of a double.
inline constexpr double kRound = std::numeric_limits<double>::epsilon();

void addConicCases(Cases& cases);           ///< conics, ellipses, ellipse fit, outlines of ellipsoids
void addCameraCases(Cases& cases);          ///< projection, rays, lens distortion, mirrors, virtual cameras
void addAngleCases(Cases& cases);           ///< the incident angle
void addSurfaceCases(Cases& cases);         ///< ray hits, feet, curvatures
void addMeshCases(Cases& cases);            ///< meshes, broken ones too
void addMeshFileCases(Cases& cases);        ///< meshes as io reads them, far from the origin
void addBrightestCases(Cases& cases);       ///< predicted brightest points
void addLightCases(Cases& cases);           ///< triangulation and bundle
void addWalkCases(Cases& cases);            ///< walks on T and S, canonical contours
void addReconstructionCases(Cases& cases);  ///< linear, anchored, refined
void addPredictionCases(Cases& cases);      ///< models in new cameras, level sets
void addBadNumberCases(Cases& cases);       ///< NaN, infinity, denormals

}  // namespace glint::stability
