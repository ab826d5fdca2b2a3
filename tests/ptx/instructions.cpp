// Implementations of PTX instructions, by name: only those that the kernels use, each for all of its types.
//
// Compiled with -frounding-math, since some of them set the rounding mode.

#include <bit>
#include <cfenv>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <unordered_map>

#include "ptx/program.h"

namespace crumple::ptx {
namespace {

using Table = std::unordered_map<std::string, Run>;
using std::int16_t, std::int32_t, std::int64_t, std::int8_t, std::uint16_t, std::uint32_t, std::uint64_t, std::uint8_t;

template <class T>
T get(const Thread& t, std::uint32_t slot) {
    if constexpr (std::is_same_v<T, bool>) return (t.slots[slot] & 1) != 0;  // true is written as -1, too
    T value;
    std::memcpy(&value, &t.slots[slot], sizeof value);
    return value;
}
template <class T>
void put(Thread& t, std::uint32_t slot, T value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof value);
    t.slots[slot] = bits;
}

// Instructions d = f(a), d = f(a, b) and d = f(a, b, c), whose operands have one type.
template <class T, class F>
Run one(F) {
    return [](Thread& t, const Instruction& i) { put(t, i.slot[0], F{}(get<T>(t, i.slot[1]))); };
}
template <class T, class Second = T, class F>
Run two(F) {
    return [](Thread& t, const Instruction& i) {
        put(t, i.slot[0], F{}(get<T>(t, i.slot[1]), get<Second>(t, i.slot[2])));
    };
}
template <class T, class F>
Run three(F) {
    return [](Thread& t, const Instruction& i) {
        put(t, i.slot[0], F{}(get<T>(t, i.slot[1]), get<T>(t, i.slot[2]), get<T>(t, i.slot[3])));
    };
}

template <class T>
void move(Thread& t, const Instruction& i) {
    put(t, i.slot[0], get<T>(t, i.slot[1]));
}
template <class T>
void select(Thread& t, const Instruction& i) {
    put(t, i.slot[0], get<T>(t, i.slot[get<bool>(t, i.slot[3]) ? 1 : 2]));
}

// Returns the host address of a memory access. Throws if a device would report an error: for null pointers, and for
// addresses that are not a multiple of `alignment`, the size of the access.
std::byte* place(Thread& t, std::uint32_t slot, std::int64_t offset, std::size_t alignment) {
    const std::uint64_t address = t.slots[slot] + static_cast<std::uint64_t>(offset);
    if (address < 4096) throw Failure("PTX reads or writes through a null pointer");
    if (address % alignment != 0) throw Failure("PTX reads or writes at an address that is not aligned");
    return reinterpret_cast<std::byte*>(address);
}
template <class T, std::uint32_t n>
void load(Thread& t, const Instruction& i) {
    const std::byte* from = place(t, i.slot[n], i.number, n * sizeof(T));
    for (std::uint32_t k = 0; k < n; ++k) {
        T value;
        std::memcpy(&value, from + k * sizeof(T), sizeof(T));
        if constexpr (std::is_signed_v<T> && std::is_integral_v<T>) {
            const auto wide = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
            t.slots[i.slot[k]] = i.register_bytes < 8 ? wide & ((1ull << 8 * i.register_bytes) - 1) : wide;
        } else {
            put(t, i.slot[k], value);
        }
    }
}
template <class T, std::uint32_t n>
void store(Thread& t, const Instruction& i) {
    std::byte* to = place(t, i.slot[0], i.number, n * sizeof(T));
    for (std::uint32_t k = 0; k < n; ++k) {
        const T value = get<T>(t, i.slot[k + 1]);
        std::memcpy(to + k * sizeof(T), &value, sizeof(T));
    }
}
template <class T, class F>
T update(Thread& t, std::uint32_t address, std::uint32_t operand, std::int64_t offset) {
    std::byte* at = place(t, address, offset, sizeof(T));
    T before;
    std::memcpy(&before, at, sizeof(T));
    const T after = F{}(before, get<T>(t, operand));
    std::memcpy(at, &after, sizeof(T));
    return before;
}
template <class T, class F>
Run atomic(F) {
    return [](Thread& t, const Instruction& i) { put(t, i.slot[0], update<T, F>(t, i.slot[1], i.slot[2], i.number)); };
}
template <class T, class F>
Run reduce(F) {
    return [](Thread& t, const Instruction& i) { update<T, F>(t, i.slot[0], i.slot[1], i.number); };
}

// Runs arithmetic in the rounding mode of the instruction.
template <int mode, class Work>
auto rounded(Work work) {
    if constexpr (mode == FE_TONEAREST) return work();
    std::fesetround(mode);
    auto result = work();
    // Keeps the compiler from restoring the mode before the operation.
    if constexpr (std::is_same_v<decltype(result), double> || std::is_same_v<decltype(result), float>)
        asm volatile("" : "+x"(result));
    std::fesetround(FE_TONEAREST);
    return result;
}

template <class T, int mode>
void add_rounded(Table& table, const std::string& suffix) {
    table["add" + suffix] = two<T>([](T a, T b) { return rounded<mode>([&] { return a + b; }); });
    table["sub" + suffix] = two<T>([](T a, T b) { return rounded<mode>([&] { return a - b; }); });
    table["mul" + suffix] = two<T>([](T a, T b) { return rounded<mode>([&] { return a * b; }); });
    table["div" + suffix] = two<T>([](T a, T b) { return rounded<mode>([&] { return a / b; }); });
    table["fma" + suffix] = three<T>([](T a, T b, T c) { return rounded<mode>([&] { return std::fma(a, b, c); }); });
    table["sqrt" + suffix] = one<T>([](T a) { return rounded<mode>([&] { return std::sqrt(a); }); });
    table["rcp" + suffix] = one<T>([](T a) { return rounded<mode>([&] { return T{1} / a; }); });
}

// Returns the smaller operand: a number rather than NaN, and -0 before +0.
template <class T>
T smaller(T a, T b) {
    if (std::isnan(a) || std::isnan(b)) return std::isnan(a) ? b : a;
    return a < b || (a == b && std::signbit(a)) ? a : b;
}

template <class T>
void add_floating(Table& table, const std::string& type) {
    add_rounded<T, FE_TONEAREST>(table, ".rn." + type);
    add_rounded<T, FE_TOWARDZERO>(table, ".rz." + type);
    add_rounded<T, FE_DOWNWARD>(table, ".rm." + type);
    add_rounded<T, FE_UPWARD>(table, ".rp." + type);
    table["neg." + type] = one<T>([](T a) { return -a; });
    table["abs." + type] = one<T>([](T a) { return std::abs(a); });
    table["min." + type] = two<T>([](T a, T b) { return smaller(a, b); });
    table["max." + type] = two<T>([](T a, T b) { return -smaller(-a, -b); });
    table["setp.num." + type] = two<T>([](T a, T b) { return !std::isunordered(a, b); });
    table["setp.nan." + type] = two<T>([](T a, T b) { return std::isunordered(a, b); });
    table["setp.equ." + type] = two<T>([](T a, T b) { return std::isunordered(a, b) || a == b; });
    table["setp.neu." + type] = two<T>([](T a, T b) { return std::isunordered(a, b) || a != b; });
    table["setp.ltu." + type] = two<T>([](T a, T b) { return !(a >= b); });
    table["setp.leu." + type] = two<T>([](T a, T b) { return !(a > b); });
    table["setp.gtu." + type] = two<T>([](T a, T b) { return !(a <= b); });
    table["setp.geu." + type] = two<T>([](T a, T b) { return !(a < b); });
    table["setp.ne." + type] = two<T>([](T a, T b) { return a < b || a > b; });
    table["mov." + type] = move<T>;
    table["selp." + type] = select<T>;
}

template <class T>
void add_order(Table& table, const std::string& type) {
    table["setp.eq." + type] = two<T>([](T a, T b) { return a == b; });
    table["setp.lt." + type] = two<T>([](T a, T b) { return a < b; });
    table["setp.le." + type] = two<T>([](T a, T b) { return a <= b; });
    table["setp.gt." + type] = two<T>([](T a, T b) { return a > b; });
    table["setp.ge." + type] = two<T>([](T a, T b) { return a >= b; });
}

template <class T>
using Twice =
    std::conditional_t<sizeof(T) == 2, std::conditional_t<std::is_signed_v<T>, int32_t, uint32_t>,
                       std::conditional_t<sizeof(T) == 4, std::conditional_t<std::is_signed_v<T>, int64_t, uint64_t>,
                                          std::conditional_t<std::is_signed_v<T>, __int128, unsigned __int128>>>;

template <class T>
void add_integer(Table& table, const std::string& type) {
    using Bits = std::make_unsigned_t<T>;
    constexpr unsigned width = 8 * sizeof(T);
    add_order<T>(table, type);
    table["setp.ne." + type] = two<T>([](T a, T b) { return a != b; });
    table["mov." + type] = move<T>;
    table["selp." + type] = select<T>;
    table["add." + type] = two<Bits>([](Bits a, Bits b) { return static_cast<Bits>(a + b); });
    table["sub." + type] = two<Bits>([](Bits a, Bits b) { return static_cast<Bits>(a - b); });
    table["neg." + type] = one<Bits>([](Bits a) { return static_cast<Bits>(0 - a); });
    table["min." + type] = two<T>([](T a, T b) { return a < b ? a : b; });
    table["max." + type] = two<T>([](T a, T b) { return a > b ? a : b; });
    table["abs." + type] = one<T>([](T a) { return static_cast<T>(std::is_signed_v<T> && a < 0 ? 0 - a : a); });
    table["mul.lo." + type] = two<T>([](T a, T b) { return static_cast<T>(Twice<T>{a} * b); });
    table["mul.hi." + type] = two<T>([](T a, T b) { return static_cast<T>((Twice<T>{a} * b) >> width); });
    table["mad.lo." + type] = three<T>(
        [](T a, T b, T c) { return static_cast<Bits>(static_cast<Bits>(Twice<T>{a} * b) + static_cast<Bits>(c)); });
    if constexpr (width < 64) table["mul.wide." + type] = two<T>([](T a, T b) { return Twice<T>{a} * b; });
    table["div." + type] = two<T>([](T a, T b) { return static_cast<T>(b == 0 ? T(-1) : a / b); });
    table["rem." + type] = two<T>([](T a, T b) { return static_cast<T>(b == 0 ? a : a % b); });
    table["shr." + type] = two<T, uint32_t>([](T a, uint32_t n) {
        return static_cast<T>(n < width ? a >> n : a < 0 ? -1 : 0);
    });
    table["bfe." + type] = [](Thread& t, const Instruction& i) {  // a field, extended by its highest bit if signed
        const auto value = static_cast<uint64_t>(static_cast<int64_t>(get<T>(t, i.slot[1])));
        const auto begin = get<uint32_t>(t, i.slot[2]) & 255, length = get<uint32_t>(t, i.slot[3]) & 255;
        const uint32_t end = begin + length < width ? begin + length : width;
        if (begin >= width || length == 0) return put(t, i.slot[0], T{0});
        put(t, i.slot[0], static_cast<T>(static_cast<T>(value << (width - end)) >> (width - end + begin)));
    };
    table["atom.global.add." + type] = atomic<Bits>([](Bits a, Bits b) { return static_cast<Bits>(a + b); });
    table["atom.global.min." + type] = atomic<T>([](T a, T b) { return a < b ? a : b; });
    table["red.global.add." + type] = reduce<Bits>([](Bits a, Bits b) { return static_cast<Bits>(a + b); });
}

template <class T>
void add_bits(Table& table, const std::string& type) {
    constexpr unsigned width = 8 * sizeof(T);
    table["mov." + type] = move<T>;
    table["selp." + type] = select<T>;
    table["setp.eq." + type] = two<T>([](T a, T b) { return a == b; });
    table["setp.ne." + type] = two<T>([](T a, T b) { return a != b; });
    table["and." + type] = two<T>([](T a, T b) { return static_cast<T>(a & b); });
    table["or." + type] = two<T>([](T a, T b) { return static_cast<T>(a | b); });
    table["xor." + type] = two<T>([](T a, T b) { return static_cast<T>(a ^ b); });
    table["not." + type] = one<T>([](T a) { return static_cast<T>(~a); });
    table["shl." + type] =
        two<T, uint32_t>([](T a, uint32_t n) { return static_cast<T>(n < width ? uint64_t{a} << n : 0); });
    table["popc." + type] = one<T>([](T a) { return static_cast<uint32_t>(std::popcount(a)); });
    table["clz." + type] = one<T>([](T a) { return static_cast<uint32_t>(std::countl_zero(a)); });
    table["atom.global.or." + type] = atomic<T>([](T a, T b) { return static_cast<T>(a | b); });
    table["bfi." + type] = [](Thread& t, const Instruction& i) {
        const auto begin = get<uint32_t>(t, i.slot[3]) & 255, length = get<uint32_t>(t, i.slot[4]) & 255;
        const uint64_t ones = length >= width ? ~0ull : (1ull << length) - 1;
        const uint64_t mask = begin >= width ? 0 : ones << begin;
        const uint64_t from = begin >= width ? 0 : uint64_t{get<T>(t, i.slot[1])} << begin;
        put(t, i.slot[0], static_cast<T>((from & mask) | (uint64_t{get<T>(t, i.slot[2])} & ~mask)));
    };
}

template <class T>
void add_memory(Table& table, const std::string& type) {
    table["ld." + type] = load<T, 1>;
    table["ld.v2." + type] = load<T, 2>;
    table["ld.v4." + type] = load<T, 4>;
    table["st." + type] = store<T, 1>;
    table["st.v2." + type] = store<T, 2>;
    table["st.v4." + type] = store<T, 4>;
}

// Conversions. From one integer type to another, the result has the low bits, or is extended by the sign of the source.
// From floating-point numbers to integers, values out of range give the smallest or largest integer, and NaN gives 0.
template <class To, class From>
void convert(Thread& t, const Instruction& i) {
    if constexpr (std::is_signed_v<To>) {  // extends the sign up to the width of the register
        const auto wide = static_cast<uint64_t>(static_cast<int64_t>(static_cast<To>(get<From>(t, i.slot[1]))));
        t.slots[i.slot[0]] = i.register_bytes < 8 ? wide & ((1ull << 8 * i.register_bytes) - 1) : wide;
    } else {
        put(t, i.slot[0], static_cast<To>(get<From>(t, i.slot[1])));
    }
}
template <class To, class From, int mode>
void round_to(Thread& t, const Instruction& i) {
    const From value = get<From>(t, i.slot[1]);
    put(t, i.slot[0], rounded<mode>([&] { return static_cast<To>(value); }));
}
template <class To, class From>
void truncate_to(Thread& t, const Instruction& i) {
    const From value = get<From>(t, i.slot[1]);
    using Limits = std::numeric_limits<To>;
    const double wide = std::trunc(static_cast<double>(value));
    put(t, i.slot[0],
        std::isnan(wide)                             ? To{0}
        : wide <= static_cast<double>(Limits::min()) ? Limits::min()
        : wide >= static_cast<double>(Limits::max()) ? Limits::max()
                                                     : static_cast<To>(wide));
}
template <class To>
void add_conversions(Table& table, const std::string& to) {
    const auto from = [&]<class From>(From, const std::string& type) {
        if constexpr (std::is_integral_v<To> && std::is_integral_v<From>) {
            table["cvt." + to + "." + type] = convert<To, From>;
        } else if constexpr (std::is_integral_v<To>) {
            table["cvt.rzi." + to + "." + type] = truncate_to<To, From>;
        } else {
            if constexpr (sizeof(To) > sizeof(From) && !std::is_integral_v<From>)
                table["cvt." + to + "." + type] = round_to<To, From, FE_TONEAREST>;
            table["cvt.rn." + to + "." + type] = round_to<To, From, FE_TONEAREST>;
            table["cvt.rz." + to + "." + type] = round_to<To, From, FE_TOWARDZERO>;
            table["cvt.rm." + to + "." + type] = round_to<To, From, FE_DOWNWARD>;
            table["cvt.rp." + to + "." + type] = round_to<To, From, FE_UPWARD>;
        }
    };
    from(int8_t{}, "s8"), from(uint8_t{}, "u8"), from(int16_t{}, "s16"), from(uint16_t{}, "u16");
    from(int32_t{}, "s32"), from(uint32_t{}, "u32"), from(int64_t{}, "s64"), from(uint64_t{}, "u64");
    from(float{}, "f32"), from(double{}, "f64");
}

void permute_bytes(Thread& t, const Instruction& i) {
    const uint64_t bytes = uint64_t{get<uint32_t>(t, i.slot[2])} << 32 | get<uint32_t>(t, i.slot[1]);
    const uint32_t selector = get<uint32_t>(t, i.slot[3]);
    uint32_t result = 0;
    for (unsigned k = 0; k < 4; ++k) {
        const uint32_t nibble = selector >> 4 * k & 15;
        uint32_t byte = static_cast<uint32_t>(bytes >> 8 * (nibble & 7)) & 255;
        if (nibble & 8) byte = byte & 128 ? 255 : 0;  // repeats the sign bit of the byte
        result |= byte << 8 * k;
    }
    put(t, i.slot[0], result);
}

void branch(Thread& t, const Instruction& i) { t.next = t.first + i.number; }
void leave(Thread& t, const Instruction&) { t.next = nullptr; }
void call(Thread& t, const Instruction& i) { t.call(t.function->calls[static_cast<std::size_t>(i.number)]); }
void nothing(Thread&, const Instruction&) {}

// A warp has one lane, which sees only itself.
void add_warp(Table& table) {
    table["vote.sync.ballot.b32"] = [](Thread& t, const Instruction& i) {
        put(t, i.slot[0], static_cast<uint32_t>(get<bool>(t, i.slot[1])));
    };
    table["vote.sync.any.pred"] = table["vote.sync.all.pred"] = move<bool>;
    table["shfl.sync.idx.b32"] = [](Thread& t, const Instruction& i) {  // operands: value | predicate, source, ...
        put(t, i.slot[1], true);
        put(t, i.slot[0], get<uint32_t>(t, i.slot[2]));
    };
    table["bar.warp.sync"] = table["membar.cta"] = table["membar.gl"] = nothing;
}

Table make_table() {
    Table table;
    add_integer<int16_t>(table, "s16"), add_integer<uint16_t>(table, "u16");
    add_integer<int32_t>(table, "s32"), add_integer<uint32_t>(table, "u32");
    add_integer<int64_t>(table, "s64"), add_integer<uint64_t>(table, "u64");
    add_bits<uint16_t>(table, "b16"), add_bits<uint32_t>(table, "b32"), add_bits<uint64_t>(table, "b64");
    add_order<float>(table, "f32"), add_order<double>(table, "f64");
    add_floating<float>(table, "f32"), add_floating<double>(table, "f64");
    add_memory<int8_t>(table, "s8"), add_memory<int16_t>(table, "s16"), add_memory<int32_t>(table, "s32");
    add_memory<uint8_t>(table, "u8"), add_memory<uint16_t>(table, "u16"), add_memory<uint32_t>(table, "u32");
    add_memory<uint8_t>(table, "b8"), add_memory<uint16_t>(table, "b16"), add_memory<uint32_t>(table, "b32");
    add_memory<int64_t>(table, "s64"), add_memory<uint64_t>(table, "u64"), add_memory<uint64_t>(table, "b64");
    add_memory<float>(table, "f32"), add_memory<double>(table, "f64");
    add_conversions<int8_t>(table, "s8"), add_conversions<uint8_t>(table, "u8");
    add_conversions<int16_t>(table, "s16"), add_conversions<uint16_t>(table, "u16");
    add_conversions<int32_t>(table, "s32"), add_conversions<uint32_t>(table, "u32");
    add_conversions<int64_t>(table, "s64"), add_conversions<uint64_t>(table, "u64");
    add_conversions<float>(table, "f32"), add_conversions<double>(table, "f64");
    table["and.pred"] = two<bool>([](bool a, bool b) { return a && b; });
    table["or.pred"] = two<bool>([](bool a, bool b) { return a || b; });
    table["xor.pred"] = two<bool>([](bool a, bool b) { return a != b; });
    table["not.pred"] = one<bool>([](bool a) { return !a; });
    table["mov.pred"] = move<bool>;
    table["mov.b64:2,1"] = [](Thread& t, const Instruction& i) {
        const auto value = get<uint64_t>(t, i.slot[2]);
        put(t, i.slot[0], static_cast<uint32_t>(value));
        put(t, i.slot[1], static_cast<uint32_t>(value >> 32));
    };
    table["mov.b64:1,2"] = [](Thread& t, const Instruction& i) {
        put(t, i.slot[0], uint64_t{get<uint32_t>(t, i.slot[2])} << 32 | get<uint32_t>(t, i.slot[1]));
    };
    table["mov.b32:2,1"] = [](Thread& t, const Instruction& i) {
        const auto value = get<uint32_t>(t, i.slot[2]);
        put(t, i.slot[0], static_cast<uint16_t>(value));
        put(t, i.slot[1], static_cast<uint16_t>(value >> 16));
    };
    table["mov.b32:1,2"] = [](Thread& t, const Instruction& i) {
        put(t, i.slot[0], uint32_t{get<uint16_t>(t, i.slot[2])} << 16 | get<uint16_t>(t, i.slot[1]));
    };
    for (const char* name : {"cvta.local.u64", "cvta.global.u64", "cvta.to.local.u64", "cvta.to.global.u64"})
        table[name] = move<uint64_t>;
    table["prmt.b32"] = permute_bytes;
    table["brev.b32"] = [](Thread& t, const Instruction& i) {
        uint32_t bits = get<uint32_t>(t, i.slot[1]), reversed = 0;
        for (unsigned k = 0; k < 32; ++k, bits >>= 1) reversed = reversed << 1 | (bits & 1);
        put(t, i.slot[0], reversed);
    };
    table["bfind.shiftamt.u32"] = [](Thread& t, const Instruction& i) {
        const auto bits = get<uint32_t>(t, i.slot[1]);
        put(t, i.slot[0], bits ? static_cast<uint32_t>(std::countl_zero(bits)) : ~uint32_t{0});
    };
    add_warp(table);
    table["bra"] = branch;
    table["call"] = call;
    table["ret"] = table["exit"] = leave;
    return table;
}

}  // namespace

Run find_instruction(const std::string& name) {
    static const Table table = make_table();
    const auto found = table.find(name);
    return found == table.end() ? nullptr : found->second;
}

}  // namespace crumple::ptx
