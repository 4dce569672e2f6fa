// SPDX-License-Identifier: BSD-3-Clause
// How long the user waits: from the start of the program to the first picture, and from a slider's movement to the overlay that
// follows from it. Drives the real window; measure_interface.py makes the scene and the display.

#include <QAbstractSlider>
#include <QApplication>
#include <QElapsedTimer>
#include <QThread>
#include <QTimer>
#include <algorithm>
#include <cstdio>
#include <deque>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "gui/base/memory_rules.h"
#include "gui/base/theme.h"
#include "gui/frame/frame_canvas.h"
#include "gui/window/main_window.h"

namespace {

using namespace glint;
using namespace glint::gui;

constexpr int kTickMs = 2;
constexpr int kEveryMs = 100;  // a hand that drags: ten positions a second, whether the window keeps up or not
constexpr int kGiveUpMs = 60'000;

/// Tells when a widget has been painted and what the event that asked for it did is on the screen, the window's composition with
/// it.
class App : public QApplication {
 public:
  App(int& argc, char** argv) : QApplication(argc, argv) {}
  bool notify(QObject* receiver, QEvent* event) override {
    if (QThread::currentThread() != thread()) return QApplication::notify(receiver, event);
    paints_ += receiver == watched && event->type() == QEvent::Paint;
    ++depth_;
    const bool done = QApplication::notify(receiver, event);
    if (--depth_ == 0 && std::exchange(paints_, 0) > 0) painted();
    return done;
  }
  QObject* watched = nullptr;
  std::function<void()> painted = [] {};

 private:
  int depth_ = 0, paints_ = 0;
};

double quantile(std::vector<double> v, double q) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[std::min(v.size() - 1, std::size_t(q * double(v.size())))];
}

template <class Condition>
bool waitFor(Condition done, int ms = kGiveUpMs) {
  QElapsedTimer clock;
  clock.start();
  // Qt's processEvents with a time limit does not wait, and a loop that spins takes time from the program.
  QTimer tick;
  tick.setTimerType(Qt::PreciseTimer);
  tick.start(kTickMs);
  while (!done() && clock.elapsed() < ms) QCoreApplication::processEvents(QEventLoop::WaitForMoreEvents);
  return done();
}

/// Positions whose overlay is not painted yet, and how long others waited, ms.
struct Waits {
  std::deque<std::pair<double, InspectionRequest>> waiting;
  std::vector<double> latencies;

  void painted(const std::shared_ptr<const Inspection>& shown, double now) {
    std::size_t answered = waiting.size();
    while (answered > 0 && !(shown && waiting[answered - 1].second == shown->request)) --answered;
    for (; answered > 0; --answered) {
      latencies.push_back(now - waiting.front().first);
      waiting.pop_front();
    }
  }
};
struct Latencies {
  std::vector<double> first;  ///< to the first overlay that follows from the position: the observed contour where that changes
  std::vector<double> all;    ///< to the overlays of every model
};

/// Moves a slider on a clock of its own and notes when the overlays of each position, or of a later one, have been painted.
Latencies drag(App& app, MainWindow& window, QAbstractSlider& slider, int events) {
  Document& document = window.document();
  QElapsedTimer clock;
  clock.start();
  Waits first, all;
  app.painted = [&] {
    const double now = double(clock.nsecsElapsed()) * 1e-6;
    first.painted(document.frameInspection(), now);
    all.painted(document.results(), now);
  };
  const int low = slider.minimum(), span = slider.maximum() - low;
  slider.setSliderDown(true);
  for (int i = 0; i < events; ++i) {
    const double due = double(i + 1) * kEveryMs;
    waitFor([&] { return double(clock.nsecsElapsed()) * 1e-6 >= due; });
    // The wait counts from when the hand moved, not from when the window found time to notice.
    const InspectionRequest before = document.request();
    slider.setSliderPosition(low + int(span * (0.25 + 0.5 * double((i * 37) % 101) / 100)));
    if (document.request() == before) continue;
    first.waiting.emplace_back(due, document.request());
    all.waiting.emplace_back(due, document.request());
  }
  waitFor([&] { return first.waiting.empty() && all.waiting.empty(); });
  slider.setSliderDown(false);
  app.painted = [] {};
  const bool lost = !first.waiting.empty() || !all.waiting.empty();
  waitFor([&] { return window.idle(); });
  return lost ? Latencies{} : Latencies{first.latencies, all.latencies};
}

int run(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("bench_inspector SESSION [EVENTS SLIDER...]   slider: object name, e.g. slider:predict.directions\n", stderr);
    return 2;
  }
  QElapsedTimer clock;
  clock.start();
  int qtArgc = 1;
  App app(qtArgc, argv);
  QApplication::setOrganizationName(QStringLiteral("Glint"));
  QApplication::setApplicationName(QStringLiteral("bench_inspector"));
  applyTheme(app, Theme::Dark);
  MainWindow window(coreEngine());
  window.setTheme(Theme::Dark);
  window.show();
  auto* canvas = window.findChild<FrameCanvas*>(QStringLiteral("frameCanvas"));
  double photograph = -1, overlay = -1;
  app.watched = canvas;
  app.painted = [&] {
    const double now = double(clock.nsecsElapsed()) * 1e-6;
    if (photograph < 0 && canvas->hasPicture()) photograph = now;
    if (overlay < 0 && canvas->hasPicture() && window.document().frameInspection()) overlay = now;
  };
  window.open(QString::fromLocal8Bit(argv[1]));
  waitFor([&] { return overlay >= 0; });
  waitFor([&] { return window.idle(); });
  const double quiet = double(clock.nsecsElapsed()) * 1e-6;
  app.painted = [] {};
  if (overlay < 0) {
    std::fprintf(stderr, "bench_inspector: no overlay: %s\n", window.lastError().toUtf8().constData());
    return 1;
  }
  std::printf("{\"first_photograph_ms\": %.1f, \"first_overlay_ms\": %.1f, \"everything_ms\": %.1f, \"sliders\": {", photograph,
              overlay, quiet);
  const int events = argc > 2 ? std::max(1, std::atoi(argv[2])) : 0;
  for (int i = 3; i < argc; ++i) {
    auto* slider = window.findChild<QAbstractSlider*>(QString::fromLocal8Bit(argv[i]));
    if (!slider) {
      std::fprintf(stderr, "bench_inspector: no slider %s\n", argv[i]);
      return 2;
    }
    const Latencies ms = drag(app, window, *slider, events);
    std::printf(
        "%s\"%s\": {\"answered\": %zu, \"median_ms\": %.1f, \"p95_ms\": %.1f, \"max_ms\": %.1f, \"all_median_ms\": %.1f, "
        "\"all_p95_ms\": %.1f}",
        i > 3 ? ", " : "", argv[i], ms.first.size(), quantile(ms.first, 0.5), quantile(ms.first, 0.95), quantile(ms.first, 1),
        quantile(ms.all, 0.5), quantile(ms.all, 0.95));
    std::fflush(stdout);
  }
  std::puts("}}");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    applyMemoryRules();
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_inspector: %s\n", e.what());
    return 2;
  }
}
