#pragma once

// Writer and reader of zip archives in memory, with and without ZIP64 fields. Entries are stored or compressed by
// deflate. The writer uses minizip. minizip's reader does not handle every mixture of ZIP64 fields, so Crumple has its
// own reader, which uses zlib.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "io/bytes/source.h"

namespace crumple::io {

/// Writer that builds an archive in memory, because the sizes stored before an entry are known only after it. Entries
/// have the date 1980-01-01, so that equal contents give equal archives.
class ZipWriter {
   public:
    /// `kind` names the archive in messages. All calls throw Error (file).
    explicit ZipWriter(std::string kind);
    ZipWriter(const ZipWriter&) = delete;
    ZipWriter& operator=(const ZipWriter&) = delete;
    ~ZipWriter();

    enum class Method : std::uint8_t { store, deflate };
    /// Begins an entry that will be no longer than `size` before compression.
    void begin(const std::string& name, Method method, std::uint64_t size = UINT64_MAX);
    void add(std::string_view bytes);
    void end();

    /// Ends the archive and writes it. Call once, after the last entry.
    void write(std::ostream& out);

   private:
    struct Memory;
    void check(int status) const;

    std::string kind_;
    std::unique_ptr<Memory> memory_;
    void* archive_ = nullptr;
};

/// Reader of an archive. Refers to the source. One entry is open at a time.
class ZipReader {
   public:
    /// Throws Error (format): "NAME: this is not a KIND archive", or that the list of entries is damaged.
    ZipReader(const Source& source, const std::string& kind);
    ZipReader(const ZipReader&) = delete;
    ZipReader& operator=(const ZipReader&) = delete;
    ~ZipReader();

    /// Returns the names of all entries, in the order of the archive's list.
    const std::vector<std::string>& names() const { return names_; }
    bool has(const std::string& name, bool any_case = false) const;
    /// Returns all bytes of an entry, or nothing if it is missing, cannot be read, or has more than `most` bytes.
    std::optional<Array<char>> expand(const std::string& name, std::uint64_t most);
    /// Opens an entry. Returns false if it is missing, encrypted or damaged, or if it is neither stored nor compressed
    /// by deflate.
    bool open(const std::string& name, bool any_case = false);
    /// Reads up to `size` next bytes of the open entry; `got` is 0 at its end. Returns false if the entry is truncated
    /// or damaged; a wrong checksum is found at the end.
    bool read(char* to, std::size_t size, std::size_t& got);

   private:
    struct Entry;
    struct Inflation;
    using Entries = std::unordered_map<std::string, Entry>;

    bool list_entries(std::size_t end_record);
    const Entry* find(const std::string& name, bool any_case) const;

    std::string_view bytes_;
    std::vector<std::string> names_;
    std::unique_ptr<Entries> exact_,
        any_case_;  ///< entries by name as written and by name in lower case; of equal names the first
    std::unique_ptr<Inflation> open_entry_;
};

/// Converts ASCII letters to lower case, for comparisons of entry names without regard to case.
inline std::string in_lower_case(std::string name) {
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return name;
}

/// True if the content is that of a zip archive.
inline bool is_zip(const Source& source) {
    using namespace std::string_view_literals;
    return source.text().starts_with("PK\3\4"sv) || source.text().starts_with("PK\5\6"sv);
}

}  // namespace crumple::io
