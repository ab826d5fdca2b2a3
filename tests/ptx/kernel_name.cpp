#include "ptx/kernel_name.h"

#include <elf.h>
#include <link.h>

#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <vector>

namespace crumple::ptx {
namespace {

// Returns names of functions by their addresses in the file. Kernels are local symbols, which dladdr() does not find.
std::map<std::uintptr_t, std::string> read_symbols() {
    std::ifstream file("/proc/self/exe", std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    const auto read = [&]<class T>(std::size_t at, T& value) { std::memcpy(&value, bytes.data() + at, sizeof value); };
    const auto section = [&](const Elf64_Ehdr& head, std::size_t i) {
        Elf64_Shdr found;
        read(head.e_shoff + i * head.e_shentsize, found);
        return found;
    };
    std::map<std::uintptr_t, std::string> symbols;
    Elf64_Ehdr head;
    read(0, head);
    for (std::size_t i = 0; i < head.e_shnum; ++i) {
        const Elf64_Shdr table = section(head, i);
        if (table.sh_type != SHT_SYMTAB) continue;
        const Elf64_Shdr names = section(head, table.sh_link);
        for (std::size_t at = table.sh_offset; at < table.sh_offset + table.sh_size; at += sizeof(Elf64_Sym)) {
            Elf64_Sym symbol;
            read(at, symbol);
            if (ELF64_ST_TYPE(symbol.st_info) == STT_FUNC)
                symbols.emplace(symbol.st_value, bytes.data() + names.sh_offset + symbol.st_name);
        }
    }
    return symbols;
}

std::uintptr_t load_address() {
    std::uintptr_t address = 0;
    dl_iterate_phdr(
        [](dl_phdr_info* program, std::size_t, void* result) {
            *static_cast<std::uintptr_t*>(result) = program->dlpi_addr;
            return 1;  // the first one is this program
        },
        &address);
    return address;
}

}  // namespace

std::string symbol_at(const void* address) {
    static const std::map<std::uintptr_t, std::string> symbols = read_symbols();
    static const std::uintptr_t base = load_address();
    const auto found = symbols.find(reinterpret_cast<std::uintptr_t>(address) - base);
    return found == symbols.end() ? std::string() : found->second;
}

// A name within a namespace is mangled as its length and its letters: "12_GLOBAL__N_1".
std::string without_file(std::string name) {
    const std::size_t begin = name.find("_GLOBAL__N_");
    if (begin == name.npos) return name;
    std::size_t digits = begin;
    while (digits > 0 && std::isdigit(static_cast<unsigned char>(name[digits - 1]))) --digits;
    const std::size_t length = std::stoul(name.substr(digits, begin - digits));
    return name.replace(digits, begin - digits + length, "12_GLOBAL__N_1");
}

}  // namespace crumple::ptx
