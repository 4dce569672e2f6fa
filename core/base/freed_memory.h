// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glint {

/// Lets this process keep the memory that it frees, for its next images. Else the C library takes each block of an image's size
/// anew from the system and gives it back, which clears all its pages every time: a quarter of the processor time of an
/// evaluation of 100 frames. For programs, not for libraries: how a host's memory is handled is the host's choice. Does nothing
/// where the user chose (environment variables MALLOC_... of glibc), and with another C library.
void keepFreedMemory();

}  // namespace glint
