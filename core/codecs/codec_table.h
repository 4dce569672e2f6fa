// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "core/base/version.h"
#include "core/codecs/codecs.h"

namespace cv {
class Mat;
}

namespace glint {

/// What libglint-codecs does, one entry for each function of codecs.h. Internal to core/codecs.
struct CodecTable {
  const char* version;  ///< GLINT_VERSION of that library: first in every version, so that another one can be told
  cv::Mat (*decode)(const std::string& bytes, std::string& reason);
  cv::Mat (*decodeDepth)(const std::string& bytes, std::string& reason);
  bool (*encode)(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
                 const std::vector<int>& parameters);
  std::unique_ptr<VideoDecoder> (*decoder)();
  std::unique_ptr<VideoEncoder> (*encoder)();
};

/// The one symbol that libglint-codecs shows.
inline constexpr char kCodecSymbol[] = "glint_codecs";
using CodecTableFunction = const CodecTable* (*)();

// Internal to libglint-codecs: kinds of files that OpenCV cannot read, by the libraries that it reads the others with.

/// BigTIFF; TIFF with half floats, with an orientation of a quarter turn (not applied, while OpenCV does), or with over 8 bits in
/// separate planes (OpenCV 4.6 makes three narrow pictures). @param reason  says why a file is refused; the picture is then empty
/// @return blue first, 1 or 3 channels, half floats as floats; nothing: a file for OpenCV
/// @throws std::runtime_error  damaged data
std::optional<cv::Mat> decodeTiff(const std::string& bytes, std::string& reason);

/// EXR files whose channels all belong to layers: the one layer with R, G and B (the one named Combined, where there are
/// several), else the one channel that is depth (Z or V) or luminance (Y).
/// @param reason  as above
/// @return floats of the first part, blue first, 1 or 3 channels; nothing: a file for OpenCV
/// @throws std::exception  damaged data
std::optional<cv::Mat> decodeExrLayer(const std::string& bytes, std::string& reason);

/// The channel of depth of an EXR file: Z or V without a layer, else that of a layer (named Depth, if there are several).
/// @param reason  says why the picture is empty. @throws std::exception  damaged data
cv::Mat depthOfExr(const std::string& bytes, std::string& reason);

}  // namespace glint
