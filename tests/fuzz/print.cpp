#include "fuzz/print.h"

#include <cstdio>

namespace crumple::fuzz {
namespace {

std::string text(double x) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%a", x);
    return buffer;
}
std::string text(std::int64_t i) { return std::to_string(i); }

template <class Rows>
std::string rows(const Rows& values) {
    std::string result = "{";
    for (const auto& row : values)
        result += (result.size() > 1 ? ", {" : "{") + text(row[0]) + ", " + text(row[1]) + ", " + text(row[2]) + "}";
    return result + "}";
}

std::string code_of(const IntersectionQuery& query) {
    constexpr const char* scopes[] = {"both", "between", "within"};
    std::string code = "IntersectionQuery query;\n";
    if (query.neighbours == Neighbours::skip) code += "query.neighbours = Neighbours::skip;\n";
    if (query.kind == IntersectionKind::proper) code += "query.kind = IntersectionKind::proper;\n";
    if (query.weld) code += "query.weld = true;\n";
    if (query.contacts()) code += "query.output = Output::contacts;\n";
    if (query.filter.groups != PairScope::both)
        code +=
            std::string("query.filter.groups = PairScope::") + scopes[static_cast<int>(query.filter.groups)] + ";\n";
    if (query.filter.excluded_groups.empty()) return code;
    code += "query.filter.excluded_groups = {";
    for (const GroupPair& pair : query.filter.excluded_groups)
        code += "{" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + "}, ";
    return code + "};\n";
}

}  // namespace

std::string as_code(const Options& o) {
    constexpr const char* sets[] = {"automatic", "scalar", "sse4", "avx2", "avx512", "neon"};
    return "Options options;\noptions.backend = Backend::cpu;\noptions.threads = " + std::to_string(o.threads) +
           ";\noptions.simd = Simd::" + sets[static_cast<int>(o.simd)] +
           ";\noptions.clusters = " + std::to_string(o.clusters) +
           ";\noptions.leaf_size = " + std::to_string(o.leaf_size) +
           ";\noptions.fuzzy_c_means.fuzziness = " + text(o.fuzzy_c_means.fuzziness) +
           ";\noptions.fuzzy_c_means.max_iterations = " + std::to_string(o.fuzzy_c_means.max_iterations) +
           ";\noptions.fuzzy_c_means.first_iterations = " + std::to_string(o.fuzzy_c_means.first_iterations) +
           ";\noptions.fuzzy_c_means.stop = " + text(o.fuzzy_c_means.stop) +
           ";\noptions.fuzzy_c_means.first_stop = " + text(o.fuzzy_c_means.first_stop) + ";\n";
}

std::string as_code(const Mesh& mesh, const std::string& name) {
    constexpr const char* indices[] = {"std::int32_t", "std::uint32_t", "std::int64_t"};
    std::string code = "// arranged as " + std::to_string(mesh.layout.vertices) + " and " +
                       std::to_string(mesh.layout.triangles) + " of fuzz::Arrays\n";
    code += std::string("const std::vector<std::array<") + (mesh.single ? "float" : "double") + ", 3>> vertices" +
            name + rows(mesh.vertices) + ";\n";
    code += std::string("const std::vector<std::array<") + indices[static_cast<int>(mesh.layout.index)] +
            ", 3>> triangles" + name + rows(mesh.triangles) + ";\n";
    if (mesh.groups.empty()) return code;
    code += "const std::vector<std::int32_t> groups" + name + "{";
    for (const std::int32_t group : mesh.groups) code += std::to_string(group) + ", ";
    return code + "};\n";
}

std::string as_code(const Search& search) {
    std::string code = as_code(search.options) + code_of(search.query);
    if (search.parts > 0) code += "// " + std::to_string(search.parts) + " parts\n";
    if (search.memory_limit >= 0) code += "// memory limit " + std::to_string(search.memory_limit) + "\n";
    for (std::size_t f = 0; f < search.frames.size(); ++f)
        for (std::size_t side = 0; side < search.frames[f].size(); ++side)
            code += as_code(search.frames[f][side], "_" + std::to_string(f) + (side ? "b" : "a"));
    return code;
}

}  // namespace crumple::fuzz
