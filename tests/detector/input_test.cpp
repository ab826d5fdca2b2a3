// Tests of input checks: every layout that the contract accepts is read in place; everything else is an error that
// names the place and leaves the detector usable.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "error_of.h"
#include "soups.h"

namespace crumple {
namespace {

using test::error_of;
using test::pairs_of;

const std::vector<std::array<float, 3>> vertices{{0, 0, 0},        {1, 0, 0},       {0, 1, 0},
                                                 {0.2f, 0.2f, -1}, {0.2f, 0.2f, 1}, {2, 2, 0}};
const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}};
const std::vector<Pair> expected{{0, 1}};

TEST(Input, int32_uint32_and_int64_triangle_indices_are_accepted) {
    Detector detector;
    EXPECT_EQ(pairs_of(detector.find({vertices, triangles})), expected);
    const std::vector<std::array<std::uint32_t, 3>> unsigned_triangles{{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(pairs_of(detector.find({vertices, unsigned_triangles})), expected);
    const std::vector<std::array<std::int64_t, 3>> long_triangles{{0, 1, 2}, {3, 4, 5}};
    EXPECT_EQ(pairs_of(detector.find({vertices, long_triangles})), expected);
}

TEST(Input, column_major_interleaved_and_unaligned_arrays_are_read) {
    Detector detector;
    std::vector<double> columns(18);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) columns[6 * axis + i] = vertices[i][axis];
    const VertexView by_column{columns.data(), 6, sizeof(double), 6 * sizeof(double), ScalarType::float64};
    EXPECT_EQ(pairs_of(detector.find({by_column, rows_of_three(triangles[0].data(), 2)})), expected);

    std::vector<float> interleaved(6 * 8, 99.0f);  // position, then five other numbers
    for (std::size_t i = 0; i < 6; ++i) std::copy(vertices[i].begin(), vertices[i].end(), interleaved.data() + 8 * i);
    const VertexView rows{interleaved.data(), 6, 8 * sizeof(float), sizeof(float), ScalarType::float32};
    EXPECT_EQ(pairs_of(detector.find({rows, rows_of_three(triangles[0].data(), 2)})), expected);

    std::vector<char> bytes(1 + sizeof(float) * 18 + sizeof(std::int32_t) * 6);
    std::memcpy(bytes.data() + 1, vertices.data(), sizeof(float) * 18);
    std::memcpy(bytes.data() + 1 + sizeof(float) * 18, triangles.data(), sizeof(std::int32_t) * 6);
    const VertexView odd{bytes.data() + 1, 6, 12, 4, ScalarType::float32};
    const TriangleView odd_triangles{bytes.data() + 1 + sizeof(float) * 18, 2, 12, 4, IndexType::int32};
    EXPECT_EQ(pairs_of(detector.find({odd, odd_triangles})), expected);
}

TEST(Input, views_without_strides_are_refused) {
    Detector detector;
    const VertexView points{.data = vertices.data(), .rows = 6, .type = ScalarType::float32};
    const TriangleView corners{.data = triangles.data(), .rows = 2};
    const VertexView strided = MeshView(vertices, triangles).vertices;
    const TriangleView strided_corners = MeshView(vertices, triangles).triangles;
    const auto refused = [&](const Scene& scene) {
        return std::string(error_of([&] { detector.find(scene); }).what());
    };
    EXPECT_EQ(refused({points, strided_corners}),
              "the mesh has vertices that have no strides; set row_stride and column_stride");
    EXPECT_EQ(refused({strided, corners}),
              "the mesh has triangles that have no strides; set row_stride and column_stride");
    const auto refused_end = [&](const VertexView& end) {
        return std::string(
            error_of([&] { detector.find(MeshView(vertices, triangles).moving_to(end), ImpactQuery()); }).what());
    };
    EXPECT_EQ(refused_end(points),
              "shape 0: the vertices at the end have no strides; set row_stride and column_stride");
}

TEST(Input, empty_soups_have_no_collisions) {
    Detector detector;
    EXPECT_TRUE(detector.find(MeshView()).pairs.empty());
    EXPECT_EQ(detector.find(MeshView()).offsets.size(), 1u);
    EXPECT_TRUE(detector.find({{vertices, triangles}, MeshView()}).pairs.empty());
    EXPECT_TRUE(detector.find({MeshView(), {vertices, triangles}}).pairs.empty());
    EXPECT_FALSE(detector.any(MeshView()));
}

TEST(Input, vertex_that_is_not_finite_is_reported_even_if_unused) {
    Detector detector;
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
        for (std::size_t v : {0u, 3u, 5u, 6u}) {
            auto broken = vertices;
            broken.push_back({0, 0, 0});
            broken[v][v % 3] = bad;
            const Error error = error_of([&] { detector.find({broken, triangles}); });
            EXPECT_EQ(error.code, ErrorCode::not_finite);
            EXPECT_EQ(error.element, Element::vertex);
            EXPECT_EQ(error.index, static_cast<std::int64_t>(v));
            EXPECT_EQ(std::string(error.what()), "vertex " + std::to_string(v) + " is not finite");
        }
    }
    EXPECT_EQ(pairs_of(detector.find({vertices, triangles})), expected) << "still usable";
}

// Tries each row at the start and around row 8,192: the checks read sixteen rows at once, and chunks of rows on several
// threads.
template <class Scalar>
void expect_bad_values_named_anywhere() {
    Detector detector;
    std::vector<std::array<Scalar, 3>> points(8192 + 37);
    for (std::size_t v = 0; v < points.size(); ++v) points[v] = {static_cast<Scalar>(v), 1, -static_cast<Scalar>(v)};
    for (std::size_t v = 0; v < points.size(); v = v < 40 || v > 8180 ? v + 1 : 8181) {
        auto broken = points;
        broken[v][v % 3] = v % 2 ? std::numeric_limits<Scalar>::quiet_NaN() : std::numeric_limits<Scalar>::infinity();
        const std::vector<std::array<std::int32_t, 3>> triangle{{0, 1, 2}};
        const Error error = error_of([&] { detector.find({broken, triangle}); });
        EXPECT_EQ(std::string(error.what()), "vertex " + std::to_string(v) + " is not finite");
    }
}

TEST(Input, error_names_the_row_of_a_coordinate_that_is_not_finite) {
    expect_bad_values_named_anywhere<float>();
    expect_bad_values_named_anywhere<double>();
}

template <class Index>
void expect_bad_indices_named_anywhere(Index bad) {
    Detector detector;
    const std::vector<std::array<Index, 3>> faces(8192 + 37, {0, 1, 2});
    for (std::size_t t = 0; t < faces.size(); t = t < 20 || t > 8180 ? t + 1 : 8181) {
        auto broken = faces;
        broken[t][t % 3] = bad;
        const Error error = error_of([&] { detector.find({vertices, broken}); });
        EXPECT_EQ(std::string(error.what()),
                  "triangle " + std::to_string(t) + " names vertex " + std::to_string(bad) + " of 6");
    }
}

TEST(Input, error_names_the_row_and_value_of_an_index_out_of_range) {
    expect_bad_indices_named_anywhere<std::int32_t>(6);
    expect_bad_indices_named_anywhere<std::int32_t>(-1);
    expect_bad_indices_named_anywhere<std::uint32_t>(6);
    expect_bad_indices_named_anywhere<std::uint32_t>(0xffffffffu);
    expect_bad_indices_named_anywhere<std::int64_t>(6);
    expect_bad_indices_named_anywhere<std::int64_t>(std::int64_t{1} << 32);
    expect_bad_indices_named_anywhere<std::int64_t>(std::numeric_limits<std::int64_t>::min());
}

TEST(Input, index_out_of_range_error_has_its_code_and_triangle) {
    Detector detector;
    for (const std::int32_t bad : {-1, 6, 90, std::numeric_limits<std::int32_t>::min()}) {
        auto broken = triangles;
        broken[1][2] = bad;
        const Error error = error_of([&] { detector.find({vertices, broken}); });
        EXPECT_EQ(error.code, ErrorCode::index_out_of_range);
        EXPECT_EQ(error.element, Element::triangle);
        EXPECT_EQ(error.index, 1);
        EXPECT_EQ(std::string(error.what()), "triangle 1 names vertex " + std::to_string(bad) + " of 6");
    }
    const std::vector<std::array<std::int64_t, 3>> far{{0, 1, std::int64_t{1} << 32}};
    EXPECT_EQ(error_of([&] { detector.find({vertices, far}); }).code, ErrorCode::index_out_of_range);
}

TEST(Input, message_names_which_of_two_meshes_is_wrong) {
    Detector detector;
    auto broken = triangles;
    broken[0][0] = 77;
    const Error error = error_of([&] { detector.find({{vertices, triangles}, {vertices, broken}}); });
    EXPECT_EQ(std::string(error.what()), "second mesh: triangle 0 names vertex 77 of 6");
    const Error other = error_of([&] { detector.find({{vertices, broken}, {vertices, triangles}}); });
    EXPECT_EQ(std::string(other.what()), "first mesh: triangle 0 names vertex 77 of 6");
}

TEST(Input, wrong_array_sizes_and_options_are_rejected) {
    Detector detector;
    const std::vector<std::int32_t> one_group{1};
    EXPECT_EQ(error_of([&] { detector.find({vertices, triangles, one_group}); }).code, ErrorCode::invalid_argument);
    MeshView negative({vertices, triangles});
    negative.triangles.rows = -1;
    EXPECT_EQ(error_of([&] { detector.find(negative); }).code, ErrorCode::invalid_argument);
    MeshView null({vertices, triangles});
    null.vertices.data = nullptr;
    EXPECT_EQ(error_of([&] { detector.find(null); }).code, ErrorCode::invalid_argument);
    MeshView device({vertices, triangles});
    device.memory = MemorySpace::cuda;
    EXPECT_EQ(error_of([&] { detector.find(device); }).code, ErrorCode::invalid_argument);
    for (const Options& options :
         {Options{.threads = -1}, Options{.memory_limit = -5}, Options{.clusters = 65}, Options{.leaf_size = 0},
          Options{.fuzzy_c_means = {.fuzziness = 1.0}}, Options{.fuzzy_c_means = {.max_iterations = -1}},
          Options{.fuzzy_c_means = {.stop = -1.0}}})
        EXPECT_EQ(error_of([&] { Detector{options}; }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { detector.partition({vertices, triangles}, {}, 0); }).code, ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] {
                  detector.partition({vertices, triangles}, {}, 262145);
              }).code,
              ErrorCode::invalid_argument);
    EXPECT_EQ(error_of([&] { detector.find(Part{}); }).code, ErrorCode::invalid_argument);
}

TEST(Input, result_is_empty_after_an_error) {
    Detector detector;
    const MeshView mesh(vertices, triangles);
    const std::vector<std::function<void()>> wrong_calls{
        [&] { detector.find(mesh, {.filter = {.groups = PairScope::between}}); },
        [&] { detector.find(Part{}); },
        [&] { detector.launch(mesh); },
        [&] { detector.partition(mesh, {}, 0); },
        [&] {
            detector.find({vertices, std::vector<std::array<std::int32_t, 3>>{{0, 1, 6}}});
        },
    };
    for (const auto& call : wrong_calls) {
        const Intersections& result = detector.find(mesh);
        ASSERT_EQ(pairs_of(result), expected);
        error_of(call);
        EXPECT_TRUE(result.pairs.empty());
        EXPECT_TRUE(result.offsets.empty());
        EXPECT_TRUE(result.hit.empty());
    }
}

TEST(Input, number_of_parts_is_checked_before_the_mesh) {
    Detector detector;
    const std::vector<std::array<std::int32_t, 3>> out_of_range{{0, 1, 6}};
    const MeshView wrong(vertices, out_of_range);
    const Error error = error_of([&] { detector.partition(wrong, {}, 262145); });
    EXPECT_EQ(error.what(), std::string("the number of parts must be 1 to 262144"));
    EXPECT_EQ(error.element, Element::option);
}

TEST(Input, wrong_array_size_error_names_the_mesh) {
    Detector detector;
    const std::vector<std::int32_t> groups{1, 2, 3};
    const MeshView good(vertices, triangles), bad(vertices, triangles, groups);
    const std::string rest = " has 3 group ids for 2 triangles";
    EXPECT_EQ(error_of([&] { detector.find(bad); }).what(), "the mesh" + rest);
    EXPECT_EQ(error_of([&] { detector.find({bad, good}); }).what(), "the first mesh" + rest);
    EXPECT_EQ(error_of([&] { detector.find({good, bad}); }).what(), "the second mesh" + rest);
}

TEST(Input, filter_between_groups_is_rejected_if_meshes_have_triangles_but_no_groups) {
    Detector detector;
    const std::vector<std::int32_t> groups{1, 2};
    const MeshView plain(vertices, triangles), grouped(vertices, triangles, groups), none;
    const IntersectionQuery between{.filter = {.groups = PairScope::between}};
    const auto expect_refused = [&](auto call) {
        const Error error = error_of(call);
        EXPECT_EQ(error.code, ErrorCode::invalid_argument);
        EXPECT_NE(std::string(error.what()).find("needs groups"), std::string::npos) << error.what();
    };
    expect_refused([&] { detector.find(plain, between); });
    expect_refused([&] { detector.any(plain, between); });
    expect_refused([&] { detector.find({plain, plain}, between); });
    expect_refused([&] { detector.any({plain, plain}, between); });
    EXPECT_EQ(pairs_of(detector.find(grouped, between)), expected);
    EXPECT_EQ(detector.find({plain, grouped}, between).pairs.size(), 4u) << "plain is in group 0";
    EXPECT_EQ(detector.find({grouped, plain}, between).pairs.size(), 4u);
    EXPECT_TRUE(detector.find(none, between).pairs.empty()) << "an empty mesh may have had groups";
    EXPECT_TRUE(detector.find({plain, none}, between).pairs.empty());
    EXPECT_EQ(pairs_of(detector.find(plain, {.filter = {.groups = PairScope::within}})), expected) << "all in group 0";
}

TEST(Input, query_may_be_omitted) {
    Detector detector;
    const MeshView mesh(vertices, triangles);
    EXPECT_EQ(pairs_of(detector.find(mesh)), expected);
    EXPECT_EQ(pairs_of(detector.find({vertices, triangles})), expected);
    EXPECT_TRUE(detector.any(mesh));
    EXPECT_EQ(detector.find({mesh, mesh}).pairs.size(), 4u);
    EXPECT_TRUE(detector.any({mesh, mesh}));
    EXPECT_EQ(detector.find(mesh, {.output = Output::contacts}).contacts.kinds.size(), 1u);
    const Part whole = detector.partition(mesh, {}, 1)[0];
    EXPECT_EQ(pairs_of(detector.find(whole, {})), expected);
    EXPECT_EQ(error_of([&] { detector.find(Part{}); }).code, ErrorCode::invalid_argument);
}

/// Stand-in for Eigen's matrices, with the functions that MeshView uses.
template <class T, bool row_major>
struct Matrix {
    std::int64_t count, width;
    std::vector<T> numbers = std::vector<T>(static_cast<std::size_t>(count * width));

    const T* data() const { return numbers.data(); }
    std::int64_t rows() const { return count; }
    std::int64_t cols() const { return width; }
    std::int64_t rowStride() const { return row_major ? width : 1; }
    std::int64_t colStride() const { return row_major ? 1 : count; }
    T& operator()(std::size_t i, std::size_t k) {
        return numbers[row_major ? i * static_cast<std::size_t>(width) + k : k * static_cast<std::size_t>(count) + i];
    }
};

template <bool vertices_by_rows, bool triangles_by_rows>
void expect_matrices_are_read() {
    Matrix<double, vertices_by_rows> v{6, 3};
    Matrix<long long, triangles_by_rows> t{2, 3};
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 6; ++i) v(i, k) = static_cast<double>(vertices[i][k]);
        for (std::size_t i = 0; i < 2; ++i) t(i, k) = triangles[i][k];
    }
    Detector detector;
    EXPECT_EQ(pairs_of(detector.find(MeshView(v, t))), expected);
}

TEST(Input, matrices_of_either_storage_order_are_read) {
    expect_matrices_are_read<true, true>();
    expect_matrices_are_read<true, false>();
    expect_matrices_are_read<false, true>();
    expect_matrices_are_read<false, false>();
    const Matrix<double, false> v{3, 6};
    const Matrix<int, false> t{2, 3};
    const Error error = error_of([&] { MeshView(v, t); });
    EXPECT_EQ(error.code, ErrorCode::invalid_argument);
    EXPECT_STREQ(error.what(), "vertices must have one row each and 3 columns, not 6 columns");
}

TEST(Input, excluded_groups_are_rejected_if_no_mesh_has_groups) {
    const std::vector<GroupPair> excluded{{0, 1}};
    const MeshView mesh(vertices, triangles);
    MeshView grouped = mesh;
    const std::vector<std::int32_t> groups{0, 1};
    grouped.groups = groups;
    Detector detector;
    const IntersectionQuery query{.filter = {.excluded_groups = excluded}};
    EXPECT_STREQ(error_of([&] { detector.find(mesh, query); }).what(),
                 "excluded_groups need groups, and the mesh has none");
    EXPECT_STREQ(error_of([&] {
                     detector.find({mesh, mesh}, query);
                 }).what(),
                 "excluded_groups need groups, and neither mesh has any");
    EXPECT_TRUE(detector.find(grouped, query).pairs.empty());
    EXPECT_FALSE(detector.find({mesh, grouped}, query).pairs.empty()) << "the first is in group 0";
    ProximityQuery near{.radius = 9};
    near.filter.excluded_groups = excluded;
    EXPECT_STREQ(error_of([&] { detector.find(mesh, near); }).what(),
                 "excluded_groups need groups, and the mesh has none");
    EXPECT_NO_THROW(detector.find(grouped, near));
}

}  // namespace
}  // namespace crumple
