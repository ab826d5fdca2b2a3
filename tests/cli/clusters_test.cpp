// Tests of crumple clusters.

#include <nlohmann/json.hpp>

#include <set>

#include "crumple/io.h"
#include "run.h"

namespace crumple::cli::test {
namespace {

class ClustersCommand : public Cli {
   protected:
    ClustersCommand() { EXPECT_EQ(crumple("make cloth --triangles 3000 -o cloth.ply").status, 0); }

    /// Returns the different colours of the faces of a coloured .obj file: the names of its materials that faces use.
    std::set<std::string> materials(const std::string& name) const {
        std::set<std::string> used;
        std::istringstream in(read(name));
        for (std::string line; std::getline(in, line);)
            if (line.starts_with("usemtl ")) used.insert(line.substr(7));
        return used;
    }
};

TEST_F(ClustersCommand, each_leaf_has_a_line) {
    const Outcome outcome = crumple("clusters cloth.ply --clusters 3 --leaf-size 5000 --sweep y");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 3);
    EXPECT_TRUE(outcome.out.starts_with("leaf 0 cluster 0 triangles ")) << outcome.out;
    EXPECT_TRUE(contains(outcome.out, " sweep 0.000000 1.000000 0.000000\n")) << outcome.out;
    EXPECT_TRUE(outcome.err.starts_with("3 clusters, 3 leaves; a triangle is in 1.")) << outcome.err;
}

TEST_F(ClustersCommand, arrays_are_those_of_the_search) {
    const std::string options = "cloth.ply --clusters 4 --leaf-size 300 ";
    EXPECT_EQ(crumple("clusters " + options + "-o c.json -o c.npz").status, 0);
    const auto json = nlohmann::json::parse(read("c.json"));
    EXPECT_EQ(crumple("detect " + options + "-o p.json").status, 0);
    const auto statistics = nlohmann::json::parse(read("p.json"))["statistics"];
    EXPECT_EQ(json["centres"].size(), 4u);
    EXPECT_EQ(json["leaf_cluster"].size(), statistics["leaves"]);
    EXPECT_EQ(json["members"].size(), statistics["members"]);
    EXPECT_EQ(json["axes"][0].size(), 9u);
    EXPECT_EQ(json["offsets"].size(), json["nearest_leaf"].size() + 1);
    EXPECT_EQ(json["complete"][0], 1);
    for (const char* const array : {"centres", "clusters", "leaf_offsets", "axes", "nearest_cluster"})
        EXPECT_TRUE(contains(read("c.npz"), std::string(array) + ".npy")) << array;
}

TEST_F(ClustersCommand, clusters_and_leaves_have_colours) {
    const std::string options = "clusters cloth.ply --clusters 2 --leaf-size 400 ";
    const Outcome outcome = crumple(options + "-o c.ply -o c.obj -o c.glb -o c.3mf -o c.html");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(materials("c.obj"),
              (std::set<std::string>{"cluster_0", "cluster_0_and_others", "cluster_1", "cluster_1_and_others"}));
    const auto triangles = io::read_mesh(file("cloth.ply")).triangle_count();
    for (const char* const name : {"c.ply", "c.obj", "c.glb", "c.3mf"})
        EXPECT_EQ(io::read_mesh(file(name)).triangle_count(), triangles) << name;
    EXPECT_TRUE(contains(read("c.mtl"), "cluster_1_and_others"));
    EXPECT_TRUE(contains(read("c.html"), "sweep direction of a leaf"));
    EXPECT_TRUE(contains(read("c.html"), "2 clusters of "));
    EXPECT_EQ(crumple(options + "--leaves -o l.obj -o l.html").status, 0);
    EXPECT_GT(materials("l.obj").size(), 8u);
    EXPECT_TRUE(materials("l.obj").count("leaf_3"));
    EXPECT_TRUE(contains(read("l.html"), " leaves in 2 clusters of "));
}

TEST_F(ClustersCommand, second_mesh_is_coloured_too) {
    write("a.off", "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n90 0 0\n91 0 0\n90 1 0\n3 0 1 2\n3 3 4 5\n");
    write("b.off", "OFF\n3 1 0\n0 0 0.1\n1 0 0.1\n0 1 -0.1\n3 0 1 2\n");
    EXPECT_EQ(crumple("clusters a.off b.off -o c.obj").status, 0);
    EXPECT_EQ(materials("c.obj"), (std::set<std::string>{"cluster_0", "left_out"}));
    EXPECT_EQ(io::read_mesh(file("c.obj")).triangle_count(), 3);
}

TEST_F(ClustersCommand, rule_that_may_lose_pairs_is_reported) {
    const Outcome outcome = crumple("clusters cloth.ply --clusters 3 --membership threshold=1 -o c.json");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(outcome.err.starts_with("crumple: warning: pairs may be missing")) << outcome.err;
    EXPECT_EQ(nlohmann::json::parse(read("c.json"))["complete"][0], 0);
}

TEST_F(ClustersCommand, wrong_use_is_refused) {
    for (const auto& [arguments, message] :
         {std::pair{"-o c.csv", "-o c.csv: clusters are written as .json or .npz, coloured meshes as .ply"},
          {"-o c.stl", "-o c.stl: clusters are written as"},
          {"-o cloth.ply", "would overwrite the input cloth.ply"},
          {"--backend reference", "clusters need the cpu backend"}}) {
        const Outcome outcome = crumple(std::string("clusters cloth.ply ") + arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_TRUE(contains(outcome.err, message)) << outcome.err;
    }
    EXPECT_EQ(crumple("clusters missing.ply").status, 2);
}

}  // namespace
}  // namespace crumple::cli::test
