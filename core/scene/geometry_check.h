// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/scene/correction.h"
#include "core/scene/scene.h"
#include "core/surface/surface.h"

namespace glint {

/// Which mistake explains that cameras do not see their surface. Each mistake is undone, and the cameras that see it are counted
/// (at least half of the surface's vertices inside the image).
struct SightHypothesis {
  std::string mistake;  ///< for a person, with what to do: "poses are camera to world (invert them)"
  Correction undoing;
  int seeing = 0;  ///< frames that see their surface once it is undone
};
struct SightCheck {
  int frames = 0, seeing = 0;           ///< as given; frames with a surface of their scene
  std::vector<SightHypothesis> undone;  ///< the best first
  /// The only one that explains it: with it nine of ten cameras see their surface, as given less than half do; null = none.
  const SightHypothesis* explanation() const;
};
/// @param trianglesOf  of a surface by its id; the answer is valid until the next question
SightCheck checkSight(const Scene& scene, const std::function<const TriangleMesh&(const std::string&)>& trianglesOf);

/// What is wrong with the sides of a mesh; "" = nothing. Facets of a closed mesh look inwards, or normals of vertices point
/// against their facets.
std::string sidesOf(const TriangleMesh& mesh);
/// Whether every edge belongs to two triangles that run along it in opposite directions.
bool isClosed(const TriangleMesh& mesh);
/// Six times the volume between the facets and a vertex: negative for a closed mesh whose facets look inwards.
double signedVolume(const TriangleMesh& mesh);
/// Whether most facets have normals of their vertices on the other side. False without normals.
bool normalsAgainstFacets(const TriangleMesh& mesh);

}  // namespace glint
