#pragma once

// Binary tree over corners of a plane polygon, which finds the corners that may lie in a triangle. A node is a range of
// the corners. It is split at the median along the longer side of its box, and stores the box and the number of its
// corners that have not been removed.

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "geometry/predicates.h"
#include "geometry/vec.h"

namespace crumple::io {

class CornerTree {
   public:
    /// Builds the tree over these corners (indices of points), projected along coordinate axis `axis`. O(n log n).
    void build(std::span<const Vec3d> points, std::vector<int> corners, int axis) {
        points_ = points;
        axis_ = axis;
        corners_ = std::move(corners);
        nodes_.assign(2 * corners_.size() / leaf_size + 2, {});
        place_.assign(points.size(), -1);
        used_ = 0;
        if (!corners_.empty()) build_node(0, static_cast<int>(corners_.size()));
        for (std::size_t i = 0; i < corners_.size(); ++i)
            place_[static_cast<std::size_t>(corners_[i])] = static_cast<int>(i);
    }

    /// Removes a corner, if it is present. O(log n).
    void remove(int corner) {
        const int place = place_[static_cast<std::size_t>(corner)];
        place_[static_cast<std::size_t>(corner)] = -1;
        for (int k = place < 0 ? -1 : 0; k >= 0;) {
            Node& node = nodes_[static_cast<std::size_t>(k)];
            --node.left;
            if (node.child < 0) break;
            const Node& first = nodes_[static_cast<std::size_t>(node.child)];
            k = place < first.end ? node.child : first.next;
        }
    }

    /// True if hit(corner) holds for any corner in the closed triangle, whose three vertices are corners. May also call
    /// hit for corners outside the triangle. `sign`: 1 if the triangle runs counter-clockwise, else -1.
    template <class Hit>
    bool any_in(const std::array<int, 3>& triangle, int sign, Hit hit) const {
        return !corners_.empty() && any_in(0, triangle, sign, hit);
    }

   private:
    static constexpr int leaf_size = 8;
    struct Node {
        int begin = 0, end = 0;  ///< range of the node in `corners_`
        int left = 0;            ///< number of corners of the range that have not been removed
        int child = -1;          ///< index of the first of two child nodes; -1: a leaf
        int next = -1;           ///< for a first child, index of the second child of the same parent
        Vec3d low, high;
    };

    const Vec3d& point(int corner) const { return points_[static_cast<std::size_t>(corner)]; }

    int build_node(int begin, int end) {
        const int k = used_++;
        if (static_cast<std::size_t>(k) >= nodes_.size()) nodes_.resize(2 * nodes_.size());
        Node node{begin, end, end - begin, -1, -1, point(corners_[static_cast<std::size_t>(begin)]), {}};
        node.high = node.low;
        for (int i = begin; i < end; ++i) {
            node.low = min(node.low, point(corners_[static_cast<std::size_t>(i)]));
            node.high = max(node.high, point(corners_[static_cast<std::size_t>(i)]));
        }
        if (end - begin > leaf_size) {
            const int x = first_axis(axis_), y = second_axis(axis_);
            const int along = node.high[x] / 2 - node.low[x] / 2 > node.high[y] / 2 - node.low[y] / 2 ? x : y;
            const int middle = begin + (end - begin) / 2;
            std::nth_element(corners_.begin() + begin, corners_.begin() + middle, corners_.begin() + end,
                             [&](int a, int b) { return point(a)[along] < point(b)[along]; });
            node.child = build_node(begin, middle);
            const int second = build_node(middle, end);
            nodes_[static_cast<std::size_t>(node.child)].next = second;
        }
        nodes_[static_cast<std::size_t>(k)] = node;
        return k;
    }

    template <class Hit>
    bool any_in(int k, const std::array<int, 3>& triangle, int sign, Hit& hit) const {
        const Node& node = nodes_[static_cast<std::size_t>(k)];
        if (node.left == 0 || is_apart(node, triangle, sign)) return false;
        if (node.child >= 0) {
            return any_in(node.child, triangle, sign, hit) ||
                   any_in(nodes_[static_cast<std::size_t>(node.child)].next, triangle, sign, hit);
        }
        for (int i = node.begin; i < node.end; ++i) {
            const int corner = corners_[static_cast<std::size_t>(i)];
            if (place_[static_cast<std::size_t>(corner)] >= 0 && hit(corner)) return true;
        }
        return false;
    }

    /// True if a side of the node's box or of the triangle certainly separates the box from the triangle.
    bool is_apart(const Node& node, const std::array<int, 3>& triangle, int sign) const {
        const Vec3d &a = point(triangle[0]), &b = point(triangle[1]), &c = point(triangle[2]);
        const int x = first_axis(axis_), y = second_axis(axis_);
        for (const int along : {x, y}) {
            if (std::max({a[along], b[along], c[along]}) < node.low[along]) return true;
            if (std::min({a[along], b[along], c[along]}) > node.high[along]) return true;
        }
        const auto outside = [&](const Vec3d& p, const Vec3d& q) {
            for (const bool right : {false, true}) {
                for (const bool upper : {false, true}) {
                    Vec3d corner;
                    corner[x] = right ? node.high[x] : node.low[x];
                    corner[y] = upper ? node.high[y] : node.low[y];
                    if (orient2d_filtered(p, q, corner, axis_) != -sign) return false;
                }
            }
            return true;
        };
        return outside(a, b) || outside(b, c) || outside(c, a);
    }

    std::span<const Vec3d> points_;
    int axis_ = 2, used_ = 0;
    std::vector<int> corners_;
    std::vector<int> place_;  ///< by corner: its index in `corners_`, or -1 if it is not in the tree
    std::vector<Node> nodes_;
};

}  // namespace crumple::io
