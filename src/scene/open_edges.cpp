#include "crumple/open_edges.h"

#include "base/float_environment.h"
#include "scene/closed_surface.h"

namespace crumple {

Array<OpenEdge> open_edges(const MeshView& mesh, bool weld) {
    const FloatEnvironment environment;
    MeshView triangles(mesh.vertices, mesh.triangles);
    triangles.memory = mesh.memory;
    ParallelFor one_thread;
    SceneBuffers buffers;
    ClosedSurface surface(nullptr);
    surface.prepare(prepare_scene(triangles, nullptr, weld, one_thread, buffers), one_thread);
    return surface.open_edges();
}

}  // namespace crumple
