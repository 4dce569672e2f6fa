// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>

/// First line of every test that reads the data beside the project (GLINT_SHARED_DIR): a plain clone has none, and a test that
/// cannot run is skipped by name, not failed.
#define GLINT_NEEDS_SHARED_DATA()                               \
  if (!std::filesystem::is_directory(GLINT_SHARED_DIR "/data")) \
  GTEST_SKIP() << "no data beside the project (" << GLINT_SHARED_DIR << ")"
