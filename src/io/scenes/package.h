#pragma once

// Packages by the Open Packaging Conventions, as 3MF files are: a zip archive of parts, and relationships that tell
// what each of them is for.

#include <cstdint>
#include <string>
#include <string_view>

#include "io/bytes/source.h"
#include "io/bytes/xml.h"
#include "io/bytes/zip.h"

namespace crumple::io {

class Package {
   public:
    /// `kind` is what messages call the archive. Refers to the source. Throws Error (format).
    Package(const Source& source, const std::string& kind);

    /// "NAME, PART", for messages and for readers.
    std::string place(const std::string& part) const { return source_.name() + ", " + part; }
    /// Reads a part, without a '/' before its name, whatever the case of its letters. Throws Error (format): there is
    /// none, it is damaged, the archive expands beyond measure; and what the reader throws.
    void read(const std::string& part, XmlReader& reader);
    /// The one part that the package names for this, without a '/' before it.
    std::string target_of(std::string_view relationship);
    /// Bytes of the parts read so far.
    std::uint64_t expanded() const { return expanded_; }

   private:
    const Source& source_;
    ZipReader archive_;
    std::uint64_t expanded_ = 0, most_expanded_;
};

/// The name that a reference has in the archive.
std::string part_named(std::string_view reference);

}  // namespace crumple::io
