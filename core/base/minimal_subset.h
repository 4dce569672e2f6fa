// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

namespace glint {

/// A smallest part of a list that still shows something, by delta debugging: ddmin, which drops ever smaller chunks as long as
/// what remains shows it. What comes back is 1-minimal: without any single one of its items it no longer shows. For n items it
/// asks at most n^2 + 3 n times, where the property is kept by every superset of one small part about 2 k log2(n / k) + k times,
/// k the size of that part. A question that was asked before is not asked again.
/// @param items  distinct; the order stays.
/// @param shows  true for the whole list, which is not asked about.
/// @param ask    before every question: how many were asked, how many items are left; false stops with Stopped. May be empty.
/// @see Zeller & Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE TSE 28 (2002), sec. 3.2.
std::vector<int> minimalSubset(std::vector<int> items, const std::function<bool(const std::vector<int>&)>& shows,
                               const std::function<bool(int asked, int left)>& ask = {});

}  // namespace glint
