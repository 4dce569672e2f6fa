// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QString>
#include <filesystem>
#include <vector>

#include "core/report/lamps_report.h"

class QWidget;

namespace glint::gui {

/// Asks for a file and writes the lamps there as `glint lights -o` does: .json, .csv or .lp, by the ending.
/// @param folder  where the dialog starts. @param inputs  what is not overwritten
/// @return  the file; "" if a person gave up. Throws InputError.
QString saveLamps(QWidget* window, const LampsReport& report, const QString& folder,
                  const std::vector<std::filesystem::path>& inputs);

}  // namespace glint::gui
