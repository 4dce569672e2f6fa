// SPDX-License-Identifier: BSD-3-Clause
#include "gui/document/recent_results.h"

#include <algorithm>

namespace glint::gui {

void RecentResults::keep(std::shared_ptr<const Inspection> results, const InspectionRequest& computedFor, const Leads& leads) {
  std::erase_if(kept_, [&](const Kept& k) { return k.first == computedFor; });
  kept_.emplace_back(computedFor, std::move(results));
  if (kept_.size() <= kMost) return;
  const auto newest = kept_.end() - 1;
  const auto passed = std::find_if(kept_.begin(), newest, [&](const Kept& k) { return !leads(k.first); });
  kept_.erase(passed != newest ? passed : kept_.begin());
}

std::shared_ptr<const Inspection> RecentResults::find(const InspectionRequest& request) {
  const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.first == request; });
  if (found == kept_.end()) return nullptr;
  std::rotate(found, found + 1, kept_.end());
  return kept_.back().second;
}

}  // namespace glint::gui
