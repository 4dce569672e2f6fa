// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/choice/tradeoff.h"

namespace glint::testing_support {

/// A complete point: ten highlights, all matched.
inline TradeoffPoint point(const std::string& model, double errorPct, double us) {
  TradeoffPoint p;
  p.model = model;
  p.frames = p.predicted = p.matched = 10;
  p.contourErrorPct = errorPct;
  p.iou = 0.9;
  p.coverage = 1;
  p.predictUs = us;
  p.fitUs = 1000;
  p.peakMb = 50;
  p.rankedErrorPct = rankedErrorPct(p);
  return p;
}

}  // namespace glint::testing_support
