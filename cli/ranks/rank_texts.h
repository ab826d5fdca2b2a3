#pragma once

// Lists as text, written by all ranks together.

#include <functional>
#include <string>
#include <vector>

#include "cli/ranks/rank_link.h"
#include "io/lists/list_rows.h"

namespace crumple::cli {

/// For each section of a list, a function that writes the rows of this rank. In the file, a section has the rows of
/// rank 0, then those of rank 1, and so on.
using RankSections = std::vector<std::function<void(io::RowWriter&)>>;

/// Collective. Writes a list as .csv or .txt to a file, which appears whole or stays unchanged, or to standard output.
/// Each rank writes its rows at their positions in the file. Rank 0 writes all rows to standard output, to pipes, and
/// to files that not all ranks can open.
void write_text(RankLink& link, const std::string& path, const io::RowTable& table, const RankSections& sections,
                bool csv);

}  // namespace crumple::cli
