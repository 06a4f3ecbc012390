// Charts of the numbers of a table.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <stdexcept>
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
  std::vector<Bar> bars;

  [[nodiscard]] std::string drawn() const {
    constexpr double width = 640, top = 44, row = 25;
    const double bottom = top + row * static_cast<double>(bars.size()) + 4;
    Drawing drawing(width, bottom + 56, title);
    drawing.words({width / 2, 24}, title, Anchor::middle, Paint::ink, true);
    const auto measure = [&](double value) { return base > 0 ? std::log10(value) : value; };
    // A letter is 10 pixels wide or less.
    double labels = 0, longest = 0, numbers = 50;
    for (const Bar& bar : bars) {
      labels = std::max(labels, 10.0 * static_cast<double>(bar.label.size()));
      if (bar.value < longest) continue;
      longest = bar.value, numbers = std::max(50.0, 10.0 * static_cast<double>(bar.number.size()));
    }
    double least = measure(base > 0 ? base : 0), most = least;
    for (const Bar& bar : bars)
      least = std::min(least, measure(bar.value)), most = std::max(most, measure(bar.value));
    for (const double tick : ticks)
      least = std::min(least, measure(tick)), most = std::max(most, measure(tick));
    const double left = labels + 12, right = width - numbers - 14;
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
    drawing.words({width / 2, bottom + 44}, axis, Anchor::middle);
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

/// Points that are joined, and words of their color.
struct Series {
  std::string words;
  std::vector<Place> points;
  Paint paint;
};

/// Lines on two logarithmic axes. drawn() throws std::logic_error if a point is outside of them.
struct LineChart {
  std::string title, to_the_right, upwards;
  std::vector<double> ticks_right, ticks_up;
  std::vector<Series> series;
  bool has_legend = false;  ///< true: words at the lower left; false: at the last point of each series

  [[nodiscard]] std::string drawn() const {
    constexpr double width = 640, height = 440, left = 76, right = width - 24, top = 68, bottom = height - 70;
    Drawing drawing(width, height, title);
    drawing.words({width / 2, 24}, title, Anchor::middle, Paint::ink, true);
    drawing.words({8, 50}, upwards);
    drawing.words({(left + right) / 2, height - 14}, to_the_right, Anchor::middle);
    const auto share = [](double value, const std::vector<double>& ticks) {
      return std::log(value / ticks.front()) / std::log(ticks.back() / ticks.front());
    };
    const auto at = [&](const Place& point) {
      return Place{left + (right - left) * share(point.x, ticks_right),
                   bottom - (bottom - top) * share(point.y, ticks_up)};
    };
    const auto number = [](double value) {
      char text[32];
      std::snprintf(text, sizeof text, "%.10g", value);
      return std::string(text);
    };
    for (const double tick : ticks_right) {
      const double x = at({tick, 1}).x;
      drawing.line({x, top}, {x, bottom}, Paint::gray, Stroke::dashed);
      drawing.words({x, bottom + 22}, number(tick),
                    tick == ticks_right.back() ? Anchor::end : Anchor::middle);
    }
    for (const double tick : ticks_up) {
      const double y = at({1, tick}).y;
      drawing.line({left, y}, {right, y}, Paint::gray, Stroke::dashed);
      drawing.words({left - 8, y + 6}, number(tick), Anchor::end);
    }
    double legend = bottom - 22.0 * static_cast<double>(series.size()) + 10;
    for (const auto& [words, points, paint] : series) {
      std::vector<Place> places;
      for (const Place& point : points) {
        if (point.x < ticks_right.front() || ticks_right.back() < point.x || point.y < ticks_up.front() ||
            ticks_up.back() < point.y)
          throw std::logic_error(title + ": a point of " + words + " is outside of the axes");
        places.push_back(at(point));
      }
      drawing.polyline(places, paint, Stroke::bold);
      for (const Place& place : places) drawing.circle(place, 4, paint, Fill::full);
      if (has_legend) {
        drawing.words({left + 12, legend}, words, Anchor::start, paint);
        legend += 22;
        continue;
      }
      const Place& last = places.back();
      const bool is_far_right = last.x > width / 2;
      drawing.words({last.x + (is_far_right ? -10 : 10), last.y - (is_far_right ? 12 : 0)}, words,
                    is_far_right ? Anchor::end : Anchor::start, paint);
    }
    return drawing.text();
  }
};

}  // namespace figures
