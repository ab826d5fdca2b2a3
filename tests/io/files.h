#pragma once

// Functions for the tests of crumple::io that make files of bytes, read them back, and compare bit by bit.

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include "crumple/error.h"
#include "crumple/io.h"
#include "error_of.h"
#include "io/bytes/bytes.h"

namespace crumple::io::test {

namespace fs = std::filesystem;
using crumple::test::error_of;

/// Temporary folder, removed at the end.
class Folder {
   public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "crumple-io-XXXXXX").string();
        if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
        path_ = name;
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() { fs::remove_all(path_); }

    fs::path operator/(const std::string& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }

    fs::path write(const std::string& name, std::string_view bytes) const {
        std::ofstream(path_ / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return path_ / name;
    }

   private:
    fs::path path_;
};

inline std::string bytes_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

/// Returns the mesh that read_mesh reads from these bytes.
inline TriangleMesh read_bytes(std::string_view bytes, const std::string& name, const ReadOptions& options = {}) {
    const Folder folder;
    return read_mesh(folder.write(name, bytes), options);
}

/// Expects an error of format at this line or byte, whose message names file and place.
inline void expect_bad(std::string_view bytes, const std::string& name, Element element, std::int64_t place,
                       const std::string& what, const ReadOptions& options = {}) {
    const Error error = error_of([&] { read_bytes(bytes, name, options); });
    EXPECT_EQ(error.code, ErrorCode::format) << error.what();
    EXPECT_EQ(error.element, element) << error.what();
    EXPECT_EQ(error.index, place) << error.what();
    const std::string message = error.what();
    EXPECT_NE(message.find(name), message.npos) << message;
    const std::string named = (element == Element::line ? "line " : "byte ") + std::to_string(place) + ":";
    EXPECT_NE(message.find(named), message.npos) << message;
    EXPECT_NE(message.find(what), message.npos) << message;
}

/// Returns the coordinates as float64, which is exact.
inline std::vector<double> coordinates(const TriangleMesh& mesh) {
    return std::visit([](const auto& xyz) { return std::vector<double>(xyz.begin(), xyz.end()); }, mesh.vertices);
}

/// Expects the same precision, the same bits (so that -0 differs from +0), and the same triangles and groups.
inline void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
    ASSERT_EQ(a.precision(), b.precision());
    ASSERT_EQ(a.vertex_count(), b.vertex_count());
    const std::vector<double> p = coordinates(a), q = coordinates(b);
    for (std::size_t i = 0; i < p.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(p[i]), std::bit_cast<std::uint64_t>(q[i]))
            << "vertex " << i / 3 << ": " << p[i] << " and " << q[i];
    }
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.groups, b.groups);
}

/// Returns the bytes of numbers in the given byte order.
template <class... Number>
std::string packed(std::endian order, Number... values) {
    std::string bytes;
    const auto append = [&](auto value) {
        const auto little = little_endian(value);
        bytes += order == std::endian::little ? std::string(little.begin(), little.end())
                                              : std::string(little.rbegin(), little.rend());
    };
    (append(values), ...);
    return bytes;
}

/// Returns the folder of real scenes and exact results, if there is one.
inline std::optional<fs::path> data_folder() {
    const char* const set = std::getenv("CRUMPLE_DATA");
    if (set && *set) return fs::path(set);
    const fs::path beside = fs::path(__FILE__).parent_path() / "../../../shared/data";
    if (fs::exists(beside)) return beside.lexically_normal();
    return std::nullopt;
}

}  // namespace crumple::io::test
