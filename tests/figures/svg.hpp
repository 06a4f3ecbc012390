// A drawing as the text of an SVG file, for a light or a dark background.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace figures {

/// A place in the drawing, in pixels: to the right and down.
struct Place {
  double x, y;
};

/// Colors of lines, fills and words. The style sheet has two values for each, for a light and a dark
/// background.
enum class Paint { ink, gray, blue, red, green, orange };

inline std::string name_of(Paint paint) {
  constexpr const char* names[] = {"ink", "gray", "blue", "red", "green", "orange"};
  return names[static_cast<int>(paint)];
}

enum class Stroke { thin, bold, dashed };
enum class Fill { full, soft, none };
enum class Anchor { start, middle, end };

class Drawing {
 public:
  /// Height of the letters, which can be read where a drawing is shown at 400 of its 640 pixels.
  static constexpr double letters = 17;

  Drawing(double width, double height, const std::string& title)
      : text_("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + number(width) + ' ' +
              number(height) + "\" width=\"" + number(width) + "\" height=\"" + number(height) +
              "\" role=\"img\">\n<title>" + escaped(title) + "</title>\n<style>\n" + style() +
              "</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n") {}

  void line(const Place& from, const Place& to, Paint paint, Stroke stroke = Stroke::thin) {
    add("line",
        "x1=\"" + number(from.x) + "\" y1=\"" + number(from.y) + "\" x2=\"" + number(to.x) + "\" y2=\"" +
            number(to.y) + '"',
        paint, Fill::none, stroke);
  }

  /// Draws a line with the head of an arrow at its end.
  void arrow(const Place& from, const Place& to, Paint paint, Stroke stroke = Stroke::thin) {
    line(from, to, paint, stroke);
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const Place along{10 * (to.x - from.x) / length, 10 * (to.y - from.y) / length};
    polygon({to,
             {to.x - along.x - 0.4 * along.y, to.y - along.y + 0.4 * along.x},
             {to.x - along.x + 0.4 * along.y, to.y - along.y - 0.4 * along.x}},
            paint, Fill::full);
  }

  void circle(const Place& center, double radius, Paint paint, Fill fill, Stroke stroke = Stroke::thin) {
    add("circle",
        "cx=\"" + number(center.x) + "\" cy=\"" + number(center.y) + "\" r=\"" + number(radius) + '"', paint,
        fill, stroke);
  }

  void rectangle(const Place& corner, double width, double height, Paint paint, Fill fill) {
    add("rect",
        "x=\"" + number(corner.x) + "\" y=\"" + number(corner.y) + "\" width=\"" + number(width) +
            "\" height=\"" + number(height) + '"',
        paint, fill, Stroke::thin);
  }

  void polygon(const std::vector<Place>& corners, Paint paint, Fill fill) {
    add("polygon", points(corners), paint, fill, Stroke::thin);
  }
  void polyline(const std::vector<Place>& corners, Paint paint, Stroke stroke = Stroke::thin) {
    add("polyline", points(corners), paint, Fill::none, stroke);
  }

  /// Draws a dot.
  void mark(const Place& at, Paint paint, Fill fill = Fill::full) { circle(at, 5, paint, fill); }

  /// Fills a rectangle with a color of its own, on either background: red, green and blue from 0 to 255.
  void swatch(const Place& corner, double width, double height, const std::array<int, 3>& color) {
    const std::string rgb = "rgb(" + std::to_string(color[0]) + ',' + std::to_string(color[1]) + ',' +
                            std::to_string(color[2]) + ')';
    text_ += "<rect x=\"" + number(corner.x) + "\" y=\"" + number(corner.y) + "\" width=\"" + number(width) +
             "\" height=\"" + number(height) + "\" style=\"fill:" + rgb + ";stroke:" + rgb +
             ";stroke-width:.5\"/>\n";
  }

  /// Draws a cross.
  void cross(const Place& at, Paint paint) {
    line({at.x - 5, at.y - 5}, {at.x + 5, at.y + 5}, paint, Stroke::bold);
    line({at.x - 5, at.y + 5}, {at.x + 5, at.y - 5}, paint, Stroke::bold);
  }

  /// Writes words, whose letters stand on the line at y.
  void words(const Place& at, const std::string& text, Anchor anchor = Anchor::start,
             Paint paint = Paint::ink, bool is_title = false) {
    constexpr const char* anchors[] = {"start", "middle", "end"};
    text_ += "<text class=\"" + name_of(paint) + (is_title ? " title" : "") + "\" x=\"" + number(at.x) +
             "\" y=\"" + number(at.y) + "\" text-anchor=\"" + anchors[static_cast<int>(anchor)] + "\">" +
             escaped(text) + "</text>\n";
  }

  /// Returns the file.
  [[nodiscard]] std::string text() const { return text_ + "</svg>\n"; }

 private:
  /// Returns a number with one digit behind the point, if it is not 0. The last bits of a logarithm, which C
  /// libraries do not agree on, do not show.
  static std::string number(double value) {
    const double tenths = std::round(10 * value) / 10;
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", tenths == std::round(tenths) ? 0 : 1,
                  tenths == 0 ? 0.0 : tenths);
    return text;
  }

  static std::string escaped(const std::string& text) {
    std::string result;
    for (const char c : text) result += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return result;
  }

  static std::string points(const std::vector<Place>& corners) {
    std::string text = "points=\"";
    for (const auto& [x, y] : corners) text.append(number(x)).append(",").append(number(y)).append(" ");
    return text + '"';
  }

  /// Returns the style of both backgrounds.
  static std::string style() {
    const auto colors = [](const std::vector<std::string>& values, const std::string& paper) {
      std::string rules = ".paper{fill:" + paper + "}\n";
      for (std::size_t i = 0; i < values.size(); ++i) {
        const std::string name = std::string(".").append(name_of(static_cast<Paint>(i))), value = values[i];
        rules += name + "{stroke:" + value + "}" + name + ".full{fill:" + value + "}" + name +
                 ".soft{fill:" + value + ";fill-opacity:.2}text" + name + "{fill:" + value +
                 ";stroke:" + paper + "}\n";
      }
      return rules;
    };
    return colors({"#1f2328", "#8c959f", "#0969da", "#cf222e", "#1a7f37", "#bc4c00"}, "#ffffff") +
           "text{font:" + number(letters) +
           "px "
           "sans-serif;stroke-width:4;stroke-linejoin:round;paint-order:stroke}.title{font-weight:bold}.none{"
           "fill:none}"
           "line,polyline,circle,rect,polygon{stroke-width:1.5}"
           ".bold{stroke-width:3}.dashed{stroke-dasharray:6 4}\n"
           "@media(prefers-color-scheme:dark){\n" +
           colors({"#e6edf3", "#7d8590", "#58a6ff", "#ff7b72", "#3fb950", "#f0883e"}, "#0d1117") + "}\n";
  }

  void add(const std::string& element, const std::string& place, Paint paint, Fill fill, Stroke stroke) {
    constexpr const char *fills[] = {" full", " soft", " none"}, *strokes[] = {"", " bold", " dashed"};
    text_ += "<" + element + " class=\"" + name_of(paint) + fills[static_cast<int>(fill)] +
             strokes[static_cast<int>(stroke)] + "\" " + place + "/>\n";
  }

  std::string text_;
};

}  // namespace figures
