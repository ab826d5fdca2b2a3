#include "io/scenes/gltf_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "io/bytes/bytes.h"
#include "io/bytes/expanded_size.h"

namespace crumple::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view magic = "glTF";
constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;

std::uint32_t word_at(const char* p) { return load<std::uint32_t>(p, std::endian::little); }

/// Returns the size of a component of this type in bytes; 0 for types that glTF does not have.
std::size_t bytes_of(std::int64_t component_type) {
    switch (component_type) {
        case gltf_int8:
        case gltf_uint8:
            return 1;
        case gltf_int16:
        case gltf_uint16:
            return 2;
        case gltf_uint32:
        case gltf_float32:
            return 4;
        default:
            return 0;
    }
}

/// Decodes base64; returns nothing if the text is not base64. Padding may be missing.
std::optional<std::string> decode_base64(std::string_view text) {
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                          : c >= 'a' && c <= 'z' ? c - 'a' + 26
                          : c >= '0' && c <= '9' ? c - '0' + 52
                          : c == '+'             ? 62
                          : c == '/'             ? 63
                                                 : -1;
        if (value < 0) return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count >= 8) bytes.push_back(static_cast<char>(bits >> (count -= 8) & 0xffu));
    }
    return bytes;
}

/// Decodes percent-encoding: "%20" is a blank. Anything that is not such a code stays unchanged.
std::string decode_percent(const std::string& text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        unsigned value = 0;
        const char* const digits = text.data() + i + 1;
        const bool coded =
            text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2;
        result += coded ? static_cast<char>(value) : text[i];
        if (coded) i += 2;
    }
    return result;
}

}  // namespace

bool is_gltf(const Source& source, const std::string& extension) {
    if (source.text().starts_with(magic)) return true;
    const std::string_view text(source.text_begin(), static_cast<std::size_t>(source.end() - source.text_begin()));
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    const bool object = first != text.npos && text[first] == '{';
    return object || extension == ".gltf" || extension == ".glb";
}

GltfFile::GltfFile(const Source& source, std::optional<fs::path> folder, Warnings& warnings)
    : source_(source), folder_(std::move(folder)), bytes_read_(source.text().size()) {
    const std::string_view text = read_container(warnings);
    try {
        document_ = nlohmann::json::parse(text.begin(), text.end());
    } catch (const nlohmann::json::parse_error& error) {
        const std::size_t place = std::min(error.byte ? error.byte - 1 : 0, text.size());
        source.fail_at_byte(text.data() + place, "the description is not valid JSON from here on");
    } catch (const nlohmann::json::exception&) {
        source.fail_at_byte(text.data(), "the description holds a number beyond float64");
    }
    root_.emplace(source, document_, "");
    const auto asset = root_->object("asset");
    if (!asset) root_->fail("asset", "is missing, so this is not glTF 2.0");
    const std::string version = asset->text("version");
    if (!version.starts_with("2.")) asset->fail("version", "is " + in_quotes(version) + "; only glTF 2.0 is supported");
    buffers_.resize(root_->size_of("buffers"));
}

/// Returns the JSON of a .glb, and sets `chunk_` to its binary chunk, or the whole text of a .gltf.
std::string_view GltfFile::read_container(Warnings& warnings) {
    const std::string_view text = source_.text();
    if (!text.starts_with(magic)) return text.substr(static_cast<std::size_t>(source_.text_begin() - text.data()));
    if (text.size() < header_bytes) source_.fail_at_byte(source_.end(), "the file is truncated in its header");
    const std::uint32_t version = word_at(text.data() + 4);
    if (version != 2)
        source_.fail_at_byte(text.data() + 4,
                             "this is version " + std::to_string(version) + " of .glb; only version 2 is supported");
    const std::size_t length = word_at(text.data() + 8);
    if (length > text.size())
        source_.fail_at_byte(source_.end(), "the file ends after " + std::to_string(text.size()) + " of " +
                                                std::to_string(length) + " bytes");
    if (length < text.size()) warnings.at_byte(text.data() + length, "the data after the announced bytes is skipped");

    std::optional<std::string_view> json;
    for (std::size_t place = header_bytes; place < length;) {
        const char* const chunk = text.data() + place;
        if (length - place < chunk_header_bytes || word_at(chunk) > length - place - chunk_header_bytes)
            source_.fail_at_byte(chunk, "a chunk is larger than what is left of the file");
        const std::string_view type(chunk + 4, 4), bytes(chunk + chunk_header_bytes, word_at(chunk));
        if (!json && type != "JSON") source_.fail_at_byte(chunk, "the first chunk is not JSON");
        if (!json)
            json = bytes;
        else if (!chunk_ && type == std::string_view("BIN\0", 4))
            chunk_ = bytes;
        place += chunk_header_bytes + bytes.size();
    }
    if (!json) source_.fail_at_byte(source_.end(), "the file holds no JSON");
    return *json;
}

GltfObject GltfFile::item(const char* list, std::int64_t index, const GltfObject& from, const char* key) const {
    const std::size_t size = root_->size_of(list);
    if (static_cast<std::uint64_t>(index) >= size)
        from.fail(key, "is " + std::to_string(index) + ", but there are " + std::to_string(size) + " " + list);
    return root_->object_of(list, static_cast<std::size_t>(index));
}

std::int64_t GltfElements::index_at(std::int64_t i) const {
    switch (component_type) {
        case gltf_uint8:
            return load<std::uint8_t>(at(i), std::endian::little);
        case gltf_uint16:
            return load<std::uint16_t>(at(i), std::endian::little);
        default:
            return load<std::uint32_t>(at(i), std::endian::little);
    }
}

GltfElements GltfFile::elements(const GltfObject& accessor, std::string_view type) {
    const std::string found = accessor.text("type");
    if (found != type) accessor.fail("type", "is " + in_quotes(found) + ", not " + in_quotes(type));
    const std::int64_t component_type = accessor.required_integer("componentType");
    const std::size_t size = bytes_of(component_type) * (type == "VEC3" ? 3 : 1);
    if (!size) accessor.fail("componentType", "is " + std::to_string(component_type) + ", which glTF does not define");
    const std::int64_t count = accessor.required_integer("count");
    const auto sparse = accessor.object("sparse");
    GltfElements result{nullptr, size, count, component_type};
    if (!sparse || accessor.has("bufferView")) result = elements_in_view(accessor, count, component_type, size);
    if (sparse) replace_some(result, *sparse, size);
    result.normalised = accessor.flag("normalized");
    return result;
}

GltfElements GltfFile::elements_in_view(const GltfObject& from, std::int64_t count, std::int64_t component_type,
                                        std::size_t size) {
    const GltfObject view = item("bufferViews", from.required_integer("bufferView"), from, "bufferView");
    const std::string_view bytes = buffer_view(view);
    GltfElements result{nullptr, size, count, component_type};
    if (const auto stride = view.integer("byteStride")) {
        if (static_cast<std::uint64_t>(*stride) < size)
            view.fail("byteStride", "is " + std::to_string(*stride) + ", but the elements of " + from.place() +
                                        " take " + std::to_string(size) + " bytes");
        result.stride = static_cast<std::size_t>(*stride);
    }
    const auto offset = static_cast<std::uint64_t>(from.integer_or("byteOffset", 0));
    const std::uint64_t left = offset > bytes.size() ? 0 : bytes.size() - offset;
    const std::uint64_t fit = left < size ? 0 : 1 + (left - size) / result.stride;
    if (static_cast<std::uint64_t>(count) > fit)
        from.fail("announces " + std::to_string(count) + " elements, but " + view.place() + " holds " +
                  std::to_string(fit));
    result.data = bytes.data() + (count ? offset : 0);
    return result;
}

/// Copies the elements of an accessor, or makes zeros if it has no buffer view, and replaces those that its member
/// `sparse` lists. Points `elements` to the copy. `size`: bytes of an element.
void GltfFile::replace_some(GltfElements& elements, const GltfObject& sparse, std::size_t size) {
    if (static_cast<std::uint64_t>(elements.count) > (expansion_limit(bytes_read_) - replaced_bytes_) / size)
        sparse.fail("replaces elements that expand too far: " + std::string(expansion_rule));
    std::string& bytes = replaced_.emplace_back(static_cast<std::size_t>(elements.count) * size, '\0');
    replaced_bytes_ += bytes.size();
    for (std::int64_t i = 0; elements.data && i < elements.count; ++i)
        std::copy_n(elements.at(i), size, bytes.data() + static_cast<std::size_t>(i) * size);
    elements.data = bytes.data();
    elements.stride = size;

    const auto at = sparse.object("indices"), values_at = sparse.object("values");
    if (!at || !values_at) sparse.fail("lacks its indices or its values");
    const std::int64_t count = sparse.required_integer("count"), type = at->required_integer("componentType");
    const GltfElements values = elements_in_view(*values_at, count, elements.component_type, size);
    if (!GltfElements{.component_type = type}.has_indices())
        at->fail("componentType", "is " + std::to_string(type) + ", which is not a type of indices");
    const GltfElements indices = elements_in_view(*at, count, type, bytes_of(type));
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t index = indices.index_at(i);
        if (index >= elements.count)
            at->fail("names element " + std::to_string(index) + " of " + std::to_string(elements.count));
        std::copy_n(values.at(i), size, bytes.data() + static_cast<std::size_t>(index) * size);
    }
}

std::string_view GltfFile::buffer_view(const GltfObject& view) {
    const std::string_view bytes = buffer(view.required_integer("buffer"), view);
    const auto offset = static_cast<std::uint64_t>(view.integer_or("byteOffset", 0));
    const auto length = static_cast<std::uint64_t>(view.required_integer("byteLength"));
    if (offset > bytes.size() || length > bytes.size() - offset)
        view.fail("ends at byte " + std::to_string(offset + length) + " of a buffer of " +
                  std::to_string(bytes.size()));
    return bytes.substr(offset, length);
}

std::string_view GltfFile::buffer(std::int64_t index, const GltfObject& from) {
    const GltfObject description = item("buffers", index, from, "buffer");
    auto& kept = buffers_[static_cast<std::size_t>(index)];
    if (!kept) {
        kept = read_buffer(description, index == 0);
        bytes_read_ += kept->file ? kept->file->text().size() : 0;
        if (kept->file) kept->bytes = kept->file->text();
        if (!kept->decoded.empty()) kept->bytes = kept->decoded;
        const auto length = static_cast<std::uint64_t>(description.required_integer("byteLength"));
        if (length > kept->bytes.size()) {
            const std::size_t size = kept->bytes.size();
            kept.reset();
            description.fail("byteLength", "is " + std::to_string(length) + ", but the buffer has " +
                                               std::to_string(size) + " bytes");
        }
        kept->bytes = kept->bytes.substr(0, length);
    }
    return kept->bytes;
}

GltfFile::Buffer GltfFile::read_buffer(const GltfObject& buffer, bool first) const {
    Buffer result;
    const std::string uri = buffer.text("uri");
    if (!buffer.has("uri")) {
        if (!first || !chunk_) buffer.fail("uri", "is missing");
        result.bytes = *chunk_;
    } else if (uri.starts_with("data:")) {
        const std::size_t begin = uri.find(";base64,");
        auto bytes = begin == uri.npos ? std::nullopt : decode_base64(std::string_view(uri).substr(begin + 8));
        if (!bytes) buffer.fail("uri", "holds data that is not base64");
        result.decoded = std::move(*bytes);
    } else {
        const fs::path path = decode_percent(uri);
        if (uri.empty() || path.is_absolute() || uri.find("://") != uri.npos)
            buffer.fail("uri", in_quotes(uri) + " is not the path of a file beside this one");
        if (!folder_) buffer.fail("uri", "names the file " + in_quotes(uri) + ", but a stream has no files beside it");
        result.file.emplace(*folder_ / path);
    }
    return result;
}

}  // namespace crumple::io
