// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the folders above core/inspect include.
#include "core/inspect/frame_score.h"
#include "core/inspect/inspection.h"
#include "core/inspect/summary.h"
#include "core/scene/scene.h"
#include "resources/setup/headers/core.h"
