#pragma once

// Searches from bytes: small meshes with hostile coordinates and topology, options of detector and query, and frames
// that follow each other. Any bytes make a search, and more bytes make no other one: what is missing is zero.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/crumple.h"

namespace crumple::fuzz {

/// Bytes from the left, then zeros.
class Bytes {
   public:
    explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    std::uint8_t next() { return place_ < bytes_.size() ? bytes_[place_++] : std::uint8_t{0}; }
    /// Below `n`, at most 256.
    int below(int n) { return next() % n; }
    bool flag() { return next() & 1; }
    /// Of all bytes, read or not.
    std::uint32_t checksum() const {
        std::uint32_t sum = 2166136261u;  // FNV-1a, its upper half folded: the lowest bits alone are poor
        for (const std::uint8_t byte : bytes_) sum = (sum ^ byte) * 16777619u;
        return sum ^ sum >> 16;
    }
    template <std::size_t n, class T>
    const T& one_of(const T (&values)[n]) {
        return values[next() % n];
    }

   private:
    std::span<const std::uint8_t> bytes_;
    std::size_t place_ = 0;
};

/// How the arrays of a mesh lie in memory.
struct Layout {
    IndexType index = IndexType::int32;
    int vertices = 0, triangles = 0;  ///< an arrangement of rows and columns (see Arrays)
    bool operator==(const Layout&) const = default;
};

struct Mesh {
    bool single = true;  ///< coordinates are float32 numbers and given as such
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int64_t, 3>> triangles;
    std::vector<std::int32_t> groups;
    Layout layout;
};

/// A mesh's arrays as its layout wants them, each in a block of its own that is as long as it must be.
class Arrays {
   public:
    explicit Arrays(const Mesh& mesh);
    const MeshView& view() const { return view_; }

   private:
    std::vector<std::byte> vertices_, triangles_;
    std::vector<std::int32_t> groups_;
    MeshView view_;
};

inline constexpr std::int32_t group_ids[] = {0, 1, 2, -1, INT32_MAX, INT32_MIN};

/// What meshes of a kind have in common, for each side.
struct Kind {
    bool between = false;
    std::array<bool, 2> single{};
    std::array<Layout, 2> layout{};
    std::array<int, 2> groups{};  ///< 0: none; else how many ids
    bool wild = false;
    bool scaled = true;  ///< perhaps, as a whole
    int most = 0;        ///< triangles of a mesh
};

Mesh mesh(Bytes& bytes, const Kind& kind, std::size_t side);

/// Of the cpu backend.
Options options(Bytes& bytes);

/// Numbers at the edges of what filters, expansions and float32 hold; the first ones of like size, unless `wild`.
double hostile_number(Bytes& bytes, bool wild);

/// One or two meshes.
using Frame = std::vector<Mesh>;

struct Search {
    bool kept = false;  ///< the detector is one that earlier inputs have used
    Options options;
    IntersectionQuery query;  ///< `excluded_groups` looks at `excluded`
    std::vector<GroupPair> excluded;
    int parts = 0;                   ///< 0: none
    std::int64_t block_rows = 0;     ///< of blocks; 0: none
    std::int64_t memory_limit = -1;  ///< beside what suffices; -1: none
    std::vector<Frame> frames;

    explicit Search(Bytes bytes);
    Search(const Search&) = delete;
    Search& operator=(const Search&) = delete;
};

}  // namespace crumple::fuzz
