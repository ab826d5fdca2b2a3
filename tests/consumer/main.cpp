// Uses the installed library: two crossing triangles and one far away give one pair. Errors of both libraries arrive as
// crumple::Error.

#include <array>
#include <cstdio>
#include <string_view>
#include <vector>

#include "crumple/crumple.h"
#include "crumple/io.h"

namespace {

template <class Call>
bool fails_with(crumple::ErrorCode code, Call call) {
    try {
        call();
    } catch (const crumple::Error& error) {
        return error.code == code;
    }
    return false;
}

}  // namespace

int main() {
    const std::vector<std::array<float, 3>> vertices{{0, 0, 0},        {1, 0, 0},       {0, 1, 0},
                                                     {0.2f, 0.2f, -1}, {0.2f, 0.2f, 1}, {2, 2, 0},
                                                     {9, 9, 9},        {9, 9, 10},      {9, 10, 9}};
    const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}};
    crumple::Detector detector;
    const crumple::Intersections& collisions = detector.find({vertices, triangles});
    for (const crumple::Pair& pair : collisions.pairs) std::printf("%d %d\n", pair.a, pair.b);
    const bool found = collisions.pairs.size() == 1 && collisions.pairs[0] == crumple::Pair{0, 1};

    const std::vector<std::array<std::int32_t, 3>> wrong{{0, 1, 9}};
    const bool refused = fails_with(crumple::ErrorCode::index_out_of_range, [&] { detector.find({vertices, wrong}); });
    const bool missing = fails_with(crumple::ErrorCode::file, [] { crumple::io::read_mesh("no such file.ply"); });
    const bool same_version = std::string_view(CRUMPLE_VERSION).starts_with(CRUMPLE_PACKAGE_VERSION);
    if (!refused || !missing) std::puts("an error did not come through as a crumple::Error");
    if (!same_version) std::puts("the headers have another version than the package");
    return found && refused && missing && same_version ? 0 : 1;
}
