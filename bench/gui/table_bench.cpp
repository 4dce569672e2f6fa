// SPDX-License-Identifier: BSD-3-Clause
// How long the table of errors and the scatter plot take with many rows: filling, searching, sorting, drawing. Without a display
//   of its own: QT_QPA_PLATFORM=offscreen build/release/bin/bench_table
#include <benchmark/benchmark.h>

#include <QApplication>
#include <cmath>

#include "core/draw/plot_view.h"
#include "core/draw/scatter_plot.h"
#include "gui/panels/error_model.h"
#include "gui/panels/row_filter.h"
#include "viz/canvas.h"

namespace {

using namespace glint;
using namespace glint::gui;

/// 2000 frames and five models, one observed and one predicted circle of 72 points each.
std::shared_ptr<const Inspection> manyRows(const std::shared_ptr<Scene>& scene, const InspectionRequest& request) {
  constexpr int kFrames = 2000;
  Polyline circle;
  for (int i = 0; i < 72; ++i) circle.points.push_back(10 * Pixel(std::cos(i * M_PI / 36), std::sin(i * M_PI / 36)));
  auto in = std::make_shared<Inspection>();
  for (int f = 0; f < kFrames; ++f) {
    Frame frame;
    frame.id = "frame" + std::to_string(f);
    scene->frames.push_back(frame);
    FrameEvidence e;
    e.frame = f;
    e.highlights.resize(1);
    e.highlights[0].light = "lamp";
    e.highlights[0].contour = circle;
    in->evidence.push_back(std::move(e));
  }
  in->scene = in->given = scene;
  in->request = request;
  in->train = parseTrainSpec(request.train, *scene);
  for (const std::string& name : request.models) {
    ModelResult& model = in->models[name];
    model.model = name;
    for (int f = 0; f < kFrames; ++f) {
      FrameComparison c;
      c.frame = f;
      c.light = "lamp";
      PredictedHighlight p;
      p.contour = circle;
      p.brightest.point = {{0, 0, 1}, {0, 0, -1}, -1, {0, 0}};
      c.prediction = std::vector{p};
      ContourMetrics m;
      m.contourErrorPct = 0.01 * ((f * 37) % 1000);
      c.rows.push_back({0, 0, m, {}, {}});
      model.frames.push_back(std::move(c));
    }
  }
  return in;
}

struct Filled {
  Filled() : document(parseTrainSpec) {
    auto scene = std::make_shared<Scene>();
    Opened opened;
    inspection = manyRows(scene, opened.request);
    opened.scene = scene;
    document.open(opened);
    document.setInspection(inspection, document.request());
  }
  std::shared_ptr<const Inspection> inspection;
  Document document;
};

/// The table of all rows, without its widgets.
struct FilledTable : Filled {
  FilledTable() : model(document) { document.setInspection(inspection, document.request()); }
  ErrorModel model;
  RowFilter filter{model};
};

void rowsOfAnEvaluation(benchmark::State& state) {
  const Filled filled;
  for (auto _ : state) benchmark::DoNotOptimize(highlightRows(*filled.inspection));
  state.counters["rows"] = double(filled.document.rows()->size());
}

void firstSearch(benchmark::State& state) {
  Filled filled;
  for (auto _ : state) {
    state.PauseTiming();
    ErrorModel model(filled.document);
    filled.document.setInspection(filled.inspection, filled.document.request());
    RowFilter filter(model);
    state.ResumeTiming();
    filter.setSearch(QStringLiteral("canonical 19"));
    benchmark::DoNotOptimize(filter.rowCount());
  }
}

void nextLetter(benchmark::State& state) {
  FilledTable table;
  bool longer = false;
  for (auto _ : state) {
    table.filter.setSearch((longer = !longer) ? QStringLiteral("canonical 19") : QStringLiteral("canonical 1"));
    benchmark::DoNotOptimize(table.filter.rowCount());
  }
}

void sortByError(benchmark::State& state) {
  FilledTable table;
  bool up = false;
  for (auto _ : state) table.filter.sort(ErrorModel::ErrorPct, (up = !up) ? Qt::AscendingOrder : Qt::DescendingOrder);
}

void scatterOfAll(benchmark::State& state) {
  const Filled filled;
  draw::PlotView view;
  for (auto _ : state) {
    view.show(draw::scatterPlot(*filled.inspection, *filled.document.rows(), {RowValue::Frame, RowValue::ErrorPct}).plot);
    viz::Canvas canvas(1000, 400, draw::kDarkBackground);
    view.paint(canvas, 1000, 400);
  }
}

BENCHMARK(rowsOfAnEvaluation)->Unit(benchmark::kMillisecond);
BENCHMARK(firstSearch)->Unit(benchmark::kMillisecond);
BENCHMARK(nextLetter)->Unit(benchmark::kMillisecond);
BENCHMARK(sortByError)->Unit(benchmark::kMillisecond);
BENCHMARK(scatterOfAll)->Unit(benchmark::kMillisecond);

}  // namespace

int main(int argc, char** argv) {
  QApplication app(argc, argv);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
