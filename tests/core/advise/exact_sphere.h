// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <memory>

#include "tests/core/pipeline/exact_scene.h"

namespace glint::testing_support {

/// Nine exact views of a ball, one model trained on the first six: tests change what was predicted.
class ExactSphere : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    InspectionRequest request;
    request.models = {"limit-angle"};
    request.train = "0-5";
    inspection_ = std::make_unique<Inspection>(inspect(exactScene(sphere(0.5), 9), request));
  }
  static void TearDownTestSuite() { inspection_.reset(); }

  static inline std::unique_ptr<Inspection> inspection_;
};

}  // namespace glint::testing_support
