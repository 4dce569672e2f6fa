// SPDX-License-Identifier: BSD-3-Clause
#include "viz/display_connection.h"

#include <xcb/xcb.h>

#include <cstdint>
#include <cstdlib>

namespace glint::viz {

Outcome<std::unique_ptr<DisplayConnection>> DisplayConnection::open() {
  const char* name = std::getenv("DISPLAY");
  if (!name || !*name) return Failure{Reason::NotSupported, "DISPLAY is not set"};
  // XCB, not Xlib: it says nothing on standard error itself. It returns a connection even if it failed.
  std::unique_ptr<DisplayConnection> display(new DisplayConnection(xcb_connect(nullptr, nullptr)));
  if (xcb_connection_has_error(display->server_) != 0)
    return Failure{Reason::NotSupported, "the display '" + std::string(name) + "' cannot be opened"};
  return display;
}

DisplayConnection::~DisplayConnection() { xcb_disconnect(server_); }

bool DisplayConnection::has(const std::string& extension) const {
  const auto length = static_cast<std::uint16_t>(extension.size());
  const xcb_query_extension_cookie_t question = xcb_query_extension(server_, length, extension.data());
  const std::unique_ptr<xcb_query_extension_reply_t, decltype(&std::free)> answer(
      xcb_query_extension_reply(server_, question, nullptr), &std::free);
  return answer && answer->present != 0;
}

}  // namespace glint::viz
