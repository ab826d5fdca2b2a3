// Reads the scene of a glTF file as a world: each of its nodes that has a mesh is a body, in the order of the file's
// nodes. A node's pose is the product of the transforms from its root down to it, in float64.

#include "io/scenes/gltf.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "io/scenes/gltf_file.h"
#include "io/scenes/gltf_mesh.h"
#include "io/scenes/pose_product.h"

namespace crumple::io {

namespace {

/// True for extensions that do not change the positions of triangles, and for those that this reader implements.
bool is_harmless(const std::string& extension) {
    constexpr std::string_view exact[] = {"KHR_mesh_quantization", "KHR_xmp_json_ld", "KHR_animation_pointer"};
    constexpr std::string_view prefixes[] = {"KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_",
                                             "EXT_lights_"};
    return std::find(std::begin(exact), std::end(exact), extension) != std::end(exact) ||
           std::any_of(std::begin(prefixes), std::end(prefixes),
                       [&](std::string_view prefix) { return extension.starts_with(prefix); });
}

class Reader {
   public:
    Reader(const Source& source, std::optional<std::filesystem::path> folder, const ReadOptions& options,
           Warnings& warnings)
        : file_(source, std::move(folder), warnings), warnings_(warnings), meshes_(file_, options) {}

    WorldMesh read() {
        const GltfObject& root = file_.root();
        for (const std::string& extension : root.texts("extensionsRequired"))
            if (!is_harmless(extension))
                root.fail("extensionsRequired", "names " + in_quotes(extension) + ", which is not supported");
        nodes_ = root.size_of("nodes");
        poses_.resize(nodes_);
        seen_.assign(nodes_, false);
        place_nodes(roots());
        for (std::size_t n = 0; n < nodes_; ++n) add_body(n);
        world_.shapes = meshes_.release_shapes();
        world_.unit = Unit::metre;
        for (TriangleMesh& shape : world_.shapes) shape.unit = world_.unit;
        warn();
        return std::move(world_);
    }

   private:
    GltfObject node(std::size_t n) const { return file_.root().object_of("nodes", n); }

    [[noreturn]] static void fail(const GltfObject& node, const std::string& what) {
        const std::string name = node.text("name");
        node.fail((name.empty() ? "" : in_quotes(name) + " ") + what);
    }

    /// Returns the indices of nodes that member `key` of `parent` lists: the children of a node, or the roots of a
    /// scene.
    std::vector<std::size_t> nodes_of(const GltfObject& parent, const char* key) const {
        std::vector<std::size_t> result;
        for (const std::int64_t index : parent.integers(key)) {
            if (static_cast<std::uint64_t>(index) >= nodes_)
                parent.fail(key, "names node " + std::to_string(index) + " of " + std::to_string(nodes_));
            result.push_back(static_cast<std::size_t>(index));
        }
        return result;
    }

    /// Returns the roots of the default scene, else of the first one; without any scene, all nodes that are not
    /// children.
    std::vector<std::size_t> roots() const {
        const GltfObject& root = file_.root();
        if (root.has("scene") || root.size_of("scenes"))
            return nodes_of(file_.item("scenes", root.integer_or("scene", 0), root, "scene"), "nodes");
        std::vector<bool> is_child(nodes_);
        for (std::size_t n = 0; n < nodes_; ++n)
            for (const std::size_t child : nodes_of(node(n), "children")) is_child[child] = true;
        std::vector<std::size_t> result;
        for (std::size_t n = 0; n < nodes_; ++n)
            if (!is_child[n]) result.push_back(n);
        return result;
    }

    /// Computes the poses of `roots` and of all nodes below them. Throws Error (format) if a node is reached twice, as
    /// in a cycle.
    void place_nodes(const std::vector<std::size_t>& roots) {
        struct Step {
            std::size_t node;
            Pose parent;
        };
        std::vector<Step> steps;
        steps.reserve(roots.size());
        for (const std::size_t n : roots) steps.push_back({n, {}});
        while (!steps.empty()) {
            const Step step = steps.back();
            steps.pop_back();
            const GltfObject object = node(step.node);
            if (seen_[step.node])
                fail(object, "is referred to twice: by the scene, another node or its own descendant");
            seen_[step.node] = true;
            Pose& pose = poses_[step.node];
            pose = product(step.parent, transform_of(object));
            if (!is_finite(pose)) fail(object, "has a transform that is not finite");
            for (const std::size_t child : nodes_of(object, "children")) steps.push_back({child, pose});
        }
    }

    /// Returns the local transform of a node: its matrix, which glTF stores by columns, or the product translation *
    /// rotation * scale.
    static Pose transform_of(const GltfObject& node) {
        const std::vector<double> matrix = node.numbers("matrix", 16);
        Pose pose;
        if (!matrix.empty()) {
            if (matrix[3] != 0 || matrix[7] != 0 || matrix[11] != 0 || matrix[15] != 1)
                fail(node, "has a matrix that is not affine: its last row is not 0 0 0 1");
            for (std::size_t i = 0; i < 3; ++i)
                for (std::size_t k = 0; k < 4; ++k) pose.rows[4 * i + k] = matrix[4 * k + i];
            return pose;
        }
        const std::vector<double> translation = node.numbers("translation", 3), rotation = node.numbers("rotation", 4),
                                  scale = node.numbers("scale", 3);
        if (!rotation.empty()) rotate(pose, rotation, node);
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t k = 0; k < 3 && !scale.empty(); ++k) pose.rows[4 * i + k] *= scale[k];
            if (!translation.empty()) pose.rows[4 * i + 3] = translation[i];
        }
        return pose;
    }

    /// Sets `pose` to the rotation of a quaternion of any length greater than 0. Divides by the squared length, so a
    /// rotation by a right angle about a coordinate axis is exact even if the quaternion was rounded to float32.
    static void rotate(Pose& pose, const std::vector<double>& q, const GltfObject& node) {
        const double x = q[0], y = q[1], z = q[2], w = q[3];
        const double length2 = (x * x + y * y) + (z * z + w * w);
        if (!(length2 > 0) || !std::isfinite(length2)) fail(node, "has a rotation whose length is 0 or not finite");
        const auto part = [&](double sum) { return 2 * sum / length2; };
        pose.rows = {1 - part(y * y + z * z), part(x * y - z * w),     part(x * z + y * w),     0,
                     part(x * y + z * w),     1 - part(x * x + z * z), part(y * z - x * w),     0,
                     part(x * z - y * w),     part(y * z + x * w),     1 - part(x * x + y * y), 0};
    }

    void add_body(std::size_t n) {
        const GltfObject object = node(n);
        const auto mesh = object.integer("mesh");
        if (!mesh) return;
        if (!seen_[n]) {
            ++not_in_scene_;
            return;
        }
        if (object.has("skin")) skins_.add(object.place());
        const auto extensions = object.object("extensions");
        if (extensions && extensions->has("EXT_mesh_gpu_instancing")) instances_.add(object.place());
        const std::vector<double> weights = object.numbers("weights");
        if (std::any_of(weights.begin(), weights.end(), [](double w) { return w != 0; }))
            meshes_.morph_targets.add(object.place());
        std::string name = object.text("name");
        const std::int32_t shape = meshes_.shape_of(*mesh, object);
        if (name.empty()) name = file_.item("meshes", *mesh, object, "mesh").text("name");
        if (name.empty()) name = "node" + std::to_string(n);
        world_.bodies.push_back({std::move(name), shape, poses_[n]});
    }

    void warn() {
        const auto tell = [&](const GltfMeshes::Unsupported& left, const char* what) {
            if (!left.count) return;
            const std::string more = left.count > 1 ? ", and " + std::to_string(left.count - 1) + " more like it" : "";
            warnings_.of_file(left.first + ' ' + what + more);
        };
        tell(meshes_.points_and_lines, "holds points or lines, which are skipped");
        tell(meshes_.without_positions, "has no attribute POSITION and is skipped");
        tell(meshes_.morph_targets, "has morph targets with weights, which are not applied");
        tell(skins_, "has a skin, which is not applied: its mesh is where the node is");
        tell(instances_, "has instances by EXT_mesh_gpu_instancing, of which one is read");
        if (not_in_scene_)
            warnings_.of_file(std::to_string(not_in_scene_) + " of its nodes with meshes are not in the scene");
    }

    GltfFile file_;
    Warnings& warnings_;
    GltfMeshes meshes_;
    WorldMesh world_;
    std::size_t nodes_ = 0;
    std::vector<Pose> poses_;
    std::vector<bool> seen_;
    GltfMeshes::Unsupported skins_, instances_;
    std::int64_t not_in_scene_ = 0;
};

}  // namespace

WorldMesh read_gltf(const Source& source, std::optional<std::filesystem::path> folder, const ReadOptions& options,
                    Warnings& warnings) {
    return Reader(source, std::move(folder), options, warnings).read();
}

}  // namespace crumple::io
