// SPDX-License-Identifier: BSD-3-Clause
#include "gui/scene/view_history.h"

#include <QUndoStack>
#include <algorithm>
#include <utility>

namespace glint::gui {

void ViewHistory::forget() {
  stays_ = {{0, nullptr, {}}};
  index_ = stack_->index();
  left_ = false;
}

std::size_t ViewHistory::stayAt(int index) const {
  const auto after = std::find_if(stays_.begin(), stays_.end(), [index](const Stay& s) { return s.from > index; });
  return std::size_t(after - stays_.begin()) - 1;  // the first is from 0
}

void ViewHistory::leave(const std::optional<Places>& places) {
  if (std::exchange(left_, true)) return;  // a jump over several steps: the views on its way were never seen
  stays_[stayAt(index_)].places = places;
}

std::optional<ViewHistory::Places> ViewHistory::arrive() {
  const int before = std::exchange(index_, stack_->index());
  // A new step takes the place of those that could be redone. It exists before they go, so that the addresses differ.
  stays_.erase(std::remove_if(stays_.begin(), stays_.end(),
                              [this](const Stay& s) { return s.from > 0 && stack_->command(s.from - 1) != s.step; }),
               stays_.end());
  if (!std::exchange(left_, false)) return {};
  const std::size_t at = stayAt(index_);
  if (index_ > before && stays_[at].from <= before) {
    stays_.insert(stays_.begin() + std::ptrdiff_t(at) + 1, {index_, stack_->command(index_ - 1), {}});
    return {};
  }
  return stays_[at].places;
}

}  // namespace glint::gui
