#pragma once

// Runs the built executable, as a user would, on small meshes whose results are known by hand.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace crumple::cli::test {

namespace fs = std::filesystem;

struct Outcome {
    int status;
    std::string out, err;
};

inline std::string text_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// True if the text is one line that begins with `crumple: `.
inline bool is_error_line(const std::string& text) {
    return text.starts_with("crumple: ") && std::count(text.begin(), text.end(), '\n') == 1 && text.back() == '\n';
}

/// Returns the lines of a text in ascending order, to compare lists whose order differs.
inline std::string sorted_lines(const std::string& text) {
    std::istringstream in(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);) lines.push_back(line);
    std::sort(lines.begin(), lines.end());
    std::string sorted;
    for (const std::string& line : lines) sorted += line + '\n';
    return sorted;
}

/// True if standard output has rows and standard error is empty, or if standard output is empty and standard error is
/// one line, "nothing ...: ..." or "no candidates: ...".
inline bool reports_empty_list(const Outcome& outcome) {
    if (!outcome.out.empty()) return outcome.err.empty();
    return (outcome.err.starts_with("nothing ") || outcome.err.starts_with("no candidates: ")) &&
           std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1;
}

/// Fixture with a temporary folder of its own, removed at the end.
class Cli : public testing::Test {
   protected:
    Cli() {
        std::string name = (fs::temp_directory_path() / "crumple-cli-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        folder_ = name;
    }
    ~Cli() override { fs::remove_all(folder_); }

    fs::path file(const std::string& name) const { return folder_ / name; }
    void write(const std::string& name, std::string_view bytes) const {
        std::ofstream(file(name), std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    std::string read(const std::string& name) const { return text_of(file(name)); }

    /// Runs a shell command in the folder. `$crumple` is the executable.
    Outcome shell(const std::string& command) const {
        const std::string line = "cd '" + folder_.string() + "' && crumple='" CRUMPLE_EXECUTABLE "' && { " + command +
                                 "\n} >stdout.log 2>stderr.log";
        const int status = std::system(("bash -c \"" + escaped(line) + "\"").c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read("stdout.log"), read("stderr.log")};
    }
    Outcome crumple(const std::string& arguments) const { return shell("$crumple " + arguments); }

   private:
    static std::string escaped(const std::string& text) {
        std::string result;
        for (const char c : text) {
            if (c == '"' || c == '$' || c == '\\' || c == '`') result += '\\';
            result += c;
        }
        return result;
    }
    fs::path folder_;
};

// Triangle 1 crosses triangle 0. Triangle 3 touches triangle 0 at a corner, with a vertex of its own. Triangle 4 is
// folded onto triangle 2 about their common edge.
inline constexpr const char* five_off =
    "OFF\n14 5 0\n"
    "0 0 0\n4 0 0\n0 4 0\n"
    "1 1 -1\n1 1 1\n3 3 0.5\n"
    "10 0 0\n14 0 0\n10 4 0\n"
    "0 0 0\n-1 0 1\n0 -1 1\n"
    "11 3 0\n7 7 7\n"
    "3 0 1 2\n3 3 4 5\n3 6 7 8\n3 9 10 11\n3 6 7 12\n";
inline constexpr const char* five_pairs = "0 1\n0 3\n2 4\n";

/// Triangle 0 crosses triangles 2 and 4 of five_off; triangle 1 touches triangles 0 and 3 of five_off at a corner.
inline constexpr const char* two_off =
    "OFF\n6 2 0\n11 1 -1\n11 1 1\n12 1 1\n0 0 0\n-1 -1 5\n-1 -2 5\n3 0 1 2\n3 3 4 5\n";

/// Two triangles that are 1e-60 apart in float64 and touch in float32.
inline constexpr const char* near_off =
    "OFF\n6 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1e-60\n1 0 1e-60\n0 1 1e-60\n3 0 1 2\n3 3 4 5\n";

}  // namespace crumple::cli::test
