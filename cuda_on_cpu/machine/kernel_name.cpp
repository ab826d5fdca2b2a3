#include "cuda_on_cpu/machine/kernel_name.h"

#include <cxxabi.h>
#include <elf.h>
#include <link.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

namespace cuda_on_cpu {
namespace {

/// Returns the difference between the addresses of the executable in memory and in its file.
std::uintptr_t load_address() {
    std::uintptr_t result = 0;
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* out) {
            *static_cast<std::uintptr_t*>(out) = info->dlpi_addr;
            return 1;  // the first object is the executable
        },
        &result);
    return result;
}

template <class T>
T read(const std::vector<char>& file, std::size_t offset) {
    T value{};
    if (offset <= file.size() && sizeof(T) <= file.size() - offset)
        std::memcpy(&value, file.data() + offset, sizeof(T));
    return value;
}

/// Returns the mangled names of the executable's functions by address in memory.
std::map<std::uintptr_t, std::string> read_symbols() {
    std::ifstream stream("/proc/self/exe", std::ios::binary);
    const std::vector<char> file{std::istreambuf_iterator<char>(stream), {}};
    const std::uintptr_t base = load_address();
    std::map<std::uintptr_t, std::string> names;
    const auto header = read<ElfW(Ehdr)>(file, 0);
    const auto section = [&](std::size_t i) { return read<ElfW(Shdr)>(file, header.e_shoff + i * sizeof(ElfW(Shdr))); };
    for (std::size_t s = 0; s < header.e_shnum; ++s) {
        const ElfW(Shdr) symbols = section(s);
        if (symbols.sh_type != SHT_SYMTAB) continue;
        const std::size_t text = section(symbols.sh_link).sh_offset;
        for (std::size_t at = 0; at < symbols.sh_size; at += sizeof(ElfW(Sym))) {
            const auto symbol = read<ElfW(Sym)>(file, symbols.sh_offset + at);
            if (ELF64_ST_TYPE(symbol.st_info) == STT_FUNC && text + symbol.st_name < file.size())
                names[base + symbol.st_value] = file.data() + text + symbol.st_name;
        }
    }
    return names;
}

/// Drops a return type, namespaces, template arguments and parameters.
std::string shortened(std::string name) {
    const std::string anonymous = "(anonymous namespace)::";
    for (std::size_t at; (at = name.find(anonymous)) != std::string::npos;) name.erase(at, anonymous.size());
    name.resize(std::min(name.find_first_of("<("), name.size()));
    const std::size_t begin = name.find_last_of(": ");
    return begin == std::string::npos ? name : name.substr(begin + 1);
}

}  // namespace

std::string kernel_name(const void* function) {
    static const std::map<std::uintptr_t, std::string> names = read_symbols();
    const auto found = names.find(reinterpret_cast<std::uintptr_t>(function));
    if (found == names.end()) {
        char text[32];
        std::snprintf(text, sizeof text, "%p", function);
        return text;
    }
    int status = 0;
    char* demangled = abi::__cxa_demangle(found->second.c_str(), nullptr, nullptr, &status);
    const std::string name = demangled ? demangled : found->second;
    std::free(demangled);
    return shortened(name);
}

}  // namespace cuda_on_cpu
