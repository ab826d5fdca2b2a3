// Entry point of all calls: dispatches each by query, type of scene and delivery (find, any, stream, partition,
// launch). Calls on the triangles of meshes are in mesh_calls.cpp, calls on worlds in world_calls.cpp, calls on
// features in feature_calls.cpp.

#include "crumple/detector.h"

#include <concepts>
#include <span>
#include <stop_token>
#include <utility>
#include <variant>

#include "detector/free_step.h"
#include "detector/mesh_calls.h"
#include "detector/posed_on_host.h"
#include "partition/parts_of_scene.h"

namespace crumple {

namespace {

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

}  // namespace

struct Detector::Implementation : MeshCalls {
    using MeshCalls::any, MeshCalls::combine, MeshCalls::find, MeshCalls::launch, MeshCalls::MeshCalls,
        MeshCalls::partition, MeshCalls::stream, MeshCalls::wait;

    /// Returns why this query is not supported for this scene with this backend, as one clause; empty if it is
    /// supported.
    template <class Query>
    const char* refusal(const Scene& scene, const Query& query) const {
        constexpr bool intersections = std::same_as<Query, IntersectionQuery>;
        constexpr bool distances = std::same_as<Query, DistanceQuery>;
        const auto* mesh = std::get_if<MeshView>(&scene.source());
        const auto* two = std::get_if<TwoMeshes>(&scene.source());
        const auto* world = std::get_if<World>(&scene.source());
        const auto on_device = [](const MeshView& of) { return of.memory != MemorySpace::host; };
        const bool some_on_device = (mesh && on_device(*mesh)) || (two && (on_device(two->a) || on_device(two->b)));
        const bool on_cuda = working == Backend::cuda;
        if constexpr (intersections) {
            if (query.containment && !two && !world) return "containment needs bodies: a world or two meshes";
        }
        if (const char* why = refusal_of_membership(query); *why) return why;
        if (distances && mesh) return "distances need bodies: a world or two meshes";
        if (!mesh && !two && !world && OneOf<Query, DistanceQuery, CandidateQuery, FreeStepQuery>)
            return "parts support only intersections, impacts, proximities and overlaps";
        if (some_on_device && !on_cuda) return "meshes in device memory need the cuda backend (Options::backend)";
        if constexpr (intersections)
            if (some_on_device && query.containment) return "containment needs meshes in host memory";
        if (some_on_device && two && !intersections)
            return "two meshes must be in host memory, except for intersections";
        if (world && lies_on_device(*world) && !on_cuda)
            return "poses in device memory need the cuda backend (Options::backend)";
        return "";
    }
    /// True if searches may lose pairs. The reference backend ignores the rule of membership, and cuda has only `ball`.
    bool may_lose_pairs() const { return working == Backend::cpu && options.method.membership != Membership::ball; }
    /// Returns why results of this query would not say that pairs may be missing; empty if they do.
    template <class Query>
    const char* refusal_of_membership(const Query& query) const {
        if (!may_lose_pairs()) return "";
        constexpr const char* reason =
            "this query needs the membership rule ball: its result could not say that pairs may be missing";
        if constexpr (std::same_as<Query, IntersectionQuery>) return query.containment ? reason : "";
        return OneOf<Query, OverlapQuery, FirstImpactQuery, FreeStepQuery> ? reason : "";
    }
    template <class Query>
    void check_neighbours(const Query& query) {
        if constexpr (std::same_as<Query, CandidateQuery>)
            if (query.neighbours && working == Backend::cuda)
                refuse("neighbours must be false with the cuda backend; use the cpu backend (Options::backend)");
    }
    /// Returns work(), which makes a result with statistics. Sets Statistics::complete.
    template <class Work>
    const auto& with_losses(Statistics& statistics, Work work) {
        backend->may_have_lost_pairs();  // discards what a call has left that threw
        const auto& result = work();
        statistics.complete = !backend->may_have_lost_pairs();
        return result;
    }
    template <class Query>
    void require_supported(const Scene& scene, const Query& query) {
        if (const char* why = refusal(scene, query); *why) refuse(why);
    }

    // Queries about a step that consist of impact queries:

    const FirstImpact& find(const Scene& scene, const FirstImpactQuery& query, std::stop_token stop) {
        require_supported(scene, query);
        ImpactQuery impacts_of = query;
        impacts_of.output = Output::first;
        impacts_of.index = false;
        return first_impact = find(scene, impacts_of, std::move(stop)).first;
    }
    const FreeStep& find(const Scene& scene, const FreeStepQuery& query, const std::stop_token& stop) {
        require_supported(scene, query);
        const auto of = [&](const Scene& on_host) -> const FreeStep& {
            find_free_step(
                on_host, query,
                [&](const Scene& moving, const ImpactQuery& impacts) -> const Impacts& {
                    return find(moving, impacts, stop);
                },
                free_step);
            return free_step;
        };
        if (const auto* world = std::get_if<World>(&scene.source())) return of(PosedOnHost(*backend, *world).world());
        const MeshView* mesh = std::get_if<MeshView>(&scene.source());
        HostShape copy;
        return mesh ? of(in_host_memory(*mesh, copy)) : of(scene);
    }

    /// Returns the mesh itself or, if it is in device memory, a view of its copy, which is written to `copy`.
    MeshView in_host_memory(const MeshView& mesh, HostShape& copy) {
        if (mesh.memory == MemorySpace::host) return mesh;
        copy_to_host(mesh, copy);
        MeshView view(copy.shape.vertices, copy.shape.triangles, copy.shape.groups);
        view.end = copy.shape.end;
        view.edges = copy.shape.edges;
        view.points = copy.shape.points;
        return view;
    }

    /// Returns the world as queries of this type read it: without end poses, unless the type reads them.
    template <class Query>
    static World as_read(const World& world) {
        World read = world;
        if (OneOf<Query, ImpactQuery, CandidateQuery>) return read;
        read.end_poses = {};
        read.device_end_poses = {};
        return read;
    }

    /// Returns the query about a single mesh, which is always about the overlap of the mesh with itself.
    static OverlapQuery with_itself(OverlapQuery query) {
        query.self_overlaps = true;
        return query;
    }

    const Overlaps& combine(const Scene& scene, const OverlapQuery& query, std::span<const Overlaps> parts,
                            std::stop_token stop) {
        const auto* mesh = std::get_if<MeshView>(&scene.source());
        const auto* two = std::get_if<TwoMeshes>(&scene.source());
        require_supported(scene, query);
        if (!mesh && !two) refuse("combine() needs the mesh or the two meshes that were cut into parts");
        HostShape copy;
        const MeshView first = mesh ? in_host_memory(*mesh, copy) : two->a;
        return as_world(first, two ? &two->b : nullptr, [&](const World& world) -> const Overlaps& {
            return combine(world, mesh ? with_itself(query) : query, parts, std::move(stop));
        });
    }

    // Dispatch by type of scene:

    template <class Query>
    const typename Query::Result& find(const Scene& scene, const Query& query, std::stop_token stop) {
        using Result = typename Query::Result;
        constexpr bool intersections = std::same_as<Query, IntersectionQuery>;
        require_supported(scene, query);
        check_neighbours(query);
        const auto of_mesh = [&](const MeshView& mesh) -> const Result& {
            if constexpr (intersections)
                return find(mesh, nullptr, query, std::move(stop));
            else if constexpr (FeatureQuery<Query>)
                return find(mesh, query, std::move(stop));
            else if constexpr (std::same_as<Query, OverlapQuery>) {
                HostShape copy;
                return as_world(in_host_memory(mesh, copy), nullptr, [&](const World& world) -> const Result& {
                    return find(world, with_itself(query), std::move(stop));
                });
            } else
                return result_of(query);  // refused
        };
        const auto of_two = [&](const TwoMeshes& meshes) -> const Result& {
            if constexpr (intersections) {
                return find(meshes.a, &meshes.b, query, std::move(stop));
            } else {
                return as_world(meshes.a, &meshes.b, [&](const World& world) -> const Result& {
                    return find(world, query, std::move(stop));
                });
            }
        };
        const auto of_world = [&](const World& world) -> const Result& {
            return find(as_read<Query>(world), query, std::move(stop));
        };
        const auto of_part = [&](const Part* part) -> const Result& {
            if constexpr (intersections) {
                if (query.output != Output::pairs && query.output != Output::contacts)
                    refuse("output must be pairs or contacts for a part");
                const MeshView first = part->mesh.view(), second = part->second ? part->second->view() : MeshView();
                return find_pairs(first, part->second ? &second : nullptr, part, query, std::move(stop));
            } else if constexpr (PartQuery<Query>) {
                return find(*part, query, std::move(stop));
            } else {
                return result_of(query);  // refused
            }
        };
        return with_losses(result_of(query).statistics, [&]() -> const Result& {
            return std::visit(Overloaded{of_mesh, of_two, of_world, of_part}, scene.source());
        });
    }

    template <class Query>
    bool any(const Scene& scene, const Query& query, std::stop_token stop) {
        if (may_lose_pairs())
            refuse("any() needs the membership rule ball: its result could not say that pairs may be missing");
        if constexpr (std::same_as<Query, IntersectionQuery>) {
            if (query.containment) return has_any(scene, query, std::move(stop));
            if (const auto* mesh = std::get_if<MeshView>(&scene.source()))
                return any(*mesh, nullptr, query, std::move(stop));
            if (const auto* two = std::get_if<TwoMeshes>(&scene.source()))
                return any(two->a, &two->b, query, std::move(stop));
            if (std::holds_alternative<const Part*>(scene.source())) return find(scene, query, std::move(stop)).any;
        }
        return has_any(scene, query, std::move(stop));
    }
    /// True if find() finds anything.
    template <class Query>
    bool has_any(const Scene& scene, const Query& query, std::stop_token stop) {
        Query whether = query;
        whether.output = Output::any;
        if constexpr (std::same_as<Query, OverlapQuery>) {
            if (std::holds_alternative<const Part*>(scene.source()))
                refuse("one part does not determine which bodies overlap: use find() for each part, then combine()");
        } else {
            whether.index = false;
        }
        return find(scene, whether, std::move(stop)).any;
    }

    template <class Query>
    Statistics stream(const Scene& scene, const Query& query, Sink<Query> take, std::int64_t block_rows,
                      std::stop_token stop) {
        constexpr bool intersections = std::same_as<Query, IntersectionQuery>;
        const auto of_mesh = [&](const MeshView& mesh) {
            if constexpr (intersections)
                return stream(mesh, nullptr, query, take, block_rows, std::move(stop));
            else if constexpr (std::same_as<Query, OverlapQuery>)
                return as_world(mesh, nullptr, [&](const World& world) {
                    return stream(world, with_itself(query), take, block_rows, std::move(stop));
                });
            else
                return stream(mesh, query, take, block_rows, std::move(stop));
        };
        const auto of_two = [&](const TwoMeshes& meshes) {
            if constexpr (intersections) {
                return stream(meshes.a, &meshes.b, query, take, block_rows, std::move(stop));
            } else {
                return as_world(meshes.a, &meshes.b, [&](const World& world) {
                    return stream(world, query, take, block_rows, std::move(stop));
                });
            }
        };
        const auto of_world = [&](const World& world) {
            return stream(as_read<Query>(world), query, take, block_rows, std::move(stop));
        };
        const auto of_part = [&](const Part*) -> Statistics {
            refuse("parts are not supported in blocks; use find()");
        };
        if (const char* why = refusal_of_membership(query); *why) refuse(why);
        Statistics statistics;
        return with_losses(statistics, [&]() -> const Statistics& {
            return statistics = std::visit(Overloaded{of_mesh, of_two, of_world, of_part}, scene.source());
        });
    }

    template <PartQuery Query>
    std::vector<Part> partition(const Scene& scene, const Query& query, int count, std::stop_token stop) {
        const auto* mesh = std::get_if<MeshView>(&scene.source());
        if constexpr (OneOf<Query, IntersectionQuery, OverlapQuery>) {
            const auto* two = std::get_if<TwoMeshes>(&scene.source());
            if (mesh) return partition(*mesh, nullptr, count, std::move(stop));
            if (two) return partition(two->a, &two->b, count, std::move(stop));
            refuse("only one mesh or two meshes can be cut into parts");
        } else {
            if (!mesh) refuse("only one mesh can be cut into parts for a query about features");
            return partition(*mesh, query, count, std::move(stop));
        }
    }

    Clustering cluster(const Scene& scene, std::stop_token stop) {
        if (const auto* mesh = std::get_if<MeshView>(&scene.source()))
            return MeshCalls::cluster(*mesh, nullptr, std::move(stop));
        if (const auto* two = std::get_if<TwoMeshes>(&scene.source()))
            return MeshCalls::cluster(two->a, &two->b, std::move(stop));
        refuse("only the clusters of one mesh or two meshes can be returned");
    }

    template <class Query>
    LaunchNumber launch(const Scene& scene, const Query& query) {
        check_neighbours(query);
        const auto* mesh = std::get_if<MeshView>(&scene.source());
        if constexpr (std::same_as<Query, IntersectionQuery>) {
            const auto* two = std::get_if<TwoMeshes>(&scene.source());
            const auto* world = std::get_if<World>(&scene.source());
            if (world) return launch(as_read<Query>(*world), query);
            if (mesh) return launch(*mesh, nullptr, query);
            if (two) return launch(two->a, &two->b, query);
            refuse("launches do not support parts; use find()");
        } else {
            if (!mesh) refuse("a launch of a query about features needs one mesh in device memory");
            return launch(*mesh, query);
        }
    }

    template <class Result>
    void swap_result(Result& mine, Result& other) {
        if (meter.limit > 0) other = {};
        swap_out(mine, other);
    }

    FirstImpact first_impact;
    FreeStep free_step;
};

Detector::Detector(const Options& options) : implementation_(std::make_unique<Implementation>(options)) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

template <AnyQuery Query>
const typename Query::Result& Detector::find(const Scene& scene, const Query& query, std::stop_token stop) {
    return implementation_->find(scene, query, std::move(stop));
}
template <AnyQuery Query>
bool Detector::supports(const Scene& scene, const Query& query) const {
    return !*implementation_->refusal(scene, query);
}
template <FlagQuery Query>
bool Detector::any(const Scene& scene, const Query& query, std::stop_token stop) {
    return implementation_->any(scene, query, std::move(stop));
}
template <BlockQuery Query>
Statistics Detector::stream(const Scene& scene, const Query& query,
                            FunctionRef<void(const typename Query::Result& block)> take, std::int64_t block_rows,
                            std::stop_token stop) {
    return implementation_->stream(scene, query, take, block_rows, std::move(stop));
}
template <PartQuery Query>
std::vector<Part> Detector::partition(const Scene& scene, const Query& query, int count, std::stop_token stop) {
    return implementation_->partition(scene, query, count, std::move(stop));
}
Clustering Detector::cluster(const Scene& scene, std::stop_token stop) {
    return implementation_->cluster(scene, std::move(stop));
}

const Overlaps& Detector::combine(const Scene& scene, const OverlapQuery& query, std::span<const Overlaps> parts,
                                  std::stop_token stop) {
    return implementation_->combine(scene, query, parts, std::move(stop));
}
template <LaunchQuery Query>
LaunchTicket<Query> Detector::launch(const Scene& scene, const Query& query) {
    return {*implementation_, implementation_->launch(scene, query)};
}
template <LaunchQuery Query>
const typename Query::DeviceResult& LaunchTicket<Query>::wait(std::stop_token stop) const {
    return detector_->wait(static_cast<const Query*>(nullptr), number_, std::move(stop));
}
template <LaunchQuery Query>
const Intersections& LaunchTicket<Query>::download() const requires std::same_as<Query, IntersectionQuery> {
    return detector_->download(number_);
}

// Deliveries of each query, explicitly instantiated:
#define CRUMPLE_FIND(Query)                                                                                \
    template CRUMPLE_API const Query::Result& Detector::find(const Scene&, const Query&, std::stop_token); \
    template CRUMPLE_API bool Detector::supports(const Scene&, const Query&) const;
#define CRUMPLE_ANY(Query) template CRUMPLE_API bool Detector::any(const Scene&, const Query&, std::stop_token);
#define CRUMPLE_STREAM(Query)                         \
    template CRUMPLE_API Statistics Detector::stream( \
        const Scene&, const Query&, FunctionRef<void(const Query::Result&)>, std::int64_t, std::stop_token);
#define CRUMPLE_PARTITION(Query) \
    template CRUMPLE_API std::vector<Part> Detector::partition(const Scene&, const Query&, int, std::stop_token);
#define CRUMPLE_LAUNCH(Query)                                                              \
    template CRUMPLE_API LaunchTicket<Query> Detector::launch(const Scene&, const Query&); \
    template CRUMPLE_API const Query::DeviceResult& LaunchTicket<Query>::wait(std::stop_token) const;
#define CRUMPLE_FOR_EACH_LISTED(Delivery) Delivery(IntersectionQuery) Delivery(ImpactQuery) Delivery(ProximityQuery)

CRUMPLE_FOR_EACH_LISTED(CRUMPLE_FIND)
CRUMPLE_FIND(CandidateQuery)
CRUMPLE_FIND(DistanceQuery)
CRUMPLE_FIND(OverlapQuery)
CRUMPLE_FIND(FirstImpactQuery)
CRUMPLE_FIND(FreeStepQuery)
CRUMPLE_FOR_EACH_LISTED(CRUMPLE_ANY)
CRUMPLE_ANY(OverlapQuery)
CRUMPLE_FOR_EACH_LISTED(CRUMPLE_STREAM)
CRUMPLE_STREAM(CandidateQuery)
CRUMPLE_STREAM(OverlapQuery)
CRUMPLE_FOR_EACH_LISTED(CRUMPLE_PARTITION)
CRUMPLE_PARTITION(OverlapQuery)
CRUMPLE_FOR_EACH_LISTED(CRUMPLE_LAUNCH)
CRUMPLE_LAUNCH(CandidateQuery)

template CRUMPLE_API const Intersections& LaunchTicket<IntersectionQuery>::download() const;

template <>
void Detector::swap_result(Intersections& other) {
    implementation_->swap_result(implementation_->result, other);
}
template <>
void Detector::swap_result(Impacts& other) {
    implementation_->swap_result(implementation_->impacts, other);
}
template <>
void Detector::swap_result(Proximities& other) {
    implementation_->swap_result(implementation_->nearby, other);
}
template <>
void Detector::swap_result(Candidates& other) {
    implementation_->swap_result(implementation_->candidates, other);
}
template <>
void Detector::swap_result(Distances& other) {
    implementation_->swap_result(implementation_->nearest_search, other);
}
template <>
void Detector::swap_result(Overlaps& other) {
    implementation_->swap_result(implementation_->overlaps, other);
}
void Detector::set_poll(std::function<void()> poll) { implementation_->cancellation.set_poll(std::move(poll)); }
const Options& Detector::options() const { return implementation_->options; }
Backend Detector::backend() const { return implementation_->working; }
std::string_view Detector::fallback() const { return implementation_->fallback; }

}  // namespace crumple
