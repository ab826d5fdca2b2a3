#pragma once

// Files as a world of bodies, and the names by which bodies are excluded.

#include <string>
#include <string_view>
#include <vector>

#include "cli/command_options.h"
#include "crumple/io.h"

namespace crumple::cli {

/// Throws Error (invalid_argument).
[[noreturn]] void refuse(const std::string& what);

/// Reads files as worlds and puts them together, in order; prints what is odd about them. Names that two files have are
/// made unique. `file_of_body`, which may be null, becomes the file of each body. Throws Error that names the file and
/// the place.
io::WorldMesh read_bodies(const std::vector<std::string>& files, const ReadingOptions& options,
                          std::vector<std::string>* file_of_body = nullptr);

/// Bodies by name.
class BodyNames {
   public:
    explicit BodyNames(const std::vector<io::NamedBody>& bodies);

    /// "A,B" as `--excluded-bodies` has it; commas in names are seen through. Throws Error (invalid_argument) that
    /// suggests a name for one that is unknown.
    BodyPair pair(const std::string& text) const;
    /// A list that detect has written, .csv or .json by extension. Any other is text: two names a line, with a tab
    /// between or, where no name has blanks, with blanks; quoted as `quoted` does. Blank lines and comments (#) are
    /// skipped, and so is what detect --containment says behind a pair. Throws Error that names the line.
    std::vector<BodyPair> read_pairs(const std::string& path) const;

    const std::vector<std::string>& list() const { return names_; }

   private:
    std::int32_t find(const std::string& name) const;
    std::int32_t require(const std::string& name) const;

    std::vector<std::string> names_;
    std::vector<std::int32_t> sorted_;
};

/// A name as a list has it: as it is, or as a JSON string if it has a tab, another control character, a quote, or `#`
/// or a blank at its beginning or end.
std::string quoted_name(const std::string& name);

}  // namespace crumple::cli
