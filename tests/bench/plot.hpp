// A figure of scatter plots as an SVG file: time to the right, error upwards, both logarithmic.
#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "support.hpp"

namespace bench {

/// Time and error. On the Pareto front of several are those that none beats in one without losing in the
/// other.
struct Measure {
  double time, error;
};
inline bool is_on_front(const Measure& point, const std::vector<Measure>& all) {
  return std::none_of(all.begin(), all.end(), [&](const Measure& other) {
    return other.time <= point.time && other.error <= point.error &&
           (other.time < point.time || other.error < point.error);
  });
}

struct Point {
  Measure measure;
  std::string label;  ///< text beside it; empty: none
  bool ours = false;  ///< the library's own, in another color
};

/// One scatter plot. Points on the Pareto front are filled and joined; an error of 0, which no logarithm
/// reaches, has a line of its own at the foot.
struct Plot {
  std::string title, time_axis, error_axis;
  std::vector<Point> points;
};

namespace detail {

/// Logarithmic axis over some length in pixels, a little longer than its values need.
class Axis {
 public:
  Axis(const std::vector<double>& values, double start, double end) : start_(start), end_(end) {
    const auto [min, max] = std::minmax_element(values.begin(), values.end());
    const double low = std::log10(*min), high = std::log10(*max), margin = 0.06 * (high - low) + 0.05;
    first_ = low - margin;
    last_ = high + margin;
  }

  [[nodiscard]] double at(double value) const {
    return start_ + (end_ - start_) * (std::log10(value) - first_) / (last_ - first_);
  }

  /// Returns the powers of ten, and on a short axis 2 and 5 times them.
  [[nodiscard]] std::vector<double> ticks() const {
    std::vector<double> all;
    for (int power = static_cast<int>(std::floor(first_)); power <= last_; ++power)
      for (const double factor : {1, 2, 5})
        if (const double tick = factor * std::pow(10, power);
            (factor == 1 || last_ - first_ < 2) && first_ <= std::log10(tick) && std::log10(tick) <= last_)
          all.push_back(tick);
    return all;
  }

 private:
  double first_, last_, start_, end_;
};

/// Draws one plot into a box whose left edge is at x.
class Panel {
 public:
  static constexpr double width = 400, height = 360;

  Panel(std::ostream& svg, const Plot& plot, double x)
      : svg_(svg),
        plot_(plot),
        left_(x + 76),
        right_(x + width - 24),
        time_(times(plot), left_, right_),
        error_(errors(plot), has_zero(plot) ? zero - 34 : zero, top) {}

  void draw() const {
    frame();
    std::vector<Measure> all, front;
    for (const Point& point : plot_.points) all.push_back(point.measure);
    std::copy_if(all.begin(), all.end(), std::back_inserter(front),
                 [&](const Measure& measure) { return is_on_front(measure, all); });
    std::sort(front.begin(), front.end(), [](auto& a, auto& b) { return a.time < b.time; });
    svg_ << "<polyline class=\"front\" points=\"";
    for (const Measure& measure : front) svg_ << time_.at(measure.time) << ',' << height_of(measure) << ' ';
    svg_ << "\"/>\n";
    bool above = true;  // labels in turns above and below, since neighbors would overlap
    int at_zero = 0;    // labels there are stacked
    for (const Point& point : plot_.points) {
      const double x = time_.at(point.measure.time), y = height_of(point.measure);
      const bool near_the_edge = x > right_ - 90;
      svg_ << "<circle class=\"" << (point.ours ? "ours" : "theirs")
           << (is_on_front(point.measure, all) ? " on" : "") << "\" cx=\"" << x << "\" cy=\"" << y
           << "\" r=\"4\"/>";
      if (!point.label.empty())
        text(x + (near_the_edge ? -8 : 8),
             point.measure.error > 0 ? (above ? y - 6 : y + 14) : y - 6 - 14 * at_zero++,
             near_the_edge ? "end" : "start", point.label);
      above = !above;
      svg_ << '\n';
    }
  }

 private:
  static constexpr double top = 40, zero = height - 50;  // heights of the frame's top and foot

  static bool has_zero(const Plot& plot) {
    return std::any_of(plot.points.begin(), plot.points.end(),
                       [](const Point& point) { return point.measure.error == 0; });
  }

  static std::vector<double> times(const Plot& plot) {
    std::vector<double> all;
    for (const Point& point : plot.points) all.push_back(point.measure.time);
    return all;
  }
  static std::vector<double> errors(const Plot& plot) {
    std::vector<double> all;
    for (const Point& point : plot.points)
      if (point.measure.error > 0) all.push_back(point.measure.error);
    return all;
  }

  [[nodiscard]] double height_of(const Measure& measure) const {
    return measure.error > 0 ? error_.at(measure.error) : zero;
  }

  void text(double x, double y, const char* anchor, const std::string& words) const {
    svg_ << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">" << words
         << "</text>";
  }

  void line(double x1, double y1, double x2, double y2) const {
    svg_ << "<line x1=\"" << x1 << "\" y1=\"" << y1 << "\" x2=\"" << x2 << "\" y2=\"" << y2 << "\"/>";
  }

  void frame() const {
    const double middle = (left_ + right_) / 2;
    svg_ << "<g class=\"title\">";
    text(middle, 22, "middle", plot_.title);
    svg_ << "</g>\n";
    for (const double tick : time_.ticks()) {
      line(time_.at(tick), top, time_.at(tick), zero);
      text(time_.at(tick), zero + 16, "middle", number(tick));
    }
    text(middle, zero + 38, "middle", plot_.time_axis);
    for (const double tick : error_.ticks()) {
      line(left_, error_.at(tick), right_, error_.at(tick));
      text(left_ - 6, error_.at(tick) + 4, "end", number(tick));
    }
    if (has_zero(plot_)) {
      line(left_, zero, right_, zero);
      text(left_ - 6, zero + 4, "end", "none");
    }
    svg_ << "<g transform=\"translate(" << left_ - 60 << ' ' << (top + zero) / 2 << ") rotate(-90)\">";
    text(0, 0, "middle", plot_.error_axis);
    svg_ << "</g>\n";
  }

  std::ostream& svg_;
  const Plot& plot_;
  double left_, right_;
  Axis time_, error_;
};

}  // namespace detail

/// Writes plots side by side. Throws std::runtime_error if the file cannot be written.
inline void save_svg(const std::string& path, const std::vector<Plot>& plots) {
  std::ofstream svg(path);
  const double width = detail::Panel::width * static_cast<double>(plots.size());
  const double height = detail::Panel::height + 24;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height << "\" width=\""
      << width << "\" height=\"" << height << "\">\n"
      << "<style>text{font:12px sans-serif;fill:#222}.title text{font-size:14px;font-weight:bold}"
         "line{stroke:#ddd}circle{fill:#fff;stroke-width:1.5}.ours{stroke:#c2410c}.theirs{stroke:#1d4ed8}"
         ".ours.on{fill:#c2410c}.theirs.on{fill:#1d4ed8}.front{fill:none;stroke:#999;stroke-dasharray:4 3}"
         ".paper{fill:#fff}\n@media(prefers-color-scheme:dark){text{fill:#e6edf3}line{stroke:#30363d}"
         ".paper,circle{fill:#0d1117}.ours{stroke:#f0883e}.theirs{stroke:#58a6ff}.ours.on{fill:#f0883e}"
         ".theirs.on{fill:#58a6ff}}\n"
         "</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n";
  for (std::size_t i = 0; i < plots.size(); ++i)
    detail::Panel(svg, plots[i], detail::Panel::width * static_cast<double>(i)).draw();
  svg << "<g transform=\"translate(" << width / 2 << ' ' << height - 12
      << ")\"><circle class=\"ours on\" cx=\"-250\" cy=\"-4\" r=\"4\"/><text x=\"-240\">the library</text>"
         "<circle class=\"theirs on\" cx=\"-150\" cy=\"-4\" r=\"4\"/><text x=\"-140\">the usual ways</text>"
         "<text x=\"-30\">filled, dashed line: nothing is both faster and nearer</text></g>\n</svg>\n";
  svg.close();
  if (!svg) throw std::runtime_error(path + ": cannot be written");
}

}  // namespace bench
