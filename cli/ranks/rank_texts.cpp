#include "cli/ranks/rank_texts.h"

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <new>
#include <numeric>
#include <optional>
#include <ostream>
#include <span>
#include <sstream>
#include <system_error>
#include <utility>

#include "cli/command_options.h"
#include "cli/terminal.h"
#include "crumple/error.h"
#include "io/bytes/atomic_file.h"

namespace crumple::cli {
namespace {

/// The text of each section that this rank writes, and the positions of the texts of all ranks in the file.
class RankTexts {
   public:
    RankTexts(RankLink& link, const io::RowTable& table, const RankSections& sections, bool csv) : link_(link) {
        link.run_checked([&] {
            begins_.resize(sections.size() * ranks() + 1);
            for (const auto& section : sections) {
                std::ostringstream out;
                {
                    io::RowWriter writer(out, table, csv);
                    if (texts_.empty() && link.is_first()) writer.write_heading();
                    section(writer);
                }
                if (!out) throw std::bad_alloc();
                begins_[place(texts_.size(), link.rank()) + 1] = static_cast<std::int64_t>(out.view().size());
                texts_.push_back(std::move(out).str());
            }
        });
        link.reduce(begins_, distribute::Reduction::sum);
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    }

    /// Collective. Sends all texts to rank 0, in the order of the file, and rank 0 writes them to `out`. Does not throw
    /// if writing fails: check the state of `out`.
    void write_by_first(std::ostream& out) const {
        for (std::size_t section = 0; section < texts_.size(); ++section)
            for (int rank = 0; rank < link_.ranks(); ++rank) {
                const std::size_t at = place(section, rank);
                distribute::Traffic traffic(link_.ranks());
                if (link_.rank() == rank) traffic.out[0] = begins_[at + 1] - begins_[at];
                if (link_.is_first()) traffic.in[static_cast<std::size_t>(rank)] = begins_[at + 1] - begins_[at];
                link_.rounds().exchange<char>(
                    traffic,
                    [&](int, std::int64_t first, std::span<char> piece) {
                        texts_[section].copy(piece.data(), piece.size(), static_cast<std::size_t>(first));
                    },
                    [&](int, std::int64_t, std::span<const char> piece) {
                        out.write(piece.data(), static_cast<std::streamsize>(piece.size()));
                    });
            }
    }
    /// Writes this rank's own texts to their positions, and closes the file. Throws Error that names `target` if that
    /// fails.
    void write_own(std::fstream& file, const std::string& target) const {
        errno = 0;
        for (std::size_t section = 0; section < texts_.size() && file; ++section)
            file.seekp(begins_[place(section, link_.rank())]) << texts_[section] << std::flush;
        if (file) file.close();
        if (file) return;
        const int reason = errno;
        throw Error(ErrorCode::file, "cannot write " + target + ": " + std::generic_category().message(reason),
                    Element::none, -1, 0, reason);
    }

   private:
    std::size_t ranks() const { return static_cast<std::size_t>(link_.ranks()); }
    std::size_t place(std::size_t section, int rank) const {
        return section * ranks() + static_cast<std::size_t>(rank);
    }

    RankLink& link_;
    std::vector<std::string> texts_;
    std::vector<std::int64_t> begins_;  ///< position of the text of each rank, section by section; then the end
};

}  // namespace

void write_text(RankLink& link, const std::string& path, const io::RowTable& table, const RankSections& sections,
                bool csv) {
    const RankTexts all(link, table, sections, csv);
    if (is_standard(path))
        return link.run_checked([&] { to_standard_output([&](std::ostream& out) { all.write_by_first(out); }); });
    std::optional<io::AtomicFile> target;  // on rank 0 only
    std::string temporary;
    link.run_checked([&] {
        if (!link.is_first()) return;
        target.emplace(path);
        temporary = target->temporary().string();
    });
    std::fstream file(link.text_of_first(temporary), std::ios::in | std::ios::out | std::ios::binary);
    const bool all_see_it = link.least(file.is_open());
    link.run_checked([&] {
        std::ostream nowhere(nullptr);
        if (all_see_it)
            all.write_own(file, path);
        else
            all.write_by_first(target ? target->stream() : nowhere);
    });
    link.run_checked([&] {
        if (target) target->commit();
    });
}

}  // namespace crumple::cli
