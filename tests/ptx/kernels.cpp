#include "ptx/kernels.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "ptx/kernel_name.h"

namespace crumple::ptx {

std::string read_ptx(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Failure("cannot read " + path);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::size_t begin = bytes.find(".version ");
    if (begin == bytes.npos) throw Failure("no PTX in " + path);
    return bytes.substr(begin, bytes.find('\0', begin) - begin);
}

Kernels::Kernels(const std::vector<std::string>& files, const std::vector<std::string>& words) {
    for (const std::string& file : files) {
        programs_.push_back(std::make_unique<Program>(read_ptx(file)));
        for (const std::string& name : programs_.back()->kernels()) {
            const auto is_in_name = [&](const std::string& word) { return name.find(word) != name.npos; };
            if (std::ranges::none_of(words, is_in_name)) continue;
            functions_[without_file(name)] = &programs_.back()->function(name);
            launches[without_file(name)] = 0;
        }
    }
}

bool Kernels::run(const cuda_on_cpu::Kernel& launch) {
    const std::string name = without_file(symbol_at(launch.function));
    const auto found = functions_.find(name);
    if (found == functions_.end()) return false;
    ++launches[name];
    thread_.run(*found->second, launch.parameters);
    return true;
}

}  // namespace crumple::ptx
