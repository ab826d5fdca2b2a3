#pragma once

// Decodes searches from bytes: small meshes with hostile coordinates and topology, options of detector and query, and
// successive frames. Any bytes make a search; missing bytes count as zero.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "crumple/crumple.h"

namespace crumple::fuzz {

/// Reads bytes from left to right, then zeros.
class Bytes {
   public:
    explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
    std::uint8_t next() { return place_ < bytes_.size() ? bytes_[place_++] : std::uint8_t{0}; }
    /// Returns a number in [0, n), for n up to 256.
    int below(int n) { return next() % n; }
    bool flag() { return next() & 1; }
    /// Returns a checksum of all bytes, read or not.
    std::uint32_t checksum() const {
        std::uint32_t sum = 2166136261u;  // FNV-1a; the upper half is folded in, as its lowest bits are poor
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

/// Memory layout of the arrays of a mesh.
struct Layout {
    IndexType index = IndexType::int32;
    int vertices = 0, triangles = 0;  ///< index of one of the six arrangements in arrays.cpp
    bool operator==(const Layout&) const = default;
};

struct Mesh {
    bool single = true;  ///< coordinates are float32 numbers and passed as float32
    std::vector<std::array<double, 3>> vertices;
    std::vector<std::array<std::int64_t, 3>> triangles;
    std::vector<std::int32_t> groups;
    Layout layout;
};

/// Arrays of a mesh in its layout. Each is an allocation of exactly the needed size, so that AddressSanitizer detects
/// accesses outside of it.
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

/// Common properties of the meshes of a search. Arrays have one element for each side, the first and the second mesh.
struct Kind {
    bool between = false;
    std::array<bool, 2> single{};
    std::array<Layout, 2> layout{};
    std::array<int, 2> groups{};  ///< number of group ids to choose from; 0: no groups
    bool wild = false;            ///< mixes numbers of very different size
    bool scaled = true;           ///< a mesh may be scaled as a whole
    int most = 0;                 ///< largest number of triangles of a mesh
};

/// Decodes a mesh of side 0 or 1.
Mesh mesh(Bytes& bytes, const Kind& kind, std::size_t side);

/// Decodes options of the cpu backend.
Options options(Bytes& bytes);

/// Returns a number at a limit of filters, expansions or float32. Without `wild`, it is of moderate size.
double hostile_number(Bytes& bytes, bool wild);

/// One or two meshes at one time of an animation.
using Frame = std::vector<Mesh>;

struct Search {
    bool reused = false;  ///< uses a detector that earlier inputs have used
    Options options;
    IntersectionQuery query;  ///< its `filter.excluded_groups` equals `excluded`
    std::vector<GroupPair> excluded;
    int parts = 0;                   ///< number of parts; 0: no search by parts
    std::int64_t block_rows = 0;     ///< most rows of a streamed block; 0: no streaming
    std::int64_t memory_limit = -1;  ///< limit of an additional detector, in bytes; -1: no such detector
    std::vector<Frame> frames;

    explicit Search(Bytes bytes);
    Search(const Search&) = delete;
    Search& operator=(const Search&) = delete;
};

}  // namespace crumple::fuzz
