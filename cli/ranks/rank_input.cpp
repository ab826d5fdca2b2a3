#include "cli/ranks/rank_input.h"

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <variant>

#include "cli/ranks/rank_command.h"
#include "cli/ranks/rank_vertices.h"
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

/// Who reads a file of which equal vertices become one: then they get other numbers, which only the one who has them
/// all can tell.
enum class Welding { anybody, rank_0 };

/// All blocks, or none: rank 0 has to read the file if some rank cannot, for it has another format, is a pipe, or lies
/// where not all ranks see it. Throws Error for what is wrong in a block.
std::optional<io::MeshSlice> read_slices(RankLink& link, const std::string& file, const AnswerOptions& answer,
                                         Welding welding) {
    // A file of groups has no rows of known length either.
    const bool possible = !is_standard(file) && (answer.groups.empty() || !std::filesystem::exists(answer.groups));
    if (!link.largest(link.is_first() && possible)) return std::nullopt;
    Attempt attempt = attempt_slice(link, file, answer);
    const std::int64_t rows = attempt.slice ? attempt.slice->triangles.rows : -1;
    const std::int64_t most = link.largest(rows);
    const bool one_by_one = attempt.slice && (welding == Welding::anybody || !attempt.slice->weld);
    const bool fits = attempt.failed || (one_by_one && rows == most);
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

using Coordinates = decltype(io::TriangleMesh::vertices);

void hand_out_vertices(RankLink& link, Coordinates& all, io::Blocks blocks, Coordinates& block) {
    const bool doubles = link.largest(link.is_first() && std::holds_alternative<std::vector<double>>(all));
    const auto size = 3 * static_cast<std::size_t>(blocks.size(link.rank()));
    link.agree([&] {
        if (doubles)
            block.emplace<std::vector<double>>(size);
        else
            block.emplace<std::vector<float>>(size);
    });
    std::visit(
        [&](auto& xyz) {
            auto* const whole = std::get_if<std::remove_reference_t<decltype(xyz)>>(&all);
            hand_out(link, whole ? rows_of(*whole) : nullptr, blocks, rows_of(xyz));
        },
        block);
}

/// Blocks of the mesh that rank 0 has.
io::MeshSlice hand_out_mesh(RankLink& link, io::TriangleMesh& all) {
    std::array<std::int64_t, 3> told{};
    if (link.is_first()) told = {all.triangle_count(), all.vertex_count(), !all.groups.empty()};
    link.transport().reduce(told, distribute::Reduction::sum);
    io::MeshSlice slice;
    slice.triangles = {told[0], link.ranks()};
    slice.vertices = {told[1], link.ranks()};
    const auto triangles = static_cast<std::size_t>(slice.triangles.size(link.rank()));
    link.agree([&] {
        slice.mesh.triangles.resize(3 * triangles);
        if (told[2]) slice.mesh.groups.resize(triangles);
    });
    hand_out(link, rows_of(all.triangles), slice.triangles, rows_of(slice.mesh.triangles));
    if (told[2]) hand_out(link, all.groups.data(), slice.triangles, slice.mesh.groups.data());
    hand_out_vertices(link, all.vertices, slice.vertices, slice.mesh.vertices);
    return slice;
}

void refuse_lines_and_points(const io::TriangleMesh& mesh) {
    if (!mesh.lines.empty()) refuse_on_ranks("a mesh with lines (l)");
    if (!mesh.points.empty()) refuse_on_ranks("a mesh with points (p)");
}

io::MeshSlice read_whole(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    Input input;
    link.agree([&] {
        if (!link.is_first()) return;
        input = read_input({file}, answer);
        refuse_lines_and_points(input.first);
    });
    io::MeshSlice slice = hand_out_mesh(link, input.first);
    slice.weld = answer.weld.value_or(false);
    return slice;
}

/// Lets corners be numbers over all ranks where they are not yet.
void number_all_corners(io::MeshSlice& slice, int rank) {
    if (!slice.soup) return;
    for (std::int32_t& corner : slice.mesh.triangles) corner += static_cast<std::int32_t>(slice.vertices.begin(rank));
    slice.soup = false;
}

/// As check_same_faces, of blocks.
void check_same_blocks(RankLink& link, const std::string& start_name, const std::string& end_name,
                       const io::MeshSlice& start, const io::MeshSlice& end) {
    link.agree([&] {
        if (!link.is_first()) return;
        check_same_counts(start_name, end_name, "vertices", start.vertices.rows, end.vertices.rows);
        check_same_counts(start_name, end_name, "triangles", start.triangles.rows, end.triangles.rows);
    });
    const std::vector<std::int32_t>&a = start.mesh.triangles, &b = end.mesh.triangles;
    const std::int64_t same = std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin();
    const bool all_same = same == static_cast<std::int64_t>(a.size());
    const std::int64_t first =
        link.least(all_same ? start.triangles.rows : start.triangles.begin(link.rank()) + same / 3);
    link.agree([&] {
        if (link.is_first() && first < start.triangles.rows)
            refuse_other_faces(start_name, end_name, "triangle " + std::to_string(first) + " has other vertices");
    });
}

RankInput input_of(RankLink& link, io::MeshSlice& slice, io::TriangleMesh* end = nullptr) {
    RankInput input{std::move(slice.mesh), {}, {}, slice.triangles, slice.weld};
    if (!slice.soup) input.vertex_ids = bring_named_vertices(link, slice.vertices, input.mesh, end);
    if (end) input.end = std::move(*end);
    return input;
}

}  // namespace

RankInput read_on_ranks(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    std::optional<io::MeshSlice> slice = read_slices(link, file, answer, Welding::anybody);
    if (!slice) slice = read_whole(link, file, answer);
    return input_of(link, *slice);
}

RankInput read_features_on_ranks(RankLink& link, const std::string& file, const AnswerOptions& answer) {
    const AnswerOptions reading = with_lines_and_points(answer);
    std::optional<io::MeshSlice> slice = read_slices(link, file, reading, Welding::rank_0);
    if (!slice) slice = read_whole(link, file, reading);
    number_all_corners(*slice, link.rank());
    return input_of(link, *slice);
}

RankInput read_step_on_ranks(RankLink& link, const std::string& start, const std::string& end,
                             const AnswerOptions& answer) {
    AnswerOptions reading = reading_of_motion(answer);
    std::optional<io::MeshSlice> first = read_slices(link, start, reading, Welding::rank_0), last;
    reading.groups.clear();
    if (first) last = read_slices(link, end, reading, Welding::rank_0);
    if (last) {
        number_all_corners(*first, link.rank());
        number_all_corners(*last, link.rank());
        check_same_blocks(link, start, end, *first, *last);
        return input_of(link, *first, &last->mesh);
    }
    MovingInput whole;
    link.agree([&] {
        if (!link.is_first()) return;
        whole = read_moving_input(start, end, answer);
        refuse_lines_and_points(whole.start.first);
    });
    io::MeshSlice slice = hand_out_mesh(link, whole.start.first);
    io::TriangleMesh moved;
    hand_out_vertices(link, whole.end.vertices, slice.vertices, moved.vertices);
    whole = {};
    return input_of(link, slice, &moved);
}

}  // namespace crumple::cli
