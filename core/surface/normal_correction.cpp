// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "core/surface/mesh.h"

namespace glint {

Eigen::Vector3d NormalCorrection::gradientAt(const Eigen::Vector3d& x) const {
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (std::size_t m = 0; m < centres.size(); ++m) {
    const Eigen::Vector3d d = x - centres[m];
    g -= weights(Eigen::Index(m)) / (length * length) * std::exp(-0.5 * d.squaredNorm() / (length * length)) * d;
  }
  return g;
}

Outcome<std::shared_ptr<const Surface>> correctedMesh(const Surface& mesh, MeshPolicy policy,
                                                      const NormalCorrection& correction) {
  require(correction.length > 0 && correction.weights.size() == Eigen::Index(correction.centres.size()),
          "correctedMesh: a weight per centre, a length");
  if (policy.normals == NormalPolicy::Facet) return Failure{Reason::NotSupported, "facet normals cannot be corrected"};
  TriangleMesh turned = mesh.tessellate(Eigen::AlignedBox3d(), 0);
  if (turned.triangles.empty() || turned.normals.size() != turned.vertices.size())
    return Failure{Reason::NotSupported, mesh.describe() + " has no vertex normals"};
  for (std::size_t i = 0; i < turned.vertices.size(); ++i) {
    Eigen::Vector3d& n = turned.normals[i];
    if (!n.allFinite() || n.isZero()) continue;  // a vertex of no triangle
    const Eigen::Vector3d g = correction.gradientAt(turned.vertices[i]);
    n = (n - (g - n * n.dot(g))).normalized();
  }
  return makeMesh(std::move(turned), policy);
}

}  // namespace glint
