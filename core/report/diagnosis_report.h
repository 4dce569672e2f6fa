// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/diagnose/diagnosis.h"

namespace glint {

/// docs/formats.md, "diagnose --json".
/// @param input  as given
std::string diagnosisJson(const Inspection& inspection, const Diagnosis& diagnosis, const std::string& input);
/// For a person: the verdict, the remedies as flags, and their reasons, one cause per model that is not good; --json has all.
std::string diagnosisText(const Inspection& inspection, const Diagnosis& diagnosis);
/// ReportContext::advice.
std::vector<std::string> adviceOf(const Diagnosis& diagnosis);

}  // namespace glint
