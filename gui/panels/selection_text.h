// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <vector>

#include "core/pipeline/inspection.h"
#include "viz/scene_view.h"

namespace glint::gui {

struct NumberGroup {
  QString title;
  QString lines;  ///< "name = value unit", one a line
};

/// What is selected, and numbers of the selected frame and highlight: the observation, its brightest point and tangent plane, the
/// light, and the model's fit and prediction. Numbers of the inspection and of core/advise; none is computed here.
std::vector<NumberGroup> describeSelection(const Inspection& inspection, const draw::Selection& selection,
                                           const std::string& model);

}  // namespace glint::gui
