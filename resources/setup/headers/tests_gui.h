// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <QtTest>

#include "resources/setup/headers/gui.h"
#include "tests/gui/fixture.h"
