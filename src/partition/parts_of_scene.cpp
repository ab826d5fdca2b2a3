#include "partition/parts_of_scene.h"

#include <algorithm>
#include <bit>
#include <utility>
#include <variant>

#include "crumple/error.h"
#include "geometry/position_hash.h"
#include "partition/part_centres.h"

namespace crumple {
namespace {

// Numbering of a part's vertices in the order of first use: a hash table with open addressing and linear probing, at
// most half full.
class LocalNumbers {
   public:
    LocalNumbers(std::size_t most, const SeededHash& hash)
        : hash_(hash), slots_(std::bit_ceil(2 * most + 1)), global_(slots_, -1), local_(slots_) {}

    template <class New>
    std::int32_t operator()(std::int32_t vertex, New on_new) {
        std::size_t slot = SeededHash::add(hash_.seed(), static_cast<std::uint32_t>(vertex)) & (slots_ - 1);
        while (global_[slot] >= 0 && global_[slot] != vertex) slot = (slot + 1) & (slots_ - 1);
        if (global_[slot] < 0) {
            global_[slot] = vertex;
            local_[slot] = count_++;
            on_new();
        }
        return local_[slot];
    }

   private:
    const SeededHash& hash_;
    std::size_t slots_;
    std::vector<std::int32_t> global_, local_;
    std::int32_t count_ = 0;
};

// Copies triangles of one of the meshes, with the coordinates of their vertices as Scalar. `ids`: as numbered in the
// scene, where the triangles of a second mesh follow those of the first.
template <class Scalar>
PartMesh copy_mesh(const PreparedScene& scene, std::size_t side, std::span<const std::int32_t> ids,
                   const SeededHash& hash) {
    PartMesh mesh;
    std::vector<Scalar> vertices;
    const auto first_triangle = static_cast<std::int32_t>(side ? scene.triangles[0] : 0);
    mesh.ids.reserve(ids.size());
    mesh.corners.reserve(3 * ids.size());
    const std::size_t most = std::min(3 * ids.size(), static_cast<std::size_t>(scene.vertices[side]));
    LocalNumbers number(most, hash);
    vertices.reserve(3 * std::min(most, ids.size()));
    for (const std::int32_t t : ids) {
        mesh.ids.push_back(t - first_triangle);
        if (scene.groups) mesh.groups.push_back(scene.groups[t]);
        for (int corner = 0; corner < 3; ++corner) {
            const std::int32_t v = scene.corners[3 * std::int64_t{t} + corner];
            mesh.corners.push_back(number(v, [&] {
                const Vec3d p = scene.position(v);
                for (int axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<Scalar>(p[axis]));
            }));
        }
    }
    mesh.vertices = std::move(vertices);
    return mesh;
}

PartMesh copy_mesh(const PreparedScene& scene, std::size_t side, std::span<const std::int32_t> ids,
                   const SeededHash& hash) {
    return scene.reader[side].float32 ? copy_mesh<float>(scene, side, ids, hash)
                                      : copy_mesh<double>(scene, side, ids, hash);
}

// Returns the ids of the triangles in part k, and appends their masks to the part's levels. `slices`: for consecutive
// ranges of the scene's triangles, the members of all parts.
std::vector<std::int32_t> join_members(std::span<const PartMembers> slices, std::size_t k, Part& part) {
    const std::size_t depth = part.levels.size();
    std::size_t size = 0;
    for (const PartMembers& slice : slices) size += static_cast<std::size_t>(slice.first[k + 1] - slice.first[k]);
    std::vector<std::int32_t> ids;
    ids.reserve(size);
    for (PartLevel& level : part.levels) level.masks.reserve(size);
    for (const PartMembers& slice : slices) {
        const auto begin = static_cast<std::size_t>(slice.first[k]), end = static_cast<std::size_t>(slice.first[k + 1]);
        ids.insert(ids.end(), slice.triangle.data() + begin, slice.triangle.data() + end);
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t l = 0; l < depth; ++l) part.levels[l].masks.push_back(slice.masks[depth * i + l]);
    }
    return ids;
}

}  // namespace

MeshView PartMesh::view() const {
    return std::visit(
        [&](const auto& xyz) {
            return MeshView(xyz.data(), static_cast<std::int64_t>(xyz.size() / 3), corners.data(),
                            static_cast<std::int64_t>(corners.size() / 3), groups);
        },
        vertices);
}

PartMembers list_members(const PartTree& tree, int parts, BallOfTriangle ball, std::int64_t begin, std::int64_t end) {
    const auto depth = static_cast<std::size_t>(tree.depth);
    std::vector<std::int32_t> part, triangle;
    std::vector<std::uint64_t> masks;
    PartMembers members;
    members.first.assign(static_cast<std::size_t>(parts) + 1, 0);
    for (std::int64_t t = begin; t < end; ++t)
        tree.for_each_part(ball(t), [&](std::int32_t k, const std::uint64_t* of_levels) {
            ++members.first[static_cast<std::size_t>(k) + 1];
            part.push_back(k);
            triangle.push_back(static_cast<std::int32_t>(t));
            masks.insert(masks.end(), of_levels, of_levels + depth);
        });
    for (std::size_t k = 0; k < static_cast<std::size_t>(parts); ++k) members.first[k + 1] += members.first[k];
    std::vector<std::int64_t> next(members.first);
    members.triangle.resize(triangle.size());
    members.masks.resize(masks.size());
    for (std::size_t i = 0; i < part.size(); ++i) {
        const auto place = static_cast<std::size_t>(next[static_cast<std::size_t>(part[i])]++);
        members.triangle[place] = triangle[i];
        std::copy_n(masks.begin() + static_cast<std::ptrdiff_t>(depth * i), depth,
                    members.masks.begin() + static_cast<std::ptrdiff_t>(depth * place));
    }
    return members;
}

// If there are several slices, each has at least as many triangles as there are parts, so that its table of parts is
// not larger than its contents.
std::vector<PartMembers> list_members(const PartTree& tree, int parts, BallOfTriangle ball, std::int64_t count,
                                      ParallelFor& parallel) {
    const std::int64_t least = std::max<std::int64_t>(4096, parts);
    const std::int64_t slice_count = std::clamp<std::int64_t>(count / least, 1, 64);
    std::vector<PartMembers> slices(static_cast<std::size_t>(slice_count));
    parallel.parallel_for(slices.size(), [&](std::size_t s) {
        const auto i = static_cast<std::int64_t>(s);
        slices[s] = list_members(tree, parts, ball, i * count / slice_count, (i + 1) * count / slice_count);
    });
    return slices;
}

std::vector<Part> make_parts(const PreparedScene& scene, int count, ParallelFor& parallel) {
    const Normaliser normalise(scene.low, scene.high);
    const SeededHash hash;
    const auto ball = [&](std::int64_t t) { return PartBall(scene.triangle(t), normalise); };
    const auto copy = [&](std::span<const std::int32_t> ids, Part& part) {
        const auto second = static_cast<std::size_t>(
            std::partition_point(ids.begin(), ids.end(), [&](std::int32_t t) { return !scene.second(t); }) -
            ids.begin());
        part.mesh = copy_mesh(scene, 0, ids.first(second), hash);
        if (scene.between) part.second = copy_mesh(scene, 1, ids.subspan(second), hash);
    };
    return make_parts(scene, count, parallel, ball, copy);
}

std::vector<Part> make_parts(const PreparedScene& scene, int count, ParallelFor& parallel, BallOfTriangle ball,
                             FunctionRef<void(std::span<const std::int32_t> ids, Part& part)> copy) {
    const PartCentres centres = place_parts(scene, count, parallel);
    const std::vector<PartMembers> slices = list_members(centres.tree(), count, ball, scene.triangle_count(), parallel);
    std::vector<Part> parts(static_cast<std::size_t>(count));
    parallel.parallel_for(parts.size(), [&](std::size_t k) {
        Part& part = parts[k];
        part.index = static_cast<std::int32_t>(k);
        part.count = count;
        part.levels = centres.path(part.index);
        copy(join_members(slices, k, part), part);
    });
    return parts;
}

void check_part(const Part& part) {
    const auto check = [](bool holds, const char* message, Element element = Element::option, std::int64_t index = -1) {
        if (!holds) throw Error(ErrorCode::invalid_argument, message, element, index);
    };
    check(part.index >= 0 && part.index < part.count, "a part's index must be below its count");
    check(!part.levels.empty() && part.levels.size() <= max_levels, "a part needs 1 to 4 levels");
    for (const PartMesh* mesh : {&part.mesh, part.second ? &*part.second : nullptr}) {
        if (!mesh) continue;
        const bool whole = std::visit([](const auto& xyz) { return xyz.size() % 3 == 0; }, mesh->vertices);
        check(whole, "a part's vertices must have three coordinates each");
        check(mesh->corners.size() == 3 * mesh->ids.size(), "a part must have three corners for each triangle id");
        std::int32_t before = -1;
        for (std::size_t i = 0; i < mesh->ids.size(); before = mesh->ids[i++])
            check(mesh->ids[i] > before, "a part's triangle ids must be 0 or more, and ascend", Element::triangle,
                  static_cast<std::int64_t>(i));
    }
    const auto triangles = static_cast<std::size_t>(part.triangle_count());
    for (const PartLevel& level : part.levels) {
        check(level.cluster >= 0 && level.cluster < max_clusters, "a part's cluster must be 0 to 63");
        check(level.masks.size() == triangles, "a part must have a mask for each triangle and level");
        for (std::size_t i = 0; i < triangles; ++i)
            check(level.masks[i] >> level.cluster & 1, "a part's triangles must be members of its cluster",
                  Element::triangle, static_cast<std::int64_t>(i));
    }
}

Part part_within(const Part& part, int side) {
    Part within;
    within.index = part.index;
    within.count = part.count;
    within.mesh = side == 0 ? part.mesh : *part.second;
    const auto begin = side == 0 ? 0 : part.mesh.size();
    for (const PartLevel& level : part.levels) {
        const auto first = level.masks.begin() + begin;
        within.levels.push_back({level.cluster, {first, first + within.mesh.size()}});
    }
    return within;
}

void name_globally(const Part& part, Array<Pair>& pairs) {
    const std::int32_t *first = part.mesh.ids.data(), *second = part.second ? part.second->ids.data() : first;
    for (Pair& pair : pairs) pair = {first[pair.a], second[pair.b]};
}

}  // namespace crumple
