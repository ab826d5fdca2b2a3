#include "distributed/rank_mesh.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <string>

#include "crumple/error.h"

namespace crumple::distribute {
namespace {

[[noreturn]] void refuse(const std::string& what, Element element = Element::none, std::int64_t index = -1) {
    throw Error(ErrorCode::invalid_argument, what, element, index);
}

void check_count(std::span<const std::int64_t> ids, std::int64_t rows, const char* what) {
    if (!ids.empty() && static_cast<std::int64_t>(ids.size()) != rows)
        refuse(std::string(what) + "_ids must have one id per " + what + ": " + std::to_string(rows) + ", not " +
               std::to_string(ids.size()));
}

// Returns the least id of an element i for which bad(i) is true, and sets `place` to i; returns the largest int64 if
// there is none.
template <class Bad>
std::int64_t least_bad(const Ids& ids, std::int64_t count, Bad bad, std::int64_t& place) {
    std::int64_t least = std::numeric_limits<std::int64_t>::max();
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t id = ids.are_given() ? ids.given[static_cast<std::size_t>(i)] : ids.first + i;
        if (id < least && bad(i)) least = id, place = i;
    }
    return least;
}

void check_range(const Ids& ids, std::int64_t count, std::int64_t end, const char* what, Element element) {
    if (!ids.are_given()) return;
    std::int64_t place = 0;
    const auto outside = [&](std::int64_t i) {
        const std::int64_t id = ids.given[static_cast<std::size_t>(i)];
        return id < 0 || id >= end;
    };
    const std::int64_t id = least_bad(ids, count, outside, place);
    if (id == std::numeric_limits<std::int64_t>::max()) return;
    refuse(std::string(what) + " " + std::to_string(place) + " has the id " + std::to_string(id) +
               ", but ids are 0 to " + std::to_string(end - 1),
           element, std::max<std::int64_t>(id, 0));
}

// 128-bit hash of arrays: two independent chains over words of eight bytes, each mixed by a multiplication and a
// rotation.
class Fingerprint {
   public:
    void add(std::span<const std::byte> bytes) {
        std::uint64_t word = 0;
        std::size_t i = 0;
        for (; i + sizeof word <= bytes.size(); i += sizeof word) {
            std::memcpy(&word, bytes.data() + i, sizeof word);
            mix(word);
        }
        word = bytes.size();  // distinguishes arrays of different lengths
        if (i < bytes.size()) std::memcpy(&word, bytes.data() + i, bytes.size() - i);
        mix(word);
        mix(bytes.size());
    }
    std::array<std::uint64_t, 2> value() const { return value_; }

   private:
    void mix(std::uint64_t word) {
        value_[0] = std::rotl((value_[0] ^ word) * 0x9e3779b97f4a7c15ull, 29);
        value_[1] = std::rotl((value_[1] + word) * 0xc2b2ae3d27d4eb4full, 31) ^ word;
    }
    std::array<std::uint64_t, 2> value_{0x243f6a8885a308d3ull, 0x13198a2e03707344ull};
};

}  // namespace

void RankMesh::check_shape(const LocalMesh& local) {
    if (local.mesh.triangles.rows < 0 || local.mesh.vertices.rows < 0)
        refuse("the local mesh has a negative number of triangles or vertices");
    check_count(local.triangle_ids, local.mesh.triangles.rows, "triangle");
    check_count(local.vertex_ids, local.mesh.vertices.rows, "vertex");
}

void RankMesh::number(const LocalMesh& local, bool triangle_ids, bool vertex_ids, std::span<const std::int64_t> counts,
                      int rank) {
    triangles_ = vertices_ = {};
    for (std::size_t r = 0; 2 * r < counts.size(); ++r) {
        if (static_cast<int>(r) < rank) triangles_.first += counts[2 * r], vertices_.first += counts[2 * r + 1];
        triangles_.all += counts[2 * r], vertices_.all += counts[2 * r + 1];
    }
    // An empty list of given ids needs a pointer that is not null, since null means that no ids are given.
    static constexpr std::int64_t none = 0;
    const auto take = [](std::span<const std::int64_t> given) {
        return given.empty() ? std::span<const std::int64_t>(&none, 0) : given;
    };
    if (triangle_ids) triangles_.given = take(local.triangle_ids);
    if (vertex_ids) vertices_.given = take(local.vertex_ids);
    const auto check_all = [](std::int64_t all, const char* what) {
        if (all > most_ids)
            refuse("there are " + std::to_string(all) + " " + what +
                   " over all ranks; at most 2147483647 are supported");
    };
    check_all(triangles_.all, "triangles");
    if (!vertex_ids) check_all(vertices_.all, "vertices");
    const auto has_ids = [](std::span<const std::int64_t> ids, std::int64_t rows, const char* what) {
        if (static_cast<std::int64_t>(ids.size()) != rows)
            refuse(std::string(what) + "_ids are missing on this rank, but another rank has them");
    };
    if (triangle_ids) has_ids(local.triangle_ids, local.mesh.triangles.rows, "triangle");
    if (vertex_ids) has_ids(local.vertex_ids, local.mesh.vertices.rows, "vertex");
}

template <class Read>
void RankMesh::with_global_index(Read read) const {
    try {
        read();
    } catch (const Error& error) {
        if (error.index < 0 || (error.element != Element::vertex && error.element != Element::triangle)) throw;
        const bool vertex = error.element == Element::vertex;
        const Ids& ids = vertex ? vertices_ : triangles_;
        const std::int64_t id =
            ids.are_given() ? ids.given[static_cast<std::size_t>(error.index)] : ids.first + error.index;
        std::string message = error.what();
        if (id != error.index)
            message += (vertex ? " (vertex " : " (triangle ") + std::to_string(id) + " over all ranks)";
        throw Error(error.code, message, error.element, id);
    }
}

void RankMesh::read(const LocalMesh& local, ParallelFor& workers) {
    MeshView mesh = local.mesh;
    mesh.edges = {}, mesh.points = {};
    check_range(triangles_, mesh.triangles.rows, triangles_.all, "triangle", Element::triangle);
    check_range(vertices_, mesh.vertices.rows, most_ids, "vertex", Element::vertex);
    with_global_index([&] { scene_ = prepare_scene(mesh, nullptr, false, workers, buffers_); });
}

void RankMesh::read_end(const VertexView& end, ParallelFor& workers) {
    with_global_index([&] { add_motion(end, workers, buffers_, scene_); });
}

bool RankMesh::is_same_as_before() {
    const auto m = static_cast<std::size_t>(scene_.triangle_count());
    Kept now;
    Fingerprint print;
    print.add(std::as_bytes(std::span(scene_.corners, 3 * m)));
    if (scene_.groups) print.add(std::as_bytes(std::span(scene_.groups, m)));
    print.add(std::as_bytes(triangles_.given));
    print.add(std::as_bytes(vertices_.given));
    now.fingerprint = print.value();
    now.first_triangle = triangles_.first, now.first_vertex = vertices_.first;
    now.triangles = triangles_.all, now.vertices = vertices_.all;
    now.own_triangles = scene_.triangle_count(), now.own_vertices = scene_.vertex_count();
    now.float32 = scene_.float32, now.groups = scene_.groups != nullptr;
    now.triangle_ids = triangles_.are_given(), now.vertex_ids = vertices_.are_given();
    const bool is_same = now == kept_;
    kept_ = now;
    return is_same;
}

void RankMesh::forget() { kept_ = {}; }

}  // namespace crumple::distribute
