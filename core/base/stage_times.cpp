// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/stage_times.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr double kLeastSeconds = 1e-3;  // shorter ones are noise of the clock and of other work

double steadySeconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

StageTimes::StageTimes(Clock clock) : clock_(clock ? std::move(clock) : steadySeconds) { began_ = since_ = clock_(); }

void StageTimes::note(const StageEvent& event) {
  const std::scoped_lock lock(mutex_);
  const double now = clock_();
  if (stages_.empty() || stages_[current_].name != event.stage) {
    if (!stages_.empty()) stages_[current_].seconds += now - since_;
    since_ = now;
    const auto it = std::find_if(stages_.begin(), stages_.end(), [&](const Stage& s) { return s.name == event.stage; });
    current_ = static_cast<std::size_t>(it - stages_.begin());
    if (it == stages_.end()) stages_.push_back({event.stage});
  }
  stages_[current_].units = std::max(stages_[current_].units, event.total);
}

std::string StageTimes::text() const {
  const std::scoped_lock lock(mutex_);
  const double now = clock_();
  std::string text;
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    const Stage& s = stages_[i];
    const double seconds = s.seconds + (i == current_ ? now - since_ : 0);
    text += (i ? ", " : "") + s.name;
    if (s.units > 1) text += " " + std::to_string(s.units);
    if (seconds >= kLeastSeconds) text += formatted(" in %.3f s", seconds);
  }
  return text + (stages_.empty() ? "" : "; ") + formatted("%.3f s in all", now - began_);
}

std::string StageTimes::stage() const {
  const std::scoped_lock lock(mutex_);
  return stages_.empty() ? "" : stages_[current_].name;
}

}  // namespace glint
