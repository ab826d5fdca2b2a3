#pragma once

// Weights of the faces of one surface, which depend on the winding numbers w of another (FaceWeights,
// exact/overlap/crossing.h). On faces that the other surface crosses, w varies, and the contributions of the crossings
// are added up. On all other faces w is constant, and each weight is w.

#include <algorithm>
#include <cstdint>
#include <vector>

#include "exact/overlap/crossing.h"
#include "search/overlap/overlap_windings.h"

namespace crumple {

template <class Number>
class WeightedFaces {
   public:
    void add(std::int32_t face, const FaceWeights<Number>& weights) { faces_.push_back({face, weights}); }

    /// Merges the entries of each face into one, sorted by face.
    void combine() {
        const auto before = [](const Entry& x, const Entry& y) { return x.face < y.face; };
        if (!std::is_sorted(faces_.begin(), faces_.end(), before))
            std::stable_sort(faces_.begin(), faces_.end(), before);
        std::size_t count = 0;
        for (std::size_t i = 0; i < faces_.size();) {
            Entry& entry = faces_[count++] = faces_[i];
            for (++i; i < faces_.size() && faces_[i].face == entry.face; ++i)
                for (std::size_t k = 0; k < 3; ++k) entry.weights[k] = entry.weights[k] + faces_[i].weights[k];
        }
        faces_.resize(count);
    }
    /// Adds to the weights of each entry the winding number at the first corner of its face.
    void add_windings(const ClosedSurface& surface, const WindingSteps& steps) {
        for (Entry& entry : faces_)
            if (const int winding = steps.winding_at(surface.place(surface.corners(entry.face)[0])))
                for (Number& weight : entry.weights) weight = weight + Number(winding);
    }

    /// Calls crossed(face, weights) for each entry, and inside(face, winding) for each face without an entry on which
    /// the winding number is not 0. Call combine() and add_windings() first.
    template <class Crossed, class Inside>
    void for_each(const ClosedSurface& surface, const WindingSteps& steps, Crossed crossed, Inside inside) {
        if (!steps.intervals().empty()) is_crossed_.resize(static_cast<std::size_t>(surface.face_count()), 0);
        const auto mark = [&](std::uint8_t value) {
            for (const Entry& entry : faces_)
                if (!is_crossed_.empty()) is_crossed_[static_cast<std::size_t>(entry.face)] = value;
        };
        for (const Entry& entry : faces_) crossed(entry.face, entry.weights);
        mark(1);
        for (const WindingInterval& interval : steps.intervals())
            for (const std::int32_t face : surface.faces(interval.begin, interval.end))
                if (!is_crossed_[static_cast<std::size_t>(face)]) inside(face, interval.winding);
        mark(0);
    }

    std::size_t bytes() const { return bytes_of(faces_) + bytes_of(is_crossed_); }

    struct Entry {
        std::int32_t face;
        FaceWeights<Number> weights;
    };
    const std::vector<Entry>& entries() const { return faces_; }

   private:
    std::vector<Entry> faces_;
    std::vector<std::uint8_t> is_crossed_;  ///< by face: 1 if it has an entry; all 0 between calls
};

}  // namespace crumple
