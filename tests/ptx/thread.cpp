#include <algorithm>
#include <cstring>
#include <tuple>

#include "ptx/program.h"

namespace crumple::ptx {
namespace {

// Fill pattern of new frames, since no program may rely on memory that it has not written.
constexpr std::uint64_t rubbish = 0xa5a5'f00d'a5a5'f00d;

}  // namespace

// Creates the callee's frame and returns its memory.
std::byte* Thread::enter(const Function& callee) {
    const std::size_t words = (callee.memory_bytes + 15) / 16 * 2;
    if (slots_used_ + callee.slots > slot_stack_.size() || memory_used_ + words + 2 > memory_stack_.size())
        throw Failure("PTX calls too deeply");
    slots = slot_stack_.data() + slots_used_;
    slots_used_ += callee.slots;
    std::uint64_t* memory = memory_stack_.data() + memory_used_;
    if (reinterpret_cast<std::uintptr_t>(memory) % 16 != 0) ++memory, ++memory_used_;
    memory_used_ += words;
    std::fill_n(memory, words, rubbish);
    std::ranges::copy(callee.constants, slots);
    std::fill(slots + callee.constants.size(), slots + callee.slots, rubbish);
    memory_ = reinterpret_cast<std::byte*>(memory);
    for (const auto& [slot, at] : callee.addresses) slots[slot] = reinterpret_cast<std::uintptr_t>(memory_ + at);
    return memory_;
}

void Thread::execute(const Function& callee) {
    function = &callee;
    first = next = callee.instructions.data();
    const Instruction* const end = first + callee.instructions.size();
    while (next && next != end) {
        const Instruction& i = *next++;
        ++steps_;
        if (i.guard != Instruction::always && ((slots[i.guard] & 1) != 0) == i.guard_is_negated) continue;
        i.run(*this, i);
    }
}

void Thread::call(const Call& call) {
    const auto caller = std::tuple(slots, next, first, function, memory_, slots_used_, memory_used_);
    const std::byte* const arguments = memory_;
    const std::byte* const memory = enter(*call.callee);
    for (std::size_t k = 0; k < call.arguments.size(); ++k)
        std::memcpy(memory_ + call.callee->parameters[k].begin, arguments + call.arguments[k].begin,
                    call.arguments[k].bytes);
    execute(*call.callee);
    std::tie(slots, next, first, function, memory_, slots_used_, memory_used_) = caller;
    std::memcpy(memory_ + call.result.begin, memory + call.callee->result.begin, call.result.bytes);
}

void Thread::run(const Function& kernel, std::span<const void* const> arguments) {
    if (arguments.size() != kernel.parameters.size()) throw Failure("a kernel has other parameters in PTX");
    slots_used_ = memory_used_ = 0;
    enter(kernel);
    for (std::size_t k = 0; k < arguments.size(); ++k)
        std::memcpy(memory_ + kernel.parameters[k].begin, arguments[k], kernel.parameters[k].bytes);
    execute(kernel);
}

}  // namespace crumple::ptx
