#pragma once

// Lists of pairs as text, of which each rank writes its own rows.

#include <functional>
#include <ostream>
#include <string>

#include "cli/rank_link.h"
#include "crumple/distributed.h"
#include "crumple/io.h"

namespace crumple::cli {

/// Rows that this rank has, as .txt or .csv; rank 0 begins with what stands before all rows.
class RankText {
   public:
    RankText(const RankLink& link, const DistributedCollisions& found, bool contacts, io::PairFormat format)
        : found_(found), first_(link.is_first()), contacts_(contacts), format_(format) {}

    void write(std::ostream& out) const;
    std::int64_t bytes() const;

   private:
    const DistributedCollisions& found_;
    bool first_, contacts_;
    io::PairFormat format_;
};

/// Collective. A file that appears whole or stays as it was: each rank writes its rows into it, at their place. Where
/// ranks do not see rank 0's file, or it is no file but a pipe, rank 0 writes them all.
void write_on_ranks(RankLink& link, const std::string& path, const RankText& text);

/// Collective. Rank 0 writes the rows of all ranks, one rank after the other.
void print_on_ranks(RankLink& link, const RankText& text);

}  // namespace crumple::cli
