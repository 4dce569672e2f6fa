// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/solver_trace.h"

#include <algorithm>

namespace glint {
namespace {

thread_local SolverTrace* recording = nullptr;

std::optional<Eigen::Vector4d> unitOf(const std::optional<Eigen::Vector4d>& v) {
  if (!v || !v->allFinite() || !(v->norm() > 0)) return std::nullopt;
  return v->normalized();
}

}  // namespace

int SolverRun::steps() const {
  int n = 0;
  for (const std::vector<double>& round : rounds) n += std::max(0, static_cast<int>(round.size()) - 1);
  return n;
}

SolverTrace::SolverTrace() : outer_(recording) { recording = this; }
SolverTrace::~SolverTrace() { recording = outer_; }

TracedRun::TracedRun(const char* what, const std::optional<Eigen::Vector4d>& start, const char* unit) {
  if (!recording) return;
  index_ = static_cast<int>(recording->runs_.size());
  SolverRun run;
  run.what = what;
  run.unit = unit;
  run.ending = "no usable step";
  run.start = unitOf(start);
  recording->runs_.push_back(std::move(run));
  recording->open_.push_back(index_);
}

TracedRun::~TracedRun() {
  if (index_ >= 0 && recording && !recording->open_.empty()) recording->open_.pop_back();
}

void TracedRun::end(bool converged, const std::string& ending, const std::optional<Eigen::Vector4d>& end) {
  if (index_ < 0 || !recording) return;
  SolverRun& run = recording->runs_[static_cast<std::size_t>(index_)];
  run.converged = converged;
  run.ending = ending;
  run.end = unitOf(end);
}

void traceRound(const std::vector<double>& costs) {
  if (!recording || recording->open_.empty()) return;
  recording->runs_[static_cast<std::size_t>(recording->open_.back())].rounds.push_back(costs);
}

void traceAnswer(int run) {
  if (!recording || run < 0 || run >= static_cast<int>(recording->runs_.size())) return;
  SolverRun& taken = recording->runs_[static_cast<std::size_t>(run)];
  for (SolverRun& earlier : recording->runs_)
    if (earlier.what == taken.what) earlier.answer = false;
  taken.answer = true;
}

}  // namespace glint
