// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/diagnose/diagnosis.h"

namespace glint {

/// docs/formats.md, "diagnose --json".
/// @param input  as given
std::string diagnosisJson(const Inspection& inspection, const Diagnosis& diagnosis, const std::string& input);
/// For a person: per model its state, the causes, the highlights that stand against it, and what helps, as flags.
std::string diagnosisText(const Inspection& inspection, const Diagnosis& diagnosis);
/// "36 % -> 15 %" or "no prediction before, 15 % after", with the views that were answered where that is not all of them.
std::string effectText(const Remedy& remedy);

}  // namespace glint
