// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <memory>
#include <string>

#include "core/base/outcome.h"
#include "viz/offscreen.h"

namespace glint::test {

/// Leaves DISPLAY as it was.
class KeepsDisplay {
 public:
  KeepsDisplay() {
    if (const char* name = std::getenv("DISPLAY")) before_ = name, wasSet_ = true;
  }
  ~KeepsDisplay() {
    if (wasSet_)
      setenv("DISPLAY", before_.c_str(), 1);
    else
      unsetenv("DISPLAY");
  }
  KeepsDisplay(const KeepsDisplay&) = delete;
  KeepsDisplay& operator=(const KeepsDisplay&) = delete;

 private:
  std::string before_;
  bool wasSet_ = false;
};

/// DISPLAY names a virtual display while this lives. The first one starts its server, for all tests of the process.
class TestDisplay {
 public:
  TestDisplay() {
    if (server()) setenv("DISPLAY", (*server())->name().c_str(), 1);
  }
  explicit operator bool() const { return bool(server()); }
  static const Failure& failure() { return server().failure(); }

 private:
  static const Outcome<std::unique_ptr<viz::VirtualDisplay>>& server() {
    static const Outcome<std::unique_ptr<viz::VirtualDisplay>> started = viz::VirtualDisplay::start(1280, 1024);
    return started;
  }
  KeepsDisplay keeps_;
};

}  // namespace glint::test
