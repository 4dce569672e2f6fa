// SPDX-License-Identifier: BSD-3-Clause
#include "core/app/lamp_fit.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/app/lamp_consensus.h"
#include "core/app/lamp_problem.h"
#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/geometry/plane.h"

namespace glint {
namespace {

constexpr double kKnownDistance =
    5;  // standard deviations of the inverse: the distance is then good to a fifth, nearly symmetric
constexpr double kFarthest95 = 1.645;     // one-sided bound of 95 %
constexpr double kExifFocalShare = 0.03;  // whole millimetres, rounded once more for the film's size
constexpr double kExifMiddle = 0.01;      // rad: where the optical axis meets a sensor
constexpr int kOutlinePoints = 180;       // of a drawn outline: of a ball of 400 px, chords leave it by 0.06 px
constexpr int kMostRounds = 5;            // of dropping; one or two are usual

class BallLampFit {
 public:
  BallLampFit(const BallPhotographs& photographs, bool refineOutlines) : p_(photographs), refine_(refineOutlines) {
    if (p_.camera) {
      view_.camera = *p_.camera;
      view_.camera->lens = Lens{};
    }
    unit_ = p_.camera ? p_.ballRadius.value_or(1) : 1;
  }

  Outcome<BallLamps> run() {
    if (p_.balls.empty()) return Failure{Reason::TooFewPoints, "no ball is given"};
    std::vector<BallParameters> balls;
    for (std::size_t k = 0; k < p_.balls.size(); ++k) {
      Outcome<BallParameters> b = ballParameters(view_, ideal(p_.balls[k]));
      if (!b) return Failure{b.failure().reason, "ball " + std::to_string(k + 1) + ": " + b.failure().detail};
      balls.push_back(*std::move(b));
    }
    reference_ = middleOf(balls);
    problem_.emplace(view_, balls, lengthOf(balls));
    gather();
    if (lamps_.empty()) return Failure{Reason::TooFewPoints, "no photograph shows a highlight on a ball"};
    fit();
    return answer();
  }

 private:
  Pixel ideal(const Pixel& measured) const { return p_.camera ? p_.camera->undistorted(measured) : measured; }
  RefinedOutline ideal(RefinedOutline outline) const;
  Eigen::Vector3d middleOf(const std::vector<BallParameters>& balls) const;
  double lengthOf(const std::vector<BallParameters>& balls) const;
  void gather();
  void fit();
  bool fitTogether();
  BallLamps answer();
  void addBallResiduals(BallLamps& result) const;
  double outlineShareOf(const LampProblem::Eliminated& equations) const;
  void describe(const LampInFit& lamp, std::size_t equation, LampAnswer& answer) const;
  void addDistance(const LampInFit& lamp, const Eigen::MatrixXd& covariance, LampAnswer& answer) const;
  void addSightings(const LampInFit& lamp, LampAnswer& answer) const;
  void addLeftOut(const LampInFit& lamp, std::size_t equation, LampAnswer& answer) const;
  std::string whyNoDistance(const LampInFit& lamp, double inverse, double sigma) const;
  Eigen::Vector3d middleOf(const LampInFit& lamp) const;

  const BallPhotographs& p_;
  bool refine_;
  BallProjection view_;
  double unit_ = 1;
  Eigen::Vector3d reference_ = Eigen::Vector3d::Zero();
  std::optional<LampProblem> problem_;
  std::vector<LampInFit> lamps_;
  std::vector<LampProblem::Eliminated> equations_;  ///< of the lamps that are fitted, in their order
  Eigen::MatrixXd ofOutlines_;                      ///< covariance of z, noise as promised
  double variance_ = 1;
  int degreesOfFreedom_ = 0;
};

RefinedOutline BallLampFit::ideal(RefinedOutline outline) const {
  if (!p_.camera || !p_.camera->hasDistortion()) return outline;
  constexpr int kPoints = 72;  // of a given circle, which the lens bends
  if (outline.edge.empty())
    for (int k = 0; k < kPoints; ++k) {
      const double t = 2 * std::numbers::pi * k / kPoints;
      outline.edge.push_back({outline.outline.centre + outline.outline.radius * Pixel(std::cos(t), std::sin(t)), 1.0});
    }
  for (EdgePoint& e : outline.edge) e.place = ideal(e.place);
  outline.outline.centre = ideal(outline.outline.centre);
  return outline;
}

Eigen::Vector3d BallLampFit::middleOf(const std::vector<BallParameters>& balls) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const BallParameters& b : balls) sum += ballOf(view_, b.value).centre;
  return sum / static_cast<double>(balls.size());
}

Eigen::Vector3d BallLampFit::middleOf(const LampInFit& lamp) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const WeightedPeak& p : lamp.unknowns.peaks) sum += problem_->ball(p.ball).centre;
  return sum / static_cast<double>(lamp.unknowns.peaks.size());
}

double BallLampFit::lengthOf(const std::vector<BallParameters>& balls) const {
  double length = 0;
  for (const BallParameters& a : balls) {
    length = std::max(length, ballOf(view_, a.value).radius);
    for (const BallParameters& b : balls)
      length = std::max(length, (ballOf(view_, a.value).centre - ballOf(view_, b.value).centre).norm());
  }
  return length;
}

void BallLampFit::gather() {
  for (const LampObservation& seen : p_.seen) {
    require(seen.object < p_.balls.size(), "fitBallLamps: a highlight on a ball that is not given");
    auto at = std::find_if(lamps_.begin(), lamps_.end(), [&](const LampInFit& l) { return l.frame == seen.frame; });
    if (at == lamps_.end()) {
      at = lamps_.insert(lamps_.end(), LampInFit{});
      at->frame = seen.frame;
      at->unknowns.lamp.reference = reference_;
    }
    for (const DroppedHighlight& d : seen.dropped) {
      at->dropped.push_back({seen.frame, seen.object, d.place, d.reason});
      if (!d.onlySmaller) continue;
      if (const Outcome<MirrorRay> ray = mirrorRay(view_, problem_->ball(seen.object), ideal(d.place)))
        at->dropped.back().direction = ray->direction;
    }
    const Pixel peak = ideal(seen.peak);
    const Outcome<MirrorRay> ray = peak.allFinite() && seen.covariance.allFinite()
                                       ? mirrorRay(view_, problem_->ball(seen.object), peak)
                                       : Outcome<MirrorRay>(Failure{Reason::NotFinite, "the place of the highlight"});
    if (!ray) {
      at->dropped.push_back({seen.frame, seen.object, seen.peak, ray.failure().detail});
      if (at->unknowns.peaks.empty() && !at->failure) at->failure = ray.failure();
      continue;
    }
    at->failure.reset();
    at->unknowns.peaks.push_back(weightedPeak(seen, peak));
    at->sources.push_back(&seen);
  }
}

/// All lamps that have no failure, and the outlines. False leaves everything as it was.
bool BallLampFit::fitTogether() {
  std::vector<LampUnknowns> together;
  bool redundant = false;
  for (const LampInFit& lamp : lamps_) {
    if (lamp.failure) continue;
    together.push_back(lamp.unknowns);
    redundant = redundant || 2 * static_cast<Eigen::Index>(lamp.unknowns.peaks.size()) > lamp.unknowns.count();
  }
  LampProblem moved = *problem_;
  if (!moved.solve(together, refine_ && redundant)) return false;
  problem_ = std::move(moved);
  std::size_t next = 0;
  for (LampInFit& lamp : lamps_)
    if (!lamp.failure) lamp.unknowns = together[next++];
  return true;
}

void BallLampFit::fit() {
  for (LampInFit& lamp : lamps_)
    if (!lamp.failure) fitAlone(*problem_, lamp);
  const std::function<Pixel(const Pixel&)> freed = [this](const Pixel& p) { return ideal(p); };
  dropContradictions(*problem_, lamps_, freed);
  for (int round = 0; round < kMostRounds; ++round) {
    if (!fitTogether()) refine_ = false;  // outlines as they are: every lamp has its own fit already
    if (!dropContradictions(*problem_, lamps_, freed)) break;
  }
  double chiSquared = problem_->outlines().squaredNorm();
  for (LampInFit& lamp : lamps_) {
    if (lamp.failure) continue;
    std::optional<LampProblem::Eliminated> e = problem_->eliminated(lamp.unknowns);
    if (!e) {
      lamp.failure = Failure{Reason::NotConverged, "the lamp grazes a ball"};
      continue;
    }
    chiSquared += misfitOf(*problem_, lamp.unknowns).chiSquared;
    degreesOfFreedom_ += static_cast<int>(e->rest.size());
    equations_.push_back(*std::move(e));
  }
  if (degreesOfFreedom_ > 0) variance_ = std::max(1.0, chiSquared / degreesOfFreedom_);
}

BallLamps BallLampFit::answer() {
  BallLamps result;
  result.noiseFactor = std::sqrt(variance_);
  result.degreesOfFreedom = degreesOfFreedom_;
  ofOutlines_ = Eigen::MatrixXd::Identity(problem_->outlines().size(), problem_->outlines().size());
  if (refine_) ofOutlines_ = problem_->outlineSystem(equations_).covariance;
  for (std::size_t k = 0; k < p_.balls.size(); ++k) {
    FittedBall b;
    b.parameters = problem_->parametersOf(k);
    b.shiftPx = problem_->shiftOf(k);
    const auto at = 3 * static_cast<Eigen::Index>(k);
    const Eigen::Matrix3d& root = problem_->rootOf(k);
    b.sigmaPx = (variance_ * root * ofOutlines_.block<3, 3>(at, at) * root.transpose()).diagonal().cwiseSqrt();
    if (p_.camera) b.centre = unit_ * problem_->ball(k).centre;
    b.outline = outlinePixels(view_, b.parameters, kOutlinePoints);
    if (p_.camera)
      for (Pixel& p : b.outline) p = p_.camera->distorted(p);
    b.edgeResidualPx = p_.balls[k].residualPx;
    b.edgeDegreesOfFreedom = p_.balls[k].degreesOfFreedom;
    result.balls.push_back(b);
  }
  std::size_t equation = 0;
  for (const LampInFit& lamp : lamps_) {
    LampAnswer a;
    a.frames = {lamp.frame};
    a.dropped = lamp.dropped;
    a.failure = lamp.failure;
    if (!lamp.failure) describe(lamp, equation++, a);
    result.lamps.push_back(std::move(a));
  }
  addBallResiduals(result);
  return result;
}

/// Residuals by ball. Leverage: the redundant equations leave out the lamp's own unknowns; the outlines' is E C E^T.
void BallLampFit::addBallResiduals(BallLamps& result) const {
  std::size_t equation = 0;
  for (std::size_t i = 0; i < lamps_.size(); ++i) {
    if (lamps_[i].failure) continue;
    const LampProblem::Eliminated& e = equations_[equation++];
    Eigen::MatrixXd left = e.redundant * e.redundant.transpose();
    if (refine_) {
      const Eigen::MatrixXd byOutlines = e.redundant * e.outlinesRest;
      left -= byOutlines * ofOutlines_ * byOutlines.transpose();
    }
    const std::vector<WeightedPeak>& peaks = lamps_[i].unknowns.peaks;
    for (std::size_t p = 0; p < peaks.size(); ++p) {
      FittedBall& ball = result.balls[peaks[p].ball];
      ++ball.highlights;
      ball.highlightDegreesOfFreedom += left.diagonal().segment<2>(2 * static_cast<Eigen::Index>(p)).sum();
      ball.highlightResidualPx += result.lamps[i].sightings[p].residualPx.squaredNorm();
    }
  }
  for (FittedBall& ball : result.balls)
    if (ball.highlights > 0) ball.highlightResidualPx = std::sqrt(ball.highlightResidualPx / ball.highlights);
}

/// trace(C E^T E) over the number of unknowns: as I = C (I + sum E^T E), all photographs and the edges, trace(C), add up to 1.
double BallLampFit::outlineShareOf(const LampProblem::Eliminated& e) const {
  if (!refine_) return 0;
  return (ofOutlines_ * e.outlinesRest.transpose() * e.outlinesRest).trace() / static_cast<double>(ofOutlines_.rows());
}

void BallLampFit::describe(const LampInFit& lamp, std::size_t equation, LampAnswer& a) const {
  const LampProblem::Eliminated& e = equations_[equation];
  const Eigen::Index own = lamp.unknowns.count();
  const Eigen::MatrixXd inverse = e.own.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(own, own));
  const Eigen::MatrixXd by = inverse * e.outlinesOwn;
  const Eigen::MatrixXd covariance = variance_ * (inverse * inverse.transpose() + by * ofOutlines_ * by.transpose());
  a.highlights = static_cast<int>(lamp.unknowns.peaks.size());
  const Misfit misfit = misfitOf(*problem_, lamp.unknowns);
  a.residualPx = misfit.rmsPx;
  a.degreesOfFreedom = misfit.degreesOfFreedom;
  a.outlineShare = outlineShareOf(e);
  a.directionSigma = std::sqrt(covariance.topLeftCorner<2, 2>().trace());
  if (p_.focalAlone) {
    const Eigen::Vector3d at = middleOf(lamp);
    a.directionSigma = std::hypot(a.directionSigma, kExifFocalShare * at.head<2>().norm() / at.z(), kExifMiddle);
  }
  addDistance(lamp, covariance, a);
  addSightings(lamp, a);
  addLeftOut(lamp, equation, a);
}

void BallLampFit::addDistance(const LampInFit& lamp, const Eigen::MatrixXd& covariance, LampAnswer& a) const {
  const AimedLamp& aimed = lamp.unknowns.lamp;
  const Eigen::Vector3d middle = middleOf(lamp);
  if (p_.camera) a.from = unit_ * middle;
  const double inverse = aimed.inverseDistance * problem_->scale();
  const double sigma = lamp.unknowns.distanceFree ? std::sqrt(covariance(2, 2)) : 0;
  if (!lamp.unknowns.distanceFree || !p_.camera || p_.focalAlone || !(inverse > kKnownDistance * sigma)) {
    a.withoutPosition = whyNoDistance(lamp, inverse, sigma);
    const std::optional<LampUnknowns> distant =
        inverse < 0 ? distantFrom(*problem_, lamp.unknowns) : std::optional(lamp.unknowns);
    a.direction = (distant ? distant->lamp : aimed).from(middle).normalized();
    return;
  }
  const double w = aimed.inverseDistance;
  const Eigen::Vector3d position = aimed.reference + aimed.direction / w;
  Eigen::Matrix3d slopes;
  slopes << tangentBasis(aimed.direction) / w, -aimed.direction / (w * w * problem_->scale());
  a.position = unit_ * position;
  a.covariance = unit_ * unit_ * (slopes * covariance * slopes.transpose());
  a.direction = (position - middle).normalized();
}

std::string BallLampFit::whyNoDistance(const LampInFit& lamp, double inverse, double sigma) const {
  if (p_.focalAlone)
    return "the focal length alone is known, by EXIF: middle of the image and lens are assumed, so no distance is given";
  if (!p_.camera) return "without a focal length the directions assume a distant camera, and no distance is known";
  std::string direction = "; the direction is that of a distant lamp";
  if (lamp.unknowns.peaks.size() < 2) {
    const MirrorBall ball = problem_->ball(lamp.unknowns.peaks.front().ball);
    constexpr double kRadii = 20;  // a lamp at arm's length before a ball in a hand
    if (const Outcome<MirrorRay> ray = mirrorRay(view_, ball, lamp.unknowns.peaks.front().peak))
      direction += formatted(" (one at %g ball radii is seen %.2g degrees off from the ball's middle)", kRadii,
                             degrees((ray->origin - ball.centre).cross(ray->direction).norm() / ball.radius / kRadii));
    return "one ball in one view leaves the distance open" + direction;
  }
  if (!lamp.unknowns.distanceFree) return "the balls lie in line with the lamp, which leaves the distance open" + direction;
  const double nearest = unit_ * problem_->scale() / (std::max(0.0, inverse) + kFarthest95 * sigma);
  return formatted("parallel rays: the lamp is farther away than the balls can tell, at %.3g %s or more (95 %%)", nearest,
                   p_.ballRadius ? "m" : "ball radii");
}

/// How the directions from the two balls that are farthest apart differ.
std::optional<Parallax> parallaxOf(const LampProblem& problem, const std::vector<LampSighting>& seen,
                                   const Eigen::Vector3d& direction) {
  const LampSighting *first = nullptr, *second = nullptr;
  double farthest = 0;
  for (const LampSighting& a : seen)
    for (const LampSighting& b : seen) {
      const double apart = (problem.ball(a.ball).centre - problem.ball(b.ball).centre).norm();
      if (a.ball < b.ball && apart > farthest) farthest = apart, first = &a, second = &b;
    }
  if (!first) return std::nullopt;
  const Eigen::Vector3d line = problem.ball(second->ball).centre - problem.ball(first->ball).centre;
  const Eigen::Vector3d across = direction.cross(line);
  if (!(across.norm() > 0)) return std::nullopt;  // the lamp is in line with the balls
  const Eigen::Vector3d side = across.normalized(), along = side.cross(direction).normalized();
  const Eigen::Vector3d change = second->direction - first->direction;
  return Parallax{first->ball, second->ball, degrees(change.dot(along)), degrees(change.dot(side))};
}

/// How large a lamp appears whose border lies in these directions, seen around their middle.
std::optional<LampExtent> extentOf(const std::vector<Eigen::Vector3d>& border) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& d : border) middle += d;
  if (border.size() < 3 || !(middle.norm() > 0)) return std::nullopt;
  const Eigen::Matrix<double, 3, 2> basis = tangentBasis(middle.normalized());
  std::vector<cv::Point2f> plane;
  for (const Eigen::Vector3d& d : border) {
    const Eigen::Vector2d aside = basis.transpose() * d;
    const Eigen::Vector2d p = degrees(std::atan2(aside.norm(), d.dot(middle.normalized()))) * aside.normalized();
    plane.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  const cv::Size2f sides = cv::minAreaRect(plane).size;
  if (!(sides.area() > 0)) return std::nullopt;
  return LampExtent{std::max(sides.width, sides.height), std::min(sides.width, sides.height),
                    cv::contourArea(plane) / sides.area()};
}

void BallLampFit::addSightings(const LampInFit& lamp, LampAnswer& a) const {
  const std::optional<Eigen::VectorXd> r = problem_->residuals(lamp.unknowns);
  for (std::size_t i = 0; i < lamp.unknowns.peaks.size(); ++i) {
    const WeightedPeak& p = lamp.unknowns.peaks[i];
    LampSighting s;
    s.ball = p.ball;
    s.peak = lamp.sources[i]->peak;
    s.clipped = lamp.sources[i]->clipped;
    if (const Outcome<MirrorRay> ray = mirrorRay(view_, problem_->ball(p.ball), p.peak)) s.direction = ray->direction;
    std::vector<Eigen::Vector3d> border;
    for (const Pixel& around : lamp.sources[i]->contour)
      if (const Outcome<MirrorRay> ray = mirrorRay(view_, problem_->ball(p.ball), ideal(around)))
        border.push_back(ray->direction);
    s.extent = extentOf(border);
    if (r) s.residualPx = p.root.inverse() * r->segment<2>(2 * static_cast<Eigen::Index>(i));
    a.sightings.push_back(s);
  }
  a.parallax = parallaxOf(*problem_, a.sightings, a.direction);
}

void BallLampFit::addLeftOut(const LampInFit& lamp, std::size_t equation, LampAnswer& a) const {
  if (lamp.unknowns.peaks.size() < 2) return;
  LampProblem without = *problem_;
  if (refine_) without.setOutlines(problem_->outlines() + problem_->outlineSystem(equations_, equation).step);
  for (std::size_t i = 0; i < lamp.unknowns.peaks.size(); ++i) {
    LampInFit others = lamp;
    others.unknowns.peaks.erase(others.unknowns.peaks.begin() + static_cast<std::ptrdiff_t>(i));
    others.sources.erase(others.sources.begin() + static_cast<std::ptrdiff_t>(i));
    fitAlone(without, others);
    if (others.failure) continue;
    const WeightedPeak& p = lamp.unknowns.peaks[i];
    const std::optional<Pixel> predicted = mirrorPixel(view_, without.ball(p.ball), others.unknowns.lamp);
    if (predicted) a.sightings[i].leftOutPx = *predicted - p.peak;
  }
}

}  // namespace

Outcome<BallLamps> fitBallLamps(const BallPhotographs& photographs, bool refineOutlines) {
  return BallLampFit(photographs, refineOutlines).run();
}

}  // namespace glint
