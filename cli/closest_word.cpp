#include "cli/closest_word.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace crumple::cli {
namespace {

/// Returns how many edits turn one word into the other, where an edit adds, removes or changes a letter, or swaps two
/// neighbouring letters. Ignores case.
std::size_t distance(const std::string& a, const std::string& b) {
    const auto letter = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> table((a.size() + 1) * width);
    const auto at = [&](std::size_t i, std::size_t k) -> std::size_t& { return table[i * width + k]; };
    for (std::size_t i = 0; i <= a.size(); ++i) at(i, 0) = i;
    for (std::size_t k = 0; k <= b.size(); ++k) at(0, k) = k;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t k = 1; k <= b.size(); ++k) {
            const std::size_t changed = at(i - 1, k - 1) + (letter(a[i - 1]) != letter(b[k - 1]));
            at(i, k) = std::min({changed, at(i - 1, k) + 1, at(i, k - 1) + 1});
            const bool swapped =
                i > 1 && k > 1 && letter(a[i - 1]) == letter(b[k - 2]) && letter(a[i - 2]) == letter(b[k - 1]);
            if (swapped) at(i, k) = std::min(at(i, k), at(i - 2, k - 2) + 1);
        }
    }
    return table.back();
}

}  // namespace

const std::string* nearest(const std::string& word, std::span<const std::string> known) {
    constexpr std::size_t longest = 200;  // the work grows with the product of the lengths
    const std::string* found = nullptr;
    std::size_t least = word.size() / 3 + 1;
    for (const std::string& candidate : known) {
        const std::size_t size = candidate.size();
        const bool begins = word.size() > 2 && candidate.starts_with(word);
        if (!begins && (word.size() > longest || size >= word.size() + least || size + least <= word.size())) continue;
        const std::size_t d = begins ? 1 : distance(word, candidate);
        if (d >= least) continue;
        least = d;
        found = &candidate;
    }
    return found;
}

}  // namespace crumple::cli
