// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/epipolar.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <utility>

namespace glint {
namespace {

struct Pair {
  Eigen::Matrix3d fundamental;
  Eigen::Vector3d epipole1, epipole2;  ///< |.| = 1
};

Outcome<Pair> pairOf(const Projection& first, const Projection& second) {
  if (!first.matrix.allFinite() || !second.matrix.allFinite()) return Failure{Reason::NotFinite, "projection"};
  const Eigen::Matrix3d m1 = first.matrix.leftCols<3>(), m2 = second.matrix.leftCols<3>();
  const Eigen::FullPivLU<Eigen::Matrix3d> lu1(m1), lu2(m2);
  if (!lu1.isInvertible() || !lu2.isInvertible()) return Failure{Reason::RankDeficient, "a camera centre lies at infinity"};
  const Eigen::Vector3d c1 = -lu1.solve(first.matrix.col(3)), c2 = -lu2.solve(second.matrix.col(3));
  const Eigen::Vector3d baseline = c1 - c2;
  if (!(baseline.norm() > 1e-12 * (c1.norm() + c2.norm())))  // shorter than that it is the centres' round-off
    return Failure{Reason::RankDeficient, "the two cameras share their centre, so no epipolar lines exist"};
  Pair pair;
  pair.epipole2 = (m2 * baseline).normalized();
  pair.epipole1 = (m1 * baseline).normalized();
  Eigen::Matrix3d cross;
  cross << 0, -pair.epipole2.z(), pair.epipole2.y(), pair.epipole2.z(), 0, -pair.epipole2.x(), -pair.epipole2.y(),
      pair.epipole2.x(), 0;
  pair.fundamental = cross * m2 * lu1.inverse();
  pair.fundamental /= pair.fundamental.norm();
  return pair;
}

Eigen::Vector3d normalisedLine(const Eigen::Vector3d& line) { return line / line.head<2>().norm(); }

Eigen::Matrix2d shapeOf(const Ellipse& e) {
  const Eigen::Matrix2d r = Eigen::Rotation2Dd(e.angle).toRotationMatrix();
  return r * e.semiAxes.cwiseAbs2().asDiagonal() * r.transpose();
}

/// Half width of the ellipse across a line with this unit normal.
double halfWidth(const Ellipse& e, const Eigen::Vector2d& normal) { return std::sqrt(normal.dot(shapeOf(e) * normal)); }

double missOf(const Ellipse& e, const Eigen::Vector3d& line) {
  return std::abs(line.dot(e.centre.homogeneous())) - halfWidth(e, line.head<2>());
}

/// Where a tangent touches: the centre moved by S n / h(n) towards the line.
Pixel contactOf(const Ellipse& e, const Eigen::Vector3d& tangent) {
  const Eigen::Vector2d n = tangent.head<2>();
  const double side = tangent.dot(e.centre.homogeneous()) > 0 ? -1 : 1;
  return e.centre + side / halfWidth(e, n) * (shapeOf(e) * n);
}

}  // namespace

Outcome<Eigen::Matrix3d> fundamentalMatrix(const Projection& first, const Projection& second) {
  const Outcome<Pair> pair = pairOf(first, second);
  if (!pair) return pair.failure();
  return pair->fundamental;
}

double EpipolarTangents::rmsPx() const {
  double sum = 0;
  for (const EpipolarView* view : {&first, &second})
    for (const double miss : view->missPx) sum += miss * miss;
  return std::sqrt(sum / 4);
}

Outcome<EpipolarTangents> epipolarTangents(const Projection& p1, const Ellipse& e1, const Projection& p2, const Ellipse& e2) {
  const Outcome<Pair> pair = pairOf(p1, p2);
  if (!pair) return pair.failure();
  EpipolarTangents answer;
  answer.first.epipole = pair->epipole1;
  answer.second.epipole = pair->epipole2;
  const Outcome<std::array<Eigen::Vector3d, 2>> lines1 = tangentLines(e1.conic(), pair->epipole1);
  if (!lines1) return Failure{lines1.failure().reason, "first image: the epipole lies inside the ellipse"};
  const Outcome<std::array<Eigen::Vector3d, 2>> lines2 = tangentLines(e2.conic(), pair->epipole2);
  if (!lines2) return Failure{lines2.failure().reason, "second image: the epipole lies inside the ellipse"};
  answer.first.tangents = *lines1;
  answer.second.tangents = *lines2;
  // l2 ~ F [e1]x l1, and back with F^T.
  const auto carried = [](const Eigen::Matrix3d& f, const Eigen::Vector3d& epipole, const Eigen::Vector3d& line) {
    return normalisedLine(f * epipole.cross(line));
  };
  std::array<Eigen::Vector3d, 2> to2, to1;
  for (std::size_t i = 0; i < 2; ++i) {
    to2[i] = carried(pair->fundamental, pair->epipole1, (*lines1)[i]);
    to1[i] = carried(pair->fundamental.transpose(), pair->epipole2, (*lines2)[i]);
    if (!to1[i].allFinite() || !to2[i].allFinite()) return Failure{Reason::NotFinite, "epipolar line"};
  }
  // Which tangent of the second image belongs to which of the first is not known beforehand: the pairing whose carried lines pass
  // nearer to the points of contact. (Angles would not tell where an epipole is far away and all lines are parallel.)
  const auto apart = [&](std::size_t shift) {
    double sum = 0;
    for (std::size_t i = 0; i < 2; ++i) sum += std::abs(to2[i].dot(contactOf(e2, (*lines2)[(i + shift) % 2]).homogeneous()));
    return sum;
  };
  if (apart(1) < apart(0)) {
    std::swap(answer.second.tangents[0], answer.second.tangents[1]);
    std::swap(to1[0], to1[1]);
  }
  answer.second.transferred = to2;
  answer.first.transferred = to1;
  for (std::size_t i = 0; i < 2; ++i) {
    answer.first.contacts[i] = contactOf(e1, answer.first.tangents[i]);
    answer.second.contacts[i] = contactOf(e2, answer.second.tangents[i]);
    answer.first.missPx[i] = missOf(e1, to1[i]);
    answer.second.missPx[i] = missOf(e2, to2[i]);
  }
  return answer;
}

}  // namespace glint
