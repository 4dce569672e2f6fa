// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// While one lives, what libraries write to standard error goes nowhere: video encoders print there and have no switch. Keep
/// it around such calls only. Several threads may have one each. The program's own lines go to `ownErrors` meanwhile.
class QuietLibraries {
 public:
  QuietLibraries();
  ~QuietLibraries();
  QuietLibraries(const QuietLibraries&) = delete;
  QuietLibraries& operator=(const QuietLibraries&) = delete;
};

/// The descriptor of the real standard error, for a line that may come at any moment. Async-signal-safe.
int ownErrors();

}  // namespace glint
