// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace glint {

/// One run of an iterative solver from one start.
struct SolverRun {
  std::string what;  ///< what was sought: "light with one limit angle", "ellipsoid"
  std::string unit;  ///< of the costs: "px^2", "squares of relative radiance"
  /// Sums of squares after the loss: of the start, then after each step that was taken. A new round begins where the weights were
  /// renewed; the costs of different rounds weigh the points differently and must not be compared.
  std::vector<std::vector<double>> rounds;
  bool converged = false;
  std::string ending;   ///< in words: "converged", "out of iterations", "the light lies behind the surface"
  bool answer = false;  ///< the fit's answer came from this run
  /// The light or the centre of the ellipsoid before and after, homogeneous, world, |.| = 1; none if it is not finite.
  std::optional<Eigen::Vector4d> start, end;
  /// Steps that were taken, over all rounds.
  int steps() const;
};

/// Records what the solvers do on this thread while it lives, to explain why a fit fails; if several live, the newest records.
/// Solvers that run on other threads meanwhile are not seen.
class SolverTrace {
 public:
  SolverTrace();
  ~SolverTrace();
  SolverTrace(const SolverTrace&) = delete;
  SolverTrace& operator=(const SolverTrace&) = delete;
  const std::vector<SolverRun>& runs() const { return runs_; }

 private:
  friend class TracedRun;
  friend void traceRound(const std::vector<double>& costs);
  friend void traceAnswer(int run);

  std::vector<SolverRun> runs_;
  std::vector<int> open_;  ///< runs within runs, outermost first
  SolverTrace* outer_;
};

/// Lives around one run of a solver. Does nothing if nothing records.
class TracedRun {
 public:
  /// @param start  homogeneous, world, any scale
  explicit TracedRun(const char* what, const std::optional<Eigen::Vector4d>& start = {}, const char* unit = "px^2");
  ~TracedRun();
  TracedRun(const TracedRun&) = delete;
  TracedRun& operator=(const TracedRun&) = delete;
  void end(bool converged, const std::string& ending, const std::optional<Eigen::Vector4d>& end = {});
  /// For traceAnswer(); -1 if nothing records.
  int index() const { return index_; }

 private:
  int index_ = -1;
};

/// A round of the innermost run. Does nothing outside of a run.
void traceRound(const std::vector<double>& costs);
/// The answer came from this run, not from earlier ones of what was sought. Nothing for -1.
void traceAnswer(int run);

}  // namespace glint
