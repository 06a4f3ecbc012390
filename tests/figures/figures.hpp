// Figures of the pages in docs/: each function returns the text of an SVG file.
#pragma once

#include <string>
#include <vector>

#include "sketch.hpp"

namespace figures {

/// Shows the start of a shadow ray on a sphere, with an epsilon that is too small and one that is too large.
std::string epsilon();

/// Shows the discriminants of three lines with the bound of their error, and the decisions that follow.
std::string decision();

/// Shows which surfaces the rays of a tile may meet, and what its pixels see.
std::string tile();

// Plots of the tables in a folder.
std::string wrong_decisions(const std::string& folder);
std::string stages(const std::string& folder);
std::string spheres(const std::string& folder);
std::string meshes(const std::string& folder);
std::string growth(const std::string& folder);
std::string error(const std::string& folder);
std::string kernels(const std::string& folder);
std::string samplers(const std::string& folder);
std::string paths(const std::string& folder);
std::string marches(const std::string& folder);
std::string shaders(const std::string& folder);

// Figures of the stages' pages.
std::vector<StageFigure> vector_figures();    ///< stages 00 to 02: vectors, images, cameras and rays
std::vector<StageFigure> light_figures();     ///< stages 03 to 08: hits, depth, normals, light, transparency
std::vector<StageFigure> path_figures();      ///< stages 09 to 13: shadows, highlights, mirrors, glass
std::vector<StageFigure> geometry_figures();  ///< stages 13 to 16: surfaces, solids, environments
std::vector<StageFigure> mesh_figures();      ///< stage 17: triangles, meshes, trees of boxes
std::vector<StageFigure> antialiasing_figures();  ///< stage 18: samples of a pixel
std::vector<StageFigure> soft_shadow_figures();   ///< stage 19: lamps of any size
std::vector<StageFigure> lens_figures();          ///< stage 20: a lens
std::vector<StageFigure> motion_figures();        ///< stage 21: surfaces that move
std::vector<StageFigure> glossy_figures();        ///< stage 22: blurred mirrors
std::vector<StageFigure> path_tracing_figures();  ///< stages 23 and 24: free space, paths
std::vector<StageFigure> cornell_figures();       ///< stage 25: light of walls, and caustics
std::vector<StageFigure> weekend_figures();       ///< stage 26: a tree of boxes, blurred mirrors
std::vector<StageFigure> normal_map_figures();    ///< stage 27: normal maps
std::vector<StageFigure> marching_figures();      ///< stages 30 to 33: steps along a ray, and proofs
std::vector<StageFigure> field_figures();         ///< stages 34 to 38: distance fields of shapes
std::vector<StageFigure> porting_figures();       ///< the page about shaders
std::vector<StageFigure>
topic_figures();  ///< pages beside the stages: history, cameras, lights, tone, threads
std::vector<StageFigure> fresnel_figures();  ///< the page about Fresnel's equations

}  // namespace figures
