#include "cli/rank_input.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <variant>

#include "cli/rank_vertices.h"
#include "cli/search.h"

namespace crumple::cli {
namespace {

using distribute::Traffic;

/// Whether a block could be read, and which numbers it has; nothing is settled yet.
struct Attempt {
    std::optional<io::MeshSlice> slice;
    std::exception_ptr failed;
};

Attempt attempt_slice(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    Attempt attempt;
    try {
        io::ReadOptions how = read_options(answer);
        how.group_property = answer.groups;
        attempt.slice = io::read_slice(file, how, link.rank(), link.ranks());
    } catch (...) {
        attempt.failed = std::current_exception();
    }
    return attempt;
}

/// All blocks, or none: rank 0 has to read the file if some rank cannot, for it has another format, is a pipe, or lies
/// where not all ranks see it. Throws Error for what is wrong in a block.
std::optional<io::MeshSlice> read_slices(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    // A file of groups has no rows of known length either.
    const bool possible = !is_standard(file) && (answer.groups.empty() || !std::filesystem::exists(answer.groups));
    if (!link.largest(link.is_first() && possible)) return std::nullopt;
    Attempt attempt = attempt_slice(link, file, answer);
    const std::int64_t rows = attempt.slice ? attempt.slice->triangles.rows : -1;
    const std::int64_t most = link.largest(rows);
    const bool fits = attempt.failed || (attempt.slice && rows == most);
    if (!link.least(fits)) return std::nullopt;
    link.agree([&] {
        if (attempt.failed) std::rethrow_exception(attempt.failed);
    });
    return std::move(attempt.slice);
}

/// Sends rank 0's rows out, a block to each rank.
template <class Row>
void hand_out(RankLink& link, const Row* rows, io::Blocks blocks, Row* block) {
    Traffic traffic(link.ranks());
    traffic.in[0] = blocks.size(link.rank());
    if (link.is_first())
        for (int r = 0; r < link.ranks(); ++r) traffic.out[static_cast<std::size_t>(r)] = blocks.size(r);
    link.rounds().exchange<Row>(
        traffic,
        [&](int rank, std::int64_t first, std::span<Row> to) {
            std::copy_n(rows + blocks.begin(rank) + first, to.size(), to.begin());
        },
        [&](int, std::int64_t first, std::span<const Row> from) {
            std::copy(from.begin(), from.end(), block + first);
        });
}

// A vector of scalars as rows of three.
template <class Scalar>
auto* rows_of(std::vector<Scalar>& values) {
    return reinterpret_cast<std::array<Scalar, 3>*>(values.data());
}

io::MeshSlice read_whole(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    Input input;
    link.agree([&] {
        if (link.is_first()) input = read_input({file}, answer);
    });
    io::TriangleMesh& all = input.first;
    std::array<std::int64_t, 4> told{};
    if (link.is_first())
        told = {all.triangle_count(), all.vertex_count(), !all.groups.empty(), all.precision() == ScalarType::float64};
    link.transport().reduce(told, distribute::Reduction::sum);
    io::MeshSlice slice;
    slice.triangles = {told[0], link.ranks()};
    slice.vertices = {told[1], link.ranks()};
    slice.weld = answer.weld.value_or(false);
    const auto triangles = static_cast<std::size_t>(slice.triangles.size(link.rank()));
    const auto vertices = static_cast<std::size_t>(slice.vertices.size(link.rank()));
    link.agree([&] {
        slice.mesh.triangles.resize(3 * triangles);
        if (told[2]) slice.mesh.groups.resize(triangles);
        if (told[3])
            slice.mesh.vertices.emplace<std::vector<double>>(3 * vertices);
        else
            slice.mesh.vertices.emplace<std::vector<float>>(3 * vertices);
    });
    hand_out(link, rows_of(all.triangles), slice.triangles, rows_of(slice.mesh.triangles));
    if (told[2]) hand_out(link, all.groups.data(), slice.triangles, slice.mesh.groups.data());
    std::visit(
        [&](auto& block) {
            using Vertices = std::remove_reference_t<decltype(block)>;
            Vertices* const whole = std::get_if<Vertices>(&all.vertices);
            hand_out(link, whole ? rows_of(*whole) : nullptr, slice.vertices, rows_of(block));
        },
        slice.mesh.vertices);
    return slice;
}

}  // namespace

RankInput read_on_ranks(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    std::optional<io::MeshSlice> slice = read_slices(link, file, answer);
    if (!slice) slice = read_whole(link, file, answer);
    RankInput input{std::move(slice->mesh), {}, slice->triangles, slice->weld};
    if (!slice->soup) input.vertex_ids = bring_named_vertices(link, slice->vertices, input.mesh);
    return input;
}

}  // namespace crumple::cli
