#include "cli/ranks/rank_input.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iterator>
#include <numeric>
#include <span>
#include <utility>
#include <variant>

#include "cli/ranks/ranks.h"
#include "cli/search.h"

namespace crumple::cli {
namespace {

/// Block of a mesh that this rank has read. `end`: for a step, the block of the mesh at the end of the step.
struct RankMeshInput : io::MeshSlice {
    std::optional<io::TriangleMesh> end;
};

/// Collective. Reads one block of a file on each rank. Returns nothing on all ranks if some rank cannot read its block:
/// because the file is standard input or a pipe, is neither binary PLY of triangles nor binary STL, has its groups in
/// another file, would have to be welded for a query about features, or cannot be opened by all ranks. Throws the same
/// Error on all ranks if a block has an error.
std::optional<io::MeshSlice> read_slice(RankLink& link, const std::string& file, const QueryOptions& query_options,
                                        bool for_features) {
    std::optional<io::MeshSlice> slice;
    std::exception_ptr failed;
    try {
        io::ReadOptions how = read_options(query_options);
        how.group_property = query_options.groups;
        // If --groups names a file, it is text, which cannot be read in slices.
        if (!is_standard(file) && (query_options.groups.empty() || !std::filesystem::exists(query_options.groups)))
            slice = io::read_slice(file, how, link.rank(), link.ranks());
    } catch (...) {
        failed = std::current_exception();
    }
    const std::int64_t rows = slice ? slice->triangles.rows : -1, most = link.largest(rows);
    const bool fits = slice && rows == most && !(for_features && slice->weld);
    if (!link.least(failed || fits)) return std::nullopt;
    link.run_checked([&] {
        if (failed) std::rethrow_exception(failed);
    });
    return slice;
}

/// Collective. Reads all files in slices. Returns nothing if that is impossible for one of them, or if the two files of
/// a step do not match: rank 0 then reads both and reports why.
std::optional<RankMeshInput> read_slices(RankLink& link, const std::vector<std::string>& files,
                                         QueryOptions query_options, bool for_features) {
    std::optional<io::MeshSlice> slice = read_slice(link, files[0], query_options, for_features);
    if (!slice) return std::nullopt;
    if (files.size() == 1) return RankMeshInput{std::move(*slice), {}};
    query_options.groups.clear();
    std::optional<io::MeshSlice> end = read_slice(link, files[1], query_options, for_features);
    if (!end) return std::nullopt;
    const bool same = slice->vertices.rows == end->vertices.rows && slice->mesh.triangles == end->mesh.triangles;
    if (!link.least(same)) return std::nullopt;
    return RankMeshInput{std::move(*slice), std::move(end->mesh)};
}

/// Collective. Reads all files on rank 0, and distributes blocks of triangles. All vertices stay on rank 0 until
/// with_vertices().
RankMeshInput read_by_first(RankLink& link, const std::vector<std::string>& files, const QueryOptions& query_options,
                            const QueryOptions& reading) {
    const bool moves = files.size() > 1;
    StepOrStatic input;
    link.run_checked([&] {
        if (!link.is_first()) return;
        if (moves)
            input = read_step_or_static(files[0], files[1], query_options);
        else
            input.start = read_input(files, reading);
        if (!input.start.first.lines.empty()) refuse_on_ranks("a mesh with lines (l)");
        if (!input.start.first.points.empty()) refuse_on_ranks("a mesh with points (p)");
    });
    if (moves && !input.end) input.end.emplace();
    io::TriangleMesh& all = input.start.first;
    RankMeshInput mesh;
    mesh.triangles = {link.sum(all.triangle_count()), link.ranks()};
    mesh.vertices = {link.sum(all.vertex_count()), 1};
    const auto block = [&](std::size_t i) { return mesh.triangles.reader_of(static_cast<std::int64_t>(i)); };
    mesh.mesh.triangles = link.redistribute(all.triangles, block, 3);
    mesh.mesh.groups = link.redistribute(all.groups, block);
    mesh.mesh.vertices = std::move(all.vertices);
    mesh.end = std::move(input.end);
    mesh.weld = query_options.weld.value_or(false);
    return mesh;
}

/// Returns the ids of the vertices that a rank needs, ascending: the vertices [begin, end) of its own block, so that
/// every vertex is on some rank, and the corners of its triangles.
std::vector<std::int64_t> needed_vertex_ids(std::span<const std::int32_t> corners, std::int64_t begin,
                                            std::int64_t end) {
    std::vector<std::int64_t> named, block(static_cast<std::size_t>(end - begin)), all;
    std::copy_if(corners.begin(), corners.end(), std::back_inserter(named),
                 [&](std::int32_t corner) { return corner < begin || corner >= end; });
    std::sort(named.begin(), named.end());
    named.erase(std::unique(named.begin(), named.end()), named.end());
    std::iota(block.begin(), block.end(), begin);
    std::merge(named.begin(), named.end(), block.begin(), block.end(), std::back_inserter(all));
    return all;
}

struct VertexRequest {
    std::int32_t vertex, rank;
};

/// Collective. Replaces the vertices of `mesh`, which this rank has read, by the vertices that it has requested.
/// `requests`: requests of all ranks for vertices that this rank has read. `first`: id of the first vertex that it has
/// read.
void fetch(RankLink& link, const std::vector<VertexRequest>& requests, std::int64_t first, io::TriangleMesh& mesh) {
    const bool doubles = link.largest(std::holds_alternative<std::vector<double>>(mesh.vertices));
    if (doubles && mesh.vertex_count() == 0) mesh.vertices.emplace<std::vector<double>>();
    std::visit(
        [&](auto& xyz) {
            std::decay_t<decltype(xyz)> requested;
            link.run_checked([&] {
                for (const VertexRequest& request : requests) {
                    const auto vertex = xyz.begin() + 3 * (request.vertex - first);
                    requested.insert(requested.end(), vertex, vertex + 3);
                }
            });
            xyz = link.redistribute(
                requested, [&](std::size_t i) { return requests[i].rank; }, 3);
        },
        mesh.vertices);
}

/// Collective. Fetches the vertices that this rank needs, and converts corners from ids to indices of these vertices.
RankInput with_vertices(RankLink& link, RankMeshInput mesh) {
    io::Blocks blocks = mesh.vertices;
    blocks.readers = link.ranks();
    const std::int64_t begin = blocks.begin(link.rank()), end = blocks.end(link.rank());
    RankInput input{std::move(mesh.mesh), std::move(mesh.end), {}, false, mesh.triangles, mesh.weld};
    std::vector<std::int64_t>& ids = input.vertex_ids;
    std::vector<VertexRequest> requests;
    link.run_checked([&] {
        ids = needed_vertex_ids(input.mesh.triangles, begin, end);
        for (const std::int64_t id : ids) requests.push_back({static_cast<std::int32_t>(id), link.rank()});
    });
    requests = link.redistribute(requests, [&](std::size_t i) { return mesh.vertices.reader_of(ids[i]); });
    const std::int64_t first = mesh.vertices.begin(link.rank());
    fetch(link, requests, first, input.mesh);
    if (input.end) fetch(link, requests, first, *input.end);
    const std::int64_t before = std::lower_bound(ids.begin(), ids.end(), begin) - ids.begin();
    for (std::int32_t& corner : input.mesh.triangles) {
        const bool in_block = corner >= begin && corner < end;
        corner = static_cast<std::int32_t>(in_block ? before + corner - begin
                                                    : std::lower_bound(ids.begin(), ids.end(), corner) - ids.begin());
    }
    input.has_copies = link.largest(static_cast<std::int64_t>(ids.size()) > end - begin);
    return input;
}

}  // namespace

LocalMesh RankInput::local_mesh() const {
    const LocalMesh local{.mesh = mesh.view(),
                          .triangle_ids = {},
                          .vertex_ids = has_copies ? std::span(vertex_ids) : std::span<const std::int64_t>()};
    return end ? local.moving_to(end->view().vertices) : local;
}

RankInput read_on_ranks(RankLink& link, const std::vector<std::string>& files, const QueryOptions& query_options,
                        bool for_features) {
    QueryOptions reading = query_options;
    if (for_features)
        reading = files.size() > 1 ? reading_of_motion(query_options) : with_lines_and_points(query_options);
    std::optional<RankMeshInput> mesh = read_slices(link, files, reading, for_features);
    return with_vertices(link, mesh ? std::move(*mesh) : read_by_first(link, files, query_options, reading));
}

}  // namespace crumple::cli
