// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// Asks oneTBB, which runs the tasks of Embree and OpenCV, for its first memory block. If the system refuses memory while those
/// libraries start tasks, they wait for ever; oneTBB takes and keeps large blocks, so that after this call small work needs no
/// more. Large work may still ask for more blocks. Call it before any other use of these libraries; once serves all threads.
/// @throw std::bad_alloc
void reserveTaskMemory();

}  // namespace glint
