#pragma once

// Writes zip archives and gzip members of stored (uncompressed) data with valid checksums, so that readers do not
// refuse mutated contents because of a checksum.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/bytes/bytes.h"

namespace crumple::fuzz {

inline std::uint32_t checksum(std::string_view bytes) {
    static const auto table = [] {
        std::array<std::uint32_t, 256> made{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t value = i;
            for (int bit = 0; bit < 8; ++bit) value = value & 1 ? value >> 1 ^ 0xedb88320u : value >> 1;
            made[i] = value;
        }
        return made;
    }();
    std::uint32_t value = ~0u;
    for (const char c : bytes) value = table[(value ^ static_cast<unsigned char>(c)) & 255] ^ value >> 8;
    return ~value;
}

/// Pairs of file name and contents.
using ArchivedFiles = std::vector<std::pair<std::string_view, std::string_view>>;

inline std::string archive_of(const ArchivedFiles& files) {
    std::string out;
    const auto put = [&](auto... values) {
        const auto append = [&](auto value) {
            const auto little = io::little_endian(value);
            out.append(little.data(), little.size());
        };
        (append(values), ...);
    };
    using Word = std::uint32_t;
    using Half = std::uint16_t;
    const auto describe = [&](std::string_view name,
                              std::string_view bytes) {  // version, flags, method, time, date, ...
        const auto size = static_cast<Word>(bytes.size());
        put(Half{20}, Half{0}, Half{0}, Half{0}, Half{33}, checksum(bytes), size, size, static_cast<Half>(name.size()),
            Half{0});
    };
    std::vector<Word> places;
    for (const auto& [name, bytes] : files) {
        places.push_back(static_cast<Word>(out.size()));
        put(Word{0x04034b50});
        describe(name, bytes);
        out += name;
        out += bytes;
    }
    const auto directory = static_cast<Word>(out.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
        put(Word{0x02014b50}, Half{20});
        describe(files[i].first, files[i].second);
        put(Half{0}, Half{0}, Half{0}, Word{0}, places[i]);
        out += files[i].first;
    }
    const auto directory_size = static_cast<Word>(out.size()) - directory;
    const auto count = static_cast<Half>(files.size());
    put(Word{0x06054b50}, Half{0}, Half{0}, count, count, directory_size, directory, Half{0});
    return out;
}

/// Returns a 3MF file that holds one model part.
inline std::string package_of(std::string_view model) {
    constexpr std::string_view relations =
        "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship "
        "Target=\"/m\" Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    return archive_of({{"_rels/.rels", relations}, {"m", model}});
}

/// Returns a gzip member that holds `bytes` in stored blocks.
inline std::string gzip_of(std::string_view bytes) {
    std::string out("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10);
    const auto put = [&](auto value) {
        const auto little = io::little_endian(value);
        out.append(little.data(), little.size());
    };
    const std::uint32_t sum = checksum(bytes), size = static_cast<std::uint32_t>(bytes.size());
    constexpr std::size_t longest_block = 65535;
    do {
        const std::string_view block = bytes.substr(0, longest_block);
        bytes.remove_prefix(block.size());
        out += bytes.empty() ? '\1' : '\0';
        const auto length = static_cast<std::uint16_t>(block.size());
        put(length);
        put(static_cast<std::uint16_t>(~length));
        out += block;
    } while (!bytes.empty());
    put(sum);
    put(size);
    return out;
}

}  // namespace crumple::fuzz
