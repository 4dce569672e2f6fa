// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// Asks oneTBB, on which Embree and OpenCV run their tasks, for its first block of memory. Where the system refuses memory while those
/// libraries start tasks, they wait for ever; oneTBB asks for large blocks and keeps them, so that after this call small work needs no
/// more. Large work may still ask for more blocks. Call it before any other use of these libraries; once is enough for all threads.
/// @throw std::bad_alloc
void reserveTaskMemory();

}  // namespace glint
