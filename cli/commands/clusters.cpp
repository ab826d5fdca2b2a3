// crumple clusters: shows how a search divides a mesh into clusters and leaves, and along which directions it sweeps
// them.

#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/search.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

struct Clusters {
    std::vector<std::string> files, outputs;
    QueryOptions query_options;
    Options options;
    bool leaves = false;

    static bool is_list(const std::string& path) {
        const std::string extension = extension_of(path);
        return extension == ".json" || extension == ".npz";
    }

    void check_outputs_of_clusters() const {
        for (const std::string& path : outputs) {
            if (is_list(path) || io::has_colours(io::mesh_format_of(extension_of(path)))) continue;
            throw Error(ErrorCode::invalid_argument,
                        "-o " + (path.empty() ? "''" : path) +
                            ": clusters are written as .json or .npz, coloured meshes as .ply, .obj, .glb, .3mf or "
                            ".html",
                        Element::option);
        }
        check_outputs(outputs, files, query_options);
    }

    /// Prints a line for each leaf: its cluster, its number of triangles, and its sweep direction.
    static void print(std::ostream& out, const Clustering& clustering) {
        for (std::size_t l = 0; l < clustering.leaf_cluster.size(); ++l) {
            const auto& [x, y, z] = clustering.axes[l][0];
            out << fmt::format("leaf {} cluster {} triangles {} sweep {:.6f} {:.6f} {:.6f}\n", l,
                               clustering.leaf_cluster[l], clustering.leaf_offsets[l + 1] - clustering.leaf_offsets[l],
                               x, y, z);
        }
    }

    static std::string summary(const Clustering& clustering) {
        const auto triangles = static_cast<double>(clustering.nearest_cluster.size());
        const auto each = [&](std::size_t n) { return triangles > 0 ? static_cast<double>(n) / triangles : 0; };
        return fmt::format("{} clusters, {} leaves; a triangle is in {:.2f} clusters and {:.2f} leaves on average\n",
                           grouped(std::ssize(clustering.centres)), grouped(std::ssize(clustering.leaf_cluster)),
                           each(clustering.clusters.size()), each(clustering.members.size()));
    }

    int run() const {
        check_outputs_of_clusters();
        check_cost_options(options);
        SearchSession search(query_options, options);
        const InputMeshes input = read_input(files, query_options);
        const Clustering clustering = search.cluster(input);
        for (const std::string& path : outputs) {
            if (is_list(path))
                io::write_clustering(path, clustering);
            else
                io::write_coloured(path, input.first, input.second_or_null(), clustering,
                                   leaves ? io::ColouredBy::leaves : io::ColouredBy::clusters);
        }
        if (outputs.empty()) to_standard_output([&](std::ostream& out) { print(out, clustering); });
        say(summary(clustering));
        return done;
    }
};

}  // namespace

Command add_clusters(CLI::App& app) {
    const auto clusters = std::make_shared<Clusters>();
    clusters->options.backend = Backend::cpu;
    CLI::App& command = *app.add_subcommand(
        "clusters", "Show the clusters and leaves into which a search divides a mesh, for researchers");
    command
        .add_option("FILE", clusters->files,
                    "A mesh (PLY, OBJ, STL, OFF, glTF, 3MF), or two that are searched "
                    "against each other. - is standard input")
        ->type_name("FILE [FILE_B]")
        ->required()
        ->expected(1, 2);
    command
        .add_option("-o,--output", clusters->outputs,
                    "Arrays of centres, members and frames as .json or .npz, or the mesh with each triangle in the "
                    "colour of its nearest cluster, darker if it is in several, as .ply, .obj, .glb, .3mf or .html, "
                    "which also shows the sweep directions. May be repeated. Without it, a line is printed for each "
                    "leaf")
        ->type_name("OUT")
        ->allow_extra_args(false);
    command.add_flag("--leaves", clusters->leaves, "Colour leaves instead of clusters");
    add_reading_options(command, clusters->query_options);
    add_cost_options(command, clusters->options);
    command.footer(
        "The clusters are those of the first search of a new detector: crumple detect with the same options.\n"
        "Example: crumple clusters dragon.ply --clusters 16 -o clusters.html\n"
        "         crumple clusters cloth.ply --membership equation_5 --sweep x -o clusters.npz");
    return {&command, [clusters] { return clusters->run(); }};
}

}  // namespace crumple::cli
