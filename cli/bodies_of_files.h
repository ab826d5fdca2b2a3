#pragma once

// Reads files as a world of bodies, and finds bodies by name.

#include <string>
#include <string_view>
#include <vector>

#include "cli/command_options.h"
#include "crumple/io.h"
#include "io/scenes/body_names.h"

namespace crumple::cli {

/// Throws Error (invalid_argument) with this message about an option.
[[noreturn]] void refuse(const std::string& what);

/// Reads files as worlds and joins them, in order; prints warnings. Names that occur in two files are made unique.
/// `file_of_body`, if not null, receives the file of each body. Throws Error that names the file and the place.
io::WorldMesh read_bodies(const std::vector<std::string>& files, const ReadingOptions& options,
                          std::vector<std::string>* file_of_body = nullptr);

/// Index of bodies by name.
class BodyNames {
   public:
    explicit BodyNames(const std::vector<io::NamedBody>& bodies);

    /// Parses "A,B", the value of `--excluded-bodies`; names may contain commas. Throws Error (invalid_argument) if no
    /// body has one of the names; the message suggests a similar name.
    BodyPair pair(const std::string& text) const;
    /// Reads pairs of names from a list that crumple detect has written. The extension selects .csv or .json; any other
    /// file is text with two names per line. In text, names are separated by a tab, or by blanks if the line has no
    /// tab, and may be quoted as by quoted_name(). Text may have blank lines and comments (#). In text and .csv,
    /// ignores the third column that detect --containment writes. Throws Error that names the line.
    std::vector<BodyPair> read_pairs(const std::string& path) const;

    const std::vector<std::string>& list() const { return names_; }

   private:
    std::int32_t find(const std::string& name) const;
    std::int32_t require(const std::string& name) const;

    std::vector<std::string> names_;
    std::vector<std::int32_t> sorted_;
};

using io::quoted_name;

}  // namespace crumple::cli
