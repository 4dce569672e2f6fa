// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/view_effects.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "core/base/numeric.h"
#include "core/base/outcome.h"
#include "core/base/uncertainty.h"
#include "core/model/view_correlation.h"

namespace glint {
namespace {

constexpr int kHighest = 9;             // order of the harmonics: finer errors of a contour average out over it
constexpr int kPointsPerShape = 3;      // at least: the rest of the points tells the noise
constexpr double kSignificance = 0.05;  // at which an error of whole views is believed
// Degrees of freedom that offset, shift and stretch borrow from each other: few views tell little of one.
constexpr double kBorrowed = 4;
// Eigenvalues of the parameters' information, relative to the largest, in units in which a fit without prior has equal ones: a
// prior held what lies below.
constexpr double kHeld = 0.2;
constexpr double kOpenDirection = 1e-9;  // a direction that moves no contour, to round-off
constexpr double kNormal95 = 1.959964;
constexpr double kWidthTolerance = 0.01;  // of a half width: far finer than a few views tell it
constexpr double kWildSigmas = 4;
constexpr int kGroups = ContourShapes::kGroups;
constexpr int kLow = 3;                // groups: offset, shift, stretch
constexpr double kLeastWeight = 1e-3;  // of the evidence: a length with less changes no band

/// One part of a mixture of Student's distributions about zero.
struct Spread {
  double weight, sigma, freedom;
};

/// What the size of a value of the mixture exceeds in one of twenty times.
double halfWidth95(const std::vector<Spread>& mixture) {
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const Spread& s : mixture) {
    const double own = s.sigma * studentFactor(0.95, s.freedom);
    low = std::min(low, own);
    high = std::max(high, own);
  }
  constexpr int kMostHalvings = 60;  // a part without width would go on for ever
  for (int i = 0; i < kMostHalvings && high - low > kWidthTolerance * high; ++i) {
    const double middle = low > 0 ? std::sqrt(low * high) : 0.5 * high;
    double outside = 0;
    for (const Spread& s : mixture)
      if (s.sigma > 0)
        outside += 2 * s.weight * boost::math::cdf(boost::math::complement(boost::math::students_t(s.freedom), middle / s.sigma));
    (outside > 0.05 ? low : high) = middle;
  }
  return high;
}

int groupOf(int order) { return order <= 2 ? order : order <= 5 ? 3 : 4; }

/// What the training views tell of the parameters, and the size from which a residual is wild.
struct Information {
  Eigen::MatrixXd matrix;   ///< sum of J' J
  Eigen::MatrixXd byNoise;  ///< covariance of the parameters for unit noise, half half'
  Eigen::MatrixXd half;
  double points = 0;
  double wildPx = 0;  ///< wild points must not pass for noise, nor for an error of their view

  explicit Information(const std::vector<ViewResiduals>& views) {
    const Eigen::Index parameters = views.front().byParameter.cols();
    matrix = Eigen::MatrixXd::Zero(parameters, parameters);
    std::vector<double> sizes;
    for (const ViewResiduals& v : views) {
      require(v.byParameter.cols() == parameters && v.residual.size() == v.byParameter.rows() &&
                  v.residual.size() == v.shapes.columns.rows(),
              "ViewEffects: sizes");
      matrix += v.byParameter.transpose() * v.byParameter;
      points += double(v.residual.size());
      for (const double r : v.residual) sizes.push_back(std::abs(r));
    }
    require(!sizes.empty(), "ViewEffects: no residuals");
    wildPx = std::max(kWildSigmas * 1.4826 * upperMedian(sizes), 1e-12);  // no division by zero

    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(matrix);
    const double largest = parameters > 0 ? std::max(0.0, eigen.eigenvalues()(parameters - 1)) : 0;
    Eigen::VectorXd inverse = Eigen::VectorXd::Zero(parameters), root = inverse;
    for (Eigen::Index i = 0; i < parameters; ++i) {
      const double e = eigen.eigenvalues()(i);
      if (!(e > kOpenDirection * largest)) continue;
      inverse(i) = 1 / std::max(e, kHeld * largest);
      root(i) = 1 / std::sqrt(std::max(e, kHeld * largest));
    }
    byNoise = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
    half = eigen.eigenvectors() * root.asDiagonal();
  }
};

/// tau^2 of the groups and noise^2, px^2.
struct Variances {
  double group[kGroups] = {};
  double noise = 0;
};

/// Squares seen in every group, and the part of each source after the parameters took their share: with P the
/// projector off the parameters, S_g and its expectation sum_h tau_h^2 tr(S_g' P N S_h S_h' P S_g) + noise^2 tr(S_g' P S_g), N
/// the points of a view. The group after the last one holds what no shape explains.
class GroupSquares {
 public:
  GroupSquares(const std::vector<ViewResiduals>& views, const Information& information) {
    taken_.assign(kGroups + 1, Eigen::MatrixXd::Zero(information.matrix.rows(), information.matrix.cols()));
    takenWeighted_ = taken_;
    const double wild = information.wildPx;
    for (const ViewResiduals& v : views) {
      const Eigen::VectorXd r = v.residual.cwiseMax(-wild).cwiseMin(wild), z = v.shapes.columns.transpose() * r;
      const Eigen::MatrixXd j = v.shapes.columns.transpose() * v.byParameter, u = j * information.half;
      const double n = double(r.size());
      all_ += r.squaredNorm();
      for (Eigen::Index k = 0; k < z.size(); ++k) {
        const int g = v.shapes.group[std::size_t(k)];
        seen_(g) += z(k) * z(k);
        count_(g) += 1;
        weighted_(g) += n;
        taken_[std::size_t(g)] += u.row(k).transpose() * u.row(k);
        takenWeighted_[std::size_t(g)] += n * u.row(k).transpose() * u.row(k);
      }
      coefficients_.push_back({z, j, v.shapes.group, n, v.where});
    }
    const Eigen::MatrixXd whole = information.half.transpose() * information.matrix * information.half;
    seen_(kGroups) = std::max(0.0, all_ - seen_.head<kGroups>().sum());
    count_(kGroups) = information.points - count_.head<kGroups>().sum();
    taken_[kGroups] = whole;
    for (int g = 0; g < kGroups; ++g) taken_[kGroups] -= taken_[std::size_t(g)];
  }

  const std::vector<ViewCoefficients>& coefficients() const { return coefficients_; }
  double all() const { return all_; }
  double noiseFreedom() const { return std::max(1.0, left(kGroups)); }
  double freedom(int g) const { return weighted_(g) > 0 ? expected(g, g) / (weighted_(g) / count_(g)) : 0; }

  /// The variances at which the expected squares are those seen. A group that would need a negative one counts as zero.
  Variances variances() const {
    Variances v;
    v.noise = seen_(kGroups) / noiseFreedom();
    std::vector<int> active = beyondNoise(v.noise);
    while (!active.empty()) {
      const Eigen::Index m = Eigen::Index(active.size());
      Eigen::MatrixXd system(m + 1, m + 1);
      Eigen::VectorXd squares(m + 1);
      for (Eigen::Index a = 0; a <= m; ++a) {
        const int g = a < m ? active[std::size_t(a)] : kGroups;
        for (Eigen::Index b = 0; b < m; ++b) system(a, b) = expected(g, active[std::size_t(b)]);
        system(a, m) = left(g);
        squares(a) = seen_(g);
      }
      const Eigen::VectorXd solution = system.colPivHouseholderQr().solve(squares);
      Eigen::Index smallest = 0;
      const double least = solution.head(m).minCoeff(&smallest);
      if (solution.allFinite() && least > 0 && solution(m) >= 0) {
        for (Eigen::Index a = 0; a < m; ++a) v.group[active[std::size_t(a)]] = solution(a);
        v.noise = solution(m);
        break;
      }
      if (solution.allFinite() && least > 0) {  // the noise came out negative: the finest residuals tell it
        for (Eigen::Index a = 0; a < m; ++a)
          v.group[active[std::size_t(a)]] = std::max(0.0, (squares(a) - v.noise * system(a, m)) / system(a, a));
        break;
      }
      active.erase(active.begin() + smallest);
    }
    return v;
  }

 private:
  double left(int g) const { return count_(g) - taken_[std::size_t(g)].trace(); }
  double expected(int g, int h) const {
    const double crossed = (taken_[std::size_t(g)] * takenWeighted_[std::size_t(h)]).trace();
    return g != h ? crossed : weighted_(g) - 2 * takenWeighted_[std::size_t(g)].trace() + crossed;
  }

  /// The groups whose squares noise alone does not explain.
  std::vector<int> beyondNoise(double noise2) const {
    std::vector<int> groups;
    for (int g = 0; g < kGroups; ++g) {
      const double free = left(g);
      if (!(free > 0.5)) continue;
      const double ratio = seen_(g) / free / std::max(noise2, 1e-300);  // no division by zero
      const boost::math::fisher_f distribution(free, noiseFreedom());
      if (ratio > boost::math::quantile(boost::math::complement(distribution, kSignificance))) groups.push_back(g);
    }
    return groups;
  }

  using Sums = Eigen::Matrix<double, kGroups + 1, 1>;
  Sums seen_ = Sums::Zero(), count_ = seen_, weighted_ = seen_;
  std::vector<Eigen::MatrixXd> taken_, takenWeighted_;
  std::vector<ViewCoefficients> coefficients_;
  double all_ = 0;
};

/// The Huber loss leaves more noise in the parameters than plain squares do where noise exceeds its scale: by this factor of the
/// variance.
double noiseOfLoss(const std::vector<ViewResiduals>& views, double robustPx, double points, double allSquares) {
  double psi2 = 0, inside = 0;
  for (const ViewResiduals& v : views)
    for (const double e : v.residual) {
      psi2 += std::pow(std::min(std::abs(e), robustPx), 2);
      inside += std::abs(e) <= robustPx;
    }
  const double slope = std::max(inside, 1.0) / points;
  return std::max(1.0, psi2 / points / (slope * slope) / std::max(allSquares / points, 1e-300));  // no division by zero
}

}  // namespace

ContourShapes contourShapes(const std::vector<Pixel>& normals, const std::vector<double>& arc) {
  require(normals.size() == arc.size(), "contourShapes: sizes");
  const Eigen::Index n = Eigen::Index(normals.size());
  ContourShapes shapes;
  // The phase of the harmonics starts where the normal points to the right, so that shapes of different views can be compared.
  double start = 0;
  Pixel right(-2, 0);
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (normals[i].x() > right.x()) right = normals[i], start = arc[i];
  std::vector<Eigen::VectorXd> columns;
  const auto add = [&](int order, const auto& value) {
    if ((Eigen::Index(columns.size()) + 1) * kPointsPerShape > n) return;
    Eigen::VectorXd c(n);
    for (Eigen::Index i = 0; i < n; ++i) c(i) = value(std::size_t(i));
    const double before = c.norm();
    for (int twice = 0; twice < 2; ++twice)  // Gram-Schmidt, repeated for orthogonality to round-off
      for (const Eigen::VectorXd& other : columns) c -= other.dot(c) * other;
    if (!(c.norm() > 0.1 * before)) return;  // nearly one of the earlier shapes: on a circle the harmonics are
    columns.push_back(c.normalized());
    shapes.group.push_back(groupOf(order));
  };
  const auto cosine = [&](std::size_t i, int k) { return std::cos(2 * M_PI * k * (arc[i] - start)); };
  const auto sine = [&](std::size_t i, int k) { return std::sin(2 * M_PI * k * (arc[i] - start)); };
  add(0, [](std::size_t) { return 1.0; });
  add(1, [&](std::size_t i) { return normals[i].x(); });
  add(1, [&](std::size_t i) { return normals[i].y(); });
  add(2, [&](std::size_t i) { return normals[i].x() * normals[i].x() - normals[i].y() * normals[i].y(); });
  add(2, [&](std::size_t i) { return 2 * normals[i].x() * normals[i].y(); });
  for (int k = 3; k <= kHighest; ++k) {
    add(k, [&](std::size_t i) { return cosine(i, k); });
    add(k, [&](std::size_t i) { return sine(i, k); });
  }
  shapes.columns.resize(n, Eigen::Index(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) shapes.columns.col(Eigen::Index(k)) = columns[k];
  return shapes;
}

ViewEffects::ViewEffects(const std::vector<ViewResiduals>& views, double robustPx) {
  require(!views.empty() && robustPx > 0, "ViewEffects: views");
  const Information information(views);
  byNoise_ = information.byNoise;
  const GroupSquares squares(views, information);
  const Variances variances = squares.variances();
  noiseFreedom_ = squares.noiseFreedom();
  noise_ = std::sqrt(variances.noise);
  Case independent;
  for (int g = 0; g < kGroups; ++g) {
    independent.freedom[g] = squares.freedom(g);
    independent.variance[g] = variances.group[g];
  }
  addPlaces(squares.coefficients());
  addCases(squares.coefficients(), independent, variances.noise);
  if (variances.noise > 0) byNoise_ *= noiseOfLoss(views, robustPx, information.points, squares.all());
}

/// Offset, shift and stretch of neighbours may be correlated; finer shapes hardly move the parameters.
void ViewEffects::addCases(const std::vector<ViewCoefficients>& views, const Case& independent, double noise2) {
  std::vector<int> low;
  for (int g = 0; g < kLow; ++g)
    if (independent.variance[g] > 0) low.push_back(g);
  Eigen::VectorXd start(low.size());
  for (std::size_t i = 0; i < low.size(); ++i) start(Eigen::Index(i)) = independent.variance[low[i]];
  bool placed = !low.empty();
  for (const ViewCoefficients& v : views) placed = placed && v.where.size() > 0 && v.where.size() == views.front().where.size();
  if (placed) {
    for (const CorrelatedEffects& e : correlatedEffects(views, low, start, noise2)) {
      if (!(e.weight > kLeastWeight)) continue;
      Case c = independent;
      c.length = e.length;
      c.weight = e.weight;
      for (std::size_t i = 0; i < low.size() && e.length > 0; ++i) {
        c.variance[low[i]] = e.variance(Eigen::Index(i));
        c.freedom[low[i]] = e.freedom(Eigen::Index(i));
      }
      cases_.push_back(std::move(c));
    }
  } else {
    cases_.push_back(independent);
  }
  double weights = 0;
  for (const Case& c : cases_) weights += c.weight;
  for (Case& c : cases_) {
    c.weight /= weights;
    borrow(c);
    addParameters(c);
  }
}

/// Few views tell little of one size of error: offset, shift and stretch borrow from each other.
void ViewEffects::borrow(Case& c) {
  double squares = 0, all = 0;
  for (int g = 0; g < kLow; ++g) squares += c.freedom[g] * c.variance[g], all += c.freedom[g];
  for (int g = 0; g < kLow && all > 0; ++g) {
    const double free = std::max(0.0, c.freedom[g]);
    c.variance[g] = (free * c.variance[g] + kBorrowed * squares / all) / (free + kBorrowed);
    c.freedom[g] = std::min(free + 0.5 * kBorrowed, all);
  }
  for (double& f : c.freedom) f = std::max(1.0, f);
}

void ViewEffects::addPlaces(const std::vector<ViewCoefficients>& views) {
  const Eigen::Index count = Eigen::Index(views.size());
  for (const ViewCoefficients& v : views) {
    where_.push_back(v.where);
    for (std::size_t k = groupOfShape_.size(); k < v.group.size(); ++k) groupOfShape_.push_back(v.group[k]);
  }
  movedBy_.assign(groupOfShape_.size(), Eigen::MatrixXd::Zero(byNoise_.rows(), count));
  for (Eigen::Index v = 0; v < count; ++v) {
    const ViewCoefficients& view = views[std::size_t(v)];
    for (std::size_t k = 0; k < view.group.size(); ++k)
      movedBy_[k].col(v) = std::sqrt(view.points) * byNoise_ * view.byParameter.row(Eigen::Index(k)).transpose();
  }
}

double ViewEffects::likeness(const Case& c, const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() > 0 && a.size() == b.size() ? viewCorrelation((a - b).norm(), c.length) : 0;
}

void ViewEffects::addParameters(Case& c) const {
  const Eigen::Index count = Eigen::Index(where_.size());
  Eigen::MatrixXd alike = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index v = 0; v < count && c.length > 0; ++v)
    for (Eigen::Index w = 0; w < v; ++w) alike(v, w) = alike(w, v) = likeness(c, where_[std::size_t(v)], where_[std::size_t(w)]);
  for (Eigen::MatrixXd& g : c.byGroup) g = Eigen::MatrixXd::Zero(byNoise_.rows(), byNoise_.cols());
  for (std::size_t k = 0; k < movedBy_.size(); ++k) c.byGroup[groupOfShape_[k]] += movedBy_[k] * alike * movedBy_[k].transpose();
}

double ViewEffects::mean(double (*of)(const Case&, int), int group) const {
  double sum = 0;
  for (const Case& c : cases_) sum += c.weight * of(c, group);
  return sum;
}

double ViewEffects::variance(int group) const {
  return mean([](const Case& c, int g) { return c.variance[g]; }, group);
}
double ViewEffects::freedom(int group) const {
  return mean([](const Case& c, int g) { return c.freedom[g]; }, group);
}

double ViewEffects::viewPx() const {
  constexpr double kColumns[kGroups] = {1, 2, 2, 6, 8};
  double sum = 0;
  for (int g = 0; g < kGroups; ++g) sum += kColumns[g] * variance(g);
  return std::sqrt(sum);
}

std::vector<double> ViewEffects::sigmaPx(const Eigen::MatrixXd& byParameter, const ContourShapes& shapes,
                                         const Eigen::VectorXd& where) const {
  require(byParameter.cols() == byNoise_.cols() && byParameter.rows() == shapes.columns.rows(), "ViewEffects::sigmaPx: sizes");
  const Eigen::Index n = byParameter.rows();
  std::vector<std::vector<Spread>> mixtures(static_cast<std::size_t>(n));
  for (const Case& c : cases_) {
    // The part of a neighbour's error that the parameters took is in this view's error, too.
    Eigen::VectorXd alike = Eigen::VectorXd::Zero(Eigen::Index(where_.size()));
    for (std::size_t v = 0; v < where_.size() && c.length > 0; ++v) alike(Eigen::Index(v)) = likeness(c, where, where_[v]);
    std::vector<Eigen::VectorXd> taken;
    for (const Eigen::MatrixXd& moved : movedBy_) taken.push_back(moved * alike);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::RowVectorXd j = byParameter.row(i);
      const double fromNoise = noise_ * noise_ * (j * byNoise_ * j.transpose()).value();
      double own[kGroups] = {};
      for (Eigen::Index k = 0; k < shapes.columns.cols(); ++k) {
        const double shape = std::sqrt(double(n)) * shapes.columns(i, k);
        own[shapes.group[std::size_t(k)]] += shape * shape;
        if (std::size_t(k) < taken.size()) own[shapes.group[std::size_t(k)]] -= 2 * shape * j.dot(taken[std::size_t(k)]);
      }
      double sum = fromNoise, squares = fromNoise * fromNoise / noiseFreedom_;
      for (int g = 0; g < kGroups; ++g) {
        const double part = c.variance[g] * std::max(0.0, (j * c.byGroup[g] * j.transpose()).value() + own[g]);
        sum += part;
        squares += part * part / c.freedom[g];
      }
      mixtures[std::size_t(i)].push_back(
          {c.weight, std::sqrt(sum), squares > 0 ? std::max(1.0, sum * sum / squares) : noiseFreedom_});
    }
  }
  std::vector<double> result;
  for (const std::vector<Spread>& m : mixtures) result.push_back(halfWidth95(m) / kNormal95);
  return result;
}

}  // namespace glint
