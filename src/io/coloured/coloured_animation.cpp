// Animated binary glTF: a node for each frame. A stepwise animation of the nodes' scales shows one node at a time with
// scale 1, and hides all others with scale 0. So frames may differ in everything, including topology, and any viewer
// that plays animations can show them. Viewers that do not play animations show the first frame.

#include <tiny_gltf.h>

#include "base/float_environment.h"
#include "io/bytes/atomic_file.h"
#include "io/meshes/unit.h"
#include "io/scenes/glb.h"

namespace crumple::io {

struct ColouredAnimation::Implementation {
    double frames_per_second;
    tinygltf::Model model = empty_glb();
    std::vector<std::optional<int>> nodes;  // one per frame; a frame without triangles has none
    Unit unit = Unit::unknown;

    /// Adds a channel that shows a frame's node from the beginning to the end of the frame; the last frame stays.
    void add_channel(tinygltf::Model& to, tinygltf::Animation& animation, std::size_t frame) const {
        const auto time = [&](std::size_t i) { return static_cast<float>(static_cast<double>(i) / frames_per_second); };
        std::vector<float> times, scales;
        const auto key = [&](std::size_t i, float scale) {
            times.push_back(time(i));
            scales.insert(scales.end(), 3, scale);
        };
        if (frame > 0) key(0, 0);
        key(frame, 1);
        key(frame + 1, frame + 1 == nodes.size() ? 1.0f : 0.0f);

        tinygltf::AnimationSampler sampler;
        sampler.input = add_floats(to, times, TINYGLTF_TYPE_SCALAR, 0);
        to.accessors.back().minValues = {times.front()};
        to.accessors.back().maxValues = {times.back()};
        sampler.output = add_floats(to, scales, TINYGLTF_TYPE_VEC3, 0);
        sampler.interpolation = "STEP";
        tinygltf::AnimationChannel channel;
        channel.sampler = static_cast<int>(animation.samplers.size());
        channel.target_node = *nodes[frame];
        channel.target_path = "scale";
        animation.samplers.push_back(sampler);
        animation.channels.push_back(channel);
    }

    /// Writes the frames added so far. Does not throw if the stream fails.
    void write(std::ostream& out) {
        // Removes the data of the animation from the model after writing, because more frames may be added later.
        const std::size_t bytes = model.buffers.empty() ? 0 : model.buffers[0].data.size(),
                          views = model.bufferViews.size(), accessors = model.accessors.size();
        tinygltf::Animation animation;
        animation.name = "frames";
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (nodes[i]) add_channel(model, animation, i);
        }
        if (!animation.channels.empty()) model.animations = {animation};
        write_glb(out, model, unit);
        model.animations.clear();
        model.accessors.resize(accessors);
        model.bufferViews.resize(views);
        if (bytes) model.buffers[0].data.resize(bytes);
    }
};

ColouredAnimation::ColouredAnimation(double frames_per_second) : implementation_(std::make_unique<Implementation>()) {
    if (!(frames_per_second > 0 && frames_per_second <= 1e6)) {
        throw Error(ErrorCode::invalid_argument, "frames per second must be above 0 and at most a million");
    }
    implementation_->frames_per_second = frames_per_second;
}

ColouredAnimation::~ColouredAnimation() = default;
ColouredAnimation::ColouredAnimation(ColouredAnimation&&) noexcept = default;
ColouredAnimation& ColouredAnimation::operator=(ColouredAnimation&&) noexcept = default;

void ColouredAnimation::add(const TriangleMesh& mesh, const TriangleMesh* second, const Intersections& collisions) {
    const FloatEnvironment environment;
    const ColouredMesh coloured = coloured_mesh(mesh, second, collisions);
    if (implementation_->nodes.empty()) implementation_->unit = coloured.mesh.unit;
    check_same_unit(implementation_->unit, coloured.mesh.unit);
    const auto node = add_node(implementation_->model, coloured);
    if (node) {
        const std::size_t frame = implementation_->nodes.size();
        tinygltf::Node& added = implementation_->model.nodes[static_cast<std::size_t>(*node)];
        added.name = "frame " + std::to_string(frame);
        if (frame > 0) added.scale = {0, 0, 0};
    }
    implementation_->nodes.push_back(node);
}

void ColouredAnimation::write(const std::filesystem::path& path) {
    if (extension_of(path) != ".glb") {
        throw Error(ErrorCode::invalid_argument, "cannot write " + path.string() + ": animations are written as .glb");
    }
    const FloatEnvironment environment;
    AtomicFile file(path);
    implementation_->write(file.stream());
    file.commit();
}

void ColouredAnimation::write(std::ostream& out) {
    const FloatEnvironment environment;
    implementation_->write(out);
    if (!out.flush()) throw Error(ErrorCode::file, "cannot write an animation to the stream");
}

}  // namespace crumple::io
