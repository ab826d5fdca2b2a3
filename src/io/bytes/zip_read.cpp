// Reader of zip archives. All data about entries come from the list of entries (the central directory, at the end of
// the file); the header before each entry is skipped. If all bits of a field of 32 or 16 bits are ones, its value is in
// a ZIP64 record (APPNOTE.TXT 6.3, sections 4.3 to 4.5).

#include <zlib.h>

#include <algorithm>
#include <new>

#include "io/bytes/bytes.h"
#include "io/bytes/zip.h"

namespace crumple::io {

namespace {

using namespace std::string_view_literals;

constexpr std::size_t end_record = 22, zip64_locator = 20, zip64_end_record = 56, list_entry = 46, local_header = 30;
constexpr std::uint32_t absent = UINT32_MAX;

template <class T>
T number(std::string_view bytes, std::size_t at) {
    return load<T>(bytes.data() + at, std::endian::little);
}

/// Returns the record with this size and signature at byte `at`; empty if there is none.
std::string_view record(std::string_view bytes, std::uint64_t at, std::size_t size, std::string_view signature) {
    if (at > bytes.size() || size > bytes.size() - at) return {};
    const std::string_view found = bytes.substr(at, size);
    return found.starts_with(signature) ? found : std::string_view();
}

/// Returns the place of the last end record, or npos. Only a comment of at most 65,535 bytes may follow it.
std::size_t find_end_record(std::string_view bytes) {
    const std::size_t at = bytes.rfind("PK\5\6"sv);
    const bool near_end = at != bytes.npos && bytes.size() - at <= end_record + UINT16_MAX;
    return near_end && bytes.size() - at >= end_record ? at : bytes.npos;
}

/// Place of the list of entries in the file, in bytes.
struct EntryList {
    std::uint64_t begin = 0, size = 0;
    std::uint64_t moved = 0;  ///< number of bytes put before the archive, to be added to all offsets in it
};

/// Finds the list of entries. Returns false if the end records contradict each other or the size of the file.
bool find_list(std::string_view bytes, std::size_t end, EntryList& list) {
    std::uint64_t begin = number<std::uint32_t>(bytes, end + 16), list_end = end;
    list.size = number<std::uint32_t>(bytes, end + 12);
    const std::string_view locator =
        end < zip64_locator ? ""sv : record(bytes, end - zip64_locator, zip64_locator, "PK\6\7"sv);
    if (!locator.empty()) {
        // The ZIP64 end record lies where the locator says or, if bytes were put before the archive, right before the
        // locator.
        std::uint64_t at = number<std::uint64_t>(locator, 8);
        if (record(bytes, at, zip64_end_record, "PK\6\6"sv).empty()) at = end - zip64_locator - zip64_end_record;
        const std::string_view large = record(bytes, at, zip64_end_record, "PK\6\6"sv);
        if (large.empty()) return false;
        list.size = number<std::uint64_t>(large, 40);
        begin = number<std::uint64_t>(large, 48);
        list_end = at;
    }
    if (list.size > list_end || begin > list_end - list.size) return false;
    list.begin = list_end - list.size;
    list.moved = list.begin - begin;
    return true;
}

}  // namespace

struct ZipReader::Entry {
    std::uint64_t header = 0, compressed = 0, size = 0;
    std::uint32_t checksum = 0;
    std::uint16_t flags = 0, method = 0;

    bool is_locked() const { return flags & 1; }

    /// Reads size, compressed size and header offset from the ZIP64 extra field where they are all ones. The extra
    /// field holds only the values that are needed, in this order. Returns false if it is too short.
    bool resolve(std::string_view extra) {
        while (extra.size() >= 4) {
            const auto kind = number<std::uint16_t>(extra, 0), length = number<std::uint16_t>(extra, 2);
            std::string_view values = extra.substr(4, length);
            extra.remove_prefix(std::min<std::size_t>(extra.size(), 4 + length));
            if (kind != 1) continue;
            for (std::uint64_t* field : {&size, &compressed, &header}) {
                if (*field != absent) continue;
                if (values.size() < 8) return false;
                *field = number<std::uint64_t>(values, 0);
                values.remove_prefix(8);
            }
            return true;
        }
        return true;
    }
};

/// Decompression state of the entry that is being read.
struct ZipReader::Inflation {
    Inflation(const Entry& entry, std::string_view compressed) : entry(entry), left(compressed) {
        if (entry.method == Z_DEFLATED && inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    }
    Inflation(const Inflation&) = delete;
    Inflation& operator=(const Inflation&) = delete;
    ~Inflation() { inflateEnd(&stream); }  // no effect if inflateInit2 was not called

    /// Reads the next bytes; `got` is 0 at the end. Returns false if the entry is damaged or truncated.
    bool read(char* to, std::size_t size, std::size_t& got) {
        size = std::min(size, max_bytes_per_call);
        if (entry.method == Z_DEFLATED) {
            if (!inflate_to(to, size, got)) return false;
        } else {
            got = std::min(size, left.size());
            std::copy_n(left.data(), got, to);
            left.remove_prefix(got);
        }
        checksum = crc32(checksum, reinterpret_cast<const Bytef*>(to), static_cast<uInt>(got));
        count += got;
        return got > 0 || (left.empty() && count == entry.size && checksum == entry.checksum);
    }

   private:
    static constexpr std::size_t max_bytes_per_call = std::size_t{1} << 30;  // zlib counts bytes in 32 bits

    bool inflate_to(char* to, std::size_t size, std::size_t& got) {
        stream.next_out = reinterpret_cast<Bytef*>(to);
        stream.avail_out = static_cast<uInt>(size);
        while (stream.avail_out > 0 && !ended) {
            const std::size_t given = std::min(left.size(), max_bytes_per_call);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left.data()));  // zlib only reads it
            stream.avail_in = static_cast<uInt>(given);
            const int status = inflate(&stream, Z_NO_FLUSH);
            left.remove_prefix(given - stream.avail_in);
            if (status == Z_MEM_ERROR) throw std::bad_alloc();
            if (status != Z_OK && status != Z_STREAM_END) return false;
            ended = status == Z_STREAM_END;
        }
        got = size - stream.avail_out;
        return true;
    }

    const Entry& entry;
    std::string_view left;  ///< compressed bytes that have not been read
    z_stream stream{};
    bool ended = false;
    std::uint64_t count = 0;
    uLong checksum = 0;
};

ZipReader::ZipReader(const Source& source, const std::string& kind)
    : bytes_(source.text()), exact_(std::make_unique<Entries>()), any_case_(std::make_unique<Entries>()) {
    const std::size_t end = find_end_record(bytes_);
    if (end == bytes_.npos) throw Error(ErrorCode::format, source.name() + ": this is not a " + kind + " archive");
    if (!list_entries(end))
        throw Error(ErrorCode::format, source.name() + ": the list of entries of the zip archive is damaged");
}

ZipReader::~ZipReader() = default;

bool ZipReader::list_entries(std::size_t end) {
    EntryList list;
    if (!find_list(bytes_, end, list)) return false;
    std::string_view left = bytes_.substr(list.begin, list.size);
    while (!left.empty()) {
        const std::string_view fixed = record(left, 0, list_entry, "PK\1\2"sv);
        if (fixed.empty()) return false;
        const auto name_size = number<std::uint16_t>(fixed, 28), extra_size = number<std::uint16_t>(fixed, 30),
                   comment_size = number<std::uint16_t>(fixed, 32);
        const std::size_t size = list_entry + std::size_t{name_size} + extra_size + comment_size;
        if (size > left.size()) return false;
        Entry entry{.header = number<std::uint32_t>(fixed, 42),
                    .compressed = number<std::uint32_t>(fixed, 20),
                    .size = number<std::uint32_t>(fixed, 24),
                    .checksum = number<std::uint32_t>(fixed, 16),
                    .flags = number<std::uint16_t>(fixed, 8),
                    .method = number<std::uint16_t>(fixed, 10)};
        if (!entry.resolve(left.substr(list_entry + name_size, extra_size))) return false;
        entry.header += list.moved;
        names_.emplace_back(left.substr(list_entry, name_size));
        exact_->try_emplace(names_.back(), entry);
        any_case_->try_emplace(in_lower_case(names_.back()), entry);
        left.remove_prefix(size);
    }
    return true;
}

const ZipReader::Entry* ZipReader::find(const std::string& name, bool any_case) const {
    const Entries& entries = any_case ? *any_case_ : *exact_;
    const auto found = entries.find(any_case ? in_lower_case(name) : name);
    return found == entries.end() ? nullptr : &found->second;
}

bool ZipReader::has(const std::string& name, bool any_case) const { return find(name, any_case) != nullptr; }

std::optional<Array<char>> ZipReader::expand(const std::string& name, std::uint64_t most) {
    const Entry* const entry = find(name, false);
    if (!entry || entry->size > most || !open(name)) return std::nullopt;
    Array<char> bytes;
    bytes.resize(static_cast<std::size_t>(entry->size));
    std::size_t size = 0;
    for (std::size_t got = 1; got > 0; size += got) {
        // Reading one byte more than expected reaches the end, where the checksum is checked.
        char beyond = 0;
        const bool whole = size == bytes.size();
        if (!read(whole ? &beyond : bytes.data() + size, whole ? 1 : bytes.size() - size, got)) return std::nullopt;
        if (whole && got > 0) return std::nullopt;
    }
    return bytes;
}

bool ZipReader::open(const std::string& name, bool any_case) {
    open_entry_.reset();
    const Entry* const found = find(name, any_case);
    if (!found) return false;
    const Entry& entry = *found;
    if (entry.is_locked() || (entry.method != 0 && entry.method != Z_DEFLATED)) return false;
    const std::string_view header = record(bytes_, entry.header, local_header, "PK\3\4"sv);
    if (header.empty()) return false;
    const std::uint64_t begin =
        entry.header + local_header + number<std::uint16_t>(header, 26) + number<std::uint16_t>(header, 28);
    if (begin > bytes_.size() || entry.compressed > bytes_.size() - begin) return false;
    open_entry_ = std::make_unique<Inflation>(entry, bytes_.substr(begin, entry.compressed));
    return true;
}

bool ZipReader::read(char* to, std::size_t size, std::size_t& got) {
    got = 0;
    return size == 0 || open_entry_->read(to, size, got);
}

}  // namespace crumple::io
