#pragma once

// Reader of packages by the Open Packaging Conventions, such as 3MF files: a zip archive of parts, and relationships
// that state the purpose of each part.

#include <cstdint>
#include <string>
#include <string_view>

#include "io/bytes/source.h"
#include "io/bytes/xml.h"
#include "io/bytes/zip.h"

namespace crumple::io {

class Package {
   public:
    /// `kind` names the archive in messages. Refers to the source. Throws Error (format).
    Package(const Source& source, const std::string& kind);

    /// Returns "NAME, PART", which names the archive and a part in messages.
    std::string place(const std::string& part) const { return source_.name() + ", " + part; }
    /// Reads a part. Its name has no leading '/', and its case does not matter. Throws Error (format) if the part is
    /// missing or damaged, or the archive expands beyond the limit of io/bytes/expanded_size.h, and whatever the reader
    /// throws.
    void read(const std::string& part, XmlReader& reader);
    /// Returns the name, without a leading '/', of the part that a relationship of this type (a URI) refers to. Throws
    /// Error (format) unless there is exactly one such relationship.
    std::string target_of(std::string_view relationship);
    /// Returns the total size of the parts read so far, in uncompressed bytes.
    std::uint64_t expanded() const { return expanded_; }

   private:
    const Source& source_;
    ZipReader archive_;
    std::uint64_t expanded_ = 0, most_expanded_;
};

/// Returns the name in the archive of the part that a reference (a path that may begin with '/') names.
std::string part_name(std::string_view reference);

}  // namespace crumple::io
