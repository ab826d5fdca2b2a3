#include "world.h"

#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include "arguments.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

constexpr std::int64_t most_bodies = std::numeric_limits<std::int32_t>::max();

template <class Number>
using Column = nb::ndarray<const Number, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

template <class T>
T& instance(nb::handle given, const char* argument, const char* type) {
    if (!nb::isinstance<T>(given)) refuse_type(argument, type, given);
    if (!nb::inst_ready(given)) refuse(std::string(type) + ".__init__ has not been called");
    return *nb::inst_ptr<T>(given);
}

// Constructs a T in a Python object, unless there is one. No Python code and no other thread runs between the check and
// the construction, so __init__ cannot construct twice.
template <class T, class... Arguments>
void construct(nb::handle self, const char* type, Arguments&&... arguments) {
    if (nb::inst_ready(self)) refuse(std::string(type) + ".__init__ has been called already");
    new (nb::inst_ptr<T>(self)) T{std::forward<Arguments>(arguments)...};
    nb::inst_mark_ready(self);
}

// Checks the shape of poses and returns a view for the world to keep. Each search borrows the array again, on its own
// stream.
BorrowedPoses borrow_shape_only(nb::handle poses, const Bodies& bodies,
                                BorrowedPoses::When when = BorrowedPoses::When::start) {
    return {poses, bodies, when, no_stream()};
}

void make_shape(nb::handle self, const nb::tuple& mesh, const char* which, std::uint64_t name, nb::handle end,
                const nb::tuple& lists, nb::handle radii, nb::handle rest) {
    if (!nb::isinstance<BorrowedShape>(self)) refuse_type("self", "a crumple.Shape", self);
    construct<BorrowedShape>(self, "crumple.Shape", mesh, which, name, end, lists, radii, rest);
}

void make_world(nb::handle self, const nb::list& shapes, const Column<std::int32_t>& shape_of,
                const Column<std::int32_t>& groups, const Column<std::int32_t>& worlds,
                const Column<bool>& has_self_pairs, nb::handle poses, nb::handle end_poses) {
    if (!nb::isinstance<BorrowedWorld>(self)) refuse_type("self", "a crumple.World", self);
    const auto made = std::make_shared<Bodies>();
    made->shapes.reserve(shapes.size());
    for (const nb::handle shape : shapes) {
        made->shapes.push_back(instance<BorrowedShape>(shape, "shape", "crumple.Shape").shape);
        made->kept.push_back(nb::borrow(shape));
    }
    const std::size_t n = shape_of.size();
    if (groups.size() != n || worlds.size() != n || has_self_pairs.size() != n)
        throw std::logic_error("crumple/_world_arrays.py gave columns of different lengths");
    made->moving = static_cast<std::int64_t>(n);
    made->bodies.reserve(n);
    for (std::size_t b = 0; b < n; ++b) made->bodies.push_back({shape_of(b), groups(b), worlds(b), has_self_pairs(b)});
    BorrowedPoses given = borrow_shape_only(poses, *made),
                  at_end = borrow_shape_only(end_poses, *made, BorrowedPoses::When::end);
    construct<BorrowedWorld>(self, "crumple.World", made, std::move(given), std::move(at_end));
}

// Makes a world of configurations: the bodies of `of` that are in world 0 (the first ones), once per configuration, and
// then the other bodies of `of`, which are static and in all worlds.
void make_configurations(nb::handle self, nb::handle of, std::int64_t count, nb::handle poses, nb::handle end_poses) {
    if (!nb::isinstance<BorrowedWorld>(self)) refuse_type("self", "a crumple.World", self);
    const BorrowedWorld& world = given_world(of);
    const Bodies& base = *world.bodies;
    const auto made = std::make_shared<Bodies>();
    made->kept = base.kept;
    made->shapes = base.shapes;
    made->configurations = count;
    const auto total = static_cast<std::int64_t>(base.bodies.size());
    while (made->moving < total && base.bodies[static_cast<std::size_t>(made->moving)].world == 0) ++made->moving;
    const std::int64_t rest = total - made->moving;
    if (made->moving > 0 && count > (most_bodies - rest) / made->moving)
        refuse("configurations must have at most 2147483647 bodies together");
    made->bodies.reserve(static_cast<std::size_t>(made->posed() + rest));
    const auto at_rest = base.bodies.begin() + made->moving;
    for (std::int64_t c = 0; c < count; ++c)
        for (auto body = base.bodies.begin(); body != at_rest; ++body) {
            made->bodies.push_back(*body);
            made->bodies.back().world = static_cast<std::int32_t>(c);
        }
    made->bodies.insert(made->bodies.end(), at_rest, base.bodies.end());
    std::vector<Pose> buffer;
    const std::span<const Pose> known = world.poses.read(base, buffer);
    if (known.empty())
        made->static_poses.resize(static_cast<std::size_t>(rest));
    else
        made->static_poses.assign(known.begin() + made->moving, known.end());
    BorrowedPoses given = borrow_shape_only(poses, *made),
                  at_end = borrow_shape_only(end_poses, *made, BorrowedPoses::When::end);
    construct<BorrowedWorld>(self, "crumple.World", made, std::move(given), std::move(at_end));
}

// Makes a world of the bodies of `of` under other poses.
void make_posed(nb::handle self, nb::handle of, nb::handle poses, nb::handle end_poses) {
    if (!nb::isinstance<BorrowedWorld>(self)) refuse_type("self", "a crumple.World", self);
    const std::shared_ptr<const Bodies> bodies = given_world(of).bodies;
    BorrowedPoses given = borrow_shape_only(poses, *bodies),
                  at_end = borrow_shape_only(end_poses, *bodies, BorrowedPoses::When::end);
    construct<BorrowedWorld>(self, "crumple.World", bodies, std::move(given), std::move(at_end));
}

double number(const std::byte* at, BorrowedArray::Number type) {
    if (type == BorrowedArray::Number::float64) {
        double value;
        std::memcpy(&value, at, sizeof value);
        return value;
    }
    float value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

[[noreturn]] void refuse_last_row(std::int64_t body, BorrowedPoses::When when, const double (&row)[4]) {
    std::string numbers;
    for (const double value : row)
        numbers += (numbers.empty() ? "" : " ") + std::string(nb::repr(nb::float_(value)).c_str());
    throw Error(ErrorCode::invalid_argument,
                "body " + std::to_string(body) + ": the last row of its " +
                    (when == BorrowedPoses::When::end ? "end pose" : "pose") + " must be 0 0 0 1, not " + numbers,
                Element::body, body);
}

}  // namespace

BorrowedShape::BorrowedShape(const nb::tuple& given, const char* which, std::uint64_t name, nb::handle at_end,
                             const nb::tuple& listed, nb::handle given_radii, nb::handle at_rest)
    : mesh(given, which), lists(listed, BorrowedArray::on_host, which), shape(mesh.view(), name) {
    lists.put_into(shape);
    if (mesh.device() != BorrowedArray::on_host)
        refuse(std::string(which) +
               "vertices lie in CUDA memory, but those of a world must be in host memory: " + copy_to_host);
    if (!at_end.is_none()) shape.end = end.emplace(at_end, mesh, which).view();
    if (!at_rest.is_none()) shape.rest = rest.emplace(at_rest, mesh, which, BorrowedEnd::When::rest).view();
    if (!given_radii.is_none()) shape.radii = radii.emplace(given_radii, mesh, which).view();
}

BorrowedWorld& given_world(nb::handle world) { return instance<BorrowedWorld>(world, "world", "crumple.World"); }

BorrowedPoses::BorrowedPoses(nb::handle poses, const Bodies& bodies, When when, void* stream)
    : when_(when), stream_(stream) {
    if (poses.is_none()) return;
    object_ = nb::borrow(poses);
    const char* const which = when == When::end ? "end_" : "";
    array_ = borrow_poses(poses, which, stream, kept_);
    const int front = array_.dimensions - 2;
    std::int64_t given = 1;
    for (int i = 0; i < front; ++i) given *= array_.shape[static_cast<std::size_t>(i)];
    const bool one_a_body = front == 1 && given == bodies.posed();
    const bool by_configuration =
        front == 2 && array_.shape[0] == bodies.configurations && array_.shape[1] == bodies.moving;
    if (one_a_body || by_configuration) return;
    const std::string n = std::to_string(bodies.moving), k = std::to_string(bodies.configurations);
    std::string shape;
    for (int i = 0; i < array_.dimensions; ++i)
        shape += (i ? ", " : "(") + std::to_string(array_.shape[static_cast<std::size_t>(i)]);
    const bool configured = bodies.configurations != 1 || bodies.static_count() > 0;
    refuse(std::string(which) + "poses must have shape (" + (configured ? k + ", " + n : n) + ", 3, 4) or (" +
           (configured ? k + ", " + n : n) + ", 4, 4), one for each body, not " + shape + ")");
}

std::span<const Pose> BorrowedPoses::read(const Bodies& bodies, std::vector<Pose>& buffer) const {
    buffer.clear();
    if (device() != BorrowedArray::on_host)
        refuse(std::string(when_ == When::end ? "end_" : "") +
               "poses lie in CUDA memory, which only a detector of the cuda backend can read: " + copy_to_host);
    if (!object_ && bodies.static_count() == 0) return {};
    if (!object_) {
        buffer.resize(static_cast<std::size_t>(bodies.posed()));
    } else {
        const bool as_they_lie = array_.number == BorrowedArray::Number::float64 && is_contiguous(array_) &&
                                 array_.shape[static_cast<std::size_t>(array_.dimensions) - 2] == 3 &&
                                 reinterpret_cast<std::uintptr_t>(array_.data) % alignof(Pose) == 0;
        if (as_they_lie && bodies.static_count() == 0)
            return {static_cast<const Pose*>(array_.data), static_cast<std::size_t>(bodies.posed())};
        if (as_they_lie) {
            const auto* poses = static_cast<const Pose*>(array_.data);
            buffer.reserve(bodies.bodies.size());
            buffer.assign(poses, poses + bodies.posed());
        } else {
            copy(bodies.posed(), buffer);
        }
    }
    buffer.insert(buffer.end(), bodies.static_poses.begin(), bodies.static_poses.end());
    return buffer;
}

DevicePoses BorrowedPoses::on_device(const Bodies& bodies) const {
    if (bodies.static_count() > 0)
        refuse(std::string("poses of configurations can be in CUDA memory only if no body is in all worlds (-1): ") +
               copy_to_host);
    return array_.number == BorrowedArray::Number::float32
               ? DevicePoses(static_cast<const float*>(array_.data), bodies.posed(), stream_)
               : DevicePoses(static_cast<const double*>(array_.data), bodies.posed(), stream_);
}

void BorrowedPoses::copy(std::int64_t count, std::vector<Pose>& buffer) const {
    const auto rows = static_cast<std::size_t>(array_.dimensions) - 2, columns = rows + 1;
    const bool by_configuration = rows == 2;
    const std::int64_t n = by_configuration ? array_.shape[1] : count;
    buffer.resize(static_cast<std::size_t>(count));
    for (std::int64_t i = 0; i < count; ++i) {
        const std::byte* const matrix =
            static_cast<const std::byte*>(array_.data) +
            (by_configuration ? i / n * array_.strides[0] + i % n * array_.strides[1] : i * array_.strides[0]);
        const auto at = [&](std::int64_t row, std::int64_t column) {
            return number(matrix + row * array_.strides[rows] + column * array_.strides[columns], array_.number);
        };
        auto& pose = buffer[static_cast<std::size_t>(i)].rows;
        for (std::size_t k = 0; k < pose.size(); ++k)
            pose[k] = at(static_cast<std::int64_t>(k / 4), static_cast<std::int64_t>(k % 4));
        if (array_.shape[rows] == 3) continue;
        const double last[4]{at(3, 0), at(3, 1), at(3, 2), at(3, 3)};
        if (last[0] != 0 || last[1] != 0 || last[2] != 0 || last[3] != 1) refuse_last_row(i, when_, last);
    }
}

std::vector<BodyPair> excluded_bodies(const Bodies& bodies, nb::handle pairs) {
    std::vector<BodyPair> result;
    if (pairs.is_none()) return result;
    nb::ndarray<const std::int32_t, nb::shape<-1, 2>, nb::c_contig, nb::device::cpu> given;
    if (!nb::try_cast(pairs, given)) throw std::logic_error("crumple/_world_arrays.py gave no pairs of bodies");
    for (std::size_t i = 0; i < given.shape(0); ++i)
        for (const std::int32_t b : {given(i, 0), given(i, 1)})
            if (b < 0 || b >= bodies.distinct())
                throw Error(ErrorCode::index_out_of_range,
                            "excluded names body " + std::to_string(b) + " of " + std::to_string(bodies.distinct()),
                            Element::body, b);
    // A pair of two static bodies is listed once, no matter how many configurations there are.
    const auto repeats = [&](std::size_t i) {
        return given(i, 0) < bodies.moving || given(i, 1) < bodies.moving ? bodies.configurations : 1;
    };
    std::int64_t count = 0;
    for (std::size_t i = 0; i < given.shape(0); ++i) count += repeats(i);
    result.reserve(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < given.shape(0); ++i)
        for (std::int64_t c = 0; c < repeats(i); ++c) {
            const auto id = [&](std::int64_t b) {
                return static_cast<std::int32_t>(b < bodies.moving ? c * bodies.moving + b
                                                                   : b - bodies.moving + bodies.posed());
            };
            result.push_back({id(given(i, 0)), id(given(i, 1))});
        }
    return result;
}

using When = BorrowedPoses::When;

// Replaces the poses of a world. Releases the old poses last, because that may run Python code.
void place(nb::handle self, BorrowedPoses BorrowedWorld::*member, nb::handle poses, When when) {
    BorrowedWorld& world = given_world(self);
    BorrowedPoses given = borrow_shape_only(poses, *world.bodies, when);
    std::swap(world.*member, given);
}

void bind_world(nb::module_& module) {
    nb::class_<BorrowedShape>(module, "Shape", "Triangles that bodies are made of; base class of crumple.Shape.")
        .def("__init__", make_shape, "mesh"_a, "which"_a, "name"_a, "end"_a.none(), "lists"_a, "radii"_a.none(),
             "rest"_a.none())
        .def_prop_ro(
            "triangles",
            [](nb::handle self) { return instance<BorrowedShape>(self, "self", "crumple.Shape").shape.triangles.rows; },
            "Number of triangles.");
    nb::class_<BorrowedWorld>(module, "World", "Bodies and their poses; base class of crumple.World.")
        .def("__init__", make_world, "shapes"_a, "bodies"_a, "groups"_a, "worlds"_a, "self_collisions"_a,
             "poses"_a.none(), "end_poses"_a.none())
        .def("_configure", make_configurations, "of"_a, "count"_a, "poses"_a.none(), "end_poses"_a.none())
        .def("_pose", make_posed, "of"_a, "poses"_a.none(), "end_poses"_a.none())
        .def_prop_ro("_static_poses",
                     [](nb::handle self) {
                         import_numpy();
                         const std::vector<Pose>& poses = given_world(self).bodies->static_poses;
                         return nb::ndarray<nb::numpy, const double>(poses.data(), {poses.size(), 3, 4}, self);
                     })
        .def("__len__", [](nb::handle self) { return given_world(self).bodies->bodies.size(); })
        .def_prop_ro("_moving", [](nb::handle self) { return given_world(self).bodies->moving; })
        .def_prop_ro("_count", [](nb::handle self) { return given_world(self).bodies->configurations; })
        .def_prop_rw(
            "poses", [](nb::handle self) { return given_world(self).poses.object(); },
            [](nb::handle self, nb::handle poses) { place(self, &BorrowedWorld::poses, poses, When::start); },
            nb::for_setter("poses"_a.none()),
            "Array of poses, as given; None: identity for all.\n\n"
            "For configurations, (k, m, 3, 4) or (k, m, 4, 4). Can be set at any time, as in World: one pose per body. "
            "A\n"
            "search in progress keeps the poses that it started with.")
        .def_prop_rw(
            "end_poses", [](nb::handle self) { return given_world(self).end_poses.object(); },
            [](nb::handle self, nb::handle poses) { place(self, &BorrowedWorld::end_poses, poses, When::end); },
            nb::for_setter("poses"_a.none()),
            "Array of poses at the end of a step, as given; None: the same as `poses`. Can be set like `poses`.");
}

}  // namespace crumple::python
