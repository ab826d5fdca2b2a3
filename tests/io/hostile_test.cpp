// Tests of files that are cut, damaged or absurd: they give an error or a valid mesh, never a crash, a hang or a huge
// allocation.

#include <atomic>
#include <cstdlib>
#include <new>
#include <random>

#include "rounds.h"
#include "samples.h"

namespace {
std::atomic<std::size_t> largest_allocation{0};

void* allocate(std::size_t size, std::size_t alignment) {
    std::size_t seen = largest_allocation.load();
    while (size > seen && !largest_allocation.compare_exchange_weak(seen, size)) {
    }
    void* const memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) throw std::bad_alloc();
    return memory;
}

// Not inlined: g++ would take the pairing of `operator new` with `free` for a mistake.
[[gnu::noinline]] void release(void* memory) { std::free(memory); }
}  // namespace

void* operator new(std::size_t size) { return allocate(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace crumple::io::test {
namespace {

/// Returns the mesh, or nothing after an Error. Any other exception fails the test.
std::optional<TriangleMesh> try_read(const fs::path& path, const ReadOptions& options = {}) {
    try {
        return read_mesh(path, options);
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
        return std::nullopt;
    }
}

void expect_valid(const TriangleMesh& mesh) {
    for (const std::int32_t corner : mesh.triangles) ASSERT_TRUE(corner >= 0 && corner < mesh.vertex_count());
    for (const double x : coordinates(mesh)) ASSERT_TRUE(x - x == 0);
    ASSERT_TRUE(mesh.groups.empty() || static_cast<std::int64_t>(mesh.groups.size()) == mesh.triangle_count());
}

TEST(HostileFiles, truncation_of_ply_stl_and_off_is_reported_unless_the_rest_is_complete) {
    const Folder folder;
    for (const Sample& sample : samples()) {
        const bool is_obj = sample.name.ends_with(".obj");  // has neither counts nor an end
        const TriangleMesh whole = read_bytes(sample.bytes, sample.name);
        const std::size_t last = sample.bytes.find_last_not_of("\n");  // the last line needs no end
        // A file that is cut between two solids is a complete file.
        const std::size_t first_solid_ends = sample.bytes.find("endsolid") + 8;
        const std::size_t second_solid_begins = sample.bytes.find("\nsolid") + 1;
        for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
            SCOPED_TRACE(sample.name + " cut to " + std::to_string(size));
            const auto mesh = try_read(folder.write(sample.name, sample.bytes.substr(0, size)));
            if (mesh) expect_valid(*mesh);
            // If only digits of the last number of a text are cut off, the rest is a number, too, so the mesh may
            // differ.
            const bool ends_in_number = sample.bytes[last] >= '0' && sample.bytes[last] <= '9';
            const bool in_last_number = ends_in_number && size > sample.bytes.find_last_of(" ", last) + 1;
            const bool between_solids =
                sample.name == "ascii.stl" && size >= first_solid_ends && size <= second_solid_begins;
            const bool warned =
                mesh && !mesh->warnings.empty() && mesh->warnings[0].find("endsolid is missing") != std::string::npos;
            if (!is_obj && size <= last && !in_last_number && !between_solids && !warned) {
                EXPECT_FALSE(mesh) << "part of a mesh was read";
            }
            if (size > last) expect_same(*mesh, whole);
        }
    }
}

TEST(HostileFiles, every_damaged_byte_is_an_error_or_gives_a_valid_mesh) {
    const Folder folder;
    for (const Sample& sample : samples()) {
        for (std::size_t i = 0; i < sample.bytes.size(); ++i) {
            const unsigned byte = static_cast<unsigned char>(sample.bytes[i]);
            std::size_t number = i;  // unless thorough() is true, each byte gets a third of the changes
            for (const unsigned change : {0x01u, 0x02u, 0x10u, 0x80u, 0xffu, byte ^ 0x20u, byte ^ 0x0au}) {
                if (number++ % 3 != 0 && !thorough()) continue;
                std::string bytes = sample.bytes;
                bytes[i] = static_cast<char>(byte ^ change);
                SCOPED_TRACE(sample.name + ", byte " + std::to_string(i) + " changed by " + std::to_string(change));
                const auto mesh = try_read(folder.write(sample.name, bytes), {.weld = Weld::yes});
                if (mesh) expect_valid(*mesh);
            }
        }
    }
}

TEST(HostileFiles, random_mutations_are_errors_or_give_valid_meshes) {
    const Folder folder;
    std::mt19937 random(1);
    const auto any = [&](std::size_t size) { return std::uniform_int_distribution<std::size_t>(0, size - 1)(random); };
    const std::vector<Sample> all = samples();
    for (int round = 0; round < (thorough() ? 4000 : 1000); ++round) {
        const Sample& sample = all[any(all.size())];
        std::string bytes = sample.bytes;
        for (std::size_t edits = 1 + any(4); edits > 0 && !bytes.empty(); --edits) {
            const std::size_t at = any(bytes.size());
            const std::size_t length = 1 + any(std::min<std::size_t>(8, bytes.size() - at));
            switch (any(4)) {
                case 0:
                    bytes.erase(at, length);
                    break;
                case 1:
                    bytes.insert(at, bytes.substr(any(bytes.size()), length));
                    break;
                case 2:
                    for (std::size_t i = 0; i < length; ++i) bytes[at + i] = static_cast<char>(random());
                    break;
                default:
                    bytes.insert(at, 1, "0123456789-+eE./# \n"[any(19)]);
            }
        }
        SCOPED_TRACE(sample.name + ", round " + std::to_string(round));
        const auto mesh = try_read(folder.write(sample.name, bytes));
        if (mesh) expect_valid(*mesh);
    }
}

TEST(HostileFiles, absurd_counts_are_errors_without_large_allocations) {
    const Folder folder;
    const std::string ply = "ply\nformat binary_little_endian 1.0\n";
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    const std::string face = "element face 1\nproperty list uint int vertex_indices\nend_header\n";
    const std::string three = packed(std::endian::little, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f);
    const auto list = [](std::uint32_t count) { return packed(std::endian::little, count, 0, 1, 2); };
    std::string stl = binary_stl();
    stl.replace(80, 4, "\xff\xff\xff\xff");
    const std::vector<Sample> absurd = {
        {"vertices.ply", ply + "element vertex 1099511627776\n" + xyz + face + three + list(3)},
        {"most.ply", ply + "element vertex 9223372036854775807\n" + xyz + face + three + list(3)},
        {"faces.ply",
         ply + "element vertex 3\n" + xyz + "element face 1099511627776\n" + face.substr(15) + three + list(3)},
        {"list.ply", ply + "element vertex 3\n" + xyz + face + three + list(1u << 31)},
        {"negative.ply", ply + "element vertex 3\n" + xyz +
                             "element face 1\nproperty list char int vertex_indices\nend_header\n" + three +
                             packed(std::endian::little, std::int8_t{-3}, 0, 1, 2)},
        {"skipped.ply", ply + "element other 1099511627776\nproperty list uchar int a\nelement vertex 3\n" + xyz +
                            face + three + list(3)},
        {"ascii.ply", "ply\nformat ascii 1.0\nelement vertex 1099511627776\n" + xyz + face + "0 0 0\n"},
        {"many.off", "OFF\n1099511627776 1099511627776 0\n0 0 0\n"},
        {"faces.off", "OFF\n1 1099511627776 0\n0 0 0\n"},
        {"corners.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2147483648 0 1 2\n"},
        {"index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2147483647\n"},
        {"count.stl", stl},
    };
    for (const Sample& sample : absurd) {
        SCOPED_TRACE(sample.name);
        const fs::path path = folder.write(sample.name, sample.bytes);
        largest_allocation = 0;
        const auto mesh = try_read(path);
        EXPECT_FALSE(mesh);
        EXPECT_LT(largest_allocation, 100'000u);
    }
}

TEST(HostileFiles, long_ply_header_without_coordinates_is_an_error) {
    std::string header = "ply\nformat ascii 1.0\n";
    for (int i = 0; i < 100'000; ++i) header += "element e 0\nproperty int p\n";
    header += "element vertex 0\n";
    for (int i = 0; i < 300'000; ++i) header += "property int p\n";
    EXPECT_EQ(error_of([&] { read_bytes(header + "end_header\n", "a.ply"); }).code, ErrorCode::format);
}

TEST(HostileFiles, numbers_of_a_million_digits_are_read) {
    const std::string digits(1'000'000, '3');
    const auto mesh = read_bytes("v 0." + digits + " 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", "a.obj");
    EXPECT_EQ(coordinates(mesh)[0], 1.0 / 3);
    expect_bad("v " + digits + " 0 0\n", "a.obj", Element::line, 1, "overflows float64");
}

}  // namespace
}  // namespace crumple::io::test
