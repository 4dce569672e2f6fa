// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What the folders above core/pipeline include.
#include "core/pipeline/frame_score.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/summary.h"
#include "core/scene/scene.h"
#include "resources/setup/headers/core.h"
