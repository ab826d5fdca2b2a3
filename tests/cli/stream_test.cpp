#include "moving.h"

namespace crumple::cli::test {
namespace {

/// Feature queries whose lists can be streamed.
class StreamOfFeatures : public Moving {
   protected:
    const std::vector<std::string> queries{"impacts above.off below.off --min-distance 0.5",
                                           "impacts above.off below.off --candidates --inflation 0.5",
                                           "impacts above.off --candidates --kinds face_face --inflation 1",
                                           "near above.off --radius 2", "near above.off below.off --radius 0.5"};
};

TEST_F(StreamOfFeatures, stream_has_the_same_lines_as_the_list) {
    for (const std::string& query : queries) {
        const std::string expected = sorted_lines(list(query));
        EXPECT_FALSE(expected.empty());
        EXPECT_EQ(sorted_lines(list(query + " --stream")), expected) << query;
        EXPECT_EQ(sorted_lines(list(query + " --stream --memory-limit 1MB")), expected) << query;
        EXPECT_EQ(sorted_lines(list(query + " --stream --backend reference")), expected) << query;
        for (const std::string file : {"a.txt", "a.csv"}) {
            EXPECT_EQ(crumple(query + " -o " + file).status, 0);
            const Outcome outcome = crumple(query + " --stream -o streamed_" + file);
            EXPECT_EQ(outcome.status, 0);
            const auto lines = std::count(expected.begin(), expected.end(), '\n');
            EXPECT_TRUE(outcome.err.starts_with(std::to_string(lines) + ' ')) << outcome.err;
            const std::string in_file = sorted_lines(read(file));
            EXPECT_EQ(sorted_lines(read("streamed_" + file)), in_file) << query;
            EXPECT_EQ(sorted_lines(list(query + " --stream -o - --format " + file.substr(2))), in_file) << query;
        }
        EXPECT_TRUE(contains(crumple(query + " --stream --stats").err, "sweep"));
    }
}

TEST_F(StreamOfFeatures, empty_result_is_streamed_as_an_empty_list) {
    const Outcome outcome = crumple("near above.off --radius 0.1 --stream -o a.csv");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_TRUE(outcome.err.starts_with("nothing is near: 2 triangles, ")) << outcome.err;
    EXPECT_EQ(read("a.csv"), "kind,vertex,face,a,b,c,d,squared_distance,touching\n");
    EXPECT_EQ(list("impacts above.off above.off --stream"), "");
}

TEST_F(StreamOfFeatures, only_one_list_can_be_streamed) {
    for (const std::string& query : queries)
        for (const std::string bad : {"-o a.json", "-o a.npz", "-o a.txt -o b.txt", "-o - --format json"})
            expect_refused(query + " --stream " + bad, "--stream writes one list, as .txt or .csv");
    expect_refused("near above.off --radius 1 --stream -o a.glb", "--stream writes one list");
    expect_refused("near above.off --radius 1 --stream --check", "--stream does not go with --check");
    expect_refused("impacts above.off below.off --stream --first", "--stream does not go with --first");
    expect_refused("impacts above.off below.off --stream --triangle-pairs",
                   "--stream does not go with --triangle-pairs");
}

}  // namespace
}  // namespace crumple::cli::test
