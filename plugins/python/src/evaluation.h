// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plugins/python/src/types.h"

namespace glint::python {

/// A request from Python: None means the session's value, else the default. The parameters are those of inspectAsAsked().
InspectionRequest requestAsAsked(const SceneHandle& scene, const RequestHandle* request,
                                 const std::optional<std::vector<std::string>>& models, const std::optional<std::string>& train,
                                 const std::optional<std::string>& exclude, const std::optional<std::string>& level,
                                 const std::optional<std::string>& source, py::handle settings);

/// For the level "auto": puts the level that training frames choose into the request; says why. Else "". CannotAnswer,
/// InputError.
std::string chooseLevelIfAsked(const Scene& scene, const std::optional<std::string>& level, InspectionRequest& request,
                               const ProgressFn& progress);

/// inspect() as a caller of Python asks for it: what is None is the session's, else the default.
/// @param request   of the session; None for a scene
/// @param models    ids; with `choose` they do not count
/// @param train,exclude  frame SPECs
/// @param level     number or "auto", as text
/// @param settings  dictionary
/// @param previous  an earlier inspection of the same scene, or None
InspectionHandle inspectAsAsked(const SceneHandle& scene, const RequestHandle* request,
                                const std::optional<std::vector<std::string>>& models, bool choose,
                                std::optional<double> goodEnoughPct, const std::optional<std::string>& train,
                                const std::optional<std::string>& exclude, const std::optional<std::string>& level,
                                const std::optional<std::string>& source, double noisePx, unsigned seed, const std::string& truth,
                                py::handle settings, const InspectionHandle* previous, py::object progress);

}  // namespace glint::python
