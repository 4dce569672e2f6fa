// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/diagnose/diagnosis.h"

namespace glint {

/// Why a model is ok, poor or failed: its fits, the highlights that contradict it, the views that it gets wrong.
/// @param inspection  complete, with this model
/// @param error       of it, in views that its fit did not see
/// Stopped.
ModelDiagnosis diagnosisOf(const Inspection& inspection, const std::string& model, const UnseenError& error,
                           const ProgressFn& progress);

}  // namespace glint
