#include <cmath>
#include <utility>

#include "io/scenes/gltf_file.h"

namespace crumple::io {

using nlohmann::json;

GltfObject::GltfObject(const Source& source, const json& value, std::string place)
    : source_(&source), value_(&value), place_(std::move(place)) {
    if (!value.is_object()) fail("is not an object");
}

void GltfObject::fail(const std::string& what) const {
    throw Error(ErrorCode::format, source_->name() + ": " + (place_.empty() ? "the description" : place_) + " " + what);
}

void GltfObject::fail(const char* key, const std::string& what) const {
    throw Error(ErrorCode::format, source_->name() + ": " + (place_.empty() ? "" : place_ + ".") + key + " " + what);
}

const json* GltfObject::find(const char* key) const {
    const auto found = value_->find(key);
    return found == value_->end() ? nullptr : &*found;
}

const json* GltfObject::find_list(const char* key) const {
    const json* const found = find(key);
    if (found && !found->is_array()) fail(key, "is not a list");
    return found;
}

namespace {

std::optional<std::int64_t> as_index(const json& value) {
    if (!value.is_number_unsigned()) return std::nullopt;  // the parser stores integers without a sign as unsigned
    const auto number = value.get<std::uint64_t>();
    return std::in_range<std::int64_t>(number) ? std::optional(static_cast<std::int64_t>(number)) : std::nullopt;
}

constexpr const char* no_index = "is not an integer from 0 to 2^63 - 1";

}  // namespace

std::optional<std::int64_t> GltfObject::integer(const char* key) const {
    const json* const found = find(key);
    if (!found) return std::nullopt;
    const auto number = as_index(*found);
    if (!number) fail(key, no_index);
    return number;
}

std::int64_t GltfObject::required_integer(const char* key) const {
    const auto number = integer(key);
    if (!number) fail(key, "is missing");
    return *number;
}

bool GltfObject::flag(const char* key) const {
    const json* const found = find(key);
    if (found && !found->is_boolean()) fail(key, "is neither true nor false");
    return found && found->get<bool>();
}

std::string GltfObject::text(const char* key) const {
    const json* const found = find(key);
    if (found && !found->is_string()) fail(key, "is not text");
    return found ? found->get<std::string>() : "";
}

std::optional<GltfObject> GltfObject::object(const char* key) const {
    const json* const found = find(key);
    if (!found) return std::nullopt;
    return GltfObject(*source_, *found, (place_.empty() ? "" : place_ + ".") + key);
}

std::size_t GltfObject::size_of(const char* key) const {
    const json* const found = find_list(key);
    return found ? found->size() : 0;
}

GltfObject GltfObject::object_of(const char* key, std::size_t i) const {
    return GltfObject(*source_, (*find_list(key))[i],
                      (place_.empty() ? "" : place_ + ".") + key + "[" + std::to_string(i) + "]");
}

std::vector<std::int64_t> GltfObject::integers(const char* key) const {
    std::vector<std::int64_t> result;
    if (const json* const found = find_list(key)) {
        for (const json& value : *found) {
            const auto number = as_index(value);
            if (!number) fail(key, std::string("holds a value that ") + no_index);
            result.push_back(*number);
        }
    }
    return result;
}

std::vector<double> GltfObject::numbers(const char* key) const {
    std::vector<double> result;
    if (const json* const found = find_list(key)) {
        for (const json& value : *found) {
            if (!value.is_number()) fail(key, "holds a value that is not a number");
            result.push_back(value.get<double>());
        }
    }
    return result;
}

std::vector<double> GltfObject::numbers(const char* key, std::size_t count) const {
    std::vector<double> result = numbers(key);
    if (has(key) && result.size() != count)
        fail(key, "holds " + std::to_string(result.size()) + " numbers, not " + std::to_string(count));
    return result;
}

std::vector<std::string> GltfObject::texts(const char* key) const {
    std::vector<std::string> result;
    if (const json* const found = find_list(key)) {
        for (const json& value : *found) {
            if (!value.is_string()) fail(key, "holds a value that is not text");
            result.push_back(value.get<std::string>());
        }
    }
    return result;
}

}  // namespace crumple::io
