#pragma once

#include <cstdint>
#include <string>

namespace crumple::io {

/// Returns a non-negative number with thousands separators: "63,602".
inline std::string grouped(std::int64_t number) {
    const std::string digits = std::to_string(number);
    std::string text;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
        text += digits[i];
    }
    return text;
}

}  // namespace crumple::io
