#include "cli/command_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>

#include "cli/choice.h"
#include "crumple/error.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/gzip.h"
#include "io/bytes/text.h"
#include "io/formats.h"

namespace crumple::cli {
namespace {

PartOfMany parse_part(const std::string& text) {
    constexpr int most_parts = 262144;
    PartOfMany part{};
    const char* const end = text.data() + text.size();
    const auto k = std::from_chars(text.data(), end, part.index);
    const bool slash = k.ec == std::errc() && k.ptr != end && *k.ptr == '/';
    const auto n = slash ? std::from_chars(k.ptr + 1, end, part.count) : k;
    if (!slash || n.ec != std::errc() || n.ptr != end || part.count < 1 || part.count > most_parts || part.index < 1 ||
        part.index > part.count) {
        throw CLI::ValidationError("--part", text + " is not K/N with 1 <= K <= N <= 262144");
    }
    return part;
}

/// Parses a size such as 2GiB, 500 MB or 1.5g; a number without a unit is in bytes. k, M, G and T stand for powers of
/// 1000; followed by an i, they stand for powers of 1024.
std::int64_t parse_bytes(const std::string& text) {
    double value = 0;
    const char* const end = text.data() + text.size();
    const auto number = std::from_chars(text.data(), end, value, std::chars_format::fixed);
    std::string unit;
    for (const char* c = number.ptr; c != end; ++c) {
        if (*c != ' ') unit += static_cast<char>(std::tolower(static_cast<unsigned char>(*c)));
    }
    if (!unit.empty() && unit.back() == 'b') unit.pop_back();
    const bool binary = unit.size() == 2 && unit.back() == 'i';
    if (binary) unit.pop_back();
    constexpr std::string_view prefixes = "kmgt";
    const std::size_t prefix = unit.size() == 1 ? prefixes.find(unit) : prefixes.npos;
    if (prefix != prefixes.npos) value *= std::pow(binary ? 1024 : 1000, static_cast<double>(prefix + 1));
    const bool known = unit.empty() ? !binary : prefix != prefixes.npos;
    if (number.ec != std::errc() || !known || !(value >= 1 && value < 0x1p63)) {
        throw CLI::ValidationError("--memory-limit", text + " is not a size, such as 2GiB, 500MB or 1000000");
    }
    return static_cast<std::int64_t>(value);
}

Choices<io::Unit> units() {
    Choices<io::Unit> choices;
    for (const io::Unit unit : {io::Unit::micrometre, io::Unit::millimetre, io::Unit::centimetre, io::Unit::inch,
                                io::Unit::foot, io::Unit::metre})
        choices.emplace_back(io::name_of(unit), unit);
    return choices;
}

void fail(const std::string& message) { throw Error(ErrorCode::invalid_argument, message, Element::option); }

}  // namespace

CLI::Validator integer(std::int64_t low, std::int64_t high) {
    return CLI::Validator(
        [low, high](const std::string& text) {
            std::int64_t value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && low <= value && value <= high;
            return fits ? "" : fmt::format("{} is not an integer from {} to {}", text, low, high);
        },
        "");
}

CLI::Option* add_number_option(CLI::App& app, const char* name, const std::function<void(double)>& set,
                               NumberRange range, const char* help) {
    const auto read = [set, range, name](const std::string& text) {
        const auto value = io::number_of(text);
        if (!value || !(*value >= 0 && *value < range.end))
            throw CLI::ValidationError(name, fmt::format("{} is not a {}", text, range.words));
        set(*value);
    };
    return app.add_option_function<std::string>(name, read, help);
}

void add_reading_options(CLI::App& app, ReadingOptions& options) {
    CLI::Option* const weld = app.add_flag_callback(
        "--weld", [&options] { options.weld = true; }, "Weld vertices: those at equal positions count as one");
    app.add_flag_callback(
           "--no-weld", [&options] { options.weld = false; },
           "Keep vertices at equal positions separate; without either option, only STL files and glTF scenes are "
           "welded")
        ->excludes(weld);
    add_choice<io::Precision, io::Precision>(
        app, "--precision", options.precision,
        {{"auto", io::Precision::automatic}, {"float32", io::Precision::float32}, {"float64", io::Precision::float64}},
        "Precision to which coordinates are rounded; auto, the default, loses no bit of the file");
    add_choice<io::Triangulation, io::Triangulation>(
        app, "--triangulation", options.triangulation,
        {{"ears", io::Triangulation::ears}, {"fan", io::Triangulation::fan}},
        "How polygons become triangles: without overlaps, also if concave (ears, the default), or all as fans from "
        "their first corner (fan)");
    add_choice<io::Unit, io::Unit>(app, "--unit", options.unit, units(),
                                   "Unit of the coordinates. Files without a unit, which are all but .3mf and glTF, "
                                   "are assumed to be in this unit; files in another unit are converted to it");
    app.add_flag("--strict", options.strict, "Treat warnings about files as errors");
}

void add_polygons_option(CLI::App& app, QueryOptions& options) {
    app.add_flag("--polygons", options.polygons,
                 "List polygons, which are the faces of the file with any number of corners, instead of triangles. `p "
                 "p` is a polygon that collides with itself");
}

void add_format_option(CLI::App& app, std::string& format, const std::string& words) {
    app.add_option("--format", format, "Format that -o - writes to standard output")->type_name(words);
}

void add_query_options(CLI::App& app, QueryOptions& options) {
    add_choice<Neighbours, Neighbours>(
        app, "--neighbours", options.neighbours, {{"geometric", Neighbours::geometric}, {"skip", Neighbours::skip}},
        "Triangles that share a vertex collide if they meet elsewhere too (geometric, the default), or never (skip)");
    add_choice<IntersectionKind, IntersectionKind>(
        app, "--kind", options.kind, {{"all", IntersectionKind::all}, {"proper", IntersectionKind::proper}},
        "Touching counts (all, the default), or only edges that strictly cross the inside of a triangle (proper). The "
        "latter leaves out triangles that cross only at edges and vertices: two boxes, one shifted along all axes, "
        "have no proper intersection. This option computes neither a depth nor a volume of penetration: crumple "
        "overlap does");
    add_reading_options(app, options);
    add_group_options(app, options);
    app.add_option_function<std::string>(
           "--part", [&options](const std::string& text) { options.part = parse_part(text); },
           "Only part K of N (1/N to N/N) of the result. The parts can be computed independently; together they are "
           "the whole result")
        ->type_name("K/N");
}

void add_group_options(CLI::App& app, QueryOptions& options) {
    app.add_option("--groups", options.groups,
                   "Groups for --filter: the connected components, the integers in a file (one per line for each "
                   "triangle, those of FILE_B last), or an integer property of a PLY file's faces. `bodies` (detect "
                   "only): the nodes of glTF scenes, the objects of 3MF files, and any other file as one body; the "
                   "names of the bodies that collide are listed")
        ->type_name("components|bodies|FILE|PROPERTY");
    add_choice<std::optional<PairScope>, PairScope>(
        app, "--filter", options.filter,
        {{"between", PairScope::between}, {"within", PairScope::within}, {"both", PairScope::both}},
        "Pairs between different groups, within one group, or both");
}

void QueryOptions::check() const {
    if (polygons && part)
        fail("--part does not go with --polygons: a polygon may be in several parts, and each of them would list it");
    if (polygons && contacts) fail("--contacts does not go with --polygons: contacts belong to triangles");
    if (groups.empty() && filter && *filter != PairScope::both) fail("--filter between and within need --groups");
    if (!groups.empty() && !filter && !of_bodies()) fail("--groups needs --filter");
    if (!of_bodies()) return;
    if (part) fail("--part does not go with --groups bodies, which lists bodies");
    if (polygons) fail("--polygons does not go with --groups bodies, which lists bodies");
    if (contacts) fail("--contacts does not go with --groups bodies, which lists bodies");
}

namespace {

/// Parses settings such as "fuzziness=1.5".
void parse_fuzzy_c_means(const std::vector<std::string>& settings, FuzzyCMeans& means) {
    for (const std::string& setting : settings) {
        const std::size_t equals = setting.find('=');
        const std::string name = setting.substr(0, equals);
        const auto value = equals == setting.npos ? std::nullopt : io::number_of(setting.substr(equals + 1));
        if (!value) fail("--fuzzy-c-means " + setting + ": NAME=NUMBER is expected");
        const auto count = [&] {
            if (*value != std::floor(*value) || std::abs(*value) > 1e9)
                fail("--fuzzy-c-means " + setting + ": an integer is expected");
            return static_cast<int>(*value);
        };
        if (name == "fuzziness")
            means.fuzziness = *value;
        else if (name == "max_iterations")
            means.max_iterations = count();
        else if (name == "first_iterations")
            means.first_iterations = count();
        else if (name == "stop")
            means.stop = *value;
        else if (name == "first_stop")
            means.first_stop = *value;
        else
            fail("--fuzzy-c-means " + setting +
                 ": the names are fuzziness, max_iterations, first_iterations, stop, first_stop");
    }
}

/// Parses a sweep direction: one of the words pca, x, y and z, or three numbers.
void parse_sweep(const std::vector<std::string>& words, Method& method) {
    static const Choices<SweepDirection> named{
        {"pca", SweepDirection::pca}, {"x", SweepDirection::x}, {"y", SweepDirection::y}, {"z", SweepDirection::z}};
    method.direction = {};
    if (words.size() == 1) {
        method.sweep = chosen("--sweep", words[0], named);
        return;
    }
    if (words.size() != 3) fail("--sweep: pca, x, y, z or three numbers are expected, as in 1,0,0.5");
    method.sweep = SweepDirection::given;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto value = io::number_of(words[i]);
        if (!value || !std::isfinite(*value)) fail("--sweep: " + words[i] + " is not a number");
        method.direction[i] = *value;
    }
    if (method.direction == std::array<double, 3>{}) fail("--sweep 0,0,0: a direction must not be 0");
}

/// Parses a membership rule: ball, equation_5, or "threshold=0.2".
void parse_membership(const std::string& text, Method& method) {
    constexpr std::string_view with_number = "threshold=";
    method.threshold = 0;
    if (text == "ball") {
        method.membership = Membership::ball;
    } else if (text == "equation_5") {
        method.membership = Membership::equation_5;
    } else if (text.starts_with(with_number)) {
        const auto value = io::number_of(text.substr(with_number.size()));
        if (!value || !(*value >= 0 && *value <= 1))
            fail("--membership " + text + ": a number from 0 to 1 is expected");
        method.membership = Membership::threshold;
        method.threshold = *value;
    } else {
        fail("--membership " + text + ": ball, equation_5 or threshold=U is expected");
    }
}

}  // namespace

void add_cost_options(CLI::App& app, Options& options) {
    add_choice<Backend, Backend>(app, "--backend", options.backend,
                                 {{"auto", Backend::automatic},
                                  {"reference", Backend::reference},
                                  {"cpu", Backend::cpu},
                                  {"cuda", Backend::cuda}},
                                 "Backend of the search. auto, the default, is cuda if it was built and there is a "
                                 "device, else cpu, and always cpu for impacts, near pairs, candidates, overlaps and "
                                 "--containment; reference is brute force in rational arithmetic, slow and simple");
    app.add_option_function<std::vector<int>>(
           "--device",
           [&options](const std::vector<int>& devices) {
               if (devices.size() == 1)
                   options.device = devices[0];
               else
                   options.devices = devices;
           },
           "Number of the cuda backend's device, from 0, or of several that share the work, as in 0,1; crumple info "
           "--devices lists them. Without it, the first one is used")
        ->type_name("N")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(integer(0, std::numeric_limits<int>::max()));
    app.add_option("--threads", options.threads,
                   "Number of threads of the cpu backend, and of the cuda backend for what the host computes; without "
                   "it, as many as "
                   "the machine has")
        ->type_name("N")
        ->check(integer(1, 1024));
    app.add_option("--clusters", options.clusters,
                   "Number of clusters of the first level, 1 to 64; without it, chosen by the size of the scene")
        ->type_name("N")
        ->check(integer(1, 64));
    app.add_option("--leaf-size", options.leaf_size,
                   "Number of triangles that a leaf should have: larger clusters are divided into leaves; 3000 by "
                   "default")
        ->type_name("N")
        ->check(integer(1, std::numeric_limits<int>::max()));
    app.add_option_function<std::vector<std::string>>(
           "--sweep", [&options](const std::vector<std::string>& words) { parse_sweep(words, options.method); },
           "Direction along which leaves are swept, for researchers: the principal component of each leaf (pca, the "
           "default), a coordinate axis, or a vector, as in 1,0,0.5")
        ->type_name("pca|x|y|z|X,Y,Z")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option_function<std::string>(
           "--membership", [&options](const std::string& text) { parse_membership(text, options.method); },
           "Rule by which triangles join clusters, for researchers: ball, the default, loses no pair; equation_5 of "
           "Mainzer and Zachmann's paper, and a threshold of membership from 0 to 1, may lose pairs, and then a "
           "warning is printed")
        ->type_name("ball|equation_5|threshold=U");
    app.add_option_function<std::vector<std::string>>(
           "--fuzzy-c-means",
           [&options](const std::vector<std::string>& settings) {
               parse_fuzzy_c_means(settings, options.fuzzy_c_means);
           },
           "How fuzzy C-means places clusters, for researchers: fuzziness=2, max_iterations=2, first_iterations=5, "
           "stop=0.01, first_stop=0.0001, or some of these, separated by commas")
        ->type_name("NAME=X")
        ->delimiter(',')
        ->allow_extra_args(false);
    app.add_option_function<std::string>(
           "--memory-limit", [&options](const std::string& text) { options.memory_limit = parse_bytes(text); },
           "Limit on the memory of the search: 2GiB, 500MB, 1.5g or a number of bytes")
        ->type_name("SIZE");
}

void check_cost_options(const Options& options) {
    if ((options.device || !options.devices.empty()) &&
        (options.backend == Backend::reference || options.backend == Backend::cpu))
        fail("--device applies to --backend cuda only");
    if (options.backend != Backend::reference) return;
    if (options.threads) fail("--threads does not apply to --backend reference, which has one thread");
    if (options.clusters) fail("--clusters does not apply to --backend reference, which has no clusters");
    if (options.leaf_size != Options().leaf_size)
        fail("--leaf-size does not apply to --backend reference, which has no leaves");
    if (options.method != Method())
        fail("--sweep and --membership do not apply to --backend reference, which has no clusters");
}

void check_outputs(const std::vector<std::string>& outputs, std::vector<std::string> inputs,
                   const QueryOptions& options, bool is_writer) {
    inputs.push_back(options.groups);
    std::vector<std::string> written = outputs;
    for (const std::string& output : outputs) {
        if (extension_of(output) == ".obj")
            written.push_back(io::without_gzip_name(output).replace_extension(".mtl").string());
    }
    for (const std::string& output : written) {
        if (is_standard(output)) continue;
        for (const std::string& input : inputs) {
            std::error_code missing;  // set if one of the files does not exist; they differ then
            if (!std::filesystem::equivalent(output, input, missing)) continue;
            throw Error(ErrorCode::invalid_argument, fmt::format("-o {} would overwrite the input {}", output, input),
                        Element::option);
        }
    }
    for (const std::string& output : outputs) {
        std::error_code missing;
        const auto status = std::filesystem::status(output, missing);
        const bool is_pipe = is_standard(output) || std::filesystem::is_other(status) ||
                             std::filesystem::is_character_file(status) || std::filesystem::is_fifo(status);
        if (is_writer && !is_pipe) io::AtomicFile{output};
    }
}

void check_standard_input(const std::vector<std::string>& inputs) {
    if (std::count_if(inputs.begin(), inputs.end(), is_standard) > 1) fail("standard input, -, can be read only once");
}

void check_format(const std::vector<std::string>& outputs, const std::string& format) {
    const bool to_standard = std::any_of(outputs.begin(), outputs.end(), is_standard);
    if (to_standard && format.empty()) fail("-o - needs --format, which chooses what is written");
    if (!to_standard && !format.empty())
        fail("--format is for -o - only: the extension of a file determines its format");
    if (std::count_if(outputs.begin(), outputs.end(), is_standard) > 1) fail("-o - can be given only once");
}

std::string extension_of(const std::string& path, const std::string& format) {
    if (is_standard(path)) return "." + format;
    return io::extension_of(path);
}

}  // namespace crumple::cli
