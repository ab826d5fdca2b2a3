// Wrong use and bad input: status 2, nothing on standard output, one line on standard error that says what and where.

#include "run.h"

namespace crumple::cli::test {
namespace {

class Misuse : public Cli {
   protected:
    Misuse() { write("five.off", five_off); }
    void expect_refused(const std::string& arguments, const std::string& reason) const {
        const Outcome outcome = crumple(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_EQ(outcome.out, "") << arguments;
        EXPECT_TRUE(is_error_line(outcome.err)) << arguments << ": " << outcome.err;
        EXPECT_TRUE(contains(outcome.err, reason)) << arguments << ": " << outcome.err;
    }
};

TEST_F(Misuse, wrong_commands_and_arguments_are_refused) {
    expect_refused("", "detect, check, impacts, near, overlap, sequence, info, verify, make or convert");
    expect_refused("dettect five.off", "dettect; did you mean detect?");
    expect_refused("five.off", "not expected: five.off; see crumple --help");
    expect_refused("--fast", "not expected: --fast; see crumple --help");
    expect_refused("--verison", "--verison; did you mean --version?");
    expect_refused("detect", "detect: FILE is required; see crumple detect --help");
    expect_refused("info", "info: FILE is required");
    expect_refused("sequence", "frames or a --scene");
    expect_refused("detect five.off five.off five.off",
                   "detect takes one FILE or two, or any number with --groups bodies");
    expect_refused("verify five.off", "verify: FILE: At least 2 required but received 1");
    expect_refused("info five.off five.off", "info: not expected: five.off");
    expect_refused("detect five.off --threads 1 --threads 2", "detect: --threads: At Most 1 required but received 2");
    expect_refused("detect five.off -o", "detect: --output: 1 required OUT missing");
}

TEST_F(Misuse, error_of_an_unknown_option_suggests_a_similar_one) {
    expect_refused("detect five.off --fast", "detect: not expected: --fast; see crumple detect --help");
    expect_refused("detect five.off --neighbors skip", "--neighbors; did you mean --neighbours?");
    expect_refused("detect five.off --neighbors=skip", "--neighbors=skip; did you mean --neighbours?");
    expect_refused("info five.off --wels", "info: not expected: --wels; did you mean --weld?");
    expect_refused("detect five.off --out x.txt", "; did you mean --output?");
    expect_refused("info five.off --neighbours skip", "info: not expected: --neighbours skip; see crumple info --help");
}

TEST_F(Misuse, error_of_a_renamed_option_names_its_replacement) {
    expect_refused("detect five.off --groups components --wanted between", "--wanted; it is --filter now");
    expect_refused("detect five.off --intersections=proper", "--intersections=proper; it is --kind now");
    expect_refused("detect five.off --groups bodies --exclude a,b", "; it is --excluded-bodies now");
    expect_refused("impacts five.off five.off --kind pairs", "; it is --triangle-pairs or --candidates now");
    expect_refused("impacts five.off five.off --separation 1",
                   "impacts: not expected: --separation; it is --min-distance now");
    expect_refused("verify five.off five.off --near 1", "; it is --radius now");
    expect_refused("info five.off --wanted between", "info: not expected: --wanted between; see crumple info --help");
}

TEST_F(Misuse, error_of_a_wrong_value_lists_the_allowed_values) {
    expect_refused("detect five.off --neighbours none", "geometric|skip");
    expect_refused("detect five.off --kind some", "all|proper");
    expect_refused("detect five.off --precision float16", "auto|float32|float64");
    expect_refused("detect five.off --backend gpu", "auto|reference|cpu");
    expect_refused("detect five.off --filter inside", "between|within|both");
}

TEST_F(Misuse, wrong_numbers_are_refused) {
    for (const char* threads : {"0", "-1", "1025", "two", "1.5"}) {
        expect_refused(std::string("detect five.off --threads ") + threads,
                       std::string("--threads: ") + threads + " is not an integer from 1 to 1024");
    }
    for (const char* command : {"make cloth -o out.ply", "sequence --scene cloth"})
        expect_refused(std::string(command) + " --seed -1", "--seed: -1 is not an integer from 0 to");
    for (const char* clusters : {"0", "65", "x"}) {
        expect_refused(std::string("detect five.off --clusters ") + clusters, "--clusters");
    }
    for (const char* size :
         {"0", "-1", "GiB", "1e9", "nan", "inf", "12XB", "1ib", "99999999999999999999", "10000000T"}) {
        expect_refused(std::string("detect five.off --memory-limit ") + size, "--memory-limit");
    }
    for (const char* part : {"0/3", "4/3", "1/262145", "1", "1/", "/2", "a/b", "1/2/3", "-1/2", "1/0"}) {
        expect_refused(std::string("detect five.off --part ") + part, "--part");
    }
}

TEST_F(Misuse, incompatible_options_are_refused) {
    expect_refused("detect five.off --weld --no-weld", "--weld excludes --no-weld");
    expect_refused("detect five.off --filter between", "need --groups");
    expect_refused("detect five.off --filter within", "need --groups");
    expect_refused("detect five.off --groups components", "--filter");
    expect_refused("detect five.off --backend reference --threads 2", "--threads does not apply");
    expect_refused("detect five.off --backend reference --clusters 2", "--clusters does not apply");
    expect_refused("detect five.off --fuzzy-c-means 2", "NAME=NUMBER is expected");
    expect_refused("detect five.off --fuzzy-c-means fuzzyness=2", "the names are fuzziness, max_iterations,");
    expect_refused("detect five.off --fuzzy-c-means max_iterations=1.5", "an integer is expected");
    expect_refused("detect five.off --fuzzy-c-means stop=0.1,fuzziness=1", "fuzziness must be finite and above 1");
    expect_refused("detect five.off --contacts -o x.glb", "hold no contacts");
    expect_refused("detect five.off --contacts --check", "--contacts needs -o with --check");
    expect_refused("detect five.off -o -", "-o - needs --format");
    expect_refused("detect five.off -o - --format obj", "needs a file beside it");
    expect_refused("detect five.off -o - --format doc", "-o - --format doc: pairs are written as");
    expect_refused("detect five.off -o x.txt --format csv", "--format is for -o -");
    expect_refused("make cloth -o -", "-o - needs --format");
    expect_refused("make cutting --all-frames -o - --format ply", "--all-frames needs files");
    expect_refused("detect - -", "standard input, -, can be read only once");
    expect_refused("sequence five.off --json -o x.csv", "--json");
}

TEST_F(Misuse, impossible_outputs_are_refused) {
    write("g.txt", "0\n0\n0\n0\n0\n");
    expect_refused("detect five.off -o x.doc", "x.doc");
    expect_refused("detect five.off -o ''", "-o '': ");
    expect_refused("detect five.off -o x", ".txt, .csv, .json or .npz");
    expect_refused("detect five.off -o no/folder/x.txt", "there is no folder no/folder");
    expect_refused("detect five.off -o five.off/x.txt", "five.off is not a folder");
    write("x.mtl", "newmtl mine\n");
    expect_refused("detect five.off -o x.obj", "x.mtl: Crumple has not written this file");
    EXPECT_EQ(read("x.mtl"), "newmtl mine\n");
    EXPECT_FALSE(fs::exists(file("x.obj")));
    write("g.mtl", "0\n0\n0\n0\n0\n");
    expect_refused("detect five.off --groups g.mtl --filter between -o g.obj", "g.mtl would overwrite the input g.mtl");
    expect_refused("detect five.off -o no/such/folder.txt", "no/such");
    expect_refused("sequence five.off -o x.txt", ".csv or .json");
    expect_refused("sequence five.off -o no/such/folder.csv", "no/such");
    expect_refused("detect five.off --groups g.txt --filter between -o g.txt", "the input g.txt");
    EXPECT_EQ(read("g.txt"), "0\n0\n0\n0\n0\n");
    EXPECT_EQ(crumple("detect missing.off -o x.doc").err.find("missing"), std::string::npos) << "outputs first";
}

TEST_F(Misuse, overwriting_an_input_is_refused) {
    ASSERT_EQ(crumple("detect five.off -o five.ply").status, 0);
    ASSERT_EQ(shell("ln -s five.ply link.ply; ln five.ply twin.ply; mkdir sub; cp five.ply a.csv").status, 0);
    const std::string before = read("five.ply");
    for (const char* const output : {"five.ply", "./sub/../five.ply", "link.ply", "twin.ply"}) {
        const std::string o = std::string(" -o ") + output;
        expect_refused("detect five.ply" + o, "would overwrite the input five.ply");
        expect_refused("detect five.off five.ply" + o, "would overwrite the input five.ply");
        expect_refused("detect five.ply -o x.txt" + o, "would overwrite the input five.ply");
    }
    expect_refused("detect link.ply -o five.ply", "would overwrite the input link.ply");
    expect_refused("sequence five.off a.csv -o a.csv", "would overwrite the input a.csv");
    EXPECT_EQ(read("five.ply"), before);
    EXPECT_EQ(read("a.csv"), before);
    EXPECT_FALSE(fs::exists(file("x.txt")));
}

TEST_F(Misuse, wrong_groups_are_refused) {
    write("short.txt", "0\n1\n");
    write("words.txt", "0\n1\ntwo\n3\n4\n");
    write("large.txt", "0\n1\n2\n3\n4000000000\n");
    expect_refused("detect five.off --filter between --groups short.txt", "2 groups for 5 triangles");
    expect_refused("detect five.off --filter between --groups words.txt", "words.txt, line 3");
    expect_refused("detect five.off --filter between --groups large.txt", "large.txt, line 5");
    expect_refused("detect five.off --filter between --groups part", "five.off");
    expect_refused("detect five.off --filter between --groups none.txt", "--groups none.txt: there is no such file");
    ASSERT_EQ(crumple("detect five.off -o five.ply").status, 0);
    expect_refused("detect five.ply --filter between --groups none.txt",
                   "no such file, and five.ply: its faces have no");
}

TEST_F(Misuse, error_in_a_file_names_file_and_place) {
    const auto refused = [&](const std::string& name, std::string_view bytes, const std::string& place) {
        write(name, bytes);
        for (const char* command : {"detect ", "info ", "sequence "}) {
            const Outcome outcome = crumple(command + name);
            EXPECT_EQ(outcome.status, 2) << command << name;
            EXPECT_TRUE(is_error_line(outcome.err)) << command << name << ": " << outcome.err;
            EXPECT_TRUE(contains(outcome.err, name)) << outcome.err;
            EXPECT_TRUE(contains(outcome.err, place)) << outcome.err;
        }
    };
    expect_refused("detect missing.ply", "missing.ply");
    expect_refused("detect ''", "cannot read '': ");
    expect_refused("detect .", "crumple: ");
    expect_refused("detect five.off missing.ply", "missing.ply");
    refused("empty.ply", "", "the file is empty");
    refused("text.txt", "Dear reader,\n", "PLY, OBJ, STL, OFF, glTF or 3MF");
    refused("short.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", "line");
    refused("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", "line 6");
    refused("nan.off", "OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "line 4");
    refused("cut.ply",
            "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0123456789",
            "line 3");
}

TEST_F(Misuse, error_in_the_second_file_names_it) {
    write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
    expect_refused("detect five.off index.off", "index.off, line 6");
}

TEST_F(Misuse, file_can_have_the_name_of_a_command) {
    write("info", five_off);
    EXPECT_EQ(crumple("detect info").out, five_pairs);
}

TEST_F(Misuse, help_and_version_succeed) {
    for (const char* command :
         {"", "detect ", "impacts ", "near ", "overlap ", "sequence ", "info ", "verify ", "make ", "convert "}) {
        const Outcome outcome = crumple(std::string(command) + "--help");
        EXPECT_EQ(outcome.status, 0) << command;
        EXPECT_EQ(outcome.err, "") << command;
        EXPECT_TRUE(contains(outcome.out, "Usage: crumple ")) << command;
        EXPECT_TRUE(contains(outcome.out, std::string("Example: crumple ") + command)) << command;
    }
    EXPECT_TRUE(crumple("--version").out.starts_with("crumple "));
    EXPECT_EQ(crumple("--version").status, 0);
}

}  // namespace
}  // namespace crumple::cli::test
