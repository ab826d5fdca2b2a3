#pragma once

// A zip archive of one stored file, written by hand: a changed byte of the file keeps the checksum right, so that
// inputs get past it.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "io/bytes.h"

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

inline std::string archive_of(std::string_view name, std::string_view bytes) {
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
    const auto size = static_cast<Word>(bytes.size());
    const auto describe = [&] {  // version, flags, stored, time, date
        put(Half{20}, Half{0}, Half{0}, Half{0}, Half{33}, checksum(bytes), size, size, static_cast<Half>(name.size()),
            Half{0});
    };
    put(Word{0x04034b50});
    describe();
    out += name;
    out += bytes;
    const auto directory = static_cast<Word>(out.size());
    put(Word{0x02014b50}, Half{20});
    describe();
    put(Half{0}, Half{0}, Half{0}, Word{0}, Word{0});
    out += name;
    const auto directory_size = static_cast<Word>(out.size()) - directory;
    put(Word{0x06054b50}, Half{0}, Half{0}, Half{1}, Half{1}, directory_size, directory, Half{0});
    return out;
}

}  // namespace crumple::fuzz
