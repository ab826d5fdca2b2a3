#include "fuzz/decode_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace crumple::fuzz {
namespace {

/// Returns an element of a pose: a number of moderate size or, if `mixed`, one of very different sizes. Mixed sizes
/// make rational arithmetic ten times as slow, so only an eighth of the inputs have them.
double number(Bytes& bytes, bool mixed) {
    constexpr double numbers[] = {0, -0.0, 1, -1, 2, -3, 0.5, 1.0 / 3, 0.1, 1 + 0x1p-52, 1 - 0x1p-53, 1 + 0x1p-23};
    return mixed ? hostile_number(bytes, false) : bytes.one_of(numbers);
}

/// Sets the pose to a rotation by a quaternion of small integers: by right angles, or by angles whose matrix is
/// rounded.
void turn(Bytes& bytes, Pose& pose) {
    double q[4], length2 = 0;
    for (double& c : q) c = bytes.below(7) - 3, length2 += c * c;
    if (length2 == 0) return;
    const double f = 2 / length2, x = q[0], y = q[1], z = q[2], w = q[3];
    pose.rows = {1 - f * (y * y + z * z), f * (x * y - z * w),     f * (x * z + y * w),     0,
                 f * (x * y + z * w),     1 - f * (x * x + z * z), f * (y * z - x * w),     0,
                 f * (x * z - y * w),     f * (y * z + x * w),     1 - f * (x * x + y * y), 0};
}

void shift(Bytes& bytes, Pose& pose, bool mixed) {
    const int kind = bytes.below(4);
    for (std::size_t i = 3; i < 12; i += 4)
        pose.rows[i] = kind == 0   ? bytes.below(8) - 4  // vertices meet vertices
                       : kind == 1 ? (bytes.next() - 128) / 64.0
                       : kind == 2 ? number(bytes, mixed)
                                   : 0.1 * (bytes.below(16) - 8);
}

Pose pose(Bytes& bytes, const std::vector<Pose>& earlier, bool mixed) {
    Pose result;
    switch (bytes.below(8)) {
        case 0:
            break;
        case 1:
            shift(bytes, result, mixed);
            break;
        case 2:  // scaled, reflected, flattened to a plane, a line or a point
            turn(bytes, result);
            for (std::size_t k = 0; k < 3; ++k) {
                constexpr double factors[] = {1, 1, 2, -1, 0.5, 0, -0.3, 0x1p-20};
                const double factor = bytes.one_of(factors);
                for (std::size_t i = 0; i < 12; i += 4) result.rows[i + k] *= factor;
            }
            shift(bytes, result, mixed);
            break;
        case 3:  // any numbers
            for (double& x : result.rows) x = number(bytes, mixed);
            break;
        case 4:  // the pose of another body, perhaps with one number moved by an ulp
            if (!earlier.empty()) result = earlier[static_cast<std::size_t>(bytes.next()) % earlier.size()];
            if (const int byte = bytes.next(); byte >= 128) {
                double& x = result.rows[static_cast<std::size_t>(byte % 12)];
                x = std::nextafter(x, byte & 64 ? INFINITY : -INFINITY);
            }
            break;
        default:
            turn(bytes, result);
            shift(bytes, result, mixed);
    }
    return result;
}

IntersectionQuery decode_query(Bytes& bytes, int bodies) {
    constexpr PairScope scopes[] = {PairScope::both, PairScope::both, PairScope::between, PairScope::within};
    IntersectionQuery result;
    constexpr Output outputs[] = {Output::any,   Output::any_by_world, Output::body_pairs,
                                  Output::count, Output::pairs,        Output::contacts};
    result.output = outputs[bytes.below(6)];
    const int how = bytes.next();
    result.neighbours = how & 1 ? Neighbours::skip : Neighbours::geometric;
    result.kind = how & 2 ? IntersectionKind::proper : IntersectionKind::all;
    result.weld = how & 4;
    result.index = how & 8;
    result.filter.bodies = scopes[how >> 4 & 3];
    result.filter.groups = scopes[how >> 6 & 3];
    for (int n = bytes.below(4) % 3; n > 0 && bodies > 0; --n) {
        const int first = bytes.below(bodies), second = bytes.below(bodies);
        result.filter.excluded_bodies.push_back({first, second});
    }
    for (int n = bytes.below(4) % 3; n > 0; --n) {
        const std::int32_t first = bytes.one_of(group_ids), second = bytes.one_of(group_ids);
        result.filter.excluded_groups.push_back({first, second});
    }
    return result;
}

/// Decodes bodies in ascending order of world ids; bodies shared by all worlds come last.
std::vector<Body> some_bodies(Bytes& bytes, int shapes) {
    std::vector<Body> result;
    const int count = bytes.below(9), worlds = bytes.below(4), everywhere = bytes.below(4);
    std::int32_t world = 0;
    for (int b = 0; b < count; ++b) {
        Body body;
        const int byte = bytes.next();
        body.shape = byte % shapes;
        body.self = byte & 128;
        body.group = bytes.one_of(group_ids);
        if (byte / 16 % 4 < worlds) world += byte / 16 % 4;
        body.world = b + everywhere > count ? -1 : world;
        result.push_back(body);
    }
    return result;
}

/// Makes the input invalid, in a way that the next byte chooses.
void spoil(Bytes& bytes, Bodies& bodies) {
    const int byte = bytes.next();
    const auto place = static_cast<std::size_t>(bytes.next());
    Mesh& shape = bodies.shapes[place % bodies.shapes.size()];
    Call& call = bodies.calls[place % bodies.calls.size()];
    constexpr double numbers[] = {NAN, INFINITY, 1e308, -1e308};
    constexpr std::int64_t outside[] = {-1, INT32_MAX, INT32_MIN, 1 << 20};
    if (byte % 5 == 0 && !shape.vertices.empty())
        shape.vertices[place % shape.vertices.size()][place % 3] = bytes.one_of(numbers);
    if (byte % 5 == 1 && !shape.triangles.empty())
        shape.triangles[place % shape.triangles.size()][place % 3] = bytes.one_of(outside);
    if (byte % 5 == 2 && !call.poses.empty())
        call.poses[place % call.poses.size()].rows[place % 12] = bytes.one_of(numbers);
    if (byte % 5 == 3 && !bodies.bodies.empty()) {
        Body& body = bodies.bodies[place % bodies.bodies.size()];
        (place & 1 ? body.shape : body.world) = static_cast<std::int32_t>(bytes.next()) - 2;
    }
    if (byte % 5 == 4) call.poses.emplace_back();
}

}  // namespace

Bodies::Bodies(Bytes bytes) {
    constexpr int sizes[] = {1, 2, 2, 3, 3, 4, 4, 6, 8, 12, 18};
    constexpr IndexType indices[] = {IndexType::int32, IndexType::uint32, IndexType::int64};
    options = fuzz::options(bytes);
    const int how = bytes.next();
    const bool spoilt = how >= 248, mixed = how % 8 == 7;
    if (const std::int64_t limit = bytes.next() * 1024; (how & 24) == 24 && bytes.checksum() % 4 == 0)
        memory_limit = limit;
    for (int n = 1 + bytes.below(4); n > 0; --n) {
        Kind kind;
        kind.most = bytes.one_of(sizes);
        kind.scaled = mixed;
        const int byte = bytes.next();
        kind.single[0] = byte & 1;
        kind.groups[0] = std::max(0, byte / 2 % 8 - 4);
        kind.layout[0] = {bytes.one_of(indices), bytes.below(6), bytes.below(6)};
        shapes.push_back(mesh(bytes, kind, 0));
        names.push_back(byte & 32 ? shapes.size() : 0);
    }
    bodies = some_bodies(bytes, static_cast<int>(shapes.size()));
    for (int n = 1 + bytes.below(4); n > 0; --n) {
        Call call;
        if (bytes.below(16) != 15)
            for (std::size_t b = 0; b < bodies.size(); ++b) {
                const bool stays = !calls.empty() && b < calls.back().poses.size() && bytes.flag();
                call.poses.push_back(stays ? calls.back().poses[b] : pose(bytes, call.poses, mixed));
            }
        call.query = decode_query(bytes, static_cast<int>(bodies.size()));
        calls.push_back(std::move(call));
    }
    if (spoilt) spoil(bytes, *this);
    // Backends that cache named shapes also read a named shape without bodies, and report its errors; other backends do
    // not. Removes its name, so that all backends report the same errors.
    for (std::size_t s = 0; s < shapes.size(); ++s)
        if (std::none_of(bodies.begin(), bodies.end(),
                         [&](const Body& body) { return body.shape == static_cast<std::int32_t>(s); }))
            names[s] = 0;
}

}  // namespace crumple::fuzz
