#pragma once

// Names of enumerators in Python.

#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "arguments.h"
#include "crumple/candidates.h"
#include "crumple/impacts.h"
#include "crumple/io.h"
#include "crumple/options.h"
#include "crumple/overlaps.h"
#include "crumple/proximities.h"
#include "crumple/world.h"

namespace crumple::python {

template <class Enum, std::size_t count>
using Names = std::array<std::pair<std::string_view, Enum>, count>;

inline constexpr Names<Backend, 4> backend_names{{{"automatic", Backend::automatic},
                                                  {"cpu", Backend::cpu},
                                                  {"cuda", Backend::cuda},
                                                  {"reference", Backend::reference}}};
inline constexpr Names<Simd, 6> simd_names{{{"automatic", Simd::automatic},
                                            {"scalar", Simd::scalar},
                                            {"sse4", Simd::sse4},
                                            {"avx2", Simd::avx2},
                                            {"avx512", Simd::avx512},
                                            {"neon", Simd::neon}}};
inline constexpr Names<SweepDirection, 4> sweep_names{
    {{"pca", SweepDirection::pca}, {"x", SweepDirection::x}, {"y", SweepDirection::y}, {"z", SweepDirection::z}}};
inline constexpr Names<Membership, 3> membership_names{
    {{"ball", Membership::ball}, {"equation_5", Membership::equation_5}, {"threshold", Membership::threshold}}};
inline constexpr Names<Neighbours, 2> neighbours_names{
    {{"geometric", Neighbours::geometric}, {"skip", Neighbours::skip}}};
inline constexpr Names<IntersectionKind, 2> intersection_kind_names{
    {{"all", IntersectionKind::all}, {"proper", IntersectionKind::proper}}};
inline constexpr Names<PairScope, 3> scope_names{
    {{"both", PairScope::both}, {"between", PairScope::between}, {"within", PairScope::within}}};
inline constexpr Names<Output, 6> intersection_output_names{{{"any", Output::any},
                                                             {"any_by_world", Output::any_by_world},
                                                             {"body_pairs", Output::body_pairs},
                                                             {"count", Output::count},
                                                             {"pairs", Output::pairs},
                                                             {"contacts", Output::contacts}}};
inline constexpr Names<Output, 4> impact_output_names{
    {{"any", Output::any}, {"any_by_world", Output::any_by_world}, {"first", Output::first}, {"pairs", Output::pairs}}};
inline constexpr Names<Held, 3> held_names{
    {{"worlds", Held::worlds}, {"bodies", Held::bodies}, {"vertices", Held::vertices}}};
inline constexpr Names<Output, 3> proximity_output_names{
    {{"any", Output::any}, {"any_by_world", Output::any_by_world}, {"pairs", Output::pairs}}};
inline constexpr Names<Output, 2> distance_output_names{{{"nearest", Output::nearest}, {"pairs", Output::pairs}}};
inline constexpr Names<Output, 4> overlap_output_names{{{"any", Output::any},
                                                        {"any_by_world", Output::any_by_world},
                                                        {"body_pairs", Output::body_pairs},
                                                        {"pairs", Output::pairs}}};
inline constexpr Names<OpenSurfaces, 3> open_surfaces_names{
    {{"error", OpenSurfaces::error}, {"skip", OpenSurfaces::skip}, {"curves", OpenSurfaces::curves}}};
inline constexpr Names<CandidateKind, 6> candidate_kind_names{{{"vertex_face", CandidateKind::vertex_face},
                                                               {"edge_edge", CandidateKind::edge_edge},
                                                               {"edge_face", CandidateKind::edge_face},
                                                               {"face_face", CandidateKind::face_face},
                                                               {"vertex_edge", CandidateKind::vertex_edge},
                                                               {"vertex_vertex", CandidateKind::vertex_vertex}}};
inline constexpr Names<FeatureKind, 4> feature_kind_names{{{"vertex_face", FeatureKind::vertex_face},
                                                           {"edge_edge", FeatureKind::edge_edge},
                                                           {"vertex_edge", FeatureKind::vertex_edge},
                                                           {"vertex_vertex", FeatureKind::vertex_vertex}}};
/// Returns the name of the array of a kind of pairs: "vertex_faces" for "vertex_face".
inline std::string plural_of_kind(std::string_view kind) {
    return kind == "vertex_vertex" ? "vertex_vertices" : std::string(kind) + 's';
}
inline constexpr Names<io::Precision, 3> precision_names{{{"automatic", io::Precision::automatic},
                                                          {"float32", io::Precision::float32},
                                                          {"float64", io::Precision::float64}}};
inline constexpr Names<io::Triangulation, 2> triangulation_names{
    {{"ears", io::Triangulation::ears}, {"fan", io::Triangulation::fan}}};
inline constexpr Names<io::Weld, 3> weld_names{
    {{"automatic", io::Weld::automatic}, {"yes", io::Weld::yes}, {"no", io::Weld::no}}};

inline constexpr Names<io::Unit, 6> unit_names{{{"um", io::Unit::micrometre},
                                                {"mm", io::Unit::millimetre},
                                                {"cm", io::Unit::centimetre},
                                                {"in", io::Unit::inch},
                                                {"ft", io::Unit::foot},
                                                {"m", io::Unit::metre}}};

template <class Enum, std::size_t count>
std::string_view name_of(const Names<Enum, count>& names, Enum value) {
    for (const auto& [name, enumerator] : names)
        if (enumerator == value) return name;
    return {};
}

/// Returns the enumerator with the name `value`. If there is none, throws an Error that lists the possible values of
/// `argument`.
template <class Enum, std::size_t count>
Enum named(const Names<Enum, count>& names, std::string_view argument, nanobind::handle value) {
    const bool is_text = PyUnicode_Check(value.ptr());
    const std::string_view name = is_text ? text(argument, value) : std::string_view();
    std::string known;
    for (const auto& [accepted_name, enumerator] : names) {
        if (is_text && accepted_name == name) return enumerator;
        known.append(known.empty() ? "one of \"" : ", \"").append(accepted_name).append("\"");
    }
    if (!is_text) refuse_type(argument, known, value);
    refuse(std::string(argument) + " must be " + known + ", not \"" + std::string(name) + "\"");
}

}  // namespace crumple::python
