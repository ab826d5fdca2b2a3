#pragma once

// Lists as text, which ranks write together.

#include <functional>
#include <string>
#include <vector>

#include "cli/ranks/rank_link.h"
#include "io/lists/list_rows.h"

namespace crumple::cli {

/// This rank's rows of each section of a list. The list is section by section, each of them rank by rank.
using RankSections = std::vector<std::function<void(io::RowWriter&)>>;

/// Collective. Writes a list as .csv or .txt, to standard output, or to a file that appears whole or stays as it was.
/// Each rank writes its rows at their place in the file. Where not all ranks see it, or where it is a pipe, rank 0
/// writes them all.
void write_text(RankLink& link, const std::string& path, const io::RowTable& table, const RankSections& sections,
                bool csv);

}  // namespace crumple::cli
