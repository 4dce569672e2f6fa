// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/limits.h"

#include <gmock/gmock.h>

#include <chrono>
#include <mutex>
#include <set>
#include <thread>

#include "core/base/atomic_file.h"
#include "core/base/json_text.h"
#include "core/base/memory.h"
#include "core/base/progress.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint {
namespace {
using namespace testing_support;
using testing::HasSubstr;
using testing::StartsWith;

/// A limit for one test; the value at the start comes back at its end.
class WithLimit {
 public:
  WithLimit(const std::string& name, double value) : name_(name) {
    setLimit(name_ + "=" + std::to_string(static_cast<long>(value)));
  }
  ~WithLimit() {
    for (const LimitInfo& info : limitInfos())
      if (info.name == name_) setLimit(name_ + "=" + std::to_string(static_cast<long>(info.standard)));
  }

 private:
  std::string name_;
};

TEST(Limits, AreNamedAndRaisedByName) {
  const std::string message = inputErrorOf([] { requireWithin(Limit::ImageMegapixels, 300, "a.png", "frames[0]"); });
  EXPECT_EQ(message, "a.png: frames[0]: contains 300 million pixels; the limit is 200 (--limit image.megapixels=300 raises it)");
  const WithLimit raised("image.megapixels", 300);
  EXPECT_NO_THROW(requireWithin(Limit::ImageMegapixels, 300, "a.png"));
  EXPECT_THROW(requireWithin(Limit::ImageMegapixels, 300.5, "a.png"), InputError);
}

TEST(Limits, WhatIsNoLimitOrNoNumberIsRefusedByName) {
  for (const char* text :
       {"image.megapixels", "image.megapixels=", "image.megapixels=x", "image.megapixels=-1", "image.megapixels=0",
        "image.megapixels=nan", "image.megapixels=inf", "image.megapixels=1,5", "pixels=3", "=3", ""})
    EXPECT_THAT(inputErrorOf([&] { setLimit(text); }), StartsWith(std::string("--limit ") + text)) << text;
  EXPECT_EQ(limitOf(Limit::ImageMegapixels), 200);
}

TEST(Limits, AJsonTextBeyondThemIsRefusedWithItsFile) {
  const WithLimit few("json.values", 10);
  EXPECT_THAT(inputErrorOf([] { JsonNode::parse("[1,2,3,4,5,6,7,8,9,10]", "a.json"); }),
              StartsWith("a.json: contains 11 values in a JSON text; the limit is 10"));
  EXPECT_NO_THROW(JsonNode::parse("[1,2,3,4,5,6,7,8,9]", "a.json"));
}

/// 40,000 lists in 120 kB of text: each takes some 80 bytes.
TEST(Limits, AJsonTextThatTakesMoreMemoryThanItIsLongIsRefused) {
  const auto listOf = [](const std::string& value, int n) {
    std::string text = "[";
    for (int i = 0; i < n; ++i) text += value + ",";
    return text + value + "]";
  };
  const WithLimit small("json.memory_megabytes", 1);
  const auto refusal =
      HasSubstr("a.json: contains 1 MB of values when it is read; the limit is 1 (--limit json.memory_megabytes=2");
  for (const char* value : {"[]", "\"\"", "{}", "{\"a\":0}", "\"a text of thirty-two letters ....\""})
    EXPECT_THAT(inputErrorOf([&] { JsonNode::parse(listOf(value, 40'000), "a.json"); }), refusal) << value;
  EXPECT_NO_THROW(JsonNode::parse(listOf("0", 40'000), "a.json")) << "numbers of contours take 16 bytes";
  EXPECT_NO_THROW(JsonNode::parse(listOf("[]", 4'000), "a.json"));
}

TEST(Limits, FramesThatTakeMuchMemoryAreWorkedOnOneByOne) {
  expectImages(100);  // million pixels: 2.4 GB each
  const auto threadsOf = [] {
    std::mutex mutex;
    std::set<std::thread::id> threads;
    parallelFor(
        16,
        [&](int) {
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
          const std::scoped_lock lock(mutex);
          threads.insert(std::this_thread::get_id());
        },
        {}, "test");
    return threads;
  };
  {
    const WithLimit little("image.memory_megabytes", 2400);
    EXPECT_EQ(imagesAtOnce(), 1);
    EXPECT_EQ(threadsOf(), std::set<std::thread::id>{std::this_thread::get_id()});
    EXPECT_NO_THROW(requireRoomForImage(100, "a.png"));
    EXPECT_EQ(
        inputErrorOf([] { requireRoomForImage(150, "a.png"); }),
        "a.png: contains 3600 MB of pixels while a frame is worked on; the limit is 2400 (--limit image.memory_megabytes=3600 "
        "raises it)");
  }
  const WithLimit more("image.memory_megabytes", 7300);
  EXPECT_EQ(imagesAtOnce(), 3);
  EXPECT_LE(threadsOf().size(), 3u);
}

TEST(Limits, AFileBeyondThemIsNotRead) {
  const TemporaryFolder folder;
  const auto file = folder.write("a.json", std::string(2'000'000, ' '));
  const WithLimit small("json.megabytes", 1);
  EXPECT_THAT(inputErrorOf([&] { readFile(file, Limit::JsonMegabytes); }),
              HasSubstr("a.json: contains 2 MB of JSON text; the limit is 1"));
}

TEST(Limits, ADeviceOrAPipeIsNoFile) {
  EXPECT_THAT(inputErrorOf([] { readFile("/dev/zero"); }), HasSubstr("is a device or a pipe"));
  const TemporaryFolder folder;
  const std::string pipe = (folder / "pipe").string();
  ASSERT_EQ(std::system(("mkfifo '" + pipe + "'").c_str()), 0);
  EXPECT_THAT(inputErrorOf([&] { readFile(pipe); }), HasSubstr("is a device or a pipe"));  // no writer: opening it must not wait
}

// Looking through all keys for each new one takes minutes here; a test's limit is the only clock.
TEST(JsonText, AnObjectOfManyKeysIsReadAndAsked) {
  constexpr int kKeys = 200'000;
  std::string text = "{";
  for (int i = 0; i < kKeys; ++i) text += (i ? ",\"k" : "\"k") + std::to_string(i) + "\":" + std::to_string(i);
  text += "}";
  const JsonNode root = JsonNode::parse(text, "a.json");
  long sum = 0;
  for (int i = 0; i < kKeys; ++i) sum += root.at("k" + std::to_string(i)).integer();
  EXPECT_EQ(sum, long(kKeys) * (kKeys - 1) / 2);
  EXPECT_FALSE(root.has("k200000"));
}

TEST(JsonText, AKeyThatStandsTwiceIsNamedWithItsPlace) {
  EXPECT_EQ(inputErrorOf([] { JsonNode::parse(R"({"a": {"b": 1, "c": 2, "b": 3}})", "s.json"); }), "s.json: a.b: duplicate key");
  EXPECT_NO_THROW(JsonNode::parse(R"({"a": {"b": 1}, "c": {"b": 2}})", "s.json"));
}

TEST(JsonText, DeepNestingIsRefused) {
  const std::string deep = std::string(101, '[') + std::string(101, ']');
  EXPECT_THAT(inputErrorOf([&] { JsonNode::parse(deep, "s.json"); }), HasSubstr("nested deeper than 100 levels"));
  EXPECT_NO_THROW(JsonNode::parse(deep.substr(1, 200), "s.json"));
}

}  // namespace
}  // namespace glint
