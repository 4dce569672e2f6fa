// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/view_correlation.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/numeric.h"
#include "core/base/outcome.h"

namespace glint {
namespace {

constexpr std::size_t kFewestViews = 4;  // fewer show no trend beside the parameters
constexpr std::size_t kMostViews = 40;   // more are thinned out: the cost grows with the cube
constexpr double kLongest = 4;           // times the extent of the views: longer ones look like one error of all
constexpr int kIterations = 40;
constexpr double kSettled = 1e-3;        // relative change of the variances: far finer than a few views tell them
constexpr double kNothing = 1e-6;        // of the variance of the noise: too small to move a contour visibly
constexpr double kOpenParameter = 1e-9;  // a parameter that moves no shape, to round-off
constexpr double kUntold = 1e-9;         // share of an effect that the parameters do not take, to round-off

/// Median distance of a view to its nearest neighbour.
double spacingOf(const std::vector<const ViewCoefficients*>& views) {
  std::vector<double> nearest;
  for (const ViewCoefficients* v : views) {
    double best = std::numeric_limits<double>::infinity();
    for (const ViewCoefficients* w : views)
      if (w != v) best = std::min(best, (w->where - v->where).norm());
    nearest.push_back(best);
  }
  return upperMedian(nearest);
}

/// The shapes of the groups of all views, one below the other.
class Stacked {
 public:
  Stacked(const std::vector<const ViewCoefficients*>& views, const std::vector<int>& groups, double noiseVariance)
      : views_(views) {
    for (std::size_t v = 0; v < views.size(); ++v)
      for (std::size_t k = 0; k < views[v]->group.size(); ++k) {
        const auto at = std::find(groups.begin(), groups.end(), views[v]->group[k]);
        if (at != groups.end()) rows_.push_back({v, k, std::size_t(at - groups.begin())});
      }
    const Eigen::Index n = Eigen::Index(rows_.size()), p = views.front()->byParameter.cols();
    z_.resize(n);
    Eigen::MatrixXd j(n, p);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Row& r = rows_[std::size_t(i)];
      z_(i) = views[r.view]->value(Eigen::Index(r.shape));
      j.row(i) = views[r.view]->byParameter.row(Eigen::Index(r.shape));
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(j);
    qr.setThreshold(kOpenParameter);
    basis_ = qr.householderQ() * Eigen::MatrixXd::Identity(n, qr.rank());
    noise_ =
        std::max(noiseVariance, 1e-12 * z_.squaredNorm() / double(n));  // exact residuals keep a covariance that can be inverted
  }
  bool tells() const { return basis_.rows() > basis_.cols() && z_.squaredNorm() > 0; }

  /// Log-likelihood, up to what all lengths share.
  double fit(double length, Eigen::VectorXd& variance, Eigen::VectorXd& freedom) const {
    const Eigen::Index n = z_.size(), m = variance.size();
    std::vector<Eigen::MatrixXd> patterns(std::size_t(m), Eigen::MatrixXd::Zero(n, n));
    for (Eigen::Index i = 0; i < n; ++i)
      for (Eigen::Index k = 0; k < n; ++k) {
        const Row &a = rows_[std::size_t(i)], &b = rows_[std::size_t(k)];
        if (a.shape != b.shape || a.group != b.group) continue;
        const double alike =
            a.view == b.view ? 1 : viewCorrelation((views_[a.view]->where - views_[b.view]->where).norm(), length);
        patterns[a.group](i, k) = std::sqrt(views_[a.view]->points * views_[b.view]->points) * alike;
      }
    // No residual tells what the parameters absorb wholly, such as a shift that all views share: its likelihood would be
    // round-off.
    const Eigen::MatrixXd open = Eigen::MatrixXd::Identity(n, n) - basis_ * basis_.transpose();
    for (Eigen::Index g = 0; g < m; ++g)
      if (!(open.cwiseProduct(patterns[std::size_t(g)]).sum() > kUntold * patterns[std::size_t(g)].trace())) variance(g) = 0;
    double likelihood = 0;
    Eigen::MatrixXd projector;
    for (int iteration = 0;; ++iteration) {
      Eigen::MatrixXd sigma = noise_ * Eigen::MatrixXd::Identity(n, n);
      for (Eigen::Index g = 0; g < m; ++g) sigma += variance(g) * patterns[std::size_t(g)];
      const Eigen::LLT<Eigen::MatrixXd> factor(sigma);
      const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n)), side = inverse * basis_;
      const Eigen::LLT<Eigen::MatrixXd> taken(basis_.transpose() * side);
      projector = inverse - side * taken.solve(side.transpose());
      likelihood = -0.5 * z_.dot(projector * z_);
      for (Eigen::Index i = 0; i < n; ++i) likelihood -= std::log(factor.matrixLLT()(i, i));
      for (Eigen::Index i = 0; i < basis_.cols(); ++i) likelihood -= std::log(taken.matrixLLT()(i, i));
      if (iteration == kIterations) break;
      const Eigen::VectorXd pz = projector * z_;
      double change = 0;
      for (Eigen::Index g = 0; g < m; ++g) {
        const Eigen::MatrixXd& pattern = patterns[std::size_t(g)];
        const double factorOf = std::sqrt(std::max(0.0, pz.dot(pattern * pz)) /
                                          std::max(projector.cwiseProduct(pattern).sum(), 1e-300));  // no division by zero
        const double before = variance(g);
        variance(g) *= factorOf;
        // A variance that goes to zero never settles, but the likelihood must be that of its last size.
        if (std::max(before, variance(g)) > kNothing * noise_) change = std::max(change, std::abs(factorOf - 1));
      }
      if (change < kSettled) break;
    }
    for (Eigen::Index g = 0; g < m; ++g) {
      const Eigen::MatrixXd product = projector * patterns[std::size_t(g)];
      freedom(g) = variance(g) * variance(g) * product.cwiseProduct(product.transpose()).sum();
    }
    return likelihood;
  }

 private:
  struct Row {
    std::size_t view, shape, group;
  };
  const std::vector<const ViewCoefficients*>& views_;
  std::vector<Row> rows_;
  Eigen::VectorXd z_;
  Eigen::MatrixXd basis_;
  double noise_ = 0;
};

}  // namespace

double viewCorrelation(double distance, double length) {
  if (length == 0) return 0;
  const double t = std::sqrt(3.0) * distance / length;  // 0 for an infinite length
  return (1 + t) * std::exp(-t);
}

std::vector<CorrelatedEffects> correlatedEffects(const std::vector<ViewCoefficients>& views, const std::vector<int>& groups,
                                                 const Eigen::VectorXd& start, double noiseVariance) {
  require(Eigen::Index(groups.size()) == start.size(), "correlatedEffects: sizes");
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(start.size());
  std::vector<CorrelatedEffects> result{{0, 1, start, none}};
  std::vector<const ViewCoefficients*> some;
  const std::size_t step = (views.size() + kMostViews - 1) / kMostViews;
  for (std::size_t i = 0; i < views.size(); i += std::max<std::size_t>(1, step)) some.push_back(&views[i]);
  if (groups.empty() || some.size() < kFewestViews) return result;
  const double spacing = spacingOf(some);
  const Stacked stacked(some, groups, noiseVariance);
  if (!(spacing > 0) || !stacked.tells()) return result;
  std::vector<double> likelihood;
  result.clear();
  double extent = 0;
  for (const ViewCoefficients* v : some) extent = std::max(extent, (v->where - some.front()->where).norm());
  std::vector<double> lengths{0};
  for (double length = spacing; length < kLongest * extent; length *= 2) lengths.push_back(length);
  lengths.push_back(std::numeric_limits<double>::infinity());
  for (const double length : lengths) {
    CorrelatedEffects e{length, 1, start, none};
    likelihood.push_back(stacked.fit(e.length, e.variance, e.freedom));
    result.push_back(std::move(e));
  }
  double best = -std::numeric_limits<double>::infinity(), sum = 0;
  for (const double l : likelihood)
    if (std::isfinite(l)) best = std::max(best, l);
  if (!std::isfinite(best)) return {{0, 1, start, none}};  // no length has a likelihood: the variances as given
  for (std::size_t i = 0; i < result.size(); ++i)
    sum += result[i].weight = std::isfinite(likelihood[i]) ? std::exp(likelihood[i] - best) : 0;
  // Before the residuals are seen, independent errors (poses) are as likely as all lengths of bumps together.
  const double others = double(result.size() - 1);
  sum += (others - 1) * result.front().weight;
  result.front().weight *= others;
  for (CorrelatedEffects& e : result) e.weight /= sum;
  return result;
}

}  // namespace glint
