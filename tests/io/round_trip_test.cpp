// Checks that coordinates that are written and read again have the same bits: random bit patterns of finite numbers,
// subnormal numbers, and the largest number.

#include <cmath>
#include <limits>
#include <random>

#include "samples.h"

namespace crumple::io::test {
namespace {

template <class Scalar>
TriangleMesh random_mesh(std::uint64_t seed) {
    using Bits = std::conditional_t<sizeof(Scalar) == 4, std::uint32_t, std::uint64_t>;
    using Limits = std::numeric_limits<Scalar>;
    std::mt19937_64 random(seed);
    std::vector<Scalar> xyz = {Scalar(-0.0),         0,
                               Limits::denorm_min(), -Limits::denorm_min(),
                               Limits::min(),        std::nextafter(Limits::min(), Scalar(0)),
                               Limits::max(),        Limits::lowest(),
                               Scalar(0.1)};
    while (xyz.size() < 3000) {
        const auto value = std::bit_cast<Scalar>(static_cast<Bits>(random()));
        if (std::isfinite(value)) xyz.push_back(value);
        if (xyz.size() % 7 == 0) xyz.push_back(std::bit_cast<Scalar>(static_cast<Bits>(random() % 5000)));  // subnormal
    }
    xyz.resize(3000);
    std::vector<std::int32_t> triangles;
    for (int i = 0; i < 6000; ++i) triangles.push_back(static_cast<std::int32_t>(random() % 1000));
    return {std::move(xyz), std::move(triangles), {}};
}

template <class Scalar>
class RoundTrip : public testing::Test {
   protected:
    static constexpr Precision precision = sizeof(Scalar) == 4 ? Precision::float32 : Precision::float64;
    Folder folder;
    TriangleMesh mesh = random_mesh<Scalar>(sizeof(Scalar));
};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(RoundTrip, Scalars);

TYPED_TEST(RoundTrip, ply_obj_and_off_keep_every_bit_if_read_at_the_same_precision) {
    for (const char* const name : {"a.ply", "a.obj", "a.off"}) {
        SCOPED_TRACE(name);
        write_mesh(this->folder / name, this->mesh);
        expect_same(read_mesh(this->folder / name, {.precision = this->precision}), this->mesh);
    }
}

TYPED_TEST(RoundTrip, obj_off_and_3mf_keep_numbers_if_read_as_float64) {
    for (const char* const name : {"a.obj", "a.off", "a.3mf"}) {
        SCOPED_TRACE(name);
        write_mesh(this->folder / name, this->mesh);
        EXPECT_EQ(coordinates(read_mesh(this->folder / name, {.precision = Precision::float64})),
                  coordinates(this->mesh));
    }
}

TYPED_TEST(RoundTrip, ply_keeps_the_precision_of_the_mesh) {
    write_mesh(this->folder / "a.ply", this->mesh);
    expect_same(read_mesh(this->folder / "a.ply"), this->mesh);
}

TYPED_TEST(RoundTrip, ply_keeps_groups) {
    std::mt19937 random(3);
    for (std::int64_t t = 0; t < this->mesh.triangle_count(); ++t) {
        this->mesh.groups.push_back(static_cast<std::int32_t>(random()));
    }
    write_mesh(this->folder / "a.ply", this->mesh);
    expect_same(read_mesh(this->folder / "a.ply", {.group_property = "group"}), this->mesh);
}

TYPED_TEST(RoundTrip, ply_off_obj_and_stl_keep_an_empty_mesh) {
    const TriangleMesh empty{std::vector<TypeParam>{}, {}, {}};
    for (const char* const name : {"a.ply", "a.off", "a.obj", "a.stl"}) {
        SCOPED_TRACE(name);
        write_mesh(this->folder / name, empty);
        expect_same(read_mesh(this->folder / name, {.precision = this->precision}), empty);
    }
}

TEST(RoundTripStl, stl_keeps_every_bit_of_float32) {
    const Folder folder;
    const TriangleMesh mesh = random_mesh<float>(9);
    write_mesh(folder / "a.stl", mesh);
    const TriangleMesh soup = read_mesh(folder / "a.stl", {.weld = Weld::no});
    ASSERT_EQ(soup.triangle_count(), mesh.triangle_count());
    const auto p = coordinates(mesh), q = coordinates(soup);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = p[3 * static_cast<std::size_t>(mesh.triangles[i]) + axis];
            ASSERT_EQ(std::bit_cast<std::uint64_t>(x), std::bit_cast<std::uint64_t>(q[3 * i + axis])) << "corner " << i;
        }
    }
}

TEST(RoundTripStl, coordinates_that_overflow_float32_are_refused) {
    const Folder folder;
    TriangleMesh mesh = sample_mesh();
    std::get<std::vector<double>>(mesh.vertices)[7] = 1e300;
    const Error error = error_of([&] { write_mesh(folder / "a.stl", mesh); });
    EXPECT_EQ(error.element, Element::vertex);
    EXPECT_EQ(error.index, 2);
    EXPECT_TRUE(fs::is_empty(folder.path())) << "no half file stays";
}

}  // namespace
}  // namespace crumple::io::test
