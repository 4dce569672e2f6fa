// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "core/capture/capture.h"

namespace glint {

/// std::invalid_argument for a name that is taken, empty, or one that `--as` knows for another input (scene, session).
void checkCaptureReader(const CaptureReader& reader);
/// One more reader of captures, asked after the others. Not thread-safe: before any input is read. std::invalid_argument as
/// checkCaptureReader().
void addCaptureReader(std::unique_ptr<const CaptureReader> reader);

}  // namespace glint
