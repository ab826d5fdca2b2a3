#include "cli/ranks/rank_vertices.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <variant>

namespace crumple::cli {
namespace {

using distribute::Traffic;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// Vertices of other blocks, each once, in order: so those of one block are together.
std::vector<std::int32_t> foreign_vertices(const io::TriangleMesh& mesh, std::int64_t begin, std::int64_t end) {
    std::vector<std::int32_t> foreign;
    for (const std::int32_t corner : mesh.triangles)
        if (corner < begin || corner >= end) foreign.push_back(corner);
    std::sort(foreign.begin(), foreign.end());
    foreign.erase(std::unique(foreign.begin(), foreign.end()), foreign.end());
    return foreign;
}

/// Sums of the counts before each.
std::vector<std::int64_t> begins(const std::vector<std::int64_t>& counts) {
    std::vector<std::int64_t> first(counts.size() + 1, 0);
    std::partial_sum(counts.begin(), counts.end(), first.begin() + 1);
    return first;
}

class Fetch {
   public:
    Fetch(RankLink& link, io::Blocks blocks) : link_(link), blocks_(blocks), questions_(link.ranks()) {}

    /// Tells each rank which of its vertices are wanted here.
    void ask(std::span<const std::int32_t> wanted) {
        for (const std::int32_t vertex : wanted) ++questions_.out[at(blocks_.reader_of(vertex))];
        link_.transport().all_to_all(questions_.out, questions_.in);
        wanted_from_ = begins(questions_.out);
        asked_by_ = begins(questions_.in);
        link_.agree([&] { asked_.resize(at(asked_by_.back())); });
        link_.rounds().exchange<std::int32_t>(
            questions_,
            [&](int rank, std::int64_t first, std::span<std::int32_t> rows) {
                std::copy_n(wanted.data() + wanted_from_[at(rank)] + first, rows.size(), rows.begin());
            },
            [&](int rank, std::int64_t first, std::span<const std::int32_t> rows) {
                std::copy(rows.begin(), rows.end(), asked_.data() + asked_by_[at(rank)] + first);
            });
    }

    /// Puts what comes behind the block's own coordinates.
    template <class Scalar>
    void answer(std::vector<Scalar>& xyz) {
        using Row = std::array<Scalar, 3>;
        const std::int64_t own = blocks_.begin(link_.rank());
        const std::size_t size = xyz.size();
        link_.agree([&] { xyz.resize(size + 3 * at(wanted_from_.back())); });
        Traffic back(link_.ranks());
        back.out = questions_.in, back.in = questions_.out;
        link_.rounds().exchange<Row>(
            back,
            [&](int rank, std::int64_t first, std::span<Row> rows) {
                const std::int32_t* vertex = asked_.data() + asked_by_[at(rank)] + first;
                for (Row& row : rows) std::copy_n(&xyz[3 * at(*vertex++ - own)], 3, row.begin());
            },
            [&](int rank, std::int64_t first, std::span<const Row> rows) {
                Scalar* to = xyz.data() + size + 3 * at(wanted_from_[at(rank)] + first);
                for (const Row& row : rows) to = std::copy(row.begin(), row.end(), to);
            });
    }

   private:
    RankLink& link_;
    io::Blocks blocks_;
    Traffic questions_;
    std::vector<std::int64_t> wanted_from_, asked_by_;  ///< the first of each rank
    std::vector<std::int32_t> asked_;
};

}  // namespace

std::vector<std::int64_t> bring_named_vertices(RankLink& link, io::Blocks blocks, io::TriangleMesh& mesh,
                                               io::TriangleMesh* moved) {
    const std::int64_t begin = blocks.begin(link.rank()), end = blocks.end(link.rank());
    std::vector<std::int32_t> wanted;
    std::vector<std::int64_t> ids;
    link.agree([&] {
        wanted = foreign_vertices(mesh, begin, end);
        ids.resize(at(end - begin));
        std::iota(ids.begin(), ids.end(), begin);
        ids.insert(ids.end(), wanted.begin(), wanted.end());
    });
    Fetch fetch(link, blocks);
    fetch.ask(wanted);
    std::visit([&](auto& xyz) { fetch.answer(xyz); }, mesh.vertices);
    if (moved) std::visit([&](auto& xyz) { fetch.answer(xyz); }, moved->vertices);
    for (std::int32_t& corner : mesh.triangles) {
        std::int64_t place = corner - begin;
        if (corner < begin || corner >= end)
            place = end - begin + (std::lower_bound(wanted.begin(), wanted.end(), corner) - wanted.begin());
        corner = static_cast<std::int32_t>(place);
    }
    return ids;
}

}  // namespace crumple::cli
