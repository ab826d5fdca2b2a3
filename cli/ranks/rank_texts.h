#pragma once

// Lists as text, written by all ranks together.

#include <functional>
#include <string>
#include <vector>

#include "cli/ranks/rank_link.h"
#include "io/lists/list_rows.h"

namespace crumple::cli {

/// Functions that write this rank's rows of each section of a list. In the list, each section has its rows rank by
/// rank.
using RankSections = std::vector<std::function<void(io::RowWriter&)>>;

/// Collective. Writes a list as .csv or .txt, to standard output, or to a file that appears whole or stays unchanged.
/// Each rank writes its rows at their place in the file. If not all ranks can open the file, or it is a pipe, rank 0
/// writes all rows.
void write_text(RankLink& link, const std::string& path, const io::RowTable& table, const RankSections& sections,
                bool csv);

}  // namespace crumple::cli
