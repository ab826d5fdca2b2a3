#include "io/scenes/body_names.h"

#include <algorithm>
#include <cctype>

#include <nlohmann/json.hpp>

namespace crumple::io {

std::string quoted_name(const std::string& name) {
    const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    const bool odd = name.empty() || is_blank(name.front()) || is_blank(name.back()) || name.front() == '#' ||
                     std::any_of(name.begin(), name.end(),
                                 [](char c) { return c == '"' || std::iscntrl(static_cast<unsigned char>(c)); });
    if (!odd) return name;
    return nlohmann::json(name).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace crumple::io
