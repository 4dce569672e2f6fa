// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// While one lives, what libraries write to standard error goes nowhere: encoders of videos print there and cannot be asked not to. Keep
/// it around calls of such a library only. Several threads may have one at once. The program's own lines go to `ownErrors` meanwhile.
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
