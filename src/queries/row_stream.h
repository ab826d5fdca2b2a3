#pragma once

#include <cstdint>

#include "crumple/array.h"
#include "crumple/intersections.h"

namespace crumple {

/// Consumer of the rows of a search as they are found, unit by unit. A unit is a piece of the work that does not depend
/// on the number of threads. Units are numbered from 0 and begun in ascending order. Calls come from several threads,
/// but those for one unit from a single thread.
template <class Rows>
class RowStream {
   public:
    virtual ~RowStream() = default;
    /// Consumes some rows of a unit; leaves `rows` empty. May wait for earlier units.
    virtual void add(std::int64_t unit, Rows& rows) = 0;
    /// Ends a unit: it has no further rows.
    virtual void finish(std::int64_t unit) = 0;
    /// Reports that the search ends with an error.
    virtual void fail() = 0;
};

using PairStream = RowStream<Array<Pair>>;

}  // namespace crumple
