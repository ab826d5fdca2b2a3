#pragma once

// Reader of glTF 2.0 files, .glb or .gltf, as far as geometry needs it: the description (JSON), and the bytes of
// accessors. Each value of the description is checked where it is used, and an error names its place, such as
// "nodes[3].mesh".
//
// tinygltf is used to write .glb files, but not to read them: release 2.7 reads past the end of a .glb that is
// truncated in the header of its second chunk, reads 2^32 as 0, and silently ignores values of a wrong type.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/bytes/source.h"

namespace crumple::io {

/// Object of the description, with its place in the description for messages.
class GltfObject {
   public:
    GltfObject(const Source& source, const nlohmann::json& value, std::string place);

    const std::string& place() const { return place_; }
    bool has(const char* key) const { return value_->contains(key); }
    /// Return the member `key`. Throw Error (format) if its value is of another kind.
    std::optional<std::int64_t> integer(const char* key) const;  ///< an integer of 0 or more
    std::int64_t integer_or(const char* key, std::int64_t otherwise) const { return integer(key).value_or(otherwise); }
    std::int64_t required_integer(const char* key) const;
    bool flag(const char* key) const;
    std::string text(const char* key) const;  ///< empty if missing
    std::optional<GltfObject> object(const char* key) const;
    std::size_t size_of(const char* key) const;                  ///< length of a list; 0 if missing
    GltfObject object_of(const char* key, std::size_t i) const;  ///< item of a list of objects
    std::vector<std::int64_t> integers(const char* key) const;   ///< integers of 0 or more
    std::vector<double> numbers(const char* key) const;
    std::vector<double> numbers(const char* key, std::size_t count) const;  ///< exactly `count`, or none if missing
    std::vector<std::string> texts(const char* key) const;

    /// Throws Error (format): "NAME: nodes[3].mesh WHAT", or without a key "NAME: nodes[3] WHAT".
    [[noreturn]] void fail(const std::string& what) const;
    [[noreturn]] void fail(const char* key, const std::string& what) const;

   private:
    const nlohmann::json* find(const char* key) const;
    const nlohmann::json* find_list(const char* key) const;

    const Source* source_;
    const nlohmann::json* value_;
    std::string place_;
};

enum GltfComponent : std::int64_t {
    gltf_int8 = 5120,
    gltf_uint8 = 5121,
    gltf_int16 = 5122,
    gltf_uint16 = 5123,
    gltf_uint32 = 5125,
    gltf_float32 = 5126
};

/// Elements of an accessor, one every `stride` bytes from `data` on. All lie within their buffer.
struct GltfElements {
    const char* data = nullptr;
    std::size_t stride = 0;
    std::int64_t count = 0;
    std::int64_t component_type = 0;
    bool normalised = false;

    const char* at(std::int64_t i) const { return data + stride * static_cast<std::size_t>(i); }
    bool has_indices() const {
        return component_type == gltf_uint8 || component_type == gltf_uint16 || component_type == gltf_uint32;
    }
    /// Returns an index. Requires has_indices().
    std::int64_t index_at(std::int64_t i) const;
};

class GltfFile {
   public:
    /// `folder`: folder in which other files that the glTF file refers to are found; none for a stream. Throws Error
    /// (format).
    GltfFile(const Source& source, std::optional<std::filesystem::path> folder, Warnings& warnings);

    const GltfObject& root() const { return *root_; }
    const std::string& name() const { return source_.name(); }
    /// Returns item `index` of the description's list `list`. `from` and `key`: the object and its member that the
    /// index was read from, for messages.
    GltfObject item(const char* list, std::int64_t index, const GltfObject& from, const char* key) const;
    /// Returns the elements of an accessor. Throws Error (format) if they are not of this type, "SCALAR" or "VEC3", or
    /// are not valid; Error (file) if the file with their bytes cannot be read.
    GltfElements elements(const GltfObject& accessor, std::string_view type);
    /// Returns the total size, in bytes, of the glTF file and of the buffers in other files that have been read so far.
    std::size_t bytes_read() const { return bytes_read_; }

   private:
    struct Buffer {
        std::optional<Source> file;
        std::string decoded;
        std::string_view bytes;
    };
    std::string_view read_container(Warnings& warnings);
    /// Returns `count` elements of `size` bytes, which lie in the buffer view that `from` names.
    GltfElements elements_in_view(const GltfObject& from, std::int64_t count, std::int64_t component_type,
                                  std::size_t size);
    void replace_some(GltfElements& elements, const GltfObject& sparse, std::size_t size);
    std::string_view buffer_view(const GltfObject& view);
    std::string_view buffer(std::int64_t index, const GltfObject& from);
    Buffer read_buffer(const GltfObject& buffer, bool first) const;

    const Source& source_;
    std::optional<std::filesystem::path> folder_;
    std::optional<std::string_view> chunk_;  ///< the binary chunk of a .glb
    nlohmann::json document_;
    std::optional<GltfObject> root_;
    std::vector<std::optional<Buffer>> buffers_;
    std::deque<std::string> replaced_;  ///< copied elements of sparse accessors
    std::uint64_t replaced_bytes_ = 0;
    std::size_t bytes_read_;
};

/// True if a file is glTF by its content or by its extension (lower case, with its dot).
bool is_gltf(const Source& source, const std::string& extension);

}  // namespace crumple::io
