#pragma once

// Small glTF scenes, made by the tests that read them.

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/bytes/bytes.h"

namespace crumple::test {

/// Meshes, nodes and a default scene, to be written as .glb or .gltf. `json` may be changed in any way before.
class GltfScene {
   public:
    using Json = nlohmann::json;
    Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", Json::array()}}}}};
    std::string bytes;  ///< contents of the scene's only buffer

    template <class T>
    int add_accessor(const std::vector<T>& values, int component_type, const char* type) {
        while (bytes.size() % 4) bytes += '\0';
        const std::size_t offset = bytes.size();
        for (const T value : values) {
            const auto little = io::little_endian(value);
            bytes.append(little.data(), little.size());
        }
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size() - offset}});
        json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                     {"componentType", component_type},
                                     {"count", values.size() / (std::string_view(type) == "VEC3" ? 3 : 1)},
                                     {"type", type}});
        return static_cast<int>(json["accessors"].size()) - 1;
    }
    int add_positions(const std::vector<float>& xyz) { return add_accessor(xyz, 5126, "VEC3"); }
    int add_indices(const std::vector<std::uint16_t>& indices) { return add_accessor(indices, 5123, "SCALAR"); }

    int add_mesh(Json primitives) {
        json["meshes"].push_back({{"primitives", std::move(primitives)}});
        return static_cast<int>(json["meshes"].size()) - 1;
    }
    /// Adds a mesh of one triangle list; returns its index.
    int add_mesh(const std::vector<float>& xyz, const std::vector<std::uint16_t>& indices) {
        const int positions = add_positions(xyz), corners = add_indices(indices);
        return add_mesh({{{"attributes", {{"POSITION", positions}}}, {"indices", corners}}});
    }
    /// Adds a tetrahedron with a corner at the origin and unit edges along the axes; returns its mesh index.
    int add_tetrahedron() {
        return add_mesh({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    }

    /// Adds a node, by default as a root of the scene; returns its index.
    int add_node(Json node, bool root = true) {
        json["nodes"].push_back(std::move(node));
        const int index = static_cast<int>(json["nodes"].size()) - 1;
        if (root) json["scenes"][0]["nodes"].push_back(index);
        return index;
    }
    int add_body(const std::string& name, int mesh, const std::array<double, 3>& translation = {}) {
        return add_node({{"name", name}, {"mesh", mesh}, {"translation", translation}});
    }

    std::string glb() const {
        Json whole = json;
        if (!bytes.empty() && !whole.contains("buffers")) whole["buffers"] = {{{"byteLength", bytes.size()}}};
        return glb_of(whole.dump(), bytes);
    }
    /// Returns the .gltf text; its buffer is the file `uri`.
    std::string gltf(const std::string& uri) const {
        Json whole = json;
        whole["buffers"] = {{{"byteLength", bytes.size()}, {"uri", uri}}};
        return whole.dump(1);
    }

    static std::string glb_of(std::string text, std::string binary) {
        text.resize((text.size() + 3) / 4 * 4, ' ');
        binary.resize((binary.size() + 3) / 4 * 4);
        std::string file = "glTF" + word(2) + word(12 + 8 + text.size() + (binary.empty() ? 0 : 8 + binary.size()));
        file += word(text.size()) + "JSON" + text;
        if (!binary.empty()) file += word(binary.size()) + std::string("BIN\0", 4) + binary;
        return file;
    }

   private:
    static std::string word(std::size_t value) {
        const auto little = io::little_endian(static_cast<std::uint32_t>(value));
        return {little.begin(), little.end()};
    }
};

/// Four bodies of one shape: `base` and `arm` touch at a corner, `arm` and `hand` overlap, `far away` is alone.
inline GltfScene robot_scene() {
    GltfScene scene;
    const int shape = scene.add_tetrahedron();
    scene.add_body("base", shape);
    scene.add_body("arm", shape, {1, 0, 0});
    scene.add_body("hand", shape, {1.25, 0.125, 0.125});
    scene.add_body("far away", shape, {9, 9, 9});
    return scene;
}

}  // namespace crumple::test
