// Tests of writing files: they appear whole or not at all.

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <limits>
#include <sstream>

#include "io/bytes/atomic_file.h"
#include "samples.h"

namespace crumple::io::test {
namespace {

std::size_t files_in(const fs::path& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(FileWriting, error_names_the_path) {
    const Folder folder;
    fs::create_directory(folder / "folder.ply");
    const Intersections none;
    const auto expect_error = [](ErrorCode code, const fs::path& path, auto&& write) {
        const Error error = error_of([&] { write(path); });
        EXPECT_EQ(error.code, code) << error.what();
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    };
    const auto mesh = [](const fs::path& path) { write_mesh(path, sample_mesh()); };
    const auto pairs = [&](const fs::path& path) { write_pairs(path, none); };
    expect_error(ErrorCode::file, folder / "missing/a.ply", mesh);
    expect_error(ErrorCode::file, folder / "folder.ply", mesh);
    expect_error(ErrorCode::file, folder / "missing/a.txt", pairs);
    expect_error(ErrorCode::invalid_argument, folder / "a.xyz", mesh);
    expect_error(ErrorCode::invalid_argument, folder / "a", mesh);
    expect_error(ErrorCode::invalid_argument, folder / "a.html", mesh);
    expect_error(ErrorCode::invalid_argument, folder / "a.xml", pairs);
    EXPECT_EQ(files_in(folder.path()), 1u) << "no half file stays";
}

TEST(FileWriting, write_beyond_the_file_size_limit_keeps_the_old_file) {
    // A limit on the size of files has the same effect as a full disk.
    const Folder folder;
    const fs::path path = folder.write("a.ply", "old");
    TriangleMesh large{std::vector<double>(30'000, 0.5), {0, 1, 2}, {}};
    rlimit before;
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit limit = before;
    limit.rlim_cur = 10'000;
    const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    std::optional<Error> error;
    try {
        write_mesh(path, large);
    } catch (const Error& caught) {
        error = caught;
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old_handler);
    ASSERT_TRUE(error) << "the error was not noticed";
    EXPECT_EQ(error->code, ErrorCode::file);
    EXPECT_NE(std::string(error->what()).find("a.ply"), std::string::npos) << error->what();
    EXPECT_EQ(bytes_of(path), "old");
    EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(FileWriting, existing_file_is_replaced_and_keeps_its_permissions) {
    const Folder folder;
    const fs::path path = folder.write("a.ply", "old");
    // Permissions that no new file gets: temporary files have 0600, others 0666 less the umask.
    const fs::perms permissions = fs::perms::owner_all | fs::perms::group_read;
    fs::permissions(path, permissions);
    write_mesh(path, sample_mesh());
    expect_same(read_mesh(path), sample_mesh());
    EXPECT_EQ(fs::status(path).permissions(), permissions);
    EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(FileWriting, symbolic_link_is_preserved_and_its_target_is_written) {
    const Folder folder;
    folder.write("target.ply", "old");
    fs::create_symlink("target.ply", folder / "link.ply");
    write_mesh(folder / "link.ply", sample_mesh());
    EXPECT_TRUE(fs::is_symlink(folder / "link.ply"));
    expect_same(read_mesh(folder / "target.ply"), sample_mesh());
}

TEST(FileWriting, read_only_file_is_not_replaced) {
    const Folder folder;
    const fs::path path = folder.write("a.ply", "old");
    fs::permissions(path, fs::perms::owner_read);
    // The user root may write to every file, so the test becomes the user nobody.
    constexpr uid_t nobody = 65534;
    const bool root = geteuid() == 0;
    if (root &&
        (chown(folder.path().c_str(), nobody, nobody) || chown(path.c_str(), nobody, nobody) || seteuid(nobody)))
        GTEST_SKIP() << "root cannot become somebody else here";
    std::optional<Error> error;
    try {
        write_mesh(path, sample_mesh());
    } catch (const Error& caught) {
        error = caught;
    }
    if (root) {
        ASSERT_EQ(seteuid(0), 0);
    }
    ASSERT_TRUE(error) << "it was replaced";
    EXPECT_EQ(error->code, ErrorCode::file);
    EXPECT_EQ(error->system_error, EACCES) << error->what();
    EXPECT_EQ(bytes_of(path), "old");
    EXPECT_EQ(files_in(folder.path()), 1u);
}

TEST(FileWriting, dangling_link_is_followed_and_link_to_itself_is_an_error) {
    const Folder folder;
    fs::create_directory(folder / "sub");
    fs::create_symlink("sub/target.ply", folder / "link.ply");
    fs::create_symlink("link.ply", folder / "twice.ply");
    write_mesh(folder / "twice.ply", sample_mesh());
    EXPECT_TRUE(fs::is_symlink(folder / "link.ply") && fs::is_symlink(folder / "twice.ply"));
    expect_same(read_mesh(folder / "sub/target.ply"), sample_mesh());
    fs::create_symlink("loop.ply", folder / "loop.ply");
    const Error error = error_of([&] { write_mesh(folder / "loop.ply", sample_mesh()); });
    EXPECT_EQ(error.system_error, ELOOP) << error.what();
    EXPECT_NE(std::string(error.what()).find("loop.ply"), std::string::npos) << error.what();
}

TEST(FileWriting, error_names_the_folder_that_is_the_cause) {
    const Folder folder;
    folder.write("file", "x");
    const auto error = [&](const char* name) { return error_of([&] { write_mesh(folder / name, sample_mesh()); }); };
    EXPECT_EQ(error("missing/a.ply").system_error, ENOENT);
    EXPECT_NE(std::string(error("missing/a.ply").what()).find("there is no folder " + (folder / "missing").string()),
              std::string::npos)
        << error("missing/a.ply").what();
    EXPECT_EQ(error("file/a.ply").system_error, ENOTDIR);
    EXPECT_NE(std::string(error("file/a.ply").what()).find("file is not a folder"), std::string::npos);
}

TEST(FileWriting, unfinished_files_are_removed_at_a_normal_exit_or_on_request) {
    const Folder folder;
    const auto begin = [&] {
        static AtomicFile* const file = new AtomicFile(folder / "a.txt");  // never closed, as if still in use
        file->stream() << "half";
        file->stream().flush();
        ASSERT_EQ(files_in(folder.path()), 1u);
    };
    EXPECT_EXIT(
        {
            begin();
            std::exit(0);
        },
        testing::ExitedWithCode(0), "");
    EXPECT_EQ(files_in(folder.path()), 0u);
    EXPECT_EXIT(
        {
            begin();
            remove_unfinished_files();  // as a signal handler does
            std::_Exit(0);
        },
        testing::ExitedWithCode(0), "");
    EXPECT_EQ(files_in(folder.path()), 0u);
}

TEST(FileWriting, missing_unfinished_file_is_an_error_on_commit) {
    const Folder folder;
    folder.write("a.txt", "old");
    AtomicFile file(folder / "a.txt"), other(folder / "b.txt");
    file.stream() << "new";
    remove_unfinished_files();
    EXPECT_EQ(error_of([&] { file.commit(); }).code, ErrorCode::file);
    EXPECT_EQ(bytes_of(folder / "a.txt"), "old");
}

TEST(FileWriting, stream_gets_the_bytes_of_a_file) {
    const Folder folder;
    for (const auto& [name, format] : {std::pair("a.ply", MeshFormat::ply),
                                       {"a.obj", MeshFormat::obj},
                                       {"a.stl", MeshFormat::stl},
                                       {"a.off", MeshFormat::off},
                                       {"a.glb", MeshFormat::glb}}) {
        std::ostringstream out;
        write_mesh(out, sample_mesh(), format);
        write_mesh(folder / name, sample_mesh());
        EXPECT_EQ(out.str(), bytes_of(folder / name)) << name;
    }
    std::ostringstream out;
    for (const MeshFormat format : {MeshFormat::automatic, MeshFormat::html})
        EXPECT_EQ(error_of([&] { write_mesh(out, sample_mesh(), format); }).code, ErrorCode::invalid_argument);
    out.setstate(std::ios::badbit);
    EXPECT_EQ(error_of([&] { write_mesh(out, sample_mesh(), MeshFormat::ply); }).code, ErrorCode::file);
}

TEST(FileWriting, device_file_is_written_and_not_replaced) {
    Intersections collisions;
    collisions.pairs.push_back({1, 2});
    write_pairs("/dev/null", collisions, PairFormat::txt);
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
    if (!fs::exists("/dev/full")) return;
    EXPECT_EQ(error_of([&] { write_pairs("/dev/full", collisions, PairFormat::txt); }).code, ErrorCode::file);
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST(FileWriting, path_without_a_folder_is_written_to_the_working_folder) {
    const Folder folder;
    const fs::path before = fs::current_path();
    fs::current_path(folder.path());
    write_mesh("a.OBJ", sample_mesh());
    fs::current_path(before);
    expect_same(read_mesh(folder / "a.OBJ"), sample_mesh());
}

TEST(FileWriting, invalid_meshes_are_refused) {
    const Folder folder;
    const auto expect_error = [&](ErrorCode code, Element element, std::int64_t index, auto&& change) {
        TriangleMesh mesh = sample_mesh();
        change(mesh, std::get<std::vector<double>>(mesh.vertices));
        const Error error = error_of([&] { write_mesh(folder / "a.ply", mesh); });
        EXPECT_EQ(error.code, code) << error.what();
        EXPECT_EQ(error.element, element) << error.what();
        EXPECT_EQ(error.index, index) << error.what();
    };
    expect_error(ErrorCode::index_out_of_range, Element::triangle, 1, [](auto& mesh, auto&) { mesh.triangles[4] = 5; });
    expect_error(ErrorCode::index_out_of_range, Element::triangle, 2,
                 [](auto& mesh, auto&) { mesh.triangles[8] = -1; });
    expect_error(ErrorCode::not_finite, Element::vertex, 1,
                 [](auto&, auto& xyz) { xyz[5] = std::numeric_limits<double>::infinity(); });
    expect_error(ErrorCode::invalid_argument, Element::none, -1, [](auto& mesh, auto&) { mesh.groups = {1, 2}; });
    expect_error(ErrorCode::invalid_argument, Element::none, -1, [](auto&, auto& xyz) { xyz.pop_back(); });
    expect_error(ErrorCode::invalid_argument, Element::none, -1, [](auto& mesh, auto&) { mesh.triangles.pop_back(); });
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(FileWriting, stl_holds_unit_normals_and_zero_for_degenerate_triangles) {
    const Folder folder;
    write_mesh(folder / "a.stl", {std::vector<float>{0, 0, 0, 1e-30f, 0, 0, 0, 1e-30f, 0}, {0, 1, 2, 0, 1, 1}, {}});
    const std::string bytes = bytes_of(folder / "a.stl");
    EXPECT_NE(bytes.substr(0, 5), "solid");
    EXPECT_EQ(bytes.substr(84, 12), packed(std::endian::little, 0.f, 0.f, 1.f));
    EXPECT_EQ(bytes.substr(134, 12), packed(std::endian::little, 0.f, 0.f, 0.f));
}

}  // namespace
}  // namespace crumple::io::test
