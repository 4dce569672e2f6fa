// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/scene: pixels from the bytes of a file whose header was read.

#include <string>

#include "core/base/image_header.h"
#include "core/base/outcome.h"

namespace cv {
class Mat;
}

namespace glint {

/// 1 or 3 channels in the order red, green, blue, and the file's own depth (8 or 16 bits, float); alpha is dropped. Writes
/// nothing to standard error, whatever the decoders find.
/// @param header  of these bytes, without a problem
/// @return FrameUnreadable for damaged data, where a decoder would go on with grey or wrong pixels, and for CMYK.
/// @throws CodecsMissing  neither PNG nor JPEG, and libglint-codecs is not there
Outcome<cv::Mat> decodeImage(const std::string& bytes, const ImageHeader& header);

/// How opaque each pixel is, one channel in the file's own depth. FrameUnreadable where the file has none.
/// @throws CodecsMissing  libglint-codecs is not there
Outcome<cv::Mat> decodeAlpha(const std::string& bytes);

/// The channel of depth (Z or V) of an EXR file that may have colours, too: floats. FrameUnreadable for no such channel, or
/// several.
/// @throws CodecsMissing  libglint-codecs is not there
Outcome<cv::Mat> decodeDepth(const std::string& bytes);

}  // namespace glint
