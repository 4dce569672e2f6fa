// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "core/base/outcome.h"

struct xcb_connection_t;

namespace glint::viz {

/// A connection to the X display that DISPLAY names, to check that it exists before VTK or Qt look for it: without a display they
/// end the program. Keep it until they have theirs: when its last client leaves, a server restarts and drops new clients.
class DisplayConnection {
 public:
  /// NotSupported: DISPLAY is not set, or nothing answers there.
  static Outcome<std::unique_ptr<DisplayConnection>> open();
  ~DisplayConnection();
  DisplayConnection(const DisplayConnection&) = delete;
  DisplayConnection& operator=(const DisplayConnection&) = delete;
  /// Whether the server has an extension: "GLX", by which VTK draws.
  bool has(const std::string& extension) const;

 private:
  explicit DisplayConnection(xcb_connection_t* server) : server_(server) {}
  xcb_connection_t* server_;
};

}  // namespace glint::viz
