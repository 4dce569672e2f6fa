// SPDX-License-Identifier: BSD-3-Clause
#include "core/reflectance/patch_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/reflectance/light_radiance.h"

namespace glint::patch {
namespace {

constexpr double kRobust = 0.01;   // share of the top: beyond it a residual is no noise of an image that can be used
constexpr double kDarkest = 0.05;  // of the top: darker pixels weigh no more
constexpr int kReweightings = 12;
constexpr double kCoefficientsSettled = 1e-9;  // of the coefficients, relative
constexpr double kSampledFrom = 0.4;           // variance in cells: from here on a sampled Gaussian has its moments to 4e-4

/// Taps of a kernel with the variance given, in cells: three where that is small, else a sampled Gaussian.
std::vector<double> kernelOf(double variance) {
  if (variance < kSampledFrom) return {variance / 2, 1 - variance, variance / 2};
  const int reach = static_cast<int>(std::ceil(3.5 * std::sqrt(variance)));
  std::vector<double> taps(static_cast<std::size_t>(2 * reach + 1));
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += taps[static_cast<std::size_t>(i + reach)] = std::exp(-0.5 * i * i / variance);
  for (double& t : taps) t /= sum;
  return taps;
}

/// Beyond the grid the outermost cells are repeated.
void blur(std::vector<double>& cells, int columns, int rows, double variance) {
  const std::vector<double> taps = kernelOf(variance);
  const int reach = static_cast<int>(taps.size()) / 2;
  Eigen::ArrayXd line, sums;
  if (columns == 0 || rows == 0) return;
  const auto along = [&](int start, int count, int stride) {
    const Eigen::Map<Eigen::ArrayXd, 0, Eigen::InnerStride<>> cell(cells.data() + start, count, Eigen::InnerStride<>(stride));
    line.resize(count + 2 * reach);
    line.head(reach).setConstant(cell(0));
    line.segment(reach, count) = cell;
    line.tail(reach).setConstant(cell(count - 1));
    sums.setZero(count);
    for (int k = 0; k <= 2 * reach; ++k) sums += taps[static_cast<std::size_t>(k)] * line.segment(k, count);
    Eigen::Map<Eigen::ArrayXd, 0, Eigen::InnerStride<>>(cells.data() + start, count, Eigen::InnerStride<>(stride)) = sums;
  };
  for (int row = 0; row < rows; ++row) along(row * columns, columns, 1);
  for (int column = 0; column < columns; ++column) along(column, rows, columns);
}

/// What the background's coefficients multiply at a cell; u, v run over about [-1, 1].
int fillBasis(const PixelPatch& p, const FramePatches& frame, std::size_t i, BackgroundKind kind, const State& at, double* row) {
  const double half = 0.5 * std::max(p.columns, p.rows);
  const double u = (static_cast<double>(i % static_cast<std::size_t>(p.columns)) - 0.5 * p.columns) / half;
  const double v = (static_cast<double>(i / static_cast<std::size_t>(p.columns)) - 0.5 * p.rows) / half;
  switch (kind) {
    case BackgroundKind::None: return 0;
    case BackgroundKind::Quadratic: {
      const double terms[] = {1, u, v, u * u, u * v, v * v};
      for (int k = 0; k < 6; ++k) row[k] = frame.top * terms[k];
      return 6;
    }
    case BackgroundKind::Cosine:
    case BackgroundKind::AmbientCosine:
    case BackgroundKind::SlopedCosine: {
      const Eigen::Vector3d towards = at.lamp.centre.head<3>() - at.lamp.centre.w() * p.seen[i].position;
      const double distance = towards.norm();
      // Up to the lamp's strength N.L / r^2, which is |w|^2 / distance^3 here; at infinity the distance is one.
      const double lit = distance > 0 ? std::max(0.0, p.seen[i].axes.normal.dot(towards)) / (distance * distance * distance) : 0;
      row[0] = frame.top * lit;
      if (kind == BackgroundKind::Cosine) return 1;
      if (kind == BackgroundKind::AmbientCosine) {
        row[1] = frame.top;
        return 2;
      }
      row[1] = u * row[0];
      row[2] = v * row[0];
      return 3;
    }
  }
  return 0;
}

}  // namespace

int coefficientsOf(BackgroundKind kind) {
  switch (kind) {
    case BackgroundKind::None: return 0;
    case BackgroundKind::Cosine: return 1;
    case BackgroundKind::AmbientCosine: return 2;
    case BackgroundKind::SlopedCosine: return 3;
    case BackgroundKind::Quadratic: return 6;
  }
  return 0;
}

double robustSquare(double r) {
  const double t = r / kRobust;
  return 2 * kRobust * r * t / (std::sqrt(1 + t * t) + 1);  // without the cancellation at small r
}
double robustWeight(double r) {
  const double t = r / kRobust;
  return 1 / std::sqrt(1 + t * t);
}

Normalised normalised(const std::vector<const PixelPatch*>& patches) {
  Normalised n;
  std::map<int, std::size_t> frames;
  n.scale = 0;
  for (const PixelPatch* p : patches) {
    const auto [known, isNew] = frames.emplace(p->frame, n.frames.size());
    if (isNew) n.frames.emplace_back();
    FramePatches& frame = n.frames[known->second];
    frame.patches.push_back(*p);
    frame.top = std::max(frame.top, p->top);
    const Eigen::Vector3d eye = p->camera.centreInWorld();
    for (std::size_t i = 0; i < p->size(); ++i) {
      if (!p->used[i]) continue;
      n.origin += p->seen[i].position;
      n.scale += (eye - p->seen[i].position).norm();
      ++frame.used;
      ++n.cells;
    }
    n.radiusPx += p->radiusPx / static_cast<double>(patches.size());
  }
  if (n.cells == 0) return n;
  n.origin /= static_cast<double>(n.cells);
  n.scale /= static_cast<double>(n.cells);
  for (FramePatches& frame : n.frames)
    for (PixelPatch& p : frame.patches)
      for (std::size_t i = 0; i < p.size(); ++i)
        if (p.onSurface[i]) p.seen[i].position = (p.seen[i].position - n.origin) / n.scale;
  return n;
}

PixelPatch coarsened(const PixelPatch& fine) {
  PixelPatch p;
  p.frame = fine.frame;
  p.camera = fine.camera;
  p.cellPx = 2 * fine.cellPx;
  p.firstCell = fine.firstCell + Pixel::Constant(0.5 * fine.cellPx);
  p.columns = fine.columns / 2;
  p.rows = fine.rows / 2;
  p.peak = fine.peak;
  p.radiusPx = fine.radiusPx;
  const std::size_t n = static_cast<std::size_t>(p.columns) * p.rows;
  p.value.assign(n, 0);
  p.used.assign(n, 1);
  p.onSurface.assign(n, 1);
  p.seen.resize(n);
  for (int row = 0; row < p.rows; ++row)
    for (int column = 0; column < p.columns; ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * p.columns + column;
      PixelPatch::Seen mean{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
      for (int k = 0; k < 4; ++k) {
        const std::size_t j = static_cast<std::size_t>(2 * row + k / 2) * fine.columns + 2 * column + k % 2;
        p.value[i] += fine.value[j] / 4;
        p.used[i] = p.used[i] && fine.used[j];
        p.onSurface[i] = p.onSurface[i] && fine.onSurface[j];
        mean.position += fine.seen[j].position / 4;
        mean.axes.normal += fine.seen[j].axes.normal;
        mean.axes.tangent += fine.seen[j].axes.tangent;
        mean.toCamera += fine.seen[j].toCamera;
      }
      if (!p.onSurface[i]) continue;
      const Eigen::Vector3d normal = mean.axes.normal.normalized(), &tangent = mean.axes.tangent;
      p.seen[i] = {mean.position, {normal, (tangent - tangent.dot(normal) * normal).normalized()}, mean.toCamera.normalized()};
      if (p.used[i]) p.top = std::max<double>(p.top, p.value[i]);
    }
  return p;
}

LobeImage sharpImage(Lobe lobe, const FramePatches& frame, const State& at, const lobe::LampRule& rule) {
  LobeImage image;
  image.logTop = -std::numeric_limits<double>::infinity();
  const Roughness roughness = at.roughness();
  for (const PixelPatch& p : frame.patches) {
    std::vector<double>& values = image.value.emplace_back(p.size(), -std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!p.onSurface[i]) continue;
      const PixelPatch::Seen& s = p.seen[i];
      const std::optional<double> log = lobe::logOfLamp<double>(lobe, roughness, s.position, s.axes, s.toCamera, at.lamp, rule);
      if (!log || !std::isfinite(*log)) continue;
      values[i] = *log;
      if (!p.used[i]) continue;
      image.lit = true;
      if (!(*log > image.logTop)) continue;
      image.logTop = *log;
      image.topPatch = image.value.size() - 1;
      image.topCell = i;
    }
  }
  if (!image.lit) return image;
  for (std::vector<double>& values : image.value)
    for (double& v : values) v = std::exp(v - image.logTop);
  return image;
}

LobeImage blurredImage(LobeImage sharp, const FramePatches& frame, const State& at) {
  if (!sharp.lit) return sharp;
  for (std::size_t k = 0; k < sharp.value.size(); ++k) {
    const PixelPatch& p = frame.patches[k];
    blur(sharp.value[k], p.columns, p.rows, std::max(0.0, at.blurVariance / (p.cellPx * p.cellPx) + kPixelVariance));
  }
  return sharp;
}

bool dependsOnLight(BackgroundKind kind) { return kind != BackgroundKind::None && kind != BackgroundKind::Quadratic; }

BackgroundBasis backgroundBasis(const FramePatches& frame, BackgroundKind kind, const State& at) {
  BackgroundBasis basis;
  basis.each = coefficientsOf(kind);
  basis.terms.reserve(frame.used * static_cast<std::size_t>(basis.each));
  basis.spread.reserve(frame.used);
  for (const PixelPatch& p : frame.patches)
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!p.used[i]) continue;
      double row[6];
      require(fillBasis(p, frame, i, kind, at, row) == basis.each, "backgroundBasis: as many terms as coefficients");
      basis.terms.insert(basis.terms.end(), row, row + basis.each);
      const double share = p.value[i] / frame.top;
      basis.spread.push_back(frame.top * std::sqrt(std::max(share, kDarkest)));
    }
  return basis;
}

LinearFit linearFit(const FramePatches& frame, const LobeImage& image, const BackgroundBasis& basis, const Weights& weights) {
  const int each = basis.each;
  const Eigen::Index unknowns = 1 + each * static_cast<Eigen::Index>(frame.patches.size());
  LinearFit fit;
  fit.residual.assign(frame.used, 0);
  if (static_cast<Eigen::Index>(frame.used) < unknowns + 2) return fit;
  // Normal equations, with rows in double precision and columns scaled to one size. Their residuals are as good as those of a QR,
  // at a tenth of the time, and the fit of the lobe sees nothing else. A trace of damping keeps directions that the pixels do not
  // determine at zero.
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>::Zero(static_cast<Eigen::Index>(frame.used),
                                                                                   unknowns);
  Eigen::VectorXd values(static_cast<Eigen::Index>(frame.used)), roots(static_cast<Eigen::Index>(frame.used));
  Eigen::Index n = 0;
  for (std::size_t k = 0; k < frame.patches.size(); ++k) {
    const PixelPatch& p = frame.patches[k];
    for (std::size_t i = 0; i < p.size(); ++i) {
      if (!p.used[i]) continue;
      roots(n) = std::sqrt(weights[static_cast<std::size_t>(n)]);
      const double weight = roots(n) / basis.spread[static_cast<std::size_t>(n)];
      rows(n, 0) = weight * frame.top * image.value[k][i];
      const double* const terms = basis.terms.data() + n * each;
      for (int b = 0; b < each; ++b) rows(n, 1 + each * static_cast<Eigen::Index>(k) + b) = weight * terms[b];
      values(n) = weight * p.value[i];
      ++n;
    }
  }
  const Eigen::RowVectorXd sizes = rows.colwise().norm().cwiseMax(1e-300);  // a lobe that is nowhere lit has a column of zeros
  rows.array().rowwise() /= sizes.array();
  Eigen::MatrixXd normal = rows.transpose() * rows;
  normal.diagonal().array() += 1e-13;  // some hundred times round-off of columns of size one
  const Eigen::LDLT<Eigen::MatrixXd> factors(normal);
  Eigen::VectorXd scaled = factors.solve(rows.transpose() * values);
  // One step of refinement takes back most of what squaring the condition costs.
  scaled += factors.solve(rows.transpose() * (values - rows * scaled));
  if (!scaled.allFinite()) return fit;
  const Eigen::VectorXd left = values - rows * scaled;
  for (Eigen::Index i = 0; i < n; ++i) fit.residual[static_cast<std::size_t>(i)] = left(i) / roots(i);
  fit.coefficients = frame.top * scaled.cwiseQuotient(sizes.transpose());
  fit.solved = true;
  return fit;
}

LinearFit robustFit(const FramePatches& frame, const LobeImage& image, const BackgroundBasis& basis, Weights& weights) {
  LinearFit fit;
  for (int round = 0; round < kReweightings; ++round) {
    const Eigen::VectorXd before = fit.coefficients;
    fit = linearFit(frame, image, basis, weights);
    if (!fit.solved) return fit;
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = robustWeight(fit.residual[i]);
    if (before.size() > 0 && (fit.coefficients - before).norm() <= kCoefficientsSettled * fit.coefficients.norm()) break;
  }
  // This is the fit with the weights as they are left: a caller that keeps them and moves the lobe a little compares with it.
  return linearFit(frame, image, basis, weights);
}

std::vector<double> backgroundOf(const PixelPatch& patch, const FramePatches& frame, BackgroundKind kind, const State& at,
                                 const Eigen::VectorXd& coefficients) {
  std::vector<double> b(patch.size(), 0);
  for (std::size_t i = 0; i < patch.size(); ++i) {
    if (!patch.onSurface[i]) continue;
    double basis[6];
    const int count = fillBasis(patch, frame, i, kind, at, basis);
    for (int k = 0; k < count; ++k) b[i] += coefficients(k) * basis[k] / frame.top;
  }
  return b;
}

}  // namespace glint::patch
