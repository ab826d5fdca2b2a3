#include <cstdio>

#include "fuzz/decode_world.h"
#include "fuzz/print.h"

namespace crumple::fuzz {
namespace {

std::string text(double x) {
    char buffer[64];
    std::snprintf(buffer, sizeof buffer, "%a", x);
    return buffer;
}

}  // namespace

std::string as_code(const Bodies& all) {
    constexpr const char* outputs[] = {"any", "any_by_world", "body_pairs", "count", "first", "pairs", "contacts"};
    constexpr const char* scopes[] = {"both", "between", "within"};
    std::string code = as_code(all.options);
    if (all.memory_limit >= 0) code += "// memory limit " + std::to_string(all.memory_limit) + "\n";
    for (std::size_t s = 0; s < all.shapes.size(); ++s)
        code += as_code(all.shapes[s], "_" + std::to_string(s)) + "// name " + std::to_string(all.names[s]) + "\n";
    code += "const std::vector<Body> bodies{";
    for (const Body& b : all.bodies)
        code += "{" + std::to_string(b.shape) + ", " + std::to_string(b.group) + ", " + std::to_string(b.world) + ", " +
                (b.self ? "true" : "false") + "}, ";
    code += "};\n";
    for (const Call& call : all.calls) {
        code += "poses = {";
        for (const Pose& pose : call.poses) {
            code += "Pose{{";
            for (const double x : pose.rows) code += text(x) + ", ";
            code += "}}, ";
        }
        const IntersectionQuery& q = call.query;
        code += std::string("};\nquestion = {.output = Output::") + outputs[static_cast<int>(q.output)] +
                ", .neighbours = Neighbours::" + (q.neighbours == Neighbours::skip ? "skip" : "geometric") +
                ", .kind = IntersectionKind::" + (q.kind == IntersectionKind::proper ? "proper" : "all") +
                ", .weld = " + (q.weld ? "true" : "false") +
                ", .filter = {.bodies = PairScope::" + scopes[static_cast<int>(q.filter.bodies)] +
                ", .groups = PairScope::" + scopes[static_cast<int>(q.filter.groups)] + ", .excluded_bodies = {";
        for (const BodyPair& pair : q.filter.excluded_bodies)
            code += "{" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + "}, ";
        code += "}, .excluded_groups = {";
        for (const GroupPair& pair : q.filter.excluded_groups)
            code += "{" + std::to_string(pair.first) + ", " + std::to_string(pair.second) + "}, ";
        code += std::string("}}, .index = ") + (q.index ? "true" : "false") + "};\n";
    }
    return code;
}

}  // namespace crumple::fuzz
