// Custom mutator: a quarter of the mutations replace, delete or insert a line or a word of the text; a number at a
// limit of the readers may replace a word. The other mutations are those of libFuzzer.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

namespace {

using Random = std::minstd_rand;

constexpr std::size_t head = 2;  ///< bytes before the file: its kind and options

constexpr std::string_view numbers[] = {
    "0",
    "-0",
    "1",
    "-1",
    "2",
    "3",
    "4",
    "255",
    "1e308",
    "1e309",
    "1e-45",
    "4.9e-324",
    "1e-400",
    "3.4028235e38",
    "3.4028236e38",
    "-1e39",
    "nan",
    "inf",
    "-inf",
    "2147483647",
    "2147483648",
    "4294967295",
    "-2147483648",
    "9223372036854775807",
    "9223372036854775808",
    "18446744073709551616",
    "0.1",
    ".5",
    "5.",
    "+1",
    "+-1",
    "1e",
    "1e+99999999999999999999",
    "0x10",
    "1/2/3",
    "-1//-1",
};

std::size_t below(Random& random, std::size_t n) { return random() % n; }

/// Returns the nonempty items between separators.
std::vector<std::string_view> items_of(std::string_view text, std::string_view separators) {
    std::vector<std::string_view> items;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
        if (end > begin) items.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    return items;
}

std::string mutated(std::string_view text, Random& random) {
    const bool of_words = random() % 2;
    const auto items = items_of(text, of_words ? " \t\r\n,[]:" : "\n");
    if (items.empty()) return std::string(text);
    const std::string_view item = items[below(random, items.size())], other = items[below(random, items.size())];
    const auto place = static_cast<std::size_t>(item.data() - text.data());
    std::string result(text);
    switch (random() % 4) {
        case 0:
            return result.replace(place, item.size(), of_words ? numbers[below(random, std::size(numbers))] : other);
        case 1:
            return result.replace(place, item.size(), other);
        case 2:
            return result.erase(place, item.size() + (place + item.size() < text.size()));
        default:
            return result.insert(place, std::string(other) + (of_words ? ' ' : '\n'));
    }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    Random random(seed);
    if (size <= head || random() % 4 != 0) return LLVMFuzzerMutate(data, size, max_size);
    const std::string result = mutated({reinterpret_cast<const char*>(data) + head, size - head}, random);
    const std::size_t length = std::min(result.size(), max_size - head);
    std::memcpy(data + head, result.data(), length);
    return head + length;
}
