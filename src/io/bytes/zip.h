#pragma once

// Zip archives in memory, with ZIP64's fields where they are needed or not: entries are stored or compressed by
// deflate. minizip writes them. Its reader does not resolve every mixture of ZIP64's fields, so that ours reads them by
// zlib.

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

/// Made in memory: the sizes that stand before an entry are known after it. Entries have the date 1980-01-01, so that
/// equal contents give equal archives.
class ZipWriter {
   public:
    /// `kind` is what messages call the archive. Throws Error (file), as all calls do.
    explicit ZipWriter(std::string kind);
    ZipWriter(const ZipWriter&) = delete;
    ZipWriter& operator=(const ZipWriter&) = delete;
    ~ZipWriter();

    enum class Method : std::uint8_t { store, deflate };
    /// Begins an entry that will be no longer than `size` before compression.
    void begin(const std::string& name, Method method, std::uint64_t size = UINT64_MAX);
    void add(std::string_view bytes);
    void end();

    /// After the last entry.
    void write(std::ostream& out);

   private:
    struct Memory;
    void check(int status) const;

    std::string kind_;
    std::unique_ptr<Memory> memory_;
    void* archive_ = nullptr;
};

/// Refers to the source. One entry is open at a time.
class ZipReader {
   public:
    /// Throws Error (format): "NAME: this is not a KIND archive", or that its list of entries is damaged.
    ZipReader(const Source& source, const std::string& kind);
    ZipReader(const ZipReader&) = delete;
    ZipReader& operator=(const ZipReader&) = delete;
    ~ZipReader();

    /// Names of all entries, in the order of the archive's list.
    const std::vector<std::string>& names() const { return names_; }
    bool has(const std::string& name, bool any_case = false) const;
    /// All bytes of an entry; nothing if there is none that can be read, or if it has more than `most`.
    std::optional<Array<char>> expand(const std::string& name, std::uint64_t most);
    /// Opens an entry; false if there is none of the name that can be read: another method, a password, damage.
    bool open(const std::string& name, bool any_case = false);
    /// The next bytes of the open entry, at most so many; none at its end. False if it is truncated or damaged, which
    /// a wrong checksum tells at the end.
    bool read(char* to, std::size_t size, std::size_t& got);

   private:
    struct Entry;
    struct Inflation;
    using Entries = std::unordered_map<std::string, Entry>;

    bool list_entries(std::size_t end_record);
    const Entry* find(const std::string& name, bool any_case) const;

    std::string_view bytes_;
    std::vector<std::string> names_;
    std::unique_ptr<Entries> exact_, any_case_;  ///< of several with one name the first
    std::unique_ptr<Inflation> open_;
};

/// By ASCII, as names of entries are compared.
inline std::string in_lower_case(std::string name) {
    for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return name;
}

/// Whether the content is that of a zip archive.
inline bool is_zip(const Source& source) {
    using namespace std::string_view_literals;
    return source.text().starts_with("PK\3\4"sv) || source.text().starts_with("PK\5\6"sv);
}

}  // namespace crumple::io
