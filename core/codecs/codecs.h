// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace cv {
class Mat;
}

/// Images and videos through OpenCV's modules imgcodecs and videoio. These bring two hundred libraries (GDAL's, FFmpeg's), which
/// took four fifths of the start of a program that may never need them. So they are linked by a library of their own,
/// libglint-codecs, which the first call of a function below loads from the folder of libglint-core. Pixels of PNG and JPEG files
/// are read without it (core/scene/image_decode.h). The functions may run on several threads at once; a decoder or an encoder
/// belongs to one thread at a time. All functions throw CodecsMissing.
namespace glint {

/// libglint-codecs is missing, cannot be loaded or is of another version. One line with its file. Not an InputError: a program
/// that goes on without one unreadable file must not go on without all of them.
class CodecsMissing : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Loads what the functions below need, once. Call it where an exception of theirs would be taken for a damaged file.
void loadCodecs();

/// All channels in OpenCV's order (blue first), in the file's own depth, as cv::imdecode with IMREAD_UNCHANGED gives them. TIFF
/// and EXR files that OpenCV cannot read are decoded by libtiff and OpenEXR themselves, without alpha and half floats as floats:
/// of EXR files one layer (codec_table.h).
/// @param reason  says why a whole file of a known format is refused
/// @return empty: refused, or not an image
/// @throws std::exception  damaged data
cv::Mat decodeOtherFormat(const std::string& bytes, std::string& reason);

/// The one channel of depth (Z or V) of an EXR file, whatever else it has: floats.
/// @param reason  says why there is no depth in it
/// @return empty: refused, or not an EXR file
/// @throws std::exception  damaged data
cv::Mat decodeExrDepth(const std::string& bytes, std::string& reason);

/// The content of a file, as cv::imencode writes it.
/// @param ending      with its dot: ".png"
/// @param pixels      blue first
/// @param parameters  pairs of cv::ImwriteFlags and values
/// @return false: the encoder refuses these pixels
/// @throws cv::Exception  no encoder for that ending
bool encodeWithOpenCv(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
                      const std::vector<int>& parameters = {});

/// A video that is being decoded, picture by picture, by FFmpeg alone: other back ends take addresses and patterns of file names.
/// Functions throw cv::Exception for some damaged files.
class VideoDecoder {
 public:
  virtual ~VideoDecoder() = default;
  /// Pictures are turned as the file says. @return false: no video that can be decoded
  virtual bool open(const std::string& file) = 0;
  virtual bool isOpen() const = 0;
  virtual void close() = 0;
  /// @param picture  from 0, counted by a constant rate. @return false: this video cannot
  virtual bool seek(int picture) = 0;
  /// Goes on by one picture. @return false: there are no more
  virtual bool grab() = 0;
  /// The pixels of the picture that was grabbed last, blue first.
  virtual bool retrieve(cv::Mat& picture) = 0;
  virtual double seconds() const = 0;            ///< s, of the picture that was grabbed last; 0 = unknown
  virtual double width() const = 0;              ///< px
  virtual double height() const = 0;             ///< px
  virtual double picturesPerSecond() const = 0;  ///< 0 = unknown
  virtual int rotation() const = 0;              ///< degrees clockwise by which the file's tag turns its pictures; 0 = no tag
};
std::unique_ptr<VideoDecoder> newVideoDecoder();

/// A video that is being written by FFmpeg. It tells of no failure after `open`: read it back.
class VideoEncoder {
 public:
  virtual ~VideoEncoder() = default;
  /// @param codec  four characters. @return false: no access or no such encoder
  virtual bool open(const std::string& file, const char* codec, double picturesPerSecond, int width, int height) = 0;
  virtual bool isOpen() const = 0;
  /// @param picture  8 bits, blue first, of the size of `open`
  virtual void write(const cv::Mat& picture) = 0;
  virtual void close() = 0;
};
std::unique_ptr<VideoEncoder> newVideoEncoder();

}  // namespace glint
