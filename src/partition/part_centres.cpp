#include "partition/part_centres.h"

#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace crumple {
namespace {

/// Cluster that is yet to be split.
struct Node {
    int parts = 1;                      ///< number of parts that it becomes
    Vec3f centre;                       ///< centre of this cluster
    std::vector<std::uint32_t> points;  ///< sample points to which its centre is the nearest of its siblings'
};

int depth_for(int parts) {
    int depth = 1;
    for (int most = max_clusters; most < parts; most *= max_clusters) ++depth;
    return depth;
}

std::int64_t power(std::int64_t base, int exponent) {
    std::int64_t result = 1;
    while (exponent-- > 0) result *= base;
    return result;
}

// Returns the least number of children per node with which `depth` levels make at least `parts` parts.
int width_for(int parts, int depth) {
    int width = 1;
    while (power(width, depth) < parts) ++width;
    return width;
}

// Computes the centres of a node's `count` children from the node's sample points. With fuzziness 2 this needs no
// pow(), whose last bit may differ from machine to machine.
void place(const Node& node, std::span<const Vec3f> points, int count, Centres& centres) {
    constexpr std::size_t most_points = 4096;
    const std::size_t all = node.points.size(), n = std::min(all, most_points);
    centres.count = count;
    if (n == 0) {
        for (int k = 0; k < count; ++k) centres.set(k, node.centre);
        return;
    }
    const auto point = [&](std::size_t i) { return points[node.points[i * all / n]]; };
    start_centres(count, n, point, centres);
    fuzzy_c_means(n, point, {.fuzziness = 2, .iterations = 30, .stop = 1e-4}, centres);
}

void measure(const Centres& placed, PartSiblings& centres, double* apart) {
    for (int k = 0; k < placed.count; ++k) {
        const Vec3f c = placed[k];
        centres.x[k] = c.x, centres.y[k] = c.y, centres.z[k] = c.z;
    }
    for (int k = 0; k < placed.count; ++k)
        for (int j = 0; j < placed.count; ++j) {
            const Vec3d between = centres.centre(k) - centres.centre(j);
            apart[k * max_clusters + j] = std::sqrt(dot(between, between));
        }
}

int nearest(const Centres& centres, Vec3f p) {
    int best = 0;
    float least = dot(p - centres[0], p - centres[0]);
    for (int k = 1; k < centres.count; ++k) {
        const float d2 = dot(p - centres[k], p - centres[k]);
        if (d2 < least) best = k, least = d2;
    }
    return best;
}

// Splits a node into clusters at `centres`, and assigns to each of them its sample points and its number of parts, at
// most `most`.
std::vector<Node> split(const Node& node, std::span<const Vec3f> points, const Centres& centres, int most) {
    std::vector<Node> children(static_cast<std::size_t>(centres.count));
    for (std::size_t k = 0; k < children.size(); ++k) children[k].centre = centres[k];
    for (const std::uint32_t i : node.points)
        children[static_cast<std::size_t>(nearest(centres, points[i]))].points.push_back(i);
    std::vector<std::int64_t> counts;
    counts.reserve(children.size());
    for (const Node& child : children) counts.push_back(static_cast<std::int64_t>(child.points.size()));
    const std::vector<int> shares = distribute_parts(node.parts, most, counts);
    for (std::size_t k = 0; k < children.size(); ++k) children[k].parts = shares[k];
    return children;
}

}  // namespace

Vec3f PartSample::centroid(const Triangle& t, const Normaliser& normalise) {
    const Vec3d c = (1.0 / 3.0) * (normalise(t.point[0]) + normalise(t.point[1]) + normalise(t.point[2]));
    return {static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)};
}

// Assigns the parts one by one, each to the cluster with the fewest parts per point. Compares integers only.
std::vector<int> distribute_parts(int parts, int most, std::span<const std::int64_t> points) {
    std::vector<int> shares(points.size(), 1);
    for (int left = parts - static_cast<int>(points.size()); left > 0; --left) {
        std::size_t best = points.size();
        for (std::size_t k = 0; k < points.size(); ++k) {
            if (shares[k] == most) continue;
            if (best == points.size() || (points[k] + 1) * shares[best] > (points[best] + 1) * shares[k]) best = k;
        }
        ++shares[best];
    }
    return shares;
}

PartCentres::PartCentres(int parts, std::span<const Vec3f> points, const Normaliser& normalise, ParallelFor& parallel)
    : normalise_(normalise) {
    std::vector<Node> nodes(1);
    nodes[0].parts = parts;
    for (std::uint32_t i = 0; i < points.size(); ++i) nodes[0].points.push_back(i);
    for (int depth = depth_for(parts); depth > 0; --depth) {
        ClusterLevel level;
        for (const Node& node : nodes) level.first.push_back(level.first.back() + width_for(node.parts, depth));
        const auto all = static_cast<std::size_t>(level.first.back());
        level.centres.resize(nodes.size());
        level.apart.resize(all * max_clusters);
        std::vector<std::vector<Node>> children(nodes.size());
        parallel.parallel_for(nodes.size(), [&](std::size_t i) {
            const auto first = static_cast<std::size_t>(level.first[i]);
            const auto count = static_cast<std::size_t>(level.first[i + 1]) - first;
            Centres centres;
            place(nodes[i], points, static_cast<int>(count), centres);
            measure(centres, level.centres[i], level.apart.data() + first * max_clusters);
            if (depth > 1)
                children[i] = split(nodes[i], points, centres, static_cast<int>(power(max_clusters, depth - 1)));
        });
        levels_.push_back(std::move(level));
        nodes.clear();
        for (auto& some : children)
            for (Node& child : some) nodes.push_back(std::move(child));
    }
}

PartCentres::PartCentres(std::span<const std::byte> bytes, const Normaliser& normalise) : normalise_(normalise) {
    const auto read = [&](auto& values, std::size_t count) {
        values.resize(count);
        const std::size_t size = count * sizeof(values[0]);
        if (size > 0) std::memcpy(values.data(), bytes.data(), size);
        bytes = bytes.subspan(size);
    };
    while (!bytes.empty()) {
        std::vector<std::int64_t> nodes;
        read(nodes, 1);
        const auto parents = static_cast<std::size_t>(nodes[0]);
        ClusterLevel level;
        read(level.first, parents + 1);
        read(level.centres, parents);
        read(level.apart, static_cast<std::size_t>(level.first.back()) * max_clusters);
        levels_.push_back(std::move(level));
    }
}

std::vector<std::byte> PartCentres::bytes() const {
    std::vector<std::byte> bytes;
    const auto write = [&](const auto& values) {
        const auto some = std::as_bytes(std::span(values));
        bytes.insert(bytes.end(), some.begin(), some.end());
    };
    for (const ClusterLevel& level : levels_) {
        write(std::array{static_cast<std::int64_t>(level.centres.size())});
        write(level.first);
        write(level.centres);
        write(level.apart);
    }
    return bytes;
}

PartTree PartCentres::tree() const {
    PartTree tree;
    tree.normalise = normalise_;
    for (const ClusterLevel& level : levels_)
        tree.level[tree.depth++] = {level.first.data(), level.centres.data(), level.apart.data()};
    return tree;
}

std::vector<PartLevel> PartCentres::path(std::int32_t part) const {
    std::vector<PartLevel> path(levels_.size());
    for (std::size_t l = levels_.size(); l-- > 0;) {
        const std::vector<std::int32_t>& first = levels_[l].first;
        const auto node =
            static_cast<std::int32_t>(std::upper_bound(first.begin(), first.end(), part) - first.begin()) - 1;
        path[l].cluster = part - first[static_cast<std::size_t>(node)];
        part = node;
    }
    return path;
}

PartCentres place_parts(const PreparedScene& scene, int parts, ParallelFor& parallel) {
    const Normaliser normalise(scene.low, scene.high);
    PartSample sample(scene.triangle_count(), parts);
    for (std::size_t i = 0; i < sample.size(); ++i)
        sample.set(i, PartSample::centroid(scene.triangle(sample.triangle(i)), normalise));
    return PartCentres(parts, sample.centroids(), normalise, parallel);
}

}  // namespace crumple
