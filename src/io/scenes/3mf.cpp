// Reader of 3MF, the core specification and the production extension: reads the build as a world. Each mesh that a
// build item refers to, directly or through components, is a body, in the order of the build. Its pose is the product
// of the transforms along these references, in float64.

#include "io/scenes/3mf.h"

#include <algorithm>
#include <map>
#include <utility>

#include "io/meshes/weld.h"
#include "io/scenes/3mf_model.h"
#include "io/scenes/pose_product.h"

namespace crumple::io {

namespace {

constexpr std::string_view model_relationship = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";
constexpr std::size_t deepest = 64;  // levels of nested components
/// Number of references to objects that a file of any size may have. Larger files may have as many as they have
/// uncompressed bytes. Without a limit, nested components of a few lines could refer to more bodies than fit in memory.
constexpr std::uint64_t always_named = std::uint64_t{1} << 16;

class Assembler {
   public:
    Assembler(const Source& source, const ReadOptions& options, Warnings& warnings)
        : package_(source, "3MF"), options_(options), warnings_(warnings) {}

    WorldMesh read() {
        root_ = part_name(package_.target_of(model_relationship));
        for (const ModelReference& item : part(root_).model.build) place(item, root_, {}, "");
        warn();
        for (TriangleMesh& shape : world_.shapes) shape.unit = world_.unit;
        return std::move(world_);
    }

   private:
    struct Part {
        Model model;
        std::vector<std::int32_t> shapes;  ///< shape of each mesh; -1: not used yet
    };

    /// Returns a part of the package, which is read on first use. Names that differ only in case name the same part.
    Part& part(const std::string& name) {
        std::string key = in_lower_case(name);
        const auto known = parts_.find(key);
        if (known != parts_.end()) return known->second;
        Part read{read_3mf_model(package_, name, options_), {}};
        read.shapes.assign(read.model.meshes.size(), -1);
        return parts_.emplace(std::move(key), std::move(read)).first->second;
    }

    /// Adds the bodies of the object that `reference`, which stands in the part `from`, refers to. `outer`: pose of the
    /// object that encloses the reference. `name`: name of the innermost enclosing object that has a name.
    void place(const ModelReference& reference, const std::string& from, const Pose& outer, std::string_view name) {
        const auto fail = [&](const std::string& what) { throw xml_error(package_.place(from), reference.line, what); };
        const std::string& in = reference.part.empty() ? from : reference.part;
        Part& part = this->part(in);
        const auto found = part.model.objects.find(reference.id);
        const std::string named = "object " + std::to_string(reference.id);
        if (found == part.model.objects.end()) fail("there is no " + named + " in " + in_quotes(in));
        const ModelObject& object = found->second;
        if (std::find(path_.begin(), path_.end(), &object) != path_.end()) fail(named + " is a component of itself");
        if (path_.size() == deepest) fail("components are nested more than " + std::to_string(deepest) + " deep");
        if (++references_ > std::max(always_named, package_.expanded()))
            fail("the build refers to more than 65536 objects, and to more than the file has bytes");
        const Pose pose = product(outer, reference.pose);
        if (!is_finite(pose)) fail(named + " has a transform that is not finite");
        if (!object.name.empty()) name = object.name;
        if (object.mesh) return add_body(part, *object.mesh, pose, name.empty() ? named : std::string(name));
        if (object.components.empty())
            throw xml_error(part.model.place, object.line, named + " holds neither a mesh nor components");
        path_.push_back(&object);
        for (const ModelReference& component : object.components) place(component, in, pose, name);
        path_.pop_back();
    }

    void add_body(Part& part, std::size_t mesh, const Pose& pose, std::string name) {
        std::int32_t& shape = part.shapes[mesh];
        if (shape < 0) {
            shape = static_cast<std::int32_t>(world_.shapes.size());
            world_.shapes.push_back(std::move(part.model.meshes[mesh]));
            if (options_.weld == Weld::yes) weld(world_.shapes.back());
        }
        world_.bodies.push_back({std::move(name), shape, pose});
    }

    void warn() {
        std::int64_t left_out = 0, beams = 0, other_units = 0;
        const Unit unit = part(root_).model.unit;
        world_.unit = unit;
        for (const auto& [key, part] : parts_) {
            left_out += std::count(part.shapes.begin(), part.shapes.end(), -1);
            beams += part.model.beams;
            other_units += part.model.unit != unit;
        }
        if (other_units)
            warnings_.of_file(std::to_string(other_units) + " of its parts have a unit other than that of " +
                              in_quotes(root_) + ", and their coordinates are not converted");
        if (left_out) warnings_.of_file(std::to_string(left_out) + " of its meshes are not in the build");
        if (beams) warnings_.of_file(std::to_string(beams) + " of its meshes have beams, which are skipped");
    }

    Package package_;
    const ReadOptions& options_;
    Warnings& warnings_;
    std::string root_;
    std::map<std::string, Part> parts_;  // references stay valid when parts are added
    std::vector<const ModelObject*> path_;
    std::uint64_t references_ = 0;
    WorldMesh world_;
};

}  // namespace

WorldMesh read_3mf(const Source& source, const ReadOptions& options, Warnings& warnings) {
    return Assembler(source, options, warnings).read();
}

bool is_3mf(const Source& source, const std::string& extension) { return is_zip(source) || extension == ".3mf"; }

}  // namespace crumple::io
