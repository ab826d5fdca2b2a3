#pragma once

// Lists that ranks have found, into files: as text each rank writes its own rows, other formats rank 0 writes.

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "cli/command_options.h"
#include "cli/ranks/rank_link.h"
#include "cli/terminal.h"
#include "io/formats.h"

namespace crumple::cli {

/// What a rank has of a list as text. The list has sections, as many for each rank, one after the other; in a section
/// the ranks' pieces follow each other. Each is written as often as it is asked for, always the same.
using RankText = std::vector<std::function<void(std::ostream&)>>;

/// Collective. A file that appears whole or stays as it was: each rank writes its pieces into it, at their place. Where
/// ranks do not see rank 0's file, or it is no file but a pipe, rank 0 writes them all.
void write_text(RankLink& link, const std::string& path, const RankText& text);

/// Collective. Rank 0 writes the pieces of all ranks to standard output.
void print_text(RankLink& link, const RankText& text);

/// Collective. write(to) on rank 0, to a path or to the stream of standard output.
template <class Write>
void write_by_first(RankLink& link, const std::string& path, Write write) {
    link.agree([&] {
        if (!link.is_first()) return;
        if (!is_standard(path)) return write(path);
        to_standard_output([&](std::ostream& out) { write(out); });
    });
}

/// Collective. Writes a list to all outputs, or prints it as text where there are none. text(format) is a RankText;
/// collect(), collective, gathers on rank 0 what write(to, all, format) writes.
template <class Text, class Collect, class Write>
void write_list(RankLink& link, const std::vector<std::string>& outputs, const std::string& format, Text text,
                Collect collect, Write write) {
    if (outputs.empty()) print_text(link, text(io::PairFormat::txt));
    std::optional<decltype(collect())> all;
    for (const std::string& path : outputs) {
        const io::PairFormat as = io::pair_format_of(extension_of(path, format));
        if (as == io::PairFormat::txt || as == io::PairFormat::csv) {
            is_standard(path) ? print_text(link, text(as)) : write_text(link, path, text(as));
            continue;
        }
        if (!all) all = collect();
        write_by_first(link, path, [&](auto& to) { write(to, *all, as); });
    }
}

}  // namespace crumple::cli
