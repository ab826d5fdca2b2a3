#include "cli/rank_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <optional>
#include <streambuf>
#include <system_error>
#include <utility>
#include <vector>

#include "cli/terminal.h"
#include "io/atomic_file.h"
#include "io/file_buffer.h"
#include "io/pairs.h"

namespace crumple::cli {
namespace {

/// Counts what is written.
class Counter : public std::streambuf {
   public:
    std::int64_t bytes = 0;

   private:
    int_type overflow(int_type c) override { return ++bytes, traits_type::not_eof(c); }
    std::streamsize xsputn(const char*, std::streamsize size) override { return bytes += size, size; }
};

constexpr int piece_bytes = 1 << 20;

/// Sends what is written to rank 0, in pieces that are full but for the last.
class Sender : public std::streambuf {
   public:
    explicit Sender(MPI_Comm communicator) : communicator_(communicator), piece_(piece_bytes) { begin(); }

   private:
    void begin() { setp(piece_.data(), piece_.data() + piece_.size()); }
    int sync() override {
        if (pptr() == pbase()) return 0;
        distribute::check_mpi(MPI_Send(pbase(), static_cast<int>(pptr() - pbase()), MPI_CHAR, 0, 0, communicator_),
                              "MPI_Send");
        begin();
        return 0;
    }
    int_type overflow(int_type c) override {
        sync();
        if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
        return traits_type::not_eof(c);
    }

    MPI_Comm communicator_;
    std::vector<char> piece_;
};

/// Writes what a rank sends. All of it is received, whether or not it can be written.
void receive(RankLink& link, int rank, std::int64_t bytes, std::vector<char>& piece, std::ostream& out) {
    while (bytes > 0) {
        const int size = static_cast<int>(std::min<std::int64_t>(bytes, piece_bytes));
        distribute::check_mpi(MPI_Recv(piece.data(), size, MPI_CHAR, rank, 0, link.communicator(), MPI_STATUS_IGNORE),
                              "MPI_Recv");
        out.write(piece.data(), size);
        bytes -= size;
    }
}

/// Where each rank's text begins, and the end.
std::vector<std::int64_t> places(RankLink& link, const RankText& text) {
    std::vector<std::int64_t> place(static_cast<std::size_t>(link.ranks()) + 1, 0);
    link.agree([&] {
        const std::int64_t bytes = text.bytes();
        for (std::size_t r = static_cast<std::size_t>(link.rank()) + 1; r < place.size(); ++r) place[r] = bytes;
    });
    link.transport().reduce(place, distribute::Reduction::sum);
    return place;
}

/// On rank 0 to(write) calls write(stream).
void through_first(RankLink& link, const RankText& text, const std::vector<std::int64_t>& place,
                   const std::function<void(const std::function<void(std::ostream&)>&)>& to) {
    std::vector<char> piece;
    link.agree([&] { piece.resize(piece_bytes); });
    link.agree([&] {
        if (!link.is_first()) {
            Sender sender(link.communicator());
            std::ostream out(&sender);
            text.write(out);
            out.flush();
            return;
        }
        to([&](std::ostream& out) {
            text.write(out);
            for (int r = 1; r < link.ranks(); ++r) {
                const auto at = static_cast<std::size_t>(r);
                receive(link, r, place[at + 1] - place[at], piece, out);
            }
        });
    });
}

/// A descriptor of another rank's file.
class Opened {
   public:
    explicit Opened(const std::string& path) : descriptor_(::open(path.c_str(), O_WRONLY | O_CLOEXEC)) {}
    Opened(const Opened&) = delete;
    Opened& operator=(const Opened&) = delete;
    ~Opened() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    bool is_open() const { return descriptor_ >= 0; }

    /// Throws Error that names the target.
    void write(std::int64_t place, const RankText& text, const std::string& target) {
        io::FileBuffer buffer(descriptor_);
        if (::lseek(descriptor_, static_cast<off_t>(place), SEEK_SET) < 0) buffer.fail(errno);
        std::ostream out(&buffer);
        text.write(out);
        out.flush();
        if (::close(std::exchange(descriptor_, -1)) != 0 && !buffer.reason()) buffer.fail(errno);
        if (const int reason = buffer.reason())
            throw Error(ErrorCode::file, "cannot write " + target + ": " + std::generic_category().message(reason),
                        Element::none, -1, 0, reason);
    }

   private:
    int descriptor_;
};

}  // namespace

// In blocks: rows are text as they are made, and are never copied as a whole.
void RankText::write(std::ostream& out) const {
    constexpr std::size_t most = std::size_t{1} << 14;
    if (first_) io::write_heading_of_pairs(out, contacts_, format_);
    Collisions block;
    for (std::size_t begin = 0; begin < found_.pairs.size(); begin += most) {
        const std::size_t n = std::min(most, found_.pairs.size() - begin);
        std::copy_n(found_.pairs.data() + begin, n, block.pairs.resize_discard(n));
        if (contacts_) {
            const Contacts& all = found_.contacts;
            const std::int64_t first = all.offsets[begin];
            std::copy_n(all.kinds.data() + begin, n, block.contacts.kinds.resize_discard(n));
            std::transform(all.offsets.data() + begin, all.offsets.data() + begin + n + 1,
                           block.contacts.offsets.resize_discard(n + 1), [&](std::int64_t i) { return i - first; });
            const auto points = static_cast<std::size_t>(block.contacts.offsets[n]);
            std::copy_n(all.points.data() + first, points, block.contacts.points.resize_discard(points));
        }
        io::write_rows_of_pairs(out, block, format_);
    }
}

std::int64_t RankText::bytes() const {
    Counter counter;
    std::ostream out(&counter);
    write(out);
    return counter.bytes;
}

void write_on_ranks(RankLink& link, const std::string& path, const RankText& text) {
    const std::vector<std::int64_t> place = places(link, text);
    std::optional<io::AtomicFile> file;  // rank 0's
    std::string temporary;
    link.agree([&] {
        if (!link.is_first()) return;
        file.emplace(path);
        temporary = file->temporary().string();
    });
    temporary = link.text_of_first(temporary);
    std::optional<Opened> opened;
    if (!link.is_first()) opened.emplace(temporary);
    if (link.least(!temporary.empty() && (link.is_first() || opened->is_open()))) {
        link.agree([&] {
            if (opened) return opened->write(place[static_cast<std::size_t>(link.rank())], text, path);
            text.write(file->stream());
            file->complete();
        });
    } else {
        through_first(link, text, place, [&](const auto& write) { write(file->stream()); });
    }
    link.agree([&] {
        if (file) file->commit();
    });
}

void print_on_ranks(RankLink& link, const RankText& text) {
    through_first(link, text, places(link, text), [](const auto& write) { to_standard_output(write); });
}

}  // namespace crumple::cli
