#pragma once

#include <cstdint>

#include "crumple/array.h"
#include "crumple/intersections.h"

namespace crumple {

/// Takes the rows of a search as they are found, unit by unit: a unit is a share of the work that does not depend on
/// threads. Units count from 0, and are begun in ascending order. Calls come from several threads, those of one unit
/// from one.
template <class Rows>
class RowStream {
   public:
    virtual ~RowStream() = default;
    /// Takes some rows of a unit; leaves `rows` empty. May wait for earlier units.
    virtual void add(std::int64_t unit, Rows& rows) = 0;
    /// The unit has no further rows.
    virtual void finish(std::int64_t unit) = 0;
    /// The search ends by an error.
    virtual void fail() = 0;
};

using PairStream = RowStream<Array<Pair>>;

}  // namespace crumple
