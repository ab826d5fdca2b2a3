// Reads poses of bodies, configuration by configuration, from text or from NumPy.

#include <cmath>
#include <optional>

#include "base/float_environment.h"
#include "crumple/error.h"
#include "io/bytes/npy.h"
#include "io/bytes/text.h"
#include "io/formats.h"

namespace crumple::io {

namespace {

constexpr std::size_t row_numbers = 12, square_numbers = 16;

/// Collector of poses, one row of numbers per pose. Rows are in the order of the bodies; each set of rows for all
/// bodies is a configuration.
class Poses {
   public:
    Poses(const Source& source, std::span<const std::string> bodies) : source_(source), bodies_(bodies) {}

    /// Adds a pose of 12 numbers, or of 16 that end with 0 0 0 1. `line`: place of the numbers in a text file, for
    /// messages; null for other files.
    void add(std::span<const double> numbers, const char* line) {
        if (numbers.size() != row_numbers && numbers.size() != square_numbers)
            fail(line, "a pose must have 12 or 16 numbers, not " + std::to_string(numbers.size()));
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (std::isfinite(numbers[i])) continue;
            fail(line, "number " + std::to_string(i + 1) + " is not finite");
        }
        if (numbers.size() == square_numbers &&
            (numbers[12] != 0 || numbers[13] != 0 || numbers[14] != 0 || numbers[15] != 1))
            fail(line, "a pose of 16 numbers must end with 0 0 0 1");
        Pose pose;
        std::copy_n(numbers.begin(), row_numbers, pose.rows.begin());
        poses_.push_back(pose);
    }

    std::vector<Pose> take() {
        const std::size_t left = bodies_.empty() ? poses_.size() : poses_.size() % bodies_.size();
        if (left)
            throw Error(ErrorCode::format, source_.name() + ": " + std::to_string(poses_.size()) + " rows for " +
                                               std::to_string(bodies_.size()) + " bodies: the last configuration has " +
                                               std::to_string(left));
        return std::move(poses_);
    }

   private:
    [[noreturn]] void fail(const char* line, const std::string& what) const {
        std::string row = "row " + std::to_string(poses_.size());
        if (!bodies_.empty())
            row += " (configuration " + std::to_string(poses_.size() / bodies_.size()) + ", body " +
                   in_quotes(bodies_[poses_.size() % bodies_.size()]) + ")";
        if (line) source_.fail_at_line(line, row + ": " + what);
        throw Error(ErrorCode::format, source_.name() + ": " + row + ": " + what);
    }

    const Source& source_;
    std::span<const std::string> bodies_;
    std::vector<Pose> poses_;
};

/// Reads one pose per line, with commas or blanks between numbers. The first line may be a heading.
std::vector<Pose> read_text(const Source& source, std::span<const std::string> bodies) {
    Poses poses(source, bodies);
    Scanner in(source, {.lines = true, .comments = true});
    std::vector<double> numbers;
    std::string words;
    for (bool first = true; in.next_line_with_items(); in.skip_line(), first = false) {
        const char* const line = in.position();
        numbers.clear();
        bool title = false;
        while (!title && !in.finished()) {
            words = in.word();
            for (std::size_t begin = 0, end; begin <= words.size(); begin = end + 1) {
                end = std::min(words.find(',', begin), words.size());
                const std::string word = words.substr(begin, end - begin);
                if (word.empty()) continue;
                const auto number = number_of(word);
                title = first && numbers.empty() && !number;
                if (title) break;
                if (!number) source.fail_at_line(line, in_quotes(word) + " is not a number");
                numbers.push_back(*number);
            }
        }
        if (!title) poses.add(numbers, line);
    }
    return poses.take();
}

template <class Scalar>
std::vector<Pose> poses_of(const std::string& bytes, std::size_t width, std::endian order, Poses&& poses) {
    std::vector<double> numbers(width);
    for (std::size_t begin = 0; begin < bytes.size(); begin += width * sizeof(Scalar)) {
        for (std::size_t i = 0; i < width; ++i)
            numbers[i] = static_cast<double>(load<Scalar>(bytes.data() + begin + i * sizeof(Scalar), order));
        poses.add(numbers, nullptr);
    }
    return poses.take();
}

[[noreturn]] void fail(const Source& source, const char* what) {
    throw Error(ErrorCode::format, source.name() + ": " + what);
}

/// Reads an array of shape (..., 12), (..., 3, 4), (..., 16) or (..., 4, 4), float32 or float64.
std::vector<Pose> read_npy(const Source& source, std::span<const std::string> bodies) {
    NpyFile npy(source);
    const std::optional<NpyHeader> header = read_npy_header(npy);
    if (!header) fail(source, "this is not a NumPy array");
    const auto& shape = header->shape;
    const std::int64_t last = shape.empty() ? 0 : shape.back(), before = shape.size() < 2 ? 0 : shape[shape.size() - 2];
    const std::size_t width = last == 12 || last == 16   ? static_cast<std::size_t>(last)
                              : last == 4 && before == 3 ? row_numbers
                              : last == 4 && before == 4 ? square_numbers
                                                         : 0;
    if (!width) fail(source, "the array's shape must end with 12, 16, (3, 4) or (4, 4)");
    const std::size_t size = header->kind == "f4" ? 4 : header->kind == "f8" ? 8 : 0;
    if (!size) fail(source, "the array must hold float32 or float64");
    if (header->by_column && shape.size() > 1)
        fail(source, "the array is in Fortran order; convert it with numpy.ascontiguousarray");
    const auto items = header->items();
    if (!items || *items > INT64_MAX / 16) fail(source, "the array is truncated");
    const std::string bytes = npy.read(static_cast<std::size_t>(*items) * size);
    if (!npy.at_end()) fail(source, "the array is longer than its header says");
    Poses poses(source, bodies);
    return size == 4 ? poses_of<float>(bytes, width, header->byte_order, std::move(poses))
                     : poses_of<double>(bytes, width, header->byte_order, std::move(poses));
}

std::vector<Pose> read(const Source& source, std::span<const std::string> bodies) {
    const FloatEnvironment environment;
    try {
        return extension_of(source.name()) == ".npy" ? read_npy(source, bodies) : read_text(source, bodies);
    } catch (const std::bad_alloc&) {
        throw Error(ErrorCode::file, "cannot read " + source.name() + ": its poses do not fit in memory");
    }
}

}  // namespace

std::vector<Pose> read_poses(const std::filesystem::path& path, std::span<const std::string> bodies) {
    return read(Source(path), bodies);
}

std::vector<Pose> read_poses(std::istream& in, const std::string& name, std::span<const std::string> bodies) {
    return read(Source(in, name), bodies);
}

}  // namespace crumple::io
