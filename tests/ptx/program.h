#pragma once

// PTX, NVIDIA's assembly language, as a program that the CPU runs: one thread, whose registers and memory are the
// host's. The text is what nvcc makes of the shipped kernels, so a fault of its optimizer shows without a device
// (docs/nvcc_13_0.md). Reference: "Parallel Thread Execution ISA", version 9.0, NVIDIA.
//
// Every PTX register is stored in a 64-bit slot; narrower values occupy its low bits, and the others are 0. A
// function's frame is
//
//     slots    constants | addresses of its memory | registers
//     memory   parameters, result, local arrays, parameters and results of its calls
//
// Constants occupy slots, too, so a decoded instruction needs only a pointer to a host function and indices of slots.

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace crumple::ptx {

/// Thrown for PTX that the interpreter does not support, and for illegal operations of a thread.
struct Failure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Thread;
struct Function;

struct Instruction {
    static constexpr std::uint32_t always = ~0u;

    void (*run)(Thread&, const Instruction&) = nullptr;
    std::uint32_t slot[6] = {};    ///< operands from left to right; each element of a vector has its own slot
    std::uint32_t guard = always;  ///< slot of the predicate
    bool guard_is_negated = false;
    unsigned register_bytes = 8;  ///< width of the first operand's register, to which loads extend
    std::int64_t number = 0;      ///< offset of an address, target of a branch, or index in `calls` of a call
};

/// A piece of a frame's memory.
struct Piece {
    std::size_t begin = 0, bytes = 0;
};

struct Call {
    const Function* callee = nullptr;
    std::vector<Piece> arguments;
    Piece result;
};

struct Function {
    std::vector<std::uint64_t> constants;
    std::vector<std::pair<std::uint32_t, std::size_t>> addresses;  ///< slot, and place in the frame's memory
    std::size_t slots = 0, memory_bytes = 0;
    std::vector<Piece> parameters;
    Piece result;
    std::vector<Instruction> instructions;
    std::vector<Call> calls;
};

/// PTX of one translation unit, whose functions are decoded on first use.
class Program {
   public:
    explicit Program(std::string text);

    /// Returns the names of the kernels.
    std::vector<std::string> kernels() const;
    /// Returns the decoded function, which the program owns. Throws Failure if it, or a function that it calls, is
    /// missing or contains an unknown instruction.
    const Function& function(std::string_view name);

   private:
    friend class Decoder;

    struct Source {
        std::string_view head, body;  ///< parameters and result; what lies between the braces
        bool kernel;
    };
    void add_global(std::string_view declaration);

    std::string text_;
    std::map<std::string, Source, std::less<>> sources_;
    std::map<std::string, std::unique_ptr<std::byte[]>, std::less<>> globals_;
    std::map<std::string, std::unique_ptr<Function>, std::less<>> functions_;
};

/// The thread that runs functions.
class Thread {
   public:
    Thread() : slot_stack_(std::size_t{1} << 20), memory_stack_(std::size_t{1} << 20) {}

    /// Runs a kernel as a grid of one thread. Each element of `arguments` points to the value of one parameter.
    void run(const Function& kernel, std::span<const void* const> arguments);
    /// Number of instructions that were run.
    std::uint64_t steps() const { return steps_; }

    // Members for instructions:
    std::uint64_t* slots = nullptr;      ///< slots of the current frame
    const Instruction* next = nullptr;   ///< null: the function returns
    const Instruction* first = nullptr;  ///< first instruction of `function`
    const Function* function = nullptr;
    void call(const Call& call);

   private:
    std::byte* enter(const Function& callee);
    void execute(const Function& callee);

    std::byte* memory_ = nullptr;  ///< memory of the current frame
    std::vector<std::uint64_t> slot_stack_, memory_stack_;
    std::size_t slots_used_ = 0, memory_used_ = 0;  ///< used elements of both stacks, 8 bytes each
    std::uint64_t steps_ = 0;
};

/// Returns the function that executes the named instruction, or null if it is unknown. Moves of vectors append the
/// lengths of their operands: "mov.b64:2,1".
using Run = void (*)(Thread&, const Instruction&);
Run find_instruction(const std::string& name);

}  // namespace crumple::ptx
