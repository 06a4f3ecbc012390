#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "explanation.hpp"

using namespace protostar;

namespace {

/// Kinds of rays, which have a color each in the drawing and a group each in the OBJ file.
enum class Kind : std::uint8_t { camera, following, shadow, occluded };
constexpr std::array kind_names{"camera", "following", "shadow", "occluded"};
constexpr std::array kind_words{"ray of the camera", "mirrored or refracted ray", "ray to a light",
                                "ray to a light that is occluded"};
constexpr std::array kind_colors{"#1668c4", "#b3540a", "#8a7400", "#c42121"};

/// Ray from its start to its hit, to the light, or as far as the drawing goes.
struct Segment {
  Kind kind;
  Point from, to;
};

/// Returns the points of a tree of rays that are not infinitely far away.
void add_points(const RayRecord& record, std::vector<Point>& points) {
  points.push_back(record.ray.origin);
  if (record.taken) points.push_back(record.ray.at(record.considered[*record.taken].crossings[0].t));
  if (record.range.max == 1) points.push_back(record.ray.at(1));
  for (const Considered& one : record.considered)
    for (const Crossing& crossing : one.crossings)
      if (record.query == RayRecord::Query::all) points.push_back(record.ray.at(crossing.t));
  for (const RayRecord& ray : record.rays) add_points(ray, points);
}

Bounds bounds_of_points(const std::vector<Point>& points) {
  Bounds box{Point{infinity}, Point{-infinity}};
  for (const Point& point : points) box = {min(box.min, point), max(box.max, point)};
  return box;
}

/// Adds a ray and those that follow it; a ray that ends nowhere is drawn with the given length.
void add_segments(const RayRecord& record, Kind kind, double far, std::vector<Segment>& segments) {
  double end = far / length(record.ray.direction);
  if (record.query == RayRecord::Query::any && record.range.max == 1) end = 1;
  if (record.taken) end = record.considered[*record.taken].crossings[0].t;
  if (kind == Kind::shadow && record.taken) kind = Kind::occluded;
  segments.push_back({kind, record.ray.origin, record.ray.at(end)});
  for (const RayRecord& ray : record.rays)
    add_segments(ray, ray.query == RayRecord::Query::any ? Kind::shadow : Kind::following, far, segments);
}

/// Everything that is drawn: the rays, and the box around them.
struct Drawing {
  std::vector<Segment> segments;
  Bounds box;
};

Drawing drawing_of(const Explanation& explanation) {
  std::vector<Point> points;
  for (const SampleRecord& sample : explanation.samples) {
    points.push_back(sample.ray.origin);
    for (const RayRecord& ray : sample.all.rays) add_points(ray, points);
  }
  // A pixel that sees nothing has one point; a ray of length 1 is better than none.
  const double extent = length(bounds_of_points(points).max - bounds_of_points(points).min);
  const double far = extent > 0 ? extent / 2 : 1;
  Drawing drawing;
  for (const SampleRecord& sample : explanation.samples) {
    for (const RayRecord& ray : sample.all.rays) add_segments(ray, Kind::camera, far, drawing.segments);
    if (sample.all.rays.empty())
      drawing.segments.push_back({Kind::camera, sample.ray.origin, sample.ray.at(far)});
  }
  for (const Segment& segment : drawing.segments) points.insert(points.end(), {segment.from, segment.to});
  // Surfaces that are at most twice as large as the rays reach are seen as a whole.
  for (const Bounds& of_surface : explanation.bounds)
    if (length(of_surface.max - of_surface.min) <= 2 * std::max(extent, far))
      points.insert(points.end(), {of_surface.min, of_surface.max});
  drawing.box = bounds_of_points(points);
  return drawing;
}

std::string number(double x) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.6g", x);
  return text.data();
}

/// View of the scene along one of its axes, as a panel of the drawing: `right` and `up` are the axes of the
/// panel.
class Panel {
 public:
  Panel(const Bounds& box, int right, int up, double left, double size, std::string title)
      : right_(right), up_(up), left_(left), size_(size), title_(std::move(title)) {
    const Vec3 extent = box.max - box.min, middle = 0.5 * (box.min + box.max);
    const double widest = std::max({extent[right], extent[up], 1e-300});
    scale_ = 0.84 * size / widest;
    center_ = middle;
  }

  std::string draw(const Explanation& explanation, const Drawing& drawing) const {
    std::string svg =
        "<g clip-path=\"url(#" + id() + ")\">\n<clipPath id=\"" + id() + "\">" + frame("") + "</clipPath>\n";
    for (std::size_t i = 0; i < explanation.surfaces.size(); ++i)
      svg += outline(explanation.surfaces[i], explanation.bounds[i]);
    for (const Segment& s : drawing.segments)
      svg += "<line x1=\"" + x(s.from) + "\" y1=\"" + y(s.from) + "\" x2=\"" + x(s.to) + "\" y2=\"" +
             y(s.to) + "\" stroke=\"" + kind_colors[static_cast<std::size_t>(s.kind)] +
             "\" stroke-width=\"1.5\"/>\n";
    for (const Light& light : explanation.lights)
      if (light.occlusion_range().max == 1) {
        const Point at = light.towards(Point{0});
        svg += "<circle class=\"light\" cx=\"" + x(at) + "\" cy=\"" + y(at) + "\" r=\"4\"/>\n";
      }
    return svg + "</g>\n" + frame(" class=\"frame\"") + "\n<text x=\"" + number(left_ + 8) + "\" y=\"30\">" +
           title_ + "</text>\n";
  }

 private:
  [[nodiscard]] std::string id() const { return "panel" + std::to_string(up_); }
  [[nodiscard]] std::string frame(const std::string& look) const {
    return "<rect x=\"" + number(left_) + "\" y=\"12\" width=\"" + number(size_) + "\" height=\"" +
           number(size_) + "\"" + look + "/>";
  }
  [[nodiscard]] std::string x(const Point& p) const {
    return number(left_ + size_ / 2 + scale_ * (p[right_] - center_[right_]));
  }
  [[nodiscard]] std::string y(const Point& p) const {
    return number(12 + size_ / 2 - scale_ * (p[up_] - center_[up_]));
  }

  [[nodiscard]] std::string polygon(const std::vector<Point>& corners, const char* look) const {
    std::string points;
    for (const Point& corner : corners) points += (points.empty() ? "" : " ") + x(corner) + "," + y(corner);
    return std::string("<polygon class=\"") + look + "\" points=\"" + points + "\"/>\n";
  }

  /// Returns a sphere as a circle, a flat surface with corners as a polygon, and any other as the box around
  /// it, if there is one.
  [[nodiscard]] std::string outline(const Facts& facts, const Bounds& bounds) const {
    const auto vector = [&](std::size_t i) {
      const std::vector<double>& v = facts.numbers[i].values;
      return Vec3{v[0], v[1], v[2]};
    };
    if (facts.type == "sphere")
      return "<circle class=\"surface\" cx=\"" + x(vector(0)) + "\" cy=\"" + y(vector(0)) + "\" r=\"" +
             number(scale_ * std::abs(facts.numbers[1].values[0])) + "\"/>\n";
    if (facts.type == "parallelogram")
      return polygon(
          {vector(0), vector(0) + vector(1), vector(0) + vector(1) + vector(2), vector(0) + vector(2)},
          "surface");
    if (facts.type == "triangle") return polygon({vector(0), vector(1), vector(2)}, "surface");
    if (!is_finite(bounds.min) || !is_finite(bounds.max)) return "";
    Point low_high = bounds.min, high_low = bounds.max;
    low_high[up_] = bounds.max[up_];
    high_low[up_] = bounds.min[up_];
    return polygon({bounds.min, low_high, bounds.max, high_low},
                   facts.type == "box" ? "surface" : "surface around");
  }

  int right_, up_;
  double left_, size_;
  std::string title_;
  double scale_ = 1;
  Point center_{0};
};

/// Returns the plan from above, with x to the right and z up, and the view from the side, with z to the right
/// and y up.
std::string svg_of(const Explanation& explanation) {
  const Drawing drawing = drawing_of(explanation);
  constexpr double size = 400;
  std::string svg =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 848 490\" width=\"848\" height=\"490\" "
      "font-family=\"sans-serif\" font-size=\"13\">\n"
      "<style>rect, polygon, circle { fill: none } text { fill: #404040 } .frame { stroke: #808080 }\n"
      ".surface { stroke: #606060 } .around { stroke-dasharray: 5 4 } .light { fill: #c9a800 }</style>\n"
      "<rect width=\"848\" height=\"490\" style=\"fill: #ffffff\"/>\n";
  svg += Panel(drawing.box, 0, 2, 12, size, "from above: x to the right, z up").draw(explanation, drawing);
  svg +=
      Panel(drawing.box, 2, 1, 436, size, "from the side: z to the right, y up").draw(explanation, drawing);
  for (std::size_t i = 0; i < kind_words.size(); ++i) {
    const std::string left = number(20 + 424.0 * static_cast<double>(i / 2)),
                      y = number(438 + 22.0 * static_cast<double>(i % 2));
    svg += "<line x1=\"" + left + "\" y1=\"" + y + "\" x2=\"" +
           number(50 + 424.0 * static_cast<double>(i / 2)) + "\" y2=\"" + y + "\" stroke=\"" +
           kind_colors[i] + "\" stroke-width=\"2\"/><text x=\"" +
           number(58 + 424.0 * static_cast<double>(i / 2)) + "\" y=\"" +
           number(442 + 22.0 * static_cast<double>(i % 2)) + "\">" + kind_words[i] + "</text>\n";
  }
  return svg + "</svg>\n";
}

std::string obj_of(const Explanation& explanation) {
  std::string vertices, lines;
  std::size_t count = 0;
  const Drawing drawing = drawing_of(explanation);
  for (std::size_t kind = 0; kind < kind_names.size(); ++kind) {
    bool is_first = true;
    for (const Segment& segment : drawing.segments) {
      if (static_cast<std::size_t>(segment.kind) != kind) continue;
      if (is_first) lines += std::string("g ") + kind_names[kind] + "\n";
      is_first = false;
      for (const Point& p : {segment.from, segment.to}) {
        std::array<char, 96> text;
        std::snprintf(text.data(), text.size(), "v %.17g %.17g %.17g\n", p.x, p.y, p.z);
        vertices += text.data();
      }
      count += 2;
      lines += "l " + std::to_string(count - 1) + " " + std::to_string(count) + "\n";
    }
  }
  return "# Rays of a pixel, by kind.\n" + vertices + lines;
}

}  // namespace

std::string rays_of(const Explanation& explanation, bool is_svg) {
  return is_svg ? svg_of(explanation) : obj_of(explanation);
}
