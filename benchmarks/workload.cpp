#include "workload.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>

#include "crumple/error.h"

namespace crumple::benchmark {
namespace {

namespace fs = std::filesystem;

struct RealScene {
    const char* name;
    Query query;
    const char *a, *b;
    io::Precision precision;
};

constexpr auto as_in_file = io::Precision::automatic;
constexpr auto float32 = io::Precision::float32;
constexpr std::array known{
    RealScene{"cloth_ball92", Query::self, "scalable-ccd/cloth-ball/frames/cloth_ball92.ply", "", as_in_file},
    RealScene{"balls16_18", Query::self, "scalable-ccd/n-body-simulation/frames/balls16_18.ply", "", as_in_file},
    RealScene{"227", Query::self, "scalable-ccd/cloth-funnel/frames/227.ply", "", as_in_file},
    RealScene{"Generic_Twin_right", Query::self, "meshes/Generic_Twin_right.obj", "", float32},
    RealScene{"ember_016", Query::between, "thingi10k-ember/case016_a_88566.ply", "thingi10k-ember/case016_b_58011.ply",
              as_in_file},
    RealScene{"ember_260", Query::between, "thingi10k-ember/case260_a_908460.ply",
              "thingi10k-ember/case260_b_73416.ply", as_in_file},
    RealScene{"ember_406", Query::between, "thingi10k-ember/case406_a_1063852.ply",
              "thingi10k-ember/case406_b_72214.ply", as_in_file},
    RealScene{"bunny_69k", Query::any, "meshes/bunny_69k.obj", "", as_in_file},
    RealScene{"armadillo_86k", Query::any, "meshes/armadillo_86k.obj", "", as_in_file},
};

bool starts_with(std::string& name, std::string_view prefix) {
    if (!name.starts_with(prefix)) return false;
    name.erase(0, prefix.size());
    return true;
}

/// Returns the triangles whose group is even (if `remainder` is 0) or odd (if it is 1), with all vertices of the mesh.
io::TriangleMesh groups_of(const io::TriangleMesh& mesh, int remainder) {
    io::TriangleMesh part{mesh.vertices, {}, {}};
    for (std::size_t t = 0; t < mesh.groups.size(); ++t) {
        if ((mesh.groups[t] & 1) != remainder) continue;
        for (std::size_t corner = 3 * t; corner < 3 * t + 3; ++corner) part.triangles.push_back(mesh.triangles[corner]);
    }
    return part;
}

/// Returns the path of a mesh file that the user names, or an empty path if the name is not that of a file.
fs::path user_file(const std::string& name) {
    std::error_code missing;
    return fs::is_regular_file(name, missing) ? fs::path(name) : fs::path();
}

/// Reads the mesh or, for `between`, the two meshes that the user names. Returns false if the name is not that of
/// files.
bool read_user_files(const std::string& name, bool between, Workload& workload) {
    const std::size_t comma = between ? name.find(',') : name.npos;
    const fs::path a = user_file(name.substr(0, comma)),
                   b = comma == name.npos ? fs::path() : user_file(name.substr(comma + 1));
    if (a.empty()) return false;
    if (between && b.empty())
        throw Error(ErrorCode::invalid_argument, "between: needs a scene or two files, as in between:a.ply,b.ply");
    workload.a = io::read_mesh(a);
    workload.a.groups.clear();
    if (!between) return true;
    workload.b = io::read_mesh(b);
    workload.b.groups.clear();
    workload.query = Query::between;
    return true;
}

}  // namespace

fs::path data_folder() {
    if (const char* folder = std::getenv("CRUMPLE_DATA")) return folder;
    return fs::path(CRUMPLE_SOURCE_DIR).parent_path() / "shared" / "data";
}

std::pair<std::string, scenes::Parameters> parse(const std::string& name) {
    std::string scene = name;
    const auto number_after = [&](char mark, auto& number) {
        const std::size_t place = scene.find(mark);
        if (place == scene.npos) return false;
        const char *begin = scene.data() + place + 1, *end = scene.data() + scene.size();
        const auto [stop, error] = std::from_chars(begin, end, number);
        if (error != std::errc() || stop != end)
            throw Error(ErrorCode::invalid_argument, "not a number: " + std::string(begin, end) + " in " + name);
        scene.resize(place);
        return true;
    };
    scenes::Parameters parameters;
    const bool framed = number_after('@', parameters.frame);
    number_after(':', parameters.triangles);
    for (const auto& description : scenes::descriptions())
        if (description.name == scene && !framed) parameters.frame = description.frames - 1;
    return {scene, parameters};
}

std::string_view name_of(Query query) {
    constexpr std::array names{"self", "between", "any"};
    return names[static_cast<std::size_t>(query)];
}

Workload load(const std::string& name) {
    Workload workload{name, Query::self, {}, {}};
    std::string scene = name;
    const bool any = starts_with(scene, "any:"), between = !any && starts_with(scene, "between:");
    const auto real = std::find_if(known.begin(), known.end(), [&](const RealScene& r) { return scene == r.name; });
    if (real != known.end()) {
        const io::ReadOptions options{.precision = real->precision};
        workload.query = real->query;
        workload.a = io::read_mesh(data_folder() / real->a, options);
        if (*real->b) workload.b = io::read_mesh(data_folder() / real->b, options);
    } else if (!read_user_files(scene, between, workload)) {
        const auto [procedural, parameters] = parse(scene);
        workload.a = scenes::make(procedural, parameters);
        if (between) {
            workload.query = Query::between;
            workload.b = groups_of(workload.a, 1);
            workload.a = groups_of(workload.a, 0);
        }
        workload.a.groups.clear();
    }
    if (any) workload.query = Query::any;
    return workload;
}

std::vector<std::string> real_scenes() {
    std::vector<std::string> names;
    if (!fs::exists(data_folder())) return names;
    for (const RealScene& scene : known) names.emplace_back(scene.name);
    return names;
}

std::vector<std::string> procedural_scenes() {
    return {"cloth", "needles", "five_decades", "ground", "fans", "bodies", "between:bodies", "any:shells"};
}

std::vector<std::string> every_procedural_scene() {
    std::vector<std::string> names = procedural_scenes();
    for (const char* name :
         {"soup", "knots", "lattice", "shells", "cloth_on_ball", "funnel", "cutting", "model:200000", "model:2000000"})
        names.emplace_back(name);
    return names;
}

std::vector<std::string> quick_scenes() {
    if (real_scenes().empty()) return {"cloth:20000", "needles:20000", "between:bodies:20000", "any:shells"};
    return {"cloth_ball92", "227", "ember_406", "bunny_69k"};
}

void normalise(std::vector<Pair>& pairs, Query query) {
    if (query != Query::between) {
        std::erase_if(pairs, [](const Pair& pair) { return pair.a == pair.b; });
        for (Pair& pair : pairs)
            if (pair.a > pair.b) std::swap(pair.a, pair.b);
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

}  // namespace crumple::benchmark
