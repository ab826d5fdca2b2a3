#include "fuzz/decode.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <limits>

namespace crumple::fuzz {
namespace {

using Point = std::array<double, 3>;

/// Numbers at limits of filters, expansions or float32. The first `tame` of them are of moderate size, so that the
/// integers of rational arithmetic stay short and a search takes about 0.1 ms.
constexpr double hostile[] = {
    0.0,         -0.0,      1.0,      -1.0,      2.0,        -2.0,        3.0,
    0.5,         -0.5,      1.0 / 3,  0.1,       0x1p-24,    0x1p-52,     0x1p23,
    0x1p24,      0x1p52,    0x1p53,   0x1p62,    0x1p-62,    1 + 0x1p-52, 1 + 0x1p-23,
    1 - 0x1p-53, 1e16,      -1e-9,    0x1p-1074, -0x1p-1074, 0x1p-1022,   0x1.fffffffffffffp-1023,
    0x1p-149,    -0x1p-149, 0x1p-126, 1e300,     -1e300,     1e-300,      -1e-300,
    0x1p301,     0x1p-301,  0x1p150,  0x1p-150,  DBL_MAX,    -DBL_MAX,    FLT_MAX,
    -FLT_MAX,    1e38,      1e-38,    0x1p127,   0x1p-127,   0x1p500,     0x1p-500,
};
constexpr int tame = 24;

struct Style {
    bool single;  ///< coordinates are float32 numbers
    bool wild;    ///< mixes numbers of very different size
};

/// Binary exponents by which a whole mesh is scaled, mostly 0.
constexpr int scales[] = {0, 0, 0, 0, 0, 0, 0, 0, 1, -1, 30, -30, 120, -140, 300, -300, 480, -480, 1000, -1000, -1074};
/// Offsets added to all coordinates of a mesh, in its own precision.
constexpr double shifts[] = {0, 0, 0, 0, 0, 0, 1, 0.1, -1e6, 0x1p24, 0x1p53, 1e16, -0x1p-30};

double nearest(double x, bool single) {
    if (!single) return std::clamp(x, -DBL_MAX, DBL_MAX);
    return std::isfinite(static_cast<float>(x)) ? static_cast<float>(x) : std::copysign(FLT_MAX, x);
}

double moved_by_ulps(double x, int ulps, bool single) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (; ulps != 0; ulps -= ulps > 0 ? 1 : -1) {
        const double to = ulps > 0 ? infinity : -infinity;
        const double next =
            single ? std::nextafter(static_cast<float>(x), static_cast<float>(to)) : std::nextafter(x, to);
        if (!std::isfinite(next)) break;
        x = next;
    }
    return x;
}

/// Returns a finite number made from the next bytes: of moderate size, or with these bits if style.wild.
double raw(Bytes& bytes, Style style) {
    std::uint64_t bits = 0;
    for (int i = 0; i < (style.single ? 4 : 8); ++i) bits = bits << 8 | bytes.next();
    if (!style.wild) {
        const int digits = style.single ? 23 : 52;
        const double fraction = static_cast<double>(bits & ((std::uint64_t{1} << digits) - 1));
        const double size = 1 + std::ldexp(fraction, -digits);
        return std::ldexp(bits >> 31 & 1 ? -size : size, static_cast<int>(bits >> digits & 15) - 12);
    }
    if (style.single) {
        const auto value = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        return std::isfinite(value) ? value : static_cast<double>(bits & 0xffff);
    }
    const auto value = std::bit_cast<double>(bits);
    return std::isfinite(value) ? value : static_cast<double>(bits & 0xffff);
}

/// Returns a vertex between, beyond or near earlier vertices: collinear or coplanar with them up to rounding.
Point derived(Bytes& bytes, const std::vector<Point>& vertices, Style style) {
    if (vertices.empty()) return {};
    const auto earlier = [&] { return vertices[static_cast<std::size_t>(bytes.next()) % vertices.size()]; };
    const int kind = bytes.below(6);
    const Point p = earlier(), q = earlier(), r = kind >= 3 ? earlier() : p;
    const double t = kind == 1 || kind == 5 ? bytes.next() / 255.0 : 0.5;
    Point result{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double x = p[axis], y = q[axis], z = r[axis];
        result[axis] = kind == 0   ? x / 2 + y / 2
                       : kind == 1 ? x + t * (y - x)
                       : kind == 2 ? 2 * y - x
                       : kind == 3 ? x + (y - z)
                       : kind == 4 ? (x + y + z) / 3
                                   : x + t * (y - x) + (1 - t) * (z - x) / 2;
        if (!std::isfinite(result[axis])) result[axis] = x;
    }
    const int nudge = bytes.next();
    auto& nudged = result[static_cast<std::size_t>(nudge % 3)];
    if (nudge >= 128 && (nudged != 0 || style.wild))
        nudged = moved_by_ulps(nearest(nudged, style.single), nudge % 5 - 2, style.single);
    return result;
}

Point vertex(Bytes& bytes, const std::vector<Point>& earlier, Style style) {
    Point p{};
    const int kind = bytes.below(8);
    switch (kind) {
        case 0:
        case 1:  // a small grid: most positions occur more than once
            for (double& x : p) x = bytes.below(kind == 0 ? 4 : 9);
            return p;
        case 2:  // near a grid, by a few ulps
            for (double& x : p) {
                const int byte = bytes.next();
                const int grid = byte % 16 - 8, ulps = byte / 16 % 8 - 3;
                x = grid != 0 || style.wild ? moved_by_ulps(grid, ulps, style.single)
                                            : std::ldexp(ulps, style.single ? -23 : -52);
            }
            return p;
        case 3:
            for (double& x : p) x = hostile_number(bytes, style.wild);
            return p;
        case 4:
            for (double& x : p) x = raw(bytes, style);
            return p;
        case 5:
            return derived(bytes, earlier, style);
        case 6: {  // an earlier vertex, perhaps with the sign or the value of one coordinate changed
            if (!earlier.empty()) p = earlier[static_cast<std::size_t>(bytes.next()) % earlier.size()];
            const int byte = bytes.next();
            double& x = p[static_cast<std::size_t>(byte % 3)];
            if (byte >= 64) x = byte < 128 ? -x : bytes.below(4);
            return p;
        }
        default:  // a common plane
            p[0] = bytes.below(16) - 8;
            p[1] = bytes.below(16) - 8;
            p[2] = 2 * p[0] - p[1];
            return p;
    }
}

Point placed(Point p, int scale, double shift, bool single) {
    for (double& x : p) x = nearest(nearest(std::ldexp(x, scale) + shift, single), single);
    return p;
}

}  // namespace

double hostile_number(Bytes& bytes, bool wild) {
    return hostile[bytes.below(wild ? static_cast<int>(std::size(hostile)) : tame)];
}

Mesh mesh(Bytes& bytes, const Kind& kind, std::size_t side) {
    Mesh result;
    result.single = kind.single[side];
    result.layout = kind.layout[side];
    const int scale = kind.scaled ? bytes.one_of(scales) : 0;
    const double shift = bytes.one_of(shifts);
    const int triangles = bytes.below(kind.most + 1);
    const int vertices = bytes.below(2 * kind.most + 4);
    const bool soup = bytes.flag();  // triangles have their own vertices while there are enough
    std::vector<Point> unplaced;
    for (int v = 0; v < vertices; ++v) {
        unplaced.push_back(vertex(bytes, unplaced, {result.single, kind.wild}));
        for (double& x : unplaced.back()) x = nearest(x, result.single);
        result.vertices.push_back(placed(unplaced.back(), scale, shift, result.single));
    }
    for (int t = 0; t < triangles && vertices > 0; ++t) {
        std::array<std::int64_t, 3> corners{};
        for (std::size_t c = 0; c < 3; ++c) corners[c] = (soup ? 3 * t + static_cast<int>(c) : bytes.next()) % vertices;
        result.triangles.push_back(corners);
        if (kind.groups[side] > 0) result.groups.push_back(group_ids[bytes.below(kind.groups[side])]);
    }
    return result;
}

namespace {

/// Returns `frame` with up to four vertices or corners changed, or with new meshes.
Frame next_frame(Bytes& bytes, const Kind& kind, Frame frame) {
    const int changes = bytes.below(5);
    for (int i = 0; i < changes; ++i) {
        Mesh& changed = frame[static_cast<std::size_t>(bytes.next()) % frame.size()];
        if (changed.vertices.empty()) continue;
        const auto place = static_cast<std::size_t>(bytes.next());
        if (place < 192 || changed.triangles.empty()) {
            Point p = vertex(bytes, changed.vertices, {changed.single, kind.wild});
            for (double& x : p) x = nearest(x, changed.single);
            changed.vertices[place % changed.vertices.size()] = p;
        } else {
            changed.triangles[place % changed.triangles.size()][0] =
                bytes.below(static_cast<int>(changed.vertices.size()));
        }
    }
    if (changes == 0)
        for (std::size_t side = 0; side < frame.size(); ++side) frame[side] = mesh(bytes, kind, side);
    return frame;
}

/// Makes the input invalid. Both backends must report the same error.
void spoil(Bytes& bytes, Frame& frame) {
    Mesh& mesh = frame[static_cast<std::size_t>(bytes.next()) % frame.size()];
    const auto place = static_cast<std::size_t>(bytes.next());
    constexpr double not_finite[] = {NAN, INFINITY, -INFINITY};
    constexpr std::int64_t outside[] = {-1, INT32_MAX, INT32_MIN, 1 << 20};
    switch (bytes.below(3)) {
        case 0:
            if (!mesh.vertices.empty())
                mesh.vertices[place % mesh.vertices.size()][place % 3] = bytes.one_of(not_finite);
            break;
        case 1:
            if (!mesh.triangles.empty())
                mesh.triangles[place % mesh.triangles.size()][place % 3] = bytes.one_of(outside);
            break;
        default:
            mesh.groups.push_back(0);
    }
}

}  // namespace

Options options(Bytes& bytes) {
    constexpr Simd sets[] = {Simd::automatic, Simd::scalar, Simd::sse4, Simd::avx2, Simd::avx512, Simd::neon};
    constexpr int clusters[] = {0, 0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 3, 7, 7, 7, 64};
    constexpr int leaf_sizes[] = {3000, 3000, 1, 2, 3, 8, 20};
    constexpr double fuzzinesses[] = {2, 2, 1.0000001, 1.5, 3, 1e9};
    constexpr int iterations[] = {2, 0, 1, 5};
    constexpr double stops[] = {1e-2, 0, 1, INFINITY};
    Options o;
    o.backend = Backend::cpu;
    o.threads = bytes.next() >= 240 ? 2 : 1;  // threads are slow to start
    o.simd = bytes.one_of(sets);
    o.clusters = bytes.one_of(clusters);
    o.leaf_size = bytes.one_of(leaf_sizes);
    o.fuzzy_c_means.fuzziness = bytes.one_of(fuzzinesses);
    const int how = bytes.next();
    o.fuzzy_c_means.max_iterations = iterations[how & 3];
    o.fuzzy_c_means.first_iterations = iterations[how >> 2 & 3];
    o.fuzzy_c_means.stop = stops[how >> 4 & 3];
    o.fuzzy_c_means.first_stop = stops[how >> 6 & 3];
    return o;
}

Search::Search(Bytes bytes) {
    constexpr int sizes[] = {1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4, 6, 8, 28,
                             1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4, 6, 8, 12};
    constexpr IndexType indices[] = {IndexType::int32, IndexType::uint32, IndexType::int64};
    constexpr PairScope scopes[] = {PairScope::both, PairScope::both, PairScope::between, PairScope::within};
    Kind kind;
    reused = bytes.flag();
    kind.most = bytes.one_of(sizes);
    kind.wild = bytes.below(8) == 7;
    if (kind.wild) kind.most = std::min(kind.most, 3);
    options = fuzz::options(bytes);
    const int how = bytes.next();
    query.neighbours = how & 1 ? Neighbours::skip : Neighbours::geometric;
    query.kind = how & 2 ? IntersectionKind::proper : IntersectionKind::all;
    query.weld = how & 4;
    query.output = how & 8 ? Output::contacts : Output::pairs;
    query.filter.groups = scopes[how >> 4 & 3];
    kind.between = how & 64;
    const bool spoilt = bytes.next() == 255;
    const int extras = bytes.next();
    // Each part costs one search, and each memory limit about five. Inputs with many parts reach more code than others,
    // so libFuzzer would prefer them. Therefore a checksum of the input decides whether such expensive checks are done:
    // unlike the value of a byte, libFuzzer cannot learn a checksum.
    const std::uint32_t share = bytes.checksum();
    if (share / 32 % 8 == 0) block_rows = 1 + share / 256 % 40;
    if (extras & 1) parts = 1 + bytes.next() % 64 / (share % 16 == 0 ? 1 : 16);
    if (extras & 4 && share % 16 == 1) parts *= 17;  // may exceed the 64 parts of one level
    if ((extras & 24) == 24) {
        const std::int64_t limit = bytes.next() * (extras & 32 ? 16 : 256);
        if (share / 16 % 2) memory_limit = limit;
    }
    for (std::size_t side = 0; side < 2; ++side) {
        kind.single[side] = bytes.flag();
        kind.layout[side] = {bytes.one_of(indices), bytes.below(6), bytes.below(6)};
        kind.groups[side] = std::max(0, bytes.below(8) - 1);
    }
    for (int n = bytes.below(4); n > 0; --n) excluded.push_back({bytes.one_of(group_ids), bytes.one_of(group_ids)});
    query.filter.excluded_groups = excluded;
    const int count = 1 + std::max(0, bytes.below(8) - 5);
    frames.emplace_back();
    for (std::size_t side = 0; side < (kind.between ? 2u : 1u); ++side) frames[0].push_back(mesh(bytes, kind, side));
    while (static_cast<int>(frames.size()) < count) frames.push_back(next_frame(bytes, kind, frames.back()));
    if (spoilt) spoil(bytes, frames[static_cast<std::size_t>(bytes.next()) % frames.size()]);
}

}  // namespace crumple::fuzz
