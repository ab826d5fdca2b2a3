#include "pickling.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include "arguments.h"
#include "arrays.h"
#include "errors.h"
#include "results.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace crumple::python {
namespace {

constexpr std::pair<const char*, std::int64_t Statistics::*> counters[]{
    {"triangles", &Statistics::triangles},
    {"clusters", &Statistics::clusters},
    {"leaves", &Statistics::leaves},
    {"members", &Statistics::members},
    {"interval_tests", &Statistics::interval_tests},
    {"box_overlaps", &Statistics::box_overlaps},
    {"edge_tests", &Statistics::edge_tests},
    {"double_tests", &Statistics::double_tests},
    {"exact_tests", &Statistics::exact_tests},
    {"rational_tests", &Statistics::rational_tests},
    {"rational_contacts", &Statistics::rational_contacts},
    {"pairs", &Statistics::pairs},
    {"peak_memory_bytes", &Statistics::peak_memory_bytes},
};

// Returns a copy of the name that lives as long as the process. Refuses more than 100 different names, so that states
// cannot fill the memory: there are only a few names of backends and instruction sets.
std::string_view static_name(const std::string& name) {
    static std::set<std::string>& names = *new std::set<std::string>;
    if (names.size() >= 100 && !names.contains(name)) refuse("the state of Statistics has an unknown backend or simd");
    return *names.insert(name).first;
}

template <class Type>
Type item(const nb::dict& state, const char* name) {
    Type value{};
    if (!state.contains(name) || !nb::try_cast(state[name], value))
        throw InvalidType(std::string("the state of Statistics needs a valid ") + name);
    return value;
}

template <class Number, int columns>
using Rows = nb::ndarray<const Number, nb::shape<-1, columns>, nb::c_contig, nb::device::cpu>;
template <class Number>
using Column = nb::ndarray<const Number, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

template <class Element, class Given>
void fill(Array<Element>& array, const Given& given) {
    array.resize_discard(given.shape(0));
    if (!array.empty()) std::memcpy(static_cast<void*>(array.data()), given.data(), array.size() * sizeof(Element));
}

void check(bool holds, const char* what) {
    if (!holds) refuse(std::string("the state of Intersections is inconsistent: ") + what);
}

// True if offsets divide `size` elements into `parts` consecutive parts.
bool are_offsets(const Array<std::int64_t>& offsets, std::size_t parts, std::size_t size) {
    return offsets.size() == parts + 1 && offsets.front() == 0 && std::is_sorted(offsets.begin(), offsets.end()) &&
           offsets.back() == static_cast<std::int64_t>(size);
}

void check_contacts(const Intersections& c, bool has_contacts) {
    const Contacts& contacts = c.contacts;
    check(contacts.kinds.size() == (has_contacts ? c.pairs.size() : 0), "contacts");
    if (!has_contacts) return;
    check(are_offsets(contacts.offsets, contacts.kinds.size(), contacts.points.size()), "offsets of contacts");
    for (std::size_t i = 0; i < contacts.kinds.size(); ++i) {
        const std::int64_t points = contacts.offsets[i + 1] - contacts.offsets[i];
        check(points >= 1 && points <= 6 && static_cast<int>(contacts.kinds[i]) == std::min<std::int64_t>(points, 3),
              "kinds of contacts");
    }
    for (const auto& point : contacts.points)
        for (const double coordinate : point) check(std::isfinite(coordinate), "points of contacts");
}

// Throws Error unless the rows are valid for a block of a stream. Blocks have no offsets and no hit flags, and their
// pairs may be in any order.
void check_block(const Intersections& c, bool one_soup) {
    check(c.offsets.empty(), "offsets");
    check(c.hit.empty() && c.hit_second.empty(), "hit");
    for (const Pair& pair : c.pairs) check(pair.a >= 0 && pair.b >= 0 && (!one_soup || pair.a < pair.b), "pairs");
}

// Throws Error unless pairs, offsets and hit flags fit together: all that writers and pictures rely on, except
// contacts.
void check_fit(const Intersections& c, bool one_soup) {
    check(are_offsets(c.offsets, c.hit.size(), c.pairs.size()), "offsets");
    const auto seconds = static_cast<std::int64_t>((one_soup ? c.hit : c.hit_second).size());
    std::vector<std::uint8_t> hit(c.hit.size()), hit_second(static_cast<std::size_t>(seconds));
    for (std::size_t a = 0; a < c.hit.size(); ++a)
        for (std::int64_t i = c.offsets[a]; i < c.offsets[a + 1]; ++i) {
            const Pair pair = c.pairs[i];
            check(pair.a >= 0 && static_cast<std::size_t>(pair.a) == a, "offsets of pairs");
            check(pair.b >= 0 && pair.b < seconds && (!one_soup || pair.a < pair.b), "pairs");
            check(i == 0 || c.pairs[i - 1] < pair, "the order of pairs");
            hit[a] = 1;
            (one_soup ? hit : hit_second)[static_cast<std::size_t>(pair.b)] = 1;
        }
    check(std::equal(hit.begin(), hit.end(), c.hit.begin(), c.hit.end()), "hit");
    if (one_soup) hit_second.clear();
    check(std::equal(hit_second.begin(), hit_second.end(), c.hit_second.begin(), c.hit_second.end()), "hit_second");
}

// For results of parts, whose pairs contain ids of triangles in the whole mesh: replaces each id by its position in
// `ids`, the part's list of ids. No effect without `ids`.
void to_positions(const std::optional<Column<std::int32_t>>& ids, const Array<std::uint8_t>& hit,
                  std::int32_t Pair::*member, Array<Pair>& pairs) {
    if (!ids) return;
    const std::int32_t *begin = ids->data(), *end = begin + ids->size();
    check(ids->size() == hit.size() && std::is_sorted(begin, end, std::less_equal<>()), "ids");
    for (Pair& pair : pairs) {
        const std::int32_t* const place = std::lower_bound(begin, end, pair.*member);
        check(place != end && *place == pair.*member, "pairs and ids");
        pair.*member = static_cast<std::int32_t>(place - begin);
    }
}
void to_ids(const std::optional<Column<std::int32_t>>& ids, std::int32_t Pair::*member, Array<Pair>& pairs) {
    if (!ids) return;
    for (Pair& pair : pairs) pair.*member = ids->data()[pair.*member];
}

void check_mesh(const BorrowedMesh& mesh, const Array<std::uint8_t>& hit) {
    check(mesh.view().triangles.rows == static_cast<std::int64_t>(hit.size()), "the number of faces");
}

Shown<Intersections> restore(const Rows<std::int32_t, 2>& pairs, const Column<std::int64_t>& offsets,
                             const Column<std::uint8_t>& hit, const Column<std::uint8_t>& hit_second,
                             const Column<std::uint8_t>& kinds, const Column<std::int64_t>& contact_offsets,
                             const Rows<double, 3>& points, const Statistics& statistics, const nb::tuple& first,
                             const std::optional<nb::tuple>& second, bool has_contacts, bool is_block,
                             const std::optional<Column<std::int32_t>>& ids,
                             const std::optional<Column<std::int32_t>>& ids_second) {
    const auto storage = std::make_shared<Intersections>();
    fill(storage->pairs, pairs);
    fill(storage->offsets, offsets);
    fill(storage->hit, hit);
    fill(storage->hit_second, hit_second);
    fill(storage->contacts.kinds, kinds);
    fill(storage->contacts.offsets, contact_offsets);
    fill(storage->contacts.points, points);
    storage->statistics = statistics;
    storage->count = static_cast<std::int64_t>(storage->pairs.size());
    storage->any = storage->count > 0;
    check_contacts(*storage, has_contacts);
    if (is_block) {
        check_block(*storage, !second);
        return {storage};
    }
    const auto& ids_of_b = second ? ids_second : ids;
    to_positions(ids, storage->hit, &Pair::a, storage->pairs);
    to_positions(ids_of_b, second ? storage->hit_second : storage->hit, &Pair::b, storage->pairs);
    check_fit(*storage, !second);
    to_ids(ids, &Pair::a, storage->pairs);
    to_ids(ids_of_b, &Pair::b, storage->pairs);
    const BorrowedMeshes meshes(first, second);
    check_mesh(meshes.first, storage->hit);
    if (meshes.second) check_mesh(*meshes.second, storage->hit_second);
    check(storage->statistics.pairs == storage->count, "statistics");
    return {storage};
}

}  // namespace

nb::dict state_of(const Statistics& statistics) {
    nb::dict state;
    for (const auto& [name, counter] : counters) state[name] = statistics.*counter;
    state["milliseconds"] = statistics.milliseconds;
    state["stage_milliseconds"] = statistics.stage_milliseconds;
    state["complete"] = statistics.complete;
    state["threads"] = statistics.threads;
    state["backend"] = statistics.backend;
    state["simd"] = statistics.simd;
    return state;
}

Statistics statistics_of(nb::handle given) {
    nb::dict state;
    if (!nb::try_cast(given, state)) throw InvalidType("the state of Statistics must be a dict");
    Statistics statistics;
    for (const auto& [name, counter] : counters) statistics.*counter = item<std::int64_t>(state, name);
    statistics.milliseconds = item<double>(state, "milliseconds");
    statistics.stage_milliseconds = item<std::array<double, stage_count>>(state, "stage_milliseconds");
    // Pickles of older versions lack it: they had only the membership rule that loses no pair.
    if (state.contains("complete")) statistics.complete = item<bool>(state, "complete");
    statistics.threads = item<int>(state, "threads");
    statistics.backend = static_name(item<std::string>(state, "backend"));
    statistics.simd = static_name(item<std::string>(state, "simd"));
    return statistics;
}

void bind_pickling(nb::module_& module) {
    // Returns False for Statistics objects that were created by __new__ but not restored from a state.
    module.def(
        "is_filled", [](nb::handle statistics) { return nb::inst_ready(statistics); }, "statistics"_a);
    module.def("restore", restore, "pairs"_a, "offsets"_a, "hit"_a, "hit_second"_a, "contact_kinds"_a,
               "contact_offsets"_a, "contact_points"_a, "statistics"_a, "first"_a, "second"_a.none(), "has_contacts"_a,
               "is_block"_a, "ids"_a.none(), "ids_second"_a.none());
}

}  // namespace crumple::python
