// SPDX-License-Identifier: BSD-3-Clause
// libglint-codecs. The interfaces hold no type of the two modules, so that nothing else links them.
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "core/codecs/codec_table.h"

namespace glint {
namespace {

cv::Mat decode(const std::string& bytes, std::string& reason) {
  if (std::optional<cv::Mat> own = decodeTiff(bytes, reason)) return *std::move(own);
  if (std::optional<cv::Mat> own = decodeExrLayer(bytes, reason)) return *std::move(own);
  const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data()));
  return cv::imdecode(view, cv::IMREAD_UNCHANGED);
}

bool encode(const std::string& ending, const cv::Mat& pixels, std::vector<unsigned char>& bytes,
            const std::vector<int>& parameters) {
  return cv::imencode(ending, pixels, bytes, parameters);
}

class OpenCvDecoder : public VideoDecoder {
 public:
  bool open(const std::string& file) override {
    const std::vector<int> options{cv::CAP_PROP_HW_ACCELERATION, cv::VIDEO_ACCELERATION_NONE};
    // An absolute path is never taken for an address.
    if (!capture_.open(std::filesystem::absolute(file).lexically_normal().string(), cv::CAP_FFMPEG, options)) return false;
    capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 1);
    return true;
  }
  bool isOpen() const override { return capture_.isOpened(); }
  void close() override { capture_.release(); }
  bool seek(int picture) override { return capture_.set(cv::CAP_PROP_POS_FRAMES, picture); }
  bool grab() override { return capture_.grab(); }
  bool retrieve(cv::Mat& picture) override { return capture_.retrieve(picture); }
  double seconds() const override {
    constexpr double kMillisecond = 1e-3;  // s: OpenCV counts milliseconds
    return capture_.get(cv::CAP_PROP_POS_MSEC) * kMillisecond;
  }
  double width() const override { return capture_.get(cv::CAP_PROP_FRAME_WIDTH); }
  double height() const override { return capture_.get(cv::CAP_PROP_FRAME_HEIGHT); }
  double picturesPerSecond() const override { return capture_.get(cv::CAP_PROP_FPS); }
  int rotation() const override { return static_cast<int>(capture_.get(cv::CAP_PROP_ORIENTATION_META)); }

 private:
  cv::VideoCapture capture_;
};

class OpenCvEncoder : public VideoEncoder {
 public:
  bool open(const std::string& file, const char* codec, double picturesPerSecond, int width, int height) override {
    return writer_.open(file, cv::CAP_FFMPEG, cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]), picturesPerSecond,
                        cv::Size(width, height));
  }
  bool isOpen() const override { return writer_.isOpened(); }
  void write(const cv::Mat& picture) override { writer_.write(picture); }
  void close() override { writer_.release(); }

 private:
  cv::VideoWriter writer_;
};

std::unique_ptr<VideoDecoder> decoder() { return std::make_unique<OpenCvDecoder>(); }
std::unique_ptr<VideoEncoder> encoder() { return std::make_unique<OpenCvEncoder>(); }

}  // namespace
}  // namespace glint

extern "C" __attribute__((visibility("default"))) const glint::CodecTable* glint_codecs() {
  static constexpr glint::CodecTable table{GLINT_VERSION,  &glint::decode,  &glint::depthOfExr,
                                           &glint::encode, &glint::decoder, &glint::encoder};
  return &table;
}
