// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/lens.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/base/number_text.h"

namespace glint {

namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using LensParameters = std::array<double, 8>;

struct LensCard {
  LensModel model;
  const char* name;
  const char* parameters;
  int count;
};
constexpr std::array<LensCard, kLensModels.size()> kLensCards{
    {{LensModel::OpenCv, "OPENCV", "k1 k2 p1 p2 k3", 5},
     {LensModel::FullOpenCv, "FULL_OPENCV", "k1 k2 p1 p2 k3 k4 k5 k6", 8},
     {LensModel::SimpleRadial, "SIMPLE_RADIAL", "k", 1},
     {LensModel::Radial, "RADIAL", "k1 k2", 2},
     {LensModel::OpenCvFisheye, "OPENCV_FISHEYE", "k1 k2 k3 k4", 4},
     {LensModel::SimpleRadialFisheye, "SIMPLE_RADIAL_FISHEYE", "k", 1},
     {LensModel::RadialFisheye, "RADIAL_FISHEYE", "k1 k2", 2},
     {LensModel::Fov, "FOV", "omega", 1},
     {LensModel::ThinPrismFisheye, "THIN_PRISM_FISHEYE", "k1 k2 p1 p2 k3 k4 sx1 sy1", 8},
     {LensModel::VisualSfm, "VISUALSFM", "r", 1}}};

const LensCard& lensCardOf(LensModel model) { return kLensCards[static_cast<std::size_t>(model)]; }

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kRightAngle = std::numbers::pi / 2;

double polynomialAt(const std::vector<double>& c, double z) {
  double sum = 0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * z + c[i];
  return sum;
}

/// Where c[0] + c[1] z + c[2] z^2 + ... changes its sign in (0, end), in order. Between two extremes it does so at most once, and
/// the extremes are where its derivative changes its sign.
std::vector<double> signChanges(const std::vector<double>& c, double end) {
  std::vector<double> found;
  if (c.size() < 2) return found;
  std::vector<double> derivative;
  for (std::size_t i = 1; i < c.size(); ++i) derivative.push_back(double(i) * c[i]);
  std::vector<double> borders = signChanges(derivative, end);
  borders.push_back(end);
  double from = 0;
  for (const double to : borders) {
    const bool positive = polynomialAt(c, from) > 0;
    if (positive != (polynomialAt(c, to) > 0)) {
      double low = from, high = to;
      for (double middle = low + (high - low) / 2; middle > low && middle < high; middle = low + (high - low) / 2)
        ((polynomialAt(c, middle) > 0) == positive ? low : high) = middle;
      found.push_back(low);  // the last number before the change
    }
    from = to;
  }
  return found;
}

/// Whether 1 + c[1] z + c[2] z^2 + ... stays positive over [0, end].
bool staysPositive(const std::vector<double>& c, double end) {
  double least = 1, power = 1;  // a bound from below: cheap, and enough for most lenses
  for (std::size_t i = 1; i < c.size(); ++i) least += std::min(0.0, c[i]) * (power *= end);
  return least > 0 || (signChanges(c, end).empty() && polynomialAt(c, end) > 0);
}

/// A map of the plane that is the identity near the centre, with its derivative.
struct BrownConrady {
  const LensParameters& d;
  static constexpr int kBranchSteps = 16;  // a polynomial of degree 7 turns at most three times on the way
  Vector2d at(const Vector2d& x) const {
    const double r2 = x.squaredNorm();
    const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    return {x.x() * radial + 2 * d[2] * x.x() * x.y() + d[3] * (r2 + 2 * x.x() * x.x()),
            x.y() * radial + d[2] * (r2 + 2 * x.y() * x.y()) + 2 * d[3] * x.x() * x.y()};
  }
  Matrix2d slope(const Vector2d& x) const {
    const double r2 = x.squaredNorm();
    const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    const double byR2 = d[0] + r2 * (2 * d[1] + 3 * r2 * d[4]);
    Matrix2d j = radial * Matrix2d::Identity() + 2 * byR2 * x * x.transpose();
    j(0, 0) += 2 * d[2] * x.y() + 6 * d[3] * x.x();
    j(0, 1) += 2 * d[2] * x.x() + 2 * d[3] * x.y();
    j(1, 0) += 2 * d[2] * x.x() + 2 * d[3] * x.y();
    j(1, 1) += 6 * d[2] * x.y() + 2 * d[3] * x.x();
    return j;
  }
};

/// The same with a denominator in the radial term: d[5], d[6], d[7].
struct RationalLens {
  const LensParameters& d;
  static constexpr int kBranchSteps = 32;  // its slope has up to six zeros
  std::vector<double> denominator{1, d[5], d[6], d[7]};
  double below(double r2) const { return 1 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])); }
  Vector2d at(const Vector2d& x) const {
    const double r2 = x.squaredNorm();
    const double radial = (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / below(r2);
    return {x.x() * radial + 2 * d[2] * x.x() * x.y() + d[3] * (r2 + 2 * x.x() * x.x()),
            x.y() * radial + d[2] * (r2 + 2 * x.y() * x.y()) + 2 * d[3] * x.x() * x.y()};
  }
  Matrix2d slope(const Vector2d& x) const {
    const double r2 = x.squaredNorm(), under = below(r2);
    if (!staysPositive(denominator, r2)) return Matrix2d::Constant(kNoNumber);  // a pole lies on the way: another branch
    const double radial = (1 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]))) / under;
    const double byR2 = (d[0] + r2 * (2 * d[1] + 3 * r2 * d[4]) - radial * (d[5] + r2 * (2 * d[6] + 3 * r2 * d[7]))) / under;
    Matrix2d j = radial * Matrix2d::Identity() + 2 * byR2 * x * x.transpose();
    j(0, 0) += 2 * d[2] * x.y() + 6 * d[3] * x.x();
    j(0, 1) += 2 * d[2] * x.x() + 2 * d[3] * x.y();
    j(1, 0) += 2 * d[2] * x.x() + 2 * d[3] * x.y();
    j(1, 1) += 6 * d[2] * x.y() + 2 * d[3] * x.x();
    return j;
  }
};

/// COLMAP's thin prism, from fisheye coordinates to measured ones.
struct ThinPrism {
  const LensParameters& d;                 // k1 k2 p1 p2 k3 k4 sx1 sy1
  static constexpr int kBranchSteps = 16;  // a polynomial of degree 9 turns at most four times on the way
  Vector2d at(const Vector2d& x) const {
    const double r2 = x.squaredNorm();
    const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * (d[4] + r2 * d[5])));
    return {x.x() * radial + 2 * d[2] * x.x() * x.y() + d[3] * (r2 + 2 * x.x() * x.x()) + d[6] * r2,
            x.y() * radial + d[2] * (r2 + 2 * x.y() * x.y()) + 2 * d[3] * x.x() * x.y() + d[7] * r2};
  }
  Matrix2d slope(const Vector2d& x) const {
    const double r2 = x.squaredNorm();
    const double radial = 1 + r2 * (d[0] + r2 * (d[1] + r2 * (d[4] + r2 * d[5])));
    const double byR2 = d[0] + r2 * (2 * d[1] + r2 * (3 * d[4] + 4 * r2 * d[5]));
    Matrix2d j = radial * Matrix2d::Identity() + 2 * byR2 * x * x.transpose();
    j(0, 0) += 2 * d[2] * x.y() + 6 * d[3] * x.x() + 2 * d[6] * x.x();
    j(0, 1) += 2 * d[2] * x.x() + 2 * d[3] * x.y() + 2 * d[6] * x.y();
    j(1, 0) += 2 * d[2] * x.x() + 2 * d[3] * x.y() + 2 * d[7] * x.x();
    j(1, 1) += 6 * d[2] * x.y() + 2 * d[3] * x.x() + 2 * d[7] * x.y();
    return j;
  }
};

Failure foldsBefore() { return {Reason::NotConverged, "no ideal pixel maps there: the lens distortion folds back before it"}; }

Failure tooWide(double radians) {
  return {Reason::OutsideImage, formatted("is seen %.4g degrees from the optical axis; only less than 90 are supported",
                                          radians * 180 / std::numbers::pi)};
}

Failure beyondHalfTurn() {
  return {Reason::OutsideImage, "nothing is seen there: it lies beyond 180 degrees from the optical axis"};
}

/// The point that `map` takes to `target`, by a damped Newton's method.
// Not OpenCV's undistortPoints: it answers beyond the fold, too, and does not say so.
template <class Map>
Outcome<Vector2d> mapSolved(const Map& map, const Vector2d& target) {
  const double size = std::max(1.0, target.norm());
  if (!std::isfinite(size)) return Failure{Reason::NotConverged, "no ideal pixel maps there: squares of its distance overflow"};

  // At the centre the model is the identity, so its determinant is 1 there and falls to 0 at the fold. A step is taken only when
  // it brings the target nearer and stays on this side of the fold.
  const auto onBranch = [&](const Vector2d& x) {
    for (int i = 1; i <= Map::kBranchSteps; ++i)
      if (!(map.slope(x * (double(i) / Map::kBranchSteps)).determinant() > 0)) return false;
    return true;
  };
  Vector2d x = onBranch(target) ? target : Vector2d(0, 0);
  Vector2d error = target - map.at(x);
  constexpr int kMaxIterations = 100;
  for (int i = 0; i < kMaxIterations && error.norm() > 1e-16 * size; ++i) {  // round-off of the target itself
    const Vector2d step = map.slope(x).partialPivLu().solve(error);
    bool moved = false;
    for (double share = 1; share > 1e-6; share *= 0.5) {  // shorter steps than a millionth are a fold, not a curve
      const Vector2d next = x + share * step, rest = target - map.at(next);
      if (!(rest.norm() < error.norm()) || !onBranch(next)) continue;
      x = next;
      error = rest;
      moved = true;
      break;
    }
    if (!moved) break;
  }
  // A few units of round-off of the polynomial; anything larger is a fold that Newton's method ran into.
  if (!(error.norm() <= 1e-14 * size)) return foldsBefore();
  return x;
}

/// theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), rising from 0 up to its first fold.
struct FisheyeRadius {
  const LensParameters& k;
  double at(double theta) const {
    const double z = theta * theta;
    return theta * (1 + z * (k[0] + z * (k[1] + z * (k[2] + z * k[3]))));
  }
  double slope(double theta) const {
    const double z = theta * theta;
    return 1 + z * (3 * k[0] + z * (5 * k[1] + z * (7 * k[2] + z * 9 * k[3])));
  }
  /// The end of the branch: the fold if one comes before `end`.
  double branchEnd(double end) const {
    const std::vector<double> c{1, 3 * k[0], 5 * k[1], 7 * k[2], 9 * k[3]};
    if (staysPositive(c, end * end)) return end;
    const std::vector<double> folds = signChanges(c, end * end);
    return folds.empty() ? end : std::sqrt(folds.front());
  }
};

/// The angle from the axis that is measured at `radius`, by Newton's method between two bounds.
Outcome<double> fisheyeAngle(const FisheyeRadius& lens, double radius) {
  double high = lens.branchEnd(kRightAngle);
  const bool folds = high < kRightAngle;
  if (!folds && !(lens.at(high) >= radius)) high = lens.branchEnd(std::numbers::pi);
  if (!(lens.at(high) >= radius)) {
    return high < std::numbers::pi ? foldsBefore() : beyondHalfTurn();
  }
  double low = 0, theta = std::min(radius, high), last = std::numeric_limits<double>::infinity();
  constexpr int kMaxIterations = 1200;  // bisection alone needs some 60 for a usual lens, 1,100 down to the least double
  for (int i = 0; i < kMaxIterations; ++i) {
    const double error = lens.at(theta) - radius;
    if (error == 0) break;
    (error < 0 ? low : high) = theta;
    double next = theta - error / lens.slope(theta);
    if (!(next > low && next < high) || std::abs(error) > last / 2) next = low + (high - low) / 2;
    if (!(next > low && next < high)) break;  // neighbours: no number lies between them
    last = std::abs(error);
    theta = next;
  }
  // A few units of round-off, as for the other models.
  if (!(std::abs(lens.at(theta) - radius) <= 1e-14 * std::max(1.0, radius))) return foldsBefore();
  return theta;
}

/// The point (x, y, 1) that is seen `theta` from the axis, in the direction of `along`, whose length is `length`.
Outcome<Vector2d> pointAt(double theta, const Vector2d& along, double length) {
  if (!(theta < kRightAngle)) return tooWide(theta);
  return length > 0 ? Vector2d(along * (std::tan(theta) / length)) : along;
}

/// theta (x, y) / r
Vector2d fisheyeCoordinates(const Vector2d& x) {
  const double r = std::hypot(x.x(), x.y());
  return r > 0 ? Vector2d(x * (std::atan(r) / r)) : x;
}

Vector2d fisheyeDistorted(const LensParameters& k, const Vector2d& x) {
  const double r = std::hypot(x.x(), x.y());
  return r > 0 ? Vector2d(x * (FisheyeRadius{k}.at(std::atan(r)) / r)) : x;
}

Outcome<Vector2d> fisheyeUndistorted(const LensParameters& k, const Vector2d& u) {
  const double radius = std::hypot(u.x(), u.y());
  const Outcome<double> theta = fisheyeAngle({k}, radius);
  if (!theta) return theta.failure();
  return pointAt(*theta, u, radius);
}

Outcome<Vector2d> thinPrismUndistorted(const LensParameters& d, const Vector2d& u) {
  const Outcome<Vector2d> w = mapSolved(ThinPrism{d}, u);
  if (!w) return w.failure();
  const double theta = std::hypot(w->x(), w->y());
  if (!(theta < std::numbers::pi)) return beyondHalfTurn();
  return pointAt(theta, *w, theta);
}

/// Below this |omega| the model is the identity to the last bit, and omega / 2 may be 0 though omega is not.
constexpr double kLeastOmega = 1e-150;

// The textbook's formula is stable down to there: tan, atan and the quotient each keep their relative precision.
Vector2d fovDistorted(double omega, const Vector2d& x) {
  if (!(std::abs(omega) < std::numbers::pi)) return Vector2d::Constant(kNoNumber);
  const double r = std::hypot(x.x(), x.y());
  if (std::abs(omega) < kLeastOmega || !(r > 0)) return x;
  return x * (std::atan(2 * r * std::tan(omega / 2)) / omega / r);
}

Outcome<Vector2d> fovUndistorted(double omega, const Vector2d& u) {
  if (!(std::abs(omega) < std::numbers::pi))
    return Failure{Reason::NotConverged, "the lens shows nothing: its omega is not between -pi and pi"};
  const double radius = std::hypot(u.x(), u.y());
  if (std::abs(omega) < kLeastOmega || !(radius > 0)) return u;
  const double angle = radius * std::abs(omega), scale = 2 * std::tan(std::abs(omega) / 2);
  if (!(angle < std::numbers::pi)) return beyondHalfTurn();
  if (!(angle < kRightAngle)) return tooWide(std::atan2(std::sin(angle), scale * std::cos(angle)));
  return Vector2d(u * (std::tan(angle) / scale / radius));
}

/// The branch of rho (1 + k rho^2) = R that begins at 0, by the formulas of threefold angles: with rho = a sinh(phi) and
/// a = 2 / sqrt(3 k) the left side is a sinh(3 phi) / 3; with sin in place of sinh where k < 0.
Vector2d visualSfmDistorted(double k, const Vector2d& x) {
  const double r = std::hypot(x.x(), x.y());
  if (k == 0 || !(r > 0)) return x;
  const double a = 2 / std::sqrt(3 * std::abs(k)), t = 3 * r / a;
  if (k < 0 && t > 1) return Vector2d::Constant(kNoNumber);  // it shows no point so far from the axis
  return x * (a * (k > 0 ? std::sinh(std::asinh(t) / 3) : std::sin(std::asin(t) / 3)) / r);
}

Outcome<Vector2d> visualSfmUndistorted(double k, const Vector2d& u) {
  const double r2 = u.squaredNorm();
  if (!(1 + 3 * k * r2 > 0)) return foldsBefore();
  const Vector2d x = u * (1 + k * r2);
  if (!x.allFinite()) return foldsBefore();
  return x;
}

bool isFisheye(LensModel model) {
  return model == LensModel::OpenCvFisheye || model == LensModel::SimpleRadialFisheye || model == LensModel::RadialFisheye ||
         model == LensModel::ThinPrismFisheye;
}

}  // namespace

const char* nameOf(LensModel model) { return lensCardOf(model).name; }

std::optional<LensModel> lensModelNamed(std::string_view name) {
  for (const LensCard& card : kLensCards)
    if (name == card.name) return card.model;
  return std::nullopt;
}

const char* parametersOf(LensModel model) { return lensCardOf(model).parameters; }

int parameterCountOf(LensModel model) { return lensCardOf(model).count; }

bool Lens::isIdeal() const {
  if (isFisheye(model)) return false;
  for (const double p : parameters)
    if (p != 0) return false;
  return true;
}

Eigen::Vector2d distorted(const Lens& lens, const Eigen::Vector2d& ideal) {
  const LensParameters& p = lens.parameters;
  switch (lens.model) {
    case LensModel::OpenCv:
    case LensModel::SimpleRadial:
    case LensModel::Radial: return BrownConrady{p}.at(ideal);
    case LensModel::FullOpenCv: return RationalLens{p}.at(ideal);
    case LensModel::OpenCvFisheye:
    case LensModel::SimpleRadialFisheye:
    case LensModel::RadialFisheye: return fisheyeDistorted(p, ideal);
    case LensModel::Fov: return fovDistorted(p[0], ideal);
    case LensModel::ThinPrismFisheye: return ThinPrism{p}.at(fisheyeCoordinates(ideal));
    case LensModel::VisualSfm: return visualSfmDistorted(p[0], ideal);
  }
  return Vector2d::Constant(kNoNumber);
}

Outcome<Eigen::Vector2d> undistorted(const Lens& lens, const Eigen::Vector2d& measured) {
  if (!measured.allFinite()) return Failure{Reason::NotFinite, "point"};
  const LensParameters& p = lens.parameters;
  switch (lens.model) {
    case LensModel::OpenCv:
    case LensModel::SimpleRadial:
    case LensModel::Radial: return mapSolved(BrownConrady{p}, measured);
    case LensModel::FullOpenCv: return mapSolved(RationalLens{p}, measured);
    case LensModel::OpenCvFisheye:
    case LensModel::SimpleRadialFisheye:
    case LensModel::RadialFisheye: return fisheyeUndistorted(p, measured);
    case LensModel::Fov: return fovUndistorted(p[0], measured);
    case LensModel::ThinPrismFisheye: return thinPrismUndistorted(p, measured);
    case LensModel::VisualSfm: return visualSfmUndistorted(p[0], measured);
  }
  return Failure{Reason::NotSupported, "lens model"};
}

}  // namespace glint
