// Study of the time to read a mesh from a binary STL file that is in the page cache, without and with welding
// (replacing vertices at equal positions by one). `processor`: time of all threads of the process, which other load on
// the machine affects less than wall-clock time.

#include <fmt/format.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>

#include "crumple/io.h"
#include "report.h"
#include "studies/studies.h"

namespace crumple::benchmark {
namespace {

namespace fs = std::filesystem;

double milliseconds_of(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return 1e3 * static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_nsec);
}

struct TemporaryFile {
    fs::path path = fs::temp_directory_path() / fmt::format("crumple_reading_{}.stl", getpid());
    ~TemporaryFile() {
        std::error_code ignored;
        fs::remove(path, ignored);
    }
};

}  // namespace

nlohmann::json study_reading(const StudySettings& settings) {
    Table table("reading binary STL, ms", {"scene", "triangles", "MB", "welded", "wall", "quartiles", "processor"});
    nlohmann::json rows = nlohmann::json::array();
    const std::vector<std::string> usual{settings.quick ? "model:100000" : "model:1300000"};
    for (const std::string& scene : choose_scenes(settings, usual, usual)) {
        const TemporaryFile file;
        io::write_mesh(file.path, load(scene).a);
        for (const io::Weld weld : {io::Weld::no, io::Weld::yes}) {
            std::vector<double> wall, processor;
            std::int64_t triangles = 0;
            for (int r = 0; r <= settings.effort.rounds; ++r) {
                const double wall_begin = milliseconds_of(CLOCK_MONOTONIC);
                const double begin = milliseconds_of(CLOCK_PROCESS_CPUTIME_ID);
                triangles = io::read_mesh(file.path, {.weld = weld}).triangle_count();
                if (r == 0) continue;  // fills the page cache
                wall.push_back(milliseconds_of(CLOCK_MONOTONIC) - wall_begin);
                processor.push_back(milliseconds_of(CLOCK_PROCESS_CPUTIME_ID) - begin);
            }
            const Summary time = summarise(wall), busy = summarise(processor);
            const double megabytes = 1e-6 * static_cast<double>(fs::file_size(file.path));
            const bool welded = weld == io::Weld::yes;
            table.row({scene, std::to_string(triangles), number(megabytes), welded ? "yes" : "no", number(time.median),
                       range(time), number(busy.median)});
            rows.push_back({{"workload", scene},
                            {"triangles", triangles},
                            {"megabytes", megabytes},
                            {"welded", welded},
                            {"wall", to_json(time)},
                            {"processor", to_json(busy)}});
        }
    }
    table.print();
    return rows;
}

}  // namespace crumple::benchmark
