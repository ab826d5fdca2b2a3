#pragma once

// File of rows of equal length: reads any range of rows, in pieces, without reading the rest.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace crumple::io {

class RowFile {
   public:
    /// Opens the file; is_open() is false if it cannot be opened or has no known size.
    explicit RowFile(const std::filesystem::path& path);

    bool is_open() const { return in_.is_open(); }
    std::int64_t size() const { return size_; }
    const std::string& name() const { return name_; }

    /// Returns the `bytes` bytes that begin at this offset, or fewer at the end of the file. Throws Error (file).
    std::vector<char> read(std::int64_t offset, std::int64_t bytes);

    /// Calls f(row, offset of the row) for `count` consecutive rows, the first of which begins at `offset`. Stops and
    /// returns false when f returns false; else returns true. All offsets are in bytes. Throws Error (file).
    template <class F>
    bool for_each(std::int64_t offset, std::int64_t row_bytes, std::int64_t count, F f) {
        constexpr std::int64_t piece_bytes = std::int64_t{1} << 22;
        const std::int64_t most = std::max<std::int64_t>(1, piece_bytes / std::max<std::int64_t>(1, row_bytes));
        for (std::int64_t first = 0; first < count; first += most) {
            const std::int64_t place = offset + first * row_bytes, rows = std::min(most, count - first);
            const std::vector<char> piece = read(place, rows * row_bytes);
            for (std::int64_t i = 0; i < rows; ++i)
                if (!f(piece.data() + i * row_bytes, place + i * row_bytes)) return false;
        }
        return true;
    }

    /// Throws Error (format): "NAME, byte 4711: WHAT".
    [[noreturn]] void fail_at(std::int64_t byte, const std::string& what) const;

   private:
    std::string name_;
    std::ifstream in_;
    std::int64_t size_ = 0;
};

}  // namespace crumple::io
