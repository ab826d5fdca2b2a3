// Writes degenerate scenes as PLY files, to compare two backends on the command line. Usage: write_hard_soups FOLDER.
// Scenes of scans and simulations hardly ever need exact arithmetic; these need it for most pairs.
//
// Each soup is written twice: NAME.ply, integers in float32, and NAME_tenths.ply, a tenth of them in float64, where
// rounding makes touching triangles miss each other or cross. FOLDER/moved/ has the same triangles at the end of a
// step.

#include <cstdio>
#include <exception>
#include <filesystem>

#include "agreement/hard_soups.h"
#include "crumple/io.h"

int main(int argc, char** argv) {
    namespace fs = std::filesystem;
    using namespace crumple;
    using namespace crumple::test;
    if (argc != 2) {
        std::fputs("usage: write_hard_soups FOLDER\n", stderr);
        return 2;
    }
    const fs::path folder = argv[1];
    const std::pair<const char*, SoupBuilder> soups[] = {
        {"grid", grid_soup(6, 200, 400, 1)},
        {"sparse_grid", grid_soup(20, 2000, 2000, 2)},
        {"sheets", stacked_sheets(8, {{0, 0, 0}, {1, 1, 0}, {0, 0, 0}, {0, 0, 1}})},
        {"folded_strip", folded_strip(100)},
        {"touching_boxes", touching_boxes(5)},
        {"degenerate", degenerate_soup(600)},
        {"one_line", collinear_soup(200)},
        {"duplicates", duplicates(90)},
        {"padded", padded_soup(30)},
        {"needles", needle_soup(600)},
    };
    try {
        fs::create_directories(folder / "moved");
        for (const auto& [name, soup] : soups)
            for (const bool at_end : {false, true}) {
                const SoupBuilder written = at_end ? soup.moved() : soup;
                const fs::path place = at_end ? folder / "moved" : folder;
                io::write_mesh(place / (std::string(name) + ".ply"), written.mesh<float>());
                io::write_mesh(place / (std::string(name) + "_tenths.ply"), written.mesh<double>(0.1));
            }
    } catch (const std::exception& error) {
        std::fprintf(stderr, "write_hard_soups: %s\n", error.what());
        return 1;
    }
}
