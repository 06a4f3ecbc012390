// Charts of the numbers of a table.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "svg.hpp"

namespace figures {

/// One bar; several may share a label, which then stands at the first only.
struct Bar {
  std::string label;
  double value;
  std::string number;  ///< as it stands in the table
  Paint paint = Paint::blue;
};

/// Horizontal bars from a base to the right. On a logarithmic axis, which a base above 0 makes, smaller
/// values go to the left.
struct BarChart {
  std::string title, axis;
  double base = 0;
  std::vector<double> ticks;
  double labels = 220;  ///< width of the labels, in pixels
  std::vector<Bar> bars;

  [[nodiscard]] std::string drawn() const {
    constexpr double width = 640, top = 44, row = 25;
    const double bottom = top + row * static_cast<double>(bars.size()) + 4;
    Drawing drawing(width, bottom + 56, title);
    drawing.words({width / 2, 24}, title, Anchor::middle, Paint::ink, true);
    const auto measure = [&](double value) { return base > 0 ? std::log10(value) : value; };
    double least = measure(base > 0 ? base : 0), most = least;
    for (const Bar& bar : bars)
      least = std::min(least, measure(bar.value)), most = std::max(most, measure(bar.value));
    for (const double tick : ticks)
      least = std::min(least, measure(tick)), most = std::max(most, measure(tick));
    const double left = labels + 12, right = width - 64;
    const auto at = [&](double value) {
      return left + (right - left) * (measure(value) - least) / (most - least);
    };
    for (const double tick : ticks) {
      drawing.line({at(tick), top - 6}, {at(tick), bottom}, Paint::gray,
                   tick == base ? Stroke::bold : Stroke::dashed);
      char text[32];
      std::snprintf(text, sizeof text, "%g", tick);
      drawing.words({at(tick), bottom + 20}, text, Anchor::middle);
    }
    drawing.words({(left + right) / 2, bottom + 44}, axis, Anchor::middle);
    double y = top;
    for (const Bar& bar : bars) {
      drawing.words({labels, y + 17}, bar.label, Anchor::end);
      const double from = std::min(at(base), at(bar.value)), to = std::max(at(base), at(bar.value));
      drawing.rectangle({from, y + 4}, to - from, row - 8, bar.paint, Fill::soft);
      drawing.words({to + 7, y + 17}, bar.number, Anchor::start, bar.paint);
      y += row;
    }
    return drawing.text();
  }
};

}  // namespace figures
