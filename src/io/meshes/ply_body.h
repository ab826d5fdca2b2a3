#pragma once

// Readers of the rows of a PLY file, value by value: one interface for both binary byte orders and for text. Errors
// name the byte, or the line.

#include <cmath>

#include "io/bytes/bytes.h"
#include "io/bytes/text.h"
#include "io/meshes/ply_header.h"

namespace crumple::io {

class BinaryBody {
   public:
    BinaryBody(const Source& source, const PlyHeader& header)
        : source_(source),
          byte_order_(header.encoding == PlyEncoding::big_endian ? std::endian::big : std::endian::little),
          p_(header.body) {}

    /// Returns the least number of bytes that a value takes.
    static std::int64_t least_size(PlyType type) {
        return with_type(type, [](auto zero) { return static_cast<std::int64_t>(sizeof zero); });
    }
    std::int64_t remaining() const { return source_.end() - p_; }
    const char* position() const { return p_; }

    std::int64_t integer(PlyType type) {
        return with_type(type, [&](auto zero) { return static_cast<std::int64_t>(next<decltype(zero)>()); });
    }
    template <class Scalar>
    Scalar real(PlyType type) {
        const char* const place = p_;
        const auto value = with_type(type, [&](auto zero) { return static_cast<Scalar>(next<decltype(zero)>()); });
        if (!std::isfinite(value))
            fail(place,
                 std::is_same_v<Scalar, float> ? "a coordinate is not a finite float32" : "a coordinate is not finite");
        return value;
    }
    void skip(PlyType type, std::int64_t count) {
        if (count > remaining() / least_size(type)) fail(p_, "the file ends here");
        p_ += count * least_size(type);
    }

    [[noreturn]] void fail(const char* place, const std::string& what) const { source_.fail_at_byte(place, what); }

   private:
    template <class T>
    T next() {
        if (remaining() < static_cast<std::int64_t>(sizeof(T))) fail(p_, "the file ends here");
        const T value = load<T>(p_, byte_order_);
        p_ += sizeof(T);
        return value;
    }

    const Source& source_;
    std::endian byte_order_;
    const char* p_;
};

class AsciiBody {
   public:
    AsciiBody(const Source& source, const PlyHeader& header) : in_(source, {}, header.body) {}

    static std::int64_t least_size(PlyType) { return 2; }  // at least a digit and a blank
    std::int64_t remaining() const {
        return static_cast<std::int64_t>(in_.remaining()) + 1;
    }  // the last value needs no blank
    const char* position() {
        in_.finished();
        return in_.position();
    }

    std::int64_t integer(PlyType) { return in_.integer(); }
    template <class Scalar>
    Scalar real(PlyType) {
        return in_.real<Scalar>();
    }
    void skip(PlyType, std::int64_t count) {
        for (std::int64_t i = 0; i < count; ++i) in_.word("a value");
    }

    [[noreturn]] void fail(const char* place, const std::string& what) const { in_.fail(place, what); }

   private:
    Scanner in_;
};

}  // namespace crumple::io
