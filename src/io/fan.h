#pragma once

// A polygon's triangles, fanned from its first corner as the corners come.

#include <cstdint>
#include <vector>

namespace crumple::io {

class Fan {
   public:
    explicit Fan(std::vector<std::int32_t>& triangles) : triangles_(triangles) {}

    void add(std::int32_t corner) {
        if (corners_ == 0) first_ = corner;
        if (corners_ >= 2) triangles_.insert(triangles_.end(), {first_, previous_, corner});
        previous_ = corner;
        ++corners_;
    }
    std::int64_t corners() const { return corners_; }

   private:
    std::vector<std::int32_t>& triangles_;
    std::int64_t corners_ = 0;
    std::int32_t first_ = 0, previous_ = 0;
};

}  // namespace crumple::io
