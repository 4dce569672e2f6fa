// SPDX-License-Identifier: BSD-3-Clause
#include "gui/base/decoded_frames.h"

#include <QThread>
#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

#include "tests/gui/fixture.h"

namespace glint::gui {

namespace {
constexpr int kSide = 16, kBytes = kSide * kSide * int(sizeof(float));  // of an image of these tests
constexpr FrameSource kPhotograph = FrameSource::Image;

FramePictures ofFiles() { return {std::make_shared<const Scene>()}; }
/// Results that look as if a what-if rendered them; their content does not matter.
FramePictures rendered(const FramePictures& files, const QString& key) {
  FramePictures pictures = files;
  pictures.key = key;
  pictures.synthesis = std::make_shared<const Inspection>();
  return pictures;
}
}  // namespace

class DecodedFramesTest : public QObject {
  Q_OBJECT
 private slots:
  void init() { decodings_ = 0; }

  void aFrameIsDecodedOnceForAll() {
    DecodedFrames frames(100 * kBytes, decode());
    const FramePictures files = ofFiles();
    QVERIFY(!frames.find(files, 3, kPhotograph));
    const DecodedFrames::Held view = *frames.whole(files, 3, kPhotograph);
    QCOMPARE(view->at(0, 0), 3.f);
    QCOMPARE(*frames.whole(files, 3, kPhotograph), view);
    QCOMPARE(*frames.part(files, 3, kPhotograph, 4), view);
    QCOMPARE(frames.find(files, 3, kPhotograph), view);
    QCOMPARE(decodings_.load(), 1);
    // Another source, frame, scene: another picture.
    QVERIFY(*frames.whole(files, 3, FrameSource::Radiance) != view);
    QVERIFY(*frames.whole(files, 4, kPhotograph) != view);
    QVERIFY(*frames.whole(ofFiles(), 3, kPhotograph) != view);
    QCOMPARE(decodings_.load(), 4);
  }

  void theLimitHoldsAndWhatWasLookedAtLongestAgoGoesFirst() {
    DecodedFrames frames(4 * kBytes, decode());
    const FramePictures files = ofFiles();
    for (int frame = 0; frame < 10; ++frame) {
      QVERIFY(frames.whole(files, frame, kPhotograph));
      QVERIFY(frames.find(files, 0, kPhotograph));  // is looked at again and again
      QVERIFY(frames.bytes() <= 4 * kBytes);
    }
    for (int frame = 0; frame < 10; ++frame) QCOMPARE(frames.find(files, frame, kPhotograph) != nullptr, frame == 0 || frame > 6);
    DecodedFrames small(kBytes - 1, decode());
    QVERIFY(small.whole(files, 0, kPhotograph));
    QCOMPARE(small.bytes(), 0);
  }

  void thumbnailsOfManyFramesPushNothingOut() {
    DecodedFrames frames(8 * kBytes, decode());
    const FramePictures files = ofFiles();
    for (int frame = 0; frame < 20; ++frame) QVERIFY(frames.part(files, frame, kPhotograph, 4));
    QCOMPARE(frames.bytes(), 2 * kBytes);  // a quarter
    for (int frame = 20; frame < 28; ++frame) QVERIFY(frames.whole(files, frame, kPhotograph));
    for (int frame = 0; frame < 20; ++frame) QVERIFY(frames.part(files, frame, kPhotograph, 4));
    for (int frame = 20; frame < 28; ++frame) QVERIFY(frames.find(files, frame, kPhotograph));
  }

  void picturesOfAnotherWhatIfAndOfASceneThatIsGoneMakeRoom() {
    DecodedFrames frames(100 * kBytes, decode());
    FramePictures files = ofFiles();
    QVERIFY(frames.whole(files, 0, kPhotograph) && frames.whole(rendered(files, "lamp left"), 0, kPhotograph));
    QCOMPARE(frames.bytes(), 2 * kBytes);
    QVERIFY(frames.whole(rendered(files, "lamp right"), 0, kPhotograph));
    QCOMPARE(frames.bytes(), 2 * kBytes);
    QVERIFY(frames.find(files, 0, kPhotograph));  // for when the what-if is put back
    files = ofFiles();
    QVERIFY(frames.whole(files, 0, kPhotograph));
    QCOMPARE(frames.bytes(), kBytes);
  }

  void aFewRenderedPixelsAreNotTakenForTheWhole() {
    DecodedFrames frames(100 * kBytes, decode());
    const FramePictures pictures = rendered(ofFiles(), "lamp left");
    QCOMPARE((*frames.part(pictures, 0, kPhotograph, 4))->width, kSide / 4);
    QCOMPARE(frames.bytes(), 0);
    QCOMPARE((*frames.whole(pictures, 0, kPhotograph))->width, kSide);
    QCOMPARE((*frames.part(pictures, 0, kPhotograph, 4))->width, kSide);
  }

  void failuresAreNotKeptAndStoppingLetsTheOthersGoOn() {
    std::atomic<int> how{0};
    DecodedFrames frames(100 * kBytes, [&](const FramePictures&, int, FrameSource, int, const ProgressFn&) -> Outcome<Image> {
      if (how == 0) return Failure{Reason::FrameUnreadable, "cut off"};
      if (how == 1) throw std::runtime_error("no memory");
      if (how == 2) throw Stopped{};
      return Image(kSide, kSide, 1);
    });
    const FramePictures files = ofFiles();
    QVERIFY(frames.whole(files, 0, kPhotograph).failure().reason == Reason::FrameUnreadable);
    QVERIFY(!frames.part(files, 0, kPhotograph, 1));
    how = 1;
    QVERIFY_EXCEPTION_THROWN(static_cast<void>(frames.whole(files, 0, kPhotograph)), std::runtime_error);
    how = 2;
    QVERIFY_EXCEPTION_THROWN(static_cast<void>(frames.whole(files, 0, kPhotograph)), Stopped);
    how = 3;
    QVERIFY(frames.part(files, 0, kPhotograph, 1));  // would wait for ever for one that is still under way
  }

  /// The thumbnail of a frame that is being read for a view waits for it; a view waits for no thumbnail.
  void twoThreadsReadAFileOnceWhereTheViewComesFirst() {
    std::atomic<bool> goOn{false};
    std::atomic<int> begun{0};
    DecodedFrames frames(100 * kBytes, [&](const FramePictures&, int, FrameSource, int, const ProgressFn&) -> Outcome<Image> {
      ++begun;
      while (!goOn) QThread::msleep(1);
      return Image(kSide, kSide, 1);
    });
    const FramePictures files = ofFiles();
    DecodedFrames::Held view, thumbnail;
    std::thread first([&] { view = *frames.whole(files, 0, kPhotograph); });
    while (begun < 1) QThread::msleep(1);
    std::thread second([&] { thumbnail = *frames.part(files, 0, kPhotograph, 4); });
    QThread::msleep(30);
    const int whileItWaits = begun;
    goOn = true;
    first.join();
    second.join();
    QCOMPARE(whileItWaits, 1);
    QCOMPARE(thumbnail, view);
    goOn = false;
    std::thread small([&] { thumbnail = *frames.part(files, 1, kPhotograph, 4); });
    while (begun < 2) QThread::msleep(1);
    std::thread large([&] { view = *frames.whole(files, 1, kPhotograph); });
    while (begun < 3) QThread::msleep(1);
    goOn = true;
    small.join();
    large.join();
    QCOMPARE(begun.load(), 3);
  }

  /// For the thread sanitizer.
  void severalThreadsAtOnce() {
    DecodedFrames frames(6 * kBytes, decode());
    const std::vector<FramePictures> scenes{ofFiles(), ofFiles()};
    std::atomic<int> wrong{0};
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&, t] {
        for (int i = 0; i < 200; ++i) {
          const FramePictures& of = scenes[std::size_t((i + t) % 2)];
          const int frame = (7 * i + t) % 9;
          const Outcome<DecodedFrames::Held> got =
              t % 2 ? frames.part(of, frame, kPhotograph, 2) : frames.whole(of, frame, kPhotograph);
          wrong += !got || (*got)->at(kSide - 1, kSide - 1) != float(frame);
          const DecodedFrames::Held found = frames.find(of, frame, kPhotograph);
          wrong += found && found->at(0, 0) != float(frame);
        }
      });
    for (std::thread& thread : threads) thread.join();
    QCOMPARE(wrong.load(), 0);
    QVERIFY(frames.bytes() <= 6 * kBytes);
  }

 private:
  /// Images that tell of which frame they are, counted.
  DecodedFrames::Decode decode() {
    return [this](const FramePictures&, int frame, FrameSource, int every, const ProgressFn&) -> Outcome<Image> {
      ++decodings_;
      return Image(kSide / every, kSide / every, 1, float(frame));
    };
  }
  std::atomic<int> decodings_{0};
};

QObject* makeDecodedFramesTest() { return new DecodedFramesTest; }

}  // namespace glint::gui

#include "decoded_frames_test.moc"
