#pragma once

// A file of rows that all have the same length: any range of them is read, in pieces, without the rest.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace crumple::io {

class RowFile {
   public:
    /// A file that cannot be opened, or that is none of a known size, is not open.
    explicit RowFile(const std::filesystem::path& path);
    RowFile(const RowFile&) = delete;
    RowFile& operator=(const RowFile&) = delete;
    ~RowFile();

    bool is_open() const { return descriptor_ >= 0; }
    std::int64_t size() const { return size_; }
    const std::string& name() const { return name_; }

    /// The bytes from here on, at most so many. Throws Error (file).
    std::vector<char> read(std::int64_t offset, std::int64_t bytes) const;

    /// Calls f(row, offset of the row) for `count` rows that begin at an offset, until one returns false; whether none
    /// has. Throws Error (file).
    template <class F>
    bool for_each(std::int64_t offset, std::int64_t row_bytes, std::int64_t count, F f) const {
        const std::int64_t most = std::max<std::int64_t>(1, piece_bytes / std::max<std::int64_t>(1, row_bytes));
        for (std::int64_t first = 0; first < count; first += most) {
            const std::int64_t rows = std::min(most, count - first);
            const std::int64_t place = offset + first * row_bytes;
            const std::vector<char> piece = read(place, rows * row_bytes);
            for (std::int64_t i = 0; i < rows; ++i)
                if (!f(piece.data() + i * row_bytes, place + i * row_bytes)) return false;
        }
        return true;
    }

    /// Throws Error (format): "NAME, byte 4711: WHAT".
    [[noreturn]] void fail_at(std::int64_t byte, const std::string& what) const;

   private:
    static constexpr std::int64_t piece_bytes = std::int64_t{1} << 22;

    std::string name_;
    int descriptor_ = -1;
    std::int64_t size_ = 0;
};

}  // namespace crumple::io
