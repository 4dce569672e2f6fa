// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/scatter_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/draw/plot_text.h"

namespace glint::draw {
namespace {

constexpr Colour kNotBrushed{0.5, 0.5, 0.5};  // stays behind on both backgrounds
// From Okabe and Ito's palette: told apart by all eyes. Lights beyond these share colours; the tool tip names them.
constexpr Colour kLights[] = {{0.90, 0.62, 0.00}, {0.34, 0.71, 0.91}, {0.00, 0.62, 0.45},
                              {0.80, 0.47, 0.65}, {0.84, 0.37, 0.00}, {0.00, 0.45, 0.70}};

Colour colourOf(RowStatus status) {
  switch (status) {
    case RowStatus::Ok: return {0.00, 0.62, 0.45};
    case RowStatus::FarOff: return {0.90, 0.62, 0.00};
    case RowStatus::Poor: return {0.60, 0.58, 0.20};
    case RowStatus::Missed: return kFailed;
    case RowStatus::Spurious: return {0.80, 0.47, 0.65};
    default: return {0.34, 0.71, 0.91};
  }
}

Colour colourOf(RowRole role) {
  return role == RowRole::Training ? kTraining : role == RowRole::HeldOut ? Colour{0.90, 0.62, 0.00} : kExcluded;
}

/// The name of a row's series, and what it is sorted by.
std::pair<int, std::string> classOf(const HighlightRow& row, ScatterColour by) {
  switch (by) {
    case ScatterColour::Model: break;
    case ScatterColour::Role: return {int(row.role), nameOf(row.role)};
    case ScatterColour::Light: return {0, row.light.empty() ? "light unknown" : lightName(row.light)};
    case ScatterColour::Status: return {int(row.status), nameOf(row.status)};
  }
  return {0, row.model};
}

std::string figure(double value, const RowColumn& column) { return formatted("%.*f", column.decimals, value); }

std::string labelOf(const Inspection& inspection, const HighlightRow& row, RowValue x, RowValue y) {
  std::string label = "frame " + frameName(inspection, row.frame) + " (" + nameOf(row.role) + "), " + row.place + "\n" +
                      row.model + ": " + nameOf(row.status);
  for (const RowValue v : {y, x})
    label += std::string("\n") + columnOf(v).title + ": " +
             (std::isfinite(row.value(v)) ? figure(row.value(v), columnOf(v)) : std::string("no value"));
  if (!row.reason.empty()) label += "\n" + row.reason;
  return label;
}

/// "8 missed, 2 refused"
std::string counted(const std::map<RowStatus, int>& counts) {
  std::string text;
  for (const auto& [status, count] : counts) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + nameOf(status);
  return text;
}

class Maker {
 public:
  Maker(const Inspection& inspection, const ScatterOptions& options) : in_(inspection), options_(options) {}
  void add(const HighlightRow& row, int index);
  ScatterPlot finish(const std::vector<HighlightRow>& rows);

 private:
  bool positive(const HighlightRow& row) const {
    return (!options_.logX || row.value(options_.x) > 0) && (!options_.logY || row.value(options_.y) > 0);
  }
  struct Group {
    PlotSeries series;
    std::vector<int> rows;
  };
  const Inspection& in_;
  const ScatterOptions& options_;
  Group dim_, none_;
  std::map<std::pair<int, std::string>, Group> classes_;
  std::vector<std::pair<int, std::string>> order_;
  std::map<RowStatus, int> without_;
  int shown_ = 0, notPositive_ = 0;
};

void Maker::add(const HighlightRow& row, int index) {
  PlotPoint p;
  p.x = row.value(options_.x);
  p.y = row.value(options_.y);
  p.hollow = row.status != RowStatus::Ok && row.status != RowStatus::FarOff && row.status != RowStatus::Poor;
  p.target = {row.frame, row.model, row.light, row.observed, {}, -1};
  p.label = labelOf(in_, row, options_.x, options_.y);
  Group* group = &none_;
  if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
    ++without_[row.status];
    p.x = p.y = std::nan("");
  } else if (!positive(row)) {
    ++notPositive_;
    p.x = p.y = std::nan("");
  } else {
    ++shown_;
    const std::pair<int, std::string> key = classOf(row, options_.colour);
    if (!classes_.count(key)) order_.push_back(key);
    group = &classes_[key];
    if (!options_.brushed.empty() && !options_.brushed.count(keyOf(row))) group = &dim_;
  }
  group->series.points.push_back(std::move(p));
  group->rows.push_back(index);
}

ScatterPlot Maker::finish(const std::vector<HighlightRow>& rows) {
  const RowColumn &x = columnOf(options_.x), &y = columnOf(options_.y);
  ScatterPlot out;
  PlotData& plot = out.plot;
  plot.id = "scatter";
  plot.title = std::string(y.title) + " against " + x.title;
  plot.x.title = x.axis;
  plot.y.title = y.axis;
  plot.x.log = options_.logX;
  plot.y.log = options_.logY;
  plot.remarks.push_back(std::to_string(shown_) + " of " + std::to_string(rows.size()) + " highlights");
  if (!without_.empty()) plot.remarks.push_back("no value: " + counted(without_));
  if (notPositive_ > 0)
    plot.remarks.push_back(std::to_string(notPositive_) + " not above 0, which a logarithmic axis cannot show");
  if (!options_.brushed.empty()) {
    const auto in =
        std::count_if(rows.begin(), rows.end(), [&](const HighlightRow& r) { return options_.brushed.count(keyOf(r)) > 0; });
    plot.remarks.push_back(std::to_string(in) + " brushed");
  }
  if (options_.colour != ScatterColour::Model) std::sort(order_.begin(), order_.end());
  int light = 0;
  const auto take = [&](Group group, const std::string& name, const Colour& colour, bool inLegend) {
    PlotSeries& s = group.series;
    s.name = name;
    s.colour = colour;
    s.shape = PlotShape::Points;
    s.pointSize = rows.size() <= 400 ? 7 : 5;
    s.inLegend = inLegend;
    plot.series.push_back(std::move(s));
    out.rows.push_back(std::move(group.rows));
  };
  if (!dim_.rows.empty()) take(std::move(dim_), "not brushed", kNotBrushed, true);
  for (const auto& key : order_) {
    Group& group = classes_[key];
    const auto model = options_.colour == ScatterColour::Model ? in_.models.find(key.second) : in_.models.end();
    const PlotSeries ofModel = modelSeries(key.second, model != in_.models.end() && isPoor(model->second), PlotShape::Points);
    const Colour colour = options_.colour == ScatterColour::Model    ? ofModel.colour
                          : options_.colour == ScatterColour::Role   ? colourOf(RowRole(key.first))
                          : options_.colour == ScatterColour::Status ? colourOf(RowStatus(key.first))
                                                                     : kLights[std::size_t(light++) % std::size(kLights)];
    if (!group.rows.empty()) take(std::move(group), ofModel.name, colour, true);
  }
  if (shown_ == 0) plot.empty = "No highlight has both values";
  if (!none_.rows.empty()) take(std::move(none_), "no value", kNotBrushed, false);
  for (auto& [axis, log] : {std::pair<PlotAxis&, bool>(plot.x, options_.logX), std::pair<PlotAxis&, bool>(plot.y, options_.logY)})
    if (log) axis.floor = std::numeric_limits<double>::min();  // nothing below 0 is among the points
  return out;
}

}  // namespace

const std::vector<ScatterColourKind>& scatterColours() {
  static const std::vector<ScatterColourKind> all{{ScatterColour::Model, "model", "model"},
                                                  {ScatterColour::Role, "role", "role"},
                                                  {ScatterColour::Light, "light", "light"},
                                                  {ScatterColour::Status, "status", "status"}};
  return all;
}

int ScatterPlot::rowOf(const PlotSample& sample) const {
  if (sample.series < 0 || sample.series >= int(rows.size())) return -1;
  const std::vector<int>& all = rows[std::size_t(sample.series)];
  return sample.point < 0 || sample.point >= int(all.size()) ? -1 : all[std::size_t(sample.point)];
}

ScatterPlot scatterPlot(const Inspection& inspection, const std::vector<HighlightRow>& rows, const ScatterOptions& options) {
  Maker maker(inspection, options);
  for (std::size_t i = 0; i < rows.size(); ++i) maker.add(rows[i], int(i));
  ScatterPlot out = maker.finish(rows);
  if (rows.empty()) out.plot.empty = "No results yet";
  return out;
}

}  // namespace glint::draw
