// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/view_effects.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>

#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr int kHighest = 9;             // order of the harmonics: finer errors of a contour average out over it
constexpr int kPointsPerShape = 3;      // at least: the rest of the points tells the noise
constexpr double kSignificance = 0.05;  // at which an error of whole views is believed
constexpr double kBorrowed = 4;         // degrees of freedom that offset, shift and stretch borrow from each other: few views tell little of one
// Eigenvalues of the parameters' information, relative to the largest, in units in which a fit without prior has equal ones: what lies
// below was held by a prior.
constexpr double kHeld = 0.2;
constexpr double kOpen = 1e-9;  // a direction that moves no contour, to round-off
constexpr double kWildSigmas = 4;

int groupOf(int order) { return order <= 2 ? order : order <= 5 ? 3 : 4; }

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
  constexpr int kGroups = ContourShapes::kGroups;
  require(!views.empty() && robustPx > 0, "ViewEffects: views");
  const Eigen::Index parameters = views.front().byParameter.cols();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(parameters, parameters);
  double points = 0;
  std::vector<double> sizes;
  for (const ViewResiduals& v : views) {
    require(v.byParameter.cols() == parameters && v.residual.size() == v.byParameter.rows() && v.residual.size() == v.shapes.columns.rows(),
            "ViewEffects: sizes");
    information += v.byParameter.transpose() * v.byParameter;
    points += double(v.residual.size());
    for (const double r : v.residual) sizes.push_back(std::abs(r));
  }
  require(!sizes.empty(), "ViewEffects: no residuals");
  // Wild points must not pass for noise, nor for an error of their view.
  std::nth_element(sizes.begin(), sizes.begin() + long(sizes.size() / 2), sizes.end());
  const double wild = std::max(kWildSigmas * 1.4826 * sizes[sizes.size() / 2], 1e-12);  // no division by zero

  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  const double largest = parameters > 0 ? std::max(0.0, eigen.eigenvalues()(parameters - 1)) : 0;
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(parameters), root = inverse;
  for (Eigen::Index i = 0; i < parameters; ++i) {
    const double e = eigen.eigenvalues()(i);
    if (!(e > kOpen * largest)) continue;
    inverse(i) = 1 / std::max(e, kHeld * largest);
    root(i) = 1 / std::sqrt(std::max(e, kHeld * largest));
  }
  byNoise_ = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  const Eigen::MatrixXd half = eigen.eigenvectors() * root.asDiagonal();

  // Squares seen in every group, and what each source would make of them after the parameters took their share: with P the projector off
  // the parameters, S_g and its expectation sum_h tau_h^2 tr(S_g' P N S_h S_h' P S_g) + noise^2 tr(S_g' P S_g), N the points of a view.
  Eigen::Matrix<double, kGroups + 1, 1> seen = Eigen::Matrix<double, kGroups + 1, 1>::Zero(), count = seen, weighted = seen;
  std::vector<Eigen::MatrixXd> taken(kGroups + 1, Eigen::MatrixXd::Zero(parameters, parameters)), takenWeighted = taken;
  std::vector<Eigen::MatrixXd> own(kGroups, Eigen::MatrixXd::Zero(parameters, parameters));
  Eigen::MatrixXd together[kGroups];
  for (Eigen::MatrixXd& t : together) t = Eigen::MatrixXd::Zero(parameters, ContourShapes::kCount);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(ContourShapes::kCount);
  double sumSquares = 0, allSquares = 0, psi2 = 0, inside = 0;
  for (const ViewResiduals& v : views) {
    const Eigen::VectorXd r = v.residual.cwiseMax(-wild).cwiseMin(wild), z = v.shapes.columns.transpose() * r;
    const Eigen::MatrixXd j = v.shapes.columns.transpose() * v.byParameter, u = j * half;
    const double n = double(r.size());
    allSquares += r.squaredNorm();
    for (const double e : v.residual) {
      psi2 += std::pow(std::min(std::abs(e), robustPx), 2);
      inside += std::abs(e) <= robustPx;
    }
    for (Eigen::Index k = 0; k < z.size(); ++k) {
      const int g = v.shapes.group[std::size_t(k)];
      seen(g) += z(k) * z(k);
      count(g) += 1;
      weighted(g) += n;
      taken[std::size_t(g)] += u.row(k).transpose() * u.row(k);
      takenWeighted[std::size_t(g)] += n * u.row(k).transpose() * u.row(k);
      own[std::size_t(g)] += n * j.row(k).transpose() * j.row(k);
      if (k < ContourShapes::kCount) {
        together[g].col(k) += std::sqrt(n) * j.row(k).transpose();
        if (g >= 2) sums(k) += z(k), sumSquares += z(k) * z(k);
      }
    }
  }
  const Eigen::MatrixXd whole = half.transpose() * information * half;
  seen(kGroups) = std::max(0.0, allSquares - seen.head<kGroups>().sum());
  count(kGroups) = points - count.head<kGroups>().sum();
  taken[kGroups] = whole;
  for (int g = 0; g < kGroups; ++g) taken[kGroups] -= taken[std::size_t(g)];
  const auto left = [&](int g) { return count(g) - taken[std::size_t(g)].trace(); };
  const auto expected = [&](int g, int h) {
    const double crossed = (taken[std::size_t(g)] * takenWeighted[std::size_t(h)]).trace();
    return g != h ? crossed : weighted(g) - 2 * takenWeighted[std::size_t(g)].trace() + crossed;
  };
  noiseFreedom_ = std::max(1.0, left(kGroups));
  double noise2 = seen(kGroups) / noiseFreedom_;
  std::vector<int> active;
  for (int g = 0; g < kGroups; ++g) {
    freedom_[g] = weighted(g) > 0 ? expected(g, g) / (weighted(g) / count(g)) : 0;
    const double free = left(g);
    if (!(free > 0.5)) continue;
    const double ratio = seen(g) / free / std::max(noise2, 1e-300);  // no division by zero
    const boost::math::fisher_f distribution(free, noiseFreedom_);
    if (ratio > boost::math::quantile(boost::math::complement(distribution, kSignificance))) active.push_back(g);
  }
  while (!active.empty()) {
    const Eigen::Index m = Eigen::Index(active.size());
    Eigen::MatrixXd system(m + 1, m + 1);
    Eigen::VectorXd squares(m + 1);
    for (Eigen::Index a = 0; a <= m; ++a) {
      const int g = a < m ? active[std::size_t(a)] : kGroups;
      for (Eigen::Index b = 0; b < m; ++b) system(a, b) = expected(g, active[std::size_t(b)]);
      system(a, m) = left(g);
      squares(a) = seen(g);
    }
    const Eigen::VectorXd solution = system.colPivHouseholderQr().solve(squares);
    Eigen::Index smallest = 0;
    const double least = solution.head(m).minCoeff(&smallest);
    if (solution.allFinite() && least > 0 && solution(m) >= 0) {
      for (Eigen::Index a = 0; a < m; ++a) variance_[active[std::size_t(a)]] = solution(a);
      noise2 = solution(m);
      break;
    }
    if (solution.allFinite() && least > 0) {  // the noise came out below nothing: it is what the finest residuals show
      for (Eigen::Index a = 0; a < m; ++a)
        variance_[active[std::size_t(a)]] = std::max(0.0, (squares(a) - noise2 * system(a, m)) / system(a, a));
      break;
    }
    active.erase(active.begin() + smallest);
  }
  noise_ = std::sqrt(noise2);
  double low = 0, lowFree = 0;
  for (int g = 0; g < 3; ++g) low += freedom_[g] * variance_[g], lowFree += freedom_[g];
  for (int g = 0; g < 3 && lowFree > 0; ++g) {
    const double free = std::max(0.0, freedom_[g]);
    variance_[g] = (free * variance_[g] + kBorrowed * low / lowFree) / (free + kBorrowed);
    freedom_[g] = std::min(free + 0.5 * kBorrowed, lowFree);
  }
  for (double& f : freedom_) f = std::max(1.0, f);

  // Errors of one shape in all views do not average out.
  const double number = double(views.size());
  if (views.size() > 1 && sumSquares > 0)
    shared_ = std::clamp((sums.squaredNorm() / sumSquares - 1) / (number - 1), 0.0, 1.0);
  for (int g = 0; g < kGroups; ++g) {
    const Eigen::MatrixXd middle = (1 - shared_) * own[std::size_t(g)] + shared_ * together[g] * together[g].transpose();
    byGroup_[g] = byNoise_ * middle * byNoise_;
  }
  // The Huber loss leaves more noise in the parameters than plain squares do where noise exceeds its scale.
  const double slope = std::max(inside, 1.0) / points;
  if (noise2 > 0) byNoise_ *= std::max(1.0, psi2 / points / (slope * slope) / std::max(allSquares / points, 1e-300));  // no division by zero
}

double ViewEffects::viewPx() const {
  constexpr double kColumns[ContourShapes::kGroups] = {1, 2, 2, 6, 8};
  double sum = 0;
  for (int g = 0; g < ContourShapes::kGroups; ++g) sum += kColumns[g] * variance_[g];
  return std::sqrt(sum);
}

ViewEffects::Variance ViewEffects::at(const Eigen::MatrixXd& byParameter, const ContourShapes& shapes) const {
  require(byParameter.cols() == byNoise_.cols() && byParameter.rows() == shapes.columns.rows(), "ViewEffects::at: sizes");
  Variance result;
  const Eigen::Index n = byParameter.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::RowVectorXd j = byParameter.row(i);
    const double fromNoise = noise_ * noise_ * (j * byNoise_ * j.transpose()).value();
    double sum = fromNoise, spread = fromNoise * fromNoise / noiseFreedom_;
    double own[ContourShapes::kGroups] = {};
    for (Eigen::Index k = 0; k < shapes.columns.cols(); ++k)
      own[shapes.group[std::size_t(k)]] += double(n) * shapes.columns(i, k) * shapes.columns(i, k);
    for (int g = 0; g < ContourShapes::kGroups; ++g) {
      const double part = variance_[g] * ((j * byGroup_[g] * j.transpose()).value() + own[g]);
      sum += part;
      spread += part * part / freedom_[g];
    }
    result.px2.push_back(sum);
    result.freedom.push_back(spread > 0 ? std::max(1.0, sum * sum / spread) : noiseFreedom_);
  }
  return result;
}

}  // namespace glint
