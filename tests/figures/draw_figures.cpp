// Draws the figures of the pages in docs/.
//
//   draw_figures FOLDER
//     writes them into the folder, docs/figures, which has the tables that they show
//   draw_figures --check FOLDER
//     changes nothing; exits with 1 if a figure differs from the one there, or is not on its stage's page
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "figures.hpp"

namespace {

struct Figure {
  std::string name, text;  ///< name of the file in docs/figures, without .svg
};

std::vector<figures::StageFigure> stage_figures() {
  std::vector<figures::StageFigure> all;
  for (const auto& some :
       {figures::vector_figures(), figures::light_figures(), figures::path_figures(),
        figures::geometry_figures(), figures::mesh_figures(), figures::antialiasing_figures(),
        figures::soft_shadow_figures(), figures::lens_figures(), figures::motion_figures(),
        figures::glossy_figures(), figures::path_tracing_figures(), figures::cornell_figures(),
        figures::weekend_figures(), figures::normal_map_figures(), figures::topic_figures(),
        figures::fresnel_figures(), figures::marching_figures(), figures::field_figures(),
        figures::porting_figures()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

Figure drawn(const figures::StageFigure& figure) {
  figures::Drawing drawing(640, figure.height, figure.alt);
  figure.draw(drawing);
  return {std::string("stages/") + figure.name, drawing.text()};
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void save(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written");
}

/// Returns true if a stage's page shows a figure with its text.
bool is_on_its_page(const figures::StageFigure& figure, const std::string& folder) {
  const std::string path = folder + "/../stages/" + figure.page + ".md";
  const std::string mark =
      std::string("![").append(figure.alt).append("](../figures/stages/").append(figure.name).append(".svg)");
  if (bytes_of(path).find(mark) != std::string::npos) return true;
  std::fprintf(stderr, "%s does not show %s\n", path.c_str(), mark.c_str());
  return false;
}

int draw(const std::string& folder, bool checks) {
  std::vector<Figure> all{{"epsilon", figures::epsilon()},
                          {"decision", figures::decision()},
                          {"tile", figures::tile()},
                          {"wrong_decisions", figures::wrong_decisions(folder)},
                          {"stages", figures::stages(folder)},
                          {"spheres", figures::spheres(folder)},
                          {"meshes", figures::meshes(folder)},
                          {"growth", figures::growth(folder)},
                          {"error", figures::error(folder)},
                          {"kernels", figures::kernels(folder)},
                          {"samplers", figures::samplers(folder)},
                          {"paths", figures::paths(folder)},
                          {"marches", figures::marches(folder)},
                          {"shaders", figures::shaders(folder)}};
  int differ = 0;
  for (const figures::StageFigure& figure : stage_figures()) {
    all.push_back(drawn(figure));
    if (checks) differ += is_on_its_page(figure, folder) ? 0 : 1;
  }
  for (const Figure& figure : all) {
    const std::string path = folder + '/' + figure.name + ".svg";
    if (!checks) {
      save(path, figure.text);
    } else if (bytes_of(path) != figure.text) {
      std::fprintf(stderr, "%s is not what the program draws: run draw_figures docs/figures\n", path.c_str());
      ++differ;
    }
  }
  return differ == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const bool checks = !words.empty() && words[0] == "--check";
  if (words.size() != (checks ? 2u : 1u)) {
    std::fprintf(stderr, "usage: draw_figures [--check] FOLDER\n");
    return 2;
  }
  try {
    return draw(words.back(), checks);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "draw_figures: %s\n", error.what());
    return 2;
  }
}
