#pragma once

// Header of a PLY file: its elements, their properties, and the encoding.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "io/bytes/source.h"

namespace crumple::io {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

constexpr bool is_integer(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

/// Calls f with a zero of the C++ type.
template <class F>
decltype(auto) with_type(PlyType type, F&& f) {
    switch (type) {
        case PlyType::int8:
            return f(std::int8_t{});
        case PlyType::uint8:
            return f(std::uint8_t{});
        case PlyType::int16:
            return f(std::int16_t{});
        case PlyType::uint16:
            return f(std::uint16_t{});
        case PlyType::int32:
            return f(std::int32_t{});
        case PlyType::uint32:
            return f(std::uint32_t{});
        case PlyType::int64:
            return f(std::int64_t{});
        case PlyType::uint64:
            return f(std::uint64_t{});
        case PlyType::float32:
            return f(float{});
        case PlyType::float64:
            break;
    }
    return f(double{});
}

struct PlyProperty {
    std::string name;
    PlyType type;
    std::optional<PlyType> count_type;  ///< type of a list's count; a scalar has none
};

struct PlyElement {
    std::string name;
    std::int64_t count = 0;
    std::vector<PlyProperty> properties;
    const char* place = nullptr;  ///< start of its line in the header, for errors

    /// Returns the property with one of these names, or null. Throws Error if there are two.
    const PlyProperty* find(const Source& source, std::initializer_list<std::string_view> names) const;
};

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

struct PlyHeader {
    PlyEncoding encoding{};
    std::vector<PlyElement> elements;
    const char* body = nullptr;  ///< the first byte after the header

    /// Returns the element with this name, or null. Throws Error if there are two.
    const PlyElement* find(const Source& source, std::string_view name) const;
};

PlyHeader read_ply_header(const Source& source);

}  // namespace crumple::io
