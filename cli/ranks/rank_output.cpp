#include "cli/ranks/rank_output.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <numeric>
#include <streambuf>
#include <system_error>
#include <utility>

#include "cli/commands.h"
#include "io/bytes/atomic_file.h"
#include "io/bytes/file_buffer.h"

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

/// Sends what is written to rank 0, in pieces that are full but for the last one before each flush. An empty piece says
/// that no more will come.
class Sender : public std::streambuf {
   public:
    /// `piece`: room for one.
    Sender(MPI_Comm communicator, std::vector<char>& piece) : communicator_(communicator), piece_(piece) { begin(); }

    void give_up() { send(0); }

   private:
    void begin() { setp(piece_.data(), piece_.data() + piece_.size()); }
    void send(int bytes) const {
        distribute::check_mpi(MPI_Send(piece_.data(), bytes, MPI_CHAR, 0, 0, communicator_), "MPI_Send");
    }
    int sync() override {
        if (pptr() > pbase()) send(static_cast<int>(pptr() - pbase()));
        begin();
        return 0;
    }
    int_type overflow(int_type c) override {
        sync();
        if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
        return traits_type::not_eof(c);
    }

    MPI_Comm communicator_;
    std::vector<char>& piece_;
};

/// Where each rank's piece of each section begins, section by section, and the end.
class Places {
   public:
    Places(RankLink& link, const RankText& text) : ranks_(static_cast<std::size_t>(link.ranks())) {
        link.agree([&] {
            begins_.assign(text.size() * ranks_ + 1, 0);
            for (std::size_t section = 0; section < text.size(); ++section) {
                Counter counter;
                std::ostream out(&counter);
                text[section](out);
                begins_[at(section, link.rank()) + 1] = counter.bytes;
            }
        });
        link.transport().reduce(begins_, distribute::Reduction::sum);
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    }
    std::int64_t begin(std::size_t section, int rank) const { return begins_[at(section, rank)]; }
    std::int64_t bytes(std::size_t section, int rank) const {
        return begins_[at(section, rank) + 1] - begins_[at(section, rank)];
    }

   private:
    std::size_t at(std::size_t section, int rank) const { return section * ranks_ + static_cast<std::size_t>(rank); }

    std::size_t ranks_;
    std::vector<std::int64_t> begins_;
};

/// What the other ranks send to rank 0. All of it is received, whether or not it can be written, for they wait until it
/// is; nothing is allocated for that.
class Receiver {
   public:
    Receiver(RankLink& link, const Places& places, std::size_t sections, std::vector<char>& piece,
             std::vector<std::int64_t>& left)
        : link_(link), piece_(piece), left_(left) {
        for (int rank = 1; rank < link.ranks(); ++rank)
            for (std::size_t section = 0; section < sections; ++section)
                left_[static_cast<std::size_t>(rank)] += places.bytes(section, rank);
    }
    Receiver(const Receiver&) = delete;
    Receiver& operator=(const Receiver&) = delete;
    ~Receiver() {
        for (int rank = 1; rank < link_.ranks(); ++rank)
            while (left_[static_cast<std::size_t>(rank)] > 0) next(rank);
    }

    /// Writes what a rank sends next. A rank that has given up tells all why.
    void write(int rank, std::int64_t bytes, std::ostream& out) {
        while (bytes > 0 && left_[static_cast<std::size_t>(rank)] > 0) {
            const int size = next(rank);
            out.write(piece_.data(), size);
            bytes -= size;
        }
    }

   private:
    /// Receives one piece. Where that fails, nothing more comes.
    int next(int rank) {
        std::int64_t& left = left_[static_cast<std::size_t>(rank)];
        MPI_Status status;
        int size = 0;
        if (MPI_Recv(piece_.data(), piece_bytes, MPI_CHAR, rank, 0, link_.communicator(), &status) != MPI_SUCCESS ||
            MPI_Get_count(&status, MPI_CHAR, &size) != MPI_SUCCESS)
            abort_all_ranks("MPI_Recv failed", failed);
        left = size > 0 ? left - size : 0;
        return size;
    }

    RankLink& link_;
    std::vector<char>& piece_;
    std::vector<std::int64_t>& left_;
};

void send(RankLink& link, const RankText& text, std::vector<char>& piece) {
    Sender sender(link.communicator(), piece);
    try {
        std::ostream out(&sender);
        for (const auto& section : text) {
            section(out);
            out.flush();
        }
        if (!out) throw Error(ErrorCode::communication, "MPI_Send failed");
    } catch (...) {
        sender.give_up();
        throw;
    }
}

/// On rank 0 to(write) calls write(stream).
template <class To>
void through_first(RankLink& link, const RankText& text, const Places& places, To to) {
    std::vector<char> piece;
    std::vector<std::int64_t> left;
    link.agree([&] {
        piece.resize(piece_bytes);
        left.resize(static_cast<std::size_t>(link.ranks()), 0);
    });
    link.agree([&] {
        if (!link.is_first()) return send(link, text, piece);
        Receiver receiver(link, places, text.size(), piece, left);
        to([&](std::ostream& out) {
            for (std::size_t section = 0; section < text.size(); ++section) {
                text[section](out);
                for (int rank = 1; rank < link.ranks(); ++rank) receiver.write(rank, places.bytes(section, rank), out);
            }
        });
    });
}

/// A descriptor of its own for a file that rank 0 has made.
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
    void write(const RankText& text, const Places& places, int rank, const std::string& target) {
        io::FileBuffer buffer(descriptor_);
        std::ostream out(&buffer);
        for (std::size_t section = 0; section < text.size() && !buffer.reason(); ++section) {
            if (::lseek(descriptor_, static_cast<off_t>(places.begin(section, rank)), SEEK_SET) < 0) buffer.fail(errno);
            text[section](out);
            out.flush();
        }
        if (::close(std::exchange(descriptor_, -1)) != 0 && !buffer.reason()) buffer.fail(errno);
        if (const int reason = buffer.reason())
            throw Error(ErrorCode::file, "cannot write " + target + ": " + std::generic_category().message(reason),
                        Element::none, -1, 0, reason);
    }

   private:
    int descriptor_;
};

}  // namespace

void write_text(RankLink& link, const std::string& path, const RankText& text) {
    const Places places(link, text);
    std::optional<io::AtomicFile> file;  // rank 0's
    std::string temporary;
    link.agree([&] {
        if (!link.is_first()) return;
        file.emplace(path);
        temporary = file->temporary().string();
    });
    temporary = link.text_of_first(temporary);
    Opened opened(temporary);
    if (link.least(!temporary.empty() && opened.is_open()))
        link.agree([&] { opened.write(text, places, link.rank(), path); });
    else
        through_first(link, text, places, [&](const auto& write) { write(file->stream()); });
    link.agree([&] {
        if (file) file->commit();
    });
}

void print_text(RankLink& link, const RankText& text) {
    through_first(link, text, Places(link, text), [](const auto& write) { to_standard_output(write); });
}

}  // namespace crumple::cli
