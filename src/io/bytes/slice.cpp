// Decides which files can be read in slices, and reads slices of STL files; ply_slice.cpp reads slices of PLY files.

#include "io/bytes/slice.h"

#include <cmath>
#include <numeric>
#include <sstream>
#include <string_view>

#include "base/float_environment.h"
#include "io/bytes/bytes.h"
#include "io/bytes/gzip.h"
#include "io/bytes/row_file.h"
#include "io/formats.h"
#include "io/meshes/ply_slice.h"
#include "io/scenes/3mf.h"
#include "io/scenes/gltf_file.h"

namespace crumple::io {
namespace {

constexpr std::int64_t stl_header = 80, stl_prologue = 84, stl_record = 50, stl_normal = 12;
constexpr std::int64_t longest_header = std::int64_t{1} << 16;

/// Makes the same test as is_binary_stl() of io/formats.h, for a file of which only the beginning is in memory. `size`:
/// bytes of the whole file.
bool is_binary_stl(const Source& beginning, std::int64_t size) {
    return size >= stl_prologue &&
           size == stl_prologue + stl_record * std::int64_t{load<std::uint32_t>(beginning.begin() + stl_header,
                                                                                std::endian::little)};
}

std::optional<MeshSlice> read_stl_slice(RowFile& file, const ReadOptions& options, int reader, int readers) {
    const std::int64_t triangles = (file.size() - stl_prologue) / stl_record;
    if (triangles == 0 || 3 * triangles > INT32_MAX) return std::nullopt;
    MeshSlice slice{{triangles, readers}, {3 * triangles, readers, 3}, {}, options.weld != Weld::no};
    const std::int64_t first = slice.triangles.begin(reader), count = slice.triangles.size(reader);
    slice.mesh = in_precision(options.precision, ScalarType::float32, [&](auto zero) -> TriangleMesh {
        std::vector<decltype(zero)> xyz;
        xyz.reserve(static_cast<std::size_t>(9 * count));
        file.for_each(stl_prologue + first * stl_record, stl_record, count, [&](const char* row, std::int64_t byte) {
            for (std::int64_t i = 0; i < 9; ++i) {
                const std::int64_t place = stl_normal + 4 * i;
                const auto value = load<float>(row + place, std::endian::little);
                if (!std::isfinite(value)) file.fail_at(byte + place, "a coordinate is not finite");
                xyz.push_back(value);
            }
            return true;
        });
        std::vector<std::int32_t> corners(static_cast<std::size_t>(3 * count));
        std::iota(corners.begin(), corners.end(), static_cast<std::int32_t>(3 * first));
        return {std::move(xyz), std::move(corners)};
    });
    return slice;
}

}  // namespace

std::optional<MeshSlice> read_slice(const std::filesystem::path& path, const ReadOptions& options, int reader,
                                    int readers) {
    const FloatEnvironment environment;
    RowFile file(path);
    if (!file.is_open()) return std::nullopt;
    const std::vector<char> bytes = file.read(0, longest_header);
    if (is_gzip({bytes.data(), bytes.size()})) return std::nullopt;
    std::istringstream stream(std::string(bytes.begin(), bytes.end()));
    const Source beginning(stream, file.name());
    const std::string extension = extension_of(path);
    if (is_gltf(beginning, extension) || is_3mf(beginning, extension)) return std::nullopt;
    if (is_binary_stl(beginning, file.size())) {
        if (!options.group_property.empty()) return std::nullopt;
        return read_stl_slice(file, options, reader, readers);
    }
    const std::string_view text(beginning.text_begin(),
                                static_cast<std::size_t>(beginning.end() - beginning.text_begin()));
    if (!text.starts_with("ply\n") && !text.starts_with("ply\r")) return std::nullopt;
    return read_ply_slice(file, beginning, options, reader, readers);
}

}  // namespace crumple::io
