// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// How a process uses memory: what it keeps, what its libraries reserve, how many images fit.
#include <string>

namespace glint {

/// Lets this process keep the memory that it frees, for its next images. Else the C library takes each block of an image's size
/// anew from the system and gives it back, which clears all its pages every time: a quarter of the processor time of an
/// evaluation of 100 frames. For programs, not for libraries: how a host's memory is handled is the host's choice. Does nothing
/// where the user chose (environment variables MALLOC_... of glibc), and with another C library.
void keepFreedMemory();

/// Asks oneTBB, which runs the tasks of Embree and OpenCV, for its first memory block. If the system refuses memory while those
/// libraries start tasks, they wait for ever; oneTBB takes and keeps large blocks, so that after this call small work needs no
/// more. Large work may still ask for more blocks. Call it before any other use of these libraries; once serves all threads.
/// @throw std::bad_alloc
void reserveTaskMemory();

// One budget for the pixels of all frames that are worked on at the same time (Limit::ImageMemory). A few megabytes of PNG may
// hold gigabytes of pixels, and every thread works on a frame of its own.

/// Says before frames are decoded how large they are, in million pixels; the largest of this process counts.
void expectImages(double megapixels);

/// How many frames of the expected size the budget has room for, at least 1: loops take no more threads than that.
int imagesAtOnce();

/// InputError (file) if one image of this size takes more than the budget; the line names the option that raises it.
void requireRoomForImage(double megapixels, const std::string& file);

}  // namespace glint
