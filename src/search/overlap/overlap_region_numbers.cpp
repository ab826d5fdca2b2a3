// Numbers of an overlap's regions (results/overlap_regions.h): the sums of the whole overlap, restricted to the
// segments and the inside vertices of a region.

#include <algorithm>

#include "results/overlap_regions.h"
#include "search/overlap/overlap_extents.h"
#include "search/overlap/overlap_row.h"

namespace crumple {

// On each surface, the faces of the overlap whose first corner is inside the other one count in the region of that
// corner, and crossings of their edges in the region of the segment that ends there (exact/overlap/pair_terms.h).
std::vector<OverlapRegion> OverlapOfBodies::regions(bool add_sums) {
    const std::array<std::vector<VertexWinding>, 2> inside{inside_vertices(0), inside_vertices(1)};
    std::array<std::vector<std::int32_t>, 2> faces;
    RegionInput input{
        .segments = forward_.segments, .links = forward_.links, .face = face_reader(), .in_range = in_range()};
    for (std::size_t side = 0; side < 2; ++side) {
        for (const WindingInterval& interval : steps(side).intervals()) {
            const auto some = topology(side).faces(interval.begin, interval.end);
            faces[side].insert(faces[side].end(), some.begin(), some.end());
        }
        input.corners[side] = topology(side).corners(0);
        input.inside[side] = inside[side];
        input.faces[side] = faces[side];
        input.vertex_count[side] = static_cast<std::size_t>(body(side).vertex_count);
        input.face_count[side] = static_cast<std::size_t>(topology(side).face_count());
    }
    MemoryClaim memory(meter_);
    for (std::size_t side = 0; side < 2; ++side)
        memory.add(2 * bytes_of(inside[side]) + 3 * bytes_of(faces[side]) + 8 * input.vertex_count[side] +
                   input.face_count[side]);
    memory.add(input.segments.size() * (4 * sizeof(Segment) + 32 * sizeof(std::int64_t)));
    const std::vector<RegionParts> found = find_regions(input, cancellation_);

    std::array<std::vector<std::int32_t>, 2> region_of_vertex;
    for (std::size_t side = 0; side < 2; ++side) region_of_vertex[side].resize(input.vertex_count[side], -1);
    region_of_segment_.assign(forward_.links, -1);
    for (std::size_t r = 0; r < found.size(); ++r) {
        const auto region = static_cast<std::int32_t>(r);
        for (const std::int32_t s : found[r].segments) region_of_segment_[static_cast<std::size_t>(s)] = region;
        for (std::size_t side = 0; side < 2; ++side)
            for (const VertexWinding& vertex : found[r].inside[side])
                region_of_vertex[side][static_cast<std::size_t>(vertex.vertex)] = region;
    }
    std::vector<std::array<std::vector<CountedFace>, 2>> counted(found.size());
    for (std::size_t side = 0; side < 2; ++side)
        for (const WindingInterval& interval : steps(side).intervals())
            for (const std::int32_t face : topology(side).faces(interval.begin, interval.end)) {
                const std::int32_t vertex = topology(side).corners(face)[0];
                const std::int32_t region = region_of_vertex[side][static_cast<std::size_t>(vertex)];
                counted[static_cast<std::size_t>(region)][side].push_back({face, interval.winding});
            }

    std::vector<OverlapRegion> regions(found.size());
    for (std::size_t r = 0; r < found.size(); ++r) {
        cancellation_.check();
        OverlapSums sums = sums_of_surfaces();
        sums.numbers = true;
        sums.faces = std::move(counted[r]);
        for (const std::int32_t s : found[r].segments) {
            Segment segment = forward_.segments[static_cast<std::size_t>(s)];
            segment.times = 2;
            count_crossed_faces(segment, sums.faces);
            sums.segments.push_back(segment);
        }
        regions[r].numbers = finish(sums, sums_.surfaces.origin, false);
        was_exact_ |= sums.was_exact();
        if (add_sums) sums_.add_part(sums);
        regions[r].merged = found[r].merged;
        regions[r].pieces = found[r].pieces;
        ExtentSearch extent(sums_.surfaces, {found[r].inside[0], found[r].inside[1]}, sums.segments, cancellation_);
        regions[r].extent = extent.find(regions[r].numbers.normal);
        was_exact_ |= extent.was_exact();
    }
    return regions;
}

bool OverlapOfBodies::regions_have_all_sums() const {
    return std::ranges::all_of(sums_.segments, [](const Segment& s) { return s.in_volume && s.times == 2; });
}

OverlapExtent OverlapOfBodies::extent(const Vec3d& normal) {
    const std::array<std::vector<VertexWinding>, 2> inside{inside_vertices(0), inside_vertices(1)};
    ExtentSearch extent(sums_.surfaces, {inside[0], inside[1]}, std::span(forward_.segments).first(forward_.links),
                        cancellation_);
    const OverlapExtent found = extent.find(normal);
    was_exact_ |= extent.was_exact();
    return found;
}

}  // namespace crumple
