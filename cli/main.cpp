#include <array>
#include <csignal>
#include <exception>
#include <ios>
#include <memory>
#include <new>
#include <string>

#include "cli/commands.h"
#include "cli/help.h"
#include "cli/misuse.h"
#include "cli/ranks/ranks.h"
#include "cli/signals.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "crumple/version.h"

namespace {

using namespace crumple::cli;

int run(int argc, char** argv) {
    CLI::App app(
        "Crumple finds every pair of colliding triangles, every impact of a step, every pair of features within a "
        "distance, and how much bodies overlap, exactly.",
        "crumple");
    app.formatter(std::make_shared<Help>());
    app.set_version_flag("--version", "crumple " CRUMPLE_VERSION, "Print the version and exit");
    app.require_subcommand(0, 1);  // at most one subcommand, so a file after it may have the name of another one
    app.footer(
        "Exit status: 0 success; 1 something collides, touches, is near or overlaps (with --check), there are "
        "findings\n"
        "(check), or a list is wrong (verify); 2 wrong use or bad input; 3 out of memory: under --memory-limit, the\n"
        "message has a lower bound on the bytes needed; 130 interrupted.\n\n"
        "Example: crumple detect bunny.ply -o pairs.txt --stats");
    const std::array commands{add_detect(app),  add_check(app),    add_impacts(app), add_near(app),
                              add_overlap(app), add_sequence(app), add_info(app),    add_verify(app),
                              add_make(app),    add_convert(app),  add_clusters(app)};
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& success) {
        int status = done;
        to_standard_output([&](std::ostream& out) { status = app.exit(success, out, out); });  // help or version
        return status;
    } catch (const CLI::ParseError& error) {
        print_error(explain(error, app));
        return failed;
    }
    for (const Command& command : commands) {
        if (!*command.app) continue;
        if (command.on_ranks || Ranks::count() == 1) return command.run();
        print_error(command.app->get_name() + " is not supported on several ranks: run it in one process");
        return failed;
    }
    print_error(
        "a subcommand is required: detect, check, impacts, near, overlap, sequence, info, verify, make or convert");
    return failed;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGPIPE, SIG_IGN);  // writing to a closed pipe then fails with EPIPE instead
    clean_up_when_killed();
    std::ios::sync_with_stdio(false);
    const Ranks ranks(argc, argv);
    try {
        return run(argc, argv);
    } catch (const crumple::Error& error) {
        print_error(error.what());
        return error.code == crumple::ErrorCode::memory_limit ? out_of_memory : failed;
    } catch (const std::bad_alloc&) {
        print_error("the machine does not have enough memory");
        return out_of_memory;
    } catch (const std::exception& error) {
        print_error(error.what());
        return failed;
    }
}
