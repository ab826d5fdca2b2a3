// Decodes PTX.

#include "ptx/program.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>
#include <optional>

namespace crumple::ptx {
namespace {

std::string_view trimmed(std::string_view text) {
    const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)); };
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    int depth = 0;
    std::size_t begin = 0;
    for (std::size_t i = 0; i <= text.size(); ++i) {
        const char c = i < text.size() ? text[i] : separator;
        if (c == '{' || c == '[' || c == '(') ++depth;
        if (c == '}' || c == ']' || c == ')') --depth;
        if (i < text.size() && (c != separator || depth > 0)) continue;
        if (const std::string_view part = trimmed(text.substr(begin, i - begin)); !part.empty()) parts.push_back(part);
        begin = i + 1;
    }
    return parts;
}

std::vector<std::string_view> words(std::string_view text) {
    std::vector<std::string_view> found;
    for (std::size_t begin = 0; (begin = text.find_first_not_of(" \t\r\n", begin)) != text.npos;) {
        const std::size_t end = std::min(text.find_first_of(" \t\r\n", begin), text.size());
        found.push_back(text.substr(begin, end - begin));
        begin = end;
    }
    return found;
}

// Returns the text without comments and without line information for debuggers.
std::string without_comments(const std::string& text) {
    std::string kept;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string_view line = trimmed(std::string_view(text).substr(begin, end - begin));
        line = line.substr(0, line.find("//"));
        if (!line.starts_with(".loc ") && !line.starts_with(".loc\t") && !line.starts_with(".file"))
            kept.append(line).append("\n");
        begin = end + 1;
    }
    return kept;
}

std::uint64_t number(std::string_view text) {
    if (text.starts_with("0d") || text.starts_with("0f") || text.starts_with("0F") || text.starts_with("0D")) {
        std::uint64_t bits = 0;
        if (std::from_chars(text.data() + 2, text.data() + text.size(), bits, 16).ec == std::errc()) return bits;
    }
    const bool negative = text.starts_with("-");
    if (negative) text.remove_prefix(1);
    if (text.ends_with("U")) text.remove_suffix(1);
    const int base = text.starts_with("0x") ? 16 : 10;
    if (base == 16) text.remove_prefix(2);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
    if (error != std::errc() || end != text.data() + text.size())
        throw Failure("not a number in PTX: " + std::string(text));
    return negative ? 0 - value : value;
}

std::size_t bytes_of_type(std::string_view type) {
    if (type == "pred") return 1;
    return static_cast<std::size_t>(number(type.substr(1))) / 8;
}

/// Name and size of what a directive such as ".param .align 8 .b8 name[24]" declares.
struct Declared {
    std::string_view name, type;
    std::size_t bytes;
};
Declared declared(std::string_view directive) {
    const auto parts = words(directive);
    std::string_view name = parts.back(), type;
    for (const std::string_view part : parts)
        if (part.size() > 2 && part[0] == '.' && std::strchr("busf", part[1]) && std::isdigit(part[2]))
            type = part.substr(1);
    std::size_t count = 1;
    if (const std::size_t bracket = name.find('['); bracket != name.npos) {
        const std::string_view inside = name.substr(bracket + 1, name.size() - bracket - 2);
        count = inside.empty() ? 0 : static_cast<std::size_t>(number(inside));
        name = name.substr(0, bracket);
    }
    return {name, type, count * bytes_of_type(type)};
}

std::string_view in_brackets(std::string_view text, char open, char close) {
    const std::size_t begin = text.find(open), end = text.rfind(close);
    return begin == text.npos ? std::string_view() : text.substr(begin + 1, end - begin - 1);
}

}  // namespace

/// Decodes one function.
class Decoder {
   public:
    Decoder(Program& program, const Program::Source& source, Function& function)
        : program_(program), source_(source), f_(function) {}

    void decode() {
        declare_parameters();
        decode_body();
        // Registers follow the constants, whose number is known only now.
        const auto constants = static_cast<std::uint32_t>(f_.constants.size());
        const auto shift = [&](std::uint32_t& slot) {
            slot = slot >= first_register ? slot - first_register + constants : slot;
        };
        for (Instruction& instruction : f_.instructions) {
            for (std::uint32_t& slot : instruction.slot) shift(slot);
            if (instruction.guard != Instruction::always) shift(instruction.guard);
            if (const auto target = targets_.find(&instruction - f_.instructions.data()); target != targets_.end()) {
                const auto label = labels_.find(target->second);
                if (label == labels_.end()) throw Failure("no label " + target->second);
                instruction.number = label->second;
            }
        }
        for (auto& [slot, place] : f_.addresses) shift(slot);
        f_.slots = constants + registers_;
    }

   private:
    static constexpr std::uint32_t first_register = 1u << 24;  // provisional slot, until all constants are known

    std::uint32_t new_register() { return first_register + registers_++; }
    std::uint32_t constant(std::uint64_t bits) {
        const auto [found, is_new] = constants_.try_emplace(bits, static_cast<std::uint32_t>(f_.constants.size()));
        if (is_new) f_.constants.push_back(bits);
        return found->second;
    }

    Piece declare_memory(const Declared& d) {
        const Piece piece{(f_.memory_bytes + 15) / 16 * 16, d.bytes};
        f_.memory_bytes = piece.begin + piece.bytes;
        const std::uint32_t slot = new_register();
        f_.addresses.emplace_back(slot, piece.begin);
        names_[std::string(d.name)] = slot;
        pieces_[std::string(d.name)] = piece;
        return piece;
    }
    void declare_registers(std::string_view type, std::string_view list) {
        for (std::string_view name : split(list, ',')) {
            std::uint64_t count = 0;
            if (const std::size_t angle = name.find('<'); angle != name.npos) {
                count = number(name.substr(angle + 1, name.size() - angle - 2));
                name = name.substr(0, angle);
            }
            const auto declare = [&](const std::string& full) {
                names_[full] = new_register();
                register_bytes_[names_[full]] = static_cast<unsigned>(bytes_of_type(type));
            };
            if (count == 0) declare(std::string(name));
            for (std::uint64_t i = 0; i < count; ++i) declare(std::string(name) + std::to_string(i));
        }
    }
    // ".entry NAME(.param ..., ...)" or ".func (.param ...) NAME(.param ..., ...)"
    void declare_parameters() {
        std::string_view head = source_.head;
        if (!source_.kernel && trimmed(head).starts_with("(")) {
            const std::size_t end = head.find(')');
            f_.result = declare_memory(declared(in_brackets(head.substr(0, end + 1), '(', ')')));
            head.remove_prefix(end + 1);
        }
        const std::size_t begin = head.find('('), end = head.find(')');
        if (begin == head.npos) return;
        for (const std::string_view parameter : split(head.substr(begin + 1, end - begin - 1), ','))
            f_.parameters.push_back(declare_memory(declared(parameter)));
    }

    void decode_body() {
        std::string_view rest = source_.body;
        for (;;) {
            rest = trimmed(rest);
            if (rest.empty()) return;
            if (rest.front() == '{' || rest.front() == '}') {  // scope: names declared in it replace earlier ones
                rest.remove_prefix(1);
                continue;
            }
            const std::size_t end = std::min(rest.find_first_of(";:"), rest.size());
            const std::string_view statement = trimmed(rest.substr(0, end));
            if (end < rest.size() && rest[end] == ':')
                labels_[std::string(statement)] = static_cast<std::int64_t>(f_.instructions.size());
            else
                decode_statement(statement);
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
    }
    void decode_statement(std::string_view statement) {
        if (statement.starts_with(".reg")) {
            const auto parts = words(statement);
            declare_registers(
                parts[1].substr(1),
                statement.substr(static_cast<std::size_t>(parts[1].data() + parts[1].size() - statement.data())));
        } else if (statement.starts_with(".local") || statement.starts_with(".param")) {
            declare_memory(declared(statement));
        } else if (!statement.starts_with(".pragma")) {
            decode_instruction(statement);
        }
    }

    void decode_instruction(std::string_view text) {
        Instruction made;
        if (text.front() == '@') {
            const std::size_t end = text.find_first_of(" \t");
            made.guard_is_negated = text[1] == '!';
            made.guard = slot(text.substr(made.guard_is_negated ? 2 : 1, end - (made.guard_is_negated ? 2 : 1)));
            text = trimmed(text.substr(end));
        }
        const std::size_t end = std::min(text.find_first_of(" \t\n"), text.size());
        std::string name(text.substr(0, end));
        const std::string_view operands = text.substr(end);
        if (name.starts_with("bra")) {
            targets_[static_cast<std::ptrdiff_t>(f_.instructions.size())] = std::string(trimmed(operands));
            name = "bra";
        } else if (name.starts_with("call")) {
            made.number = static_cast<std::int64_t>(f_.calls.size());
            f_.calls.push_back(decode_call(operands));
            name = "call";
        } else {
            decode_operands(operands, name, made);
        }
        made.run = find_instruction(name);
        if (!made.run) throw Failure("unknown PTX instruction: " + std::string(text) + " (" + name + ")");
        f_.instructions.push_back(made);
    }
    void decode_operands(std::string_view operands, std::string& name, Instruction& made) {
        std::size_t count = 0;
        std::string shape;
        bool has_vectors = false;
        for (const std::string_view operand : split(operands, ',')) {
            std::vector<std::string_view> parts{operand};
            if (operand.front() == '{') {
                parts = split(in_brackets(operand, '{', '}'), ',');
                has_vectors = true;
            } else if (operand.front() == '[') {
                parts[0] = in_brackets(operand, '[', ']');
                if (const std::size_t plus = parts[0].find('+'); plus != operand.npos) {
                    made.number = static_cast<std::int64_t>(number(parts[0].substr(plus + 1)));
                    parts[0] = parts[0].substr(0, plus);
                }
            } else if (operand.find('|') != operand.npos) {
                parts = split(operand, '|');
            }
            shape += (shape.empty() ? ":" : ",") + std::to_string(parts.size());
            for (const std::string_view part : parts) {
                if (count == std::size(made.slot)) throw Failure("too many operands in PTX: " + std::string(operands));
                made.slot[count++] = slot(trimmed(part));
            }
        }
        if (const auto bytes = register_bytes_.find(made.slot[0]); bytes != register_bytes_.end())
            made.register_bytes = bytes->second;
        if (name.starts_with("ld.") || name.starts_with("st."))
            name = without_state_spaces(name);
        else if (has_vectors)
            name += shape;
    }
    // Removes state spaces and memory orders: all memory is on the host, and only one thread uses it.
    static std::string without_state_spaces(const std::string& name) {
        std::string kept;
        for (const std::string_view part : split(name, '.')) {
            if (part == "global" || part == "local" || part == "param" || part == "const" || part == "nc" ||
                part == "volatile" || part == "relaxed" || part == "gpu")
                continue;
            kept += (kept.empty() ? "" : ".") + std::string(part);
        }
        return kept;
    }
    // "(result), callee, (arguments)"
    Call decode_call(std::string_view operands) {
        Call call;
        for (const std::string_view part : split(operands, ',')) {
            if (part.front() != '(') {
                call.callee = &program_.function(part);
                continue;
            }
            const auto list = split(in_brackets(part, '(', ')'), ',');
            for (const std::string_view name : list) {
                const auto piece = pieces_.find(std::string(name));
                if (piece == pieces_.end()) throw Failure("unknown parameter in PTX: " + std::string(name));
                if (call.callee)
                    call.arguments.push_back(piece->second);
                else
                    call.result = piece->second;
            }
        }
        if (!call.callee || call.arguments.size() != call.callee->parameters.size())
            throw Failure("PTX calls a function with other parameters: " + std::string(operands));
        return call;
    }

    std::uint32_t slot(std::string_view operand) {
        if (const auto name = names_.find(std::string(operand)); name != names_.end()) return name->second;
        if (const auto global = program_.globals_.find(operand); global != program_.globals_.end())
            return constant(reinterpret_cast<std::uint64_t>(global->second.get()));
        // A grid of one thread.
        if (operand.starts_with("%tid.") || operand.starts_with("%ctaid.") || operand == "%laneid") return constant(0);
        if (operand.starts_with("%ntid.") || operand.starts_with("%nctaid.")) return constant(1);
        if (operand == "_") return new_register();
        return constant(number(operand));
    }

    Program& program_;
    const Program::Source& source_;
    Function& f_;
    std::uint32_t registers_ = 0;
    std::map<std::uint64_t, std::uint32_t> constants_;
    std::map<std::string, std::uint32_t> names_;
    std::map<std::uint32_t, unsigned> register_bytes_;
    std::map<std::string, Piece> pieces_;
    std::map<std::string, std::int64_t> labels_;
    std::map<std::ptrdiff_t, std::string> targets_;  ///< label of each branch, by the index of its instruction
};

Program::Program(std::string text) : text_(without_comments(text)) {
    std::string_view rest = text_;
    while (!(rest = trimmed(rest)).empty()) {
        if (rest.starts_with(".version") || rest.starts_with(".target") || rest.starts_with(".address_size")) {
            rest.remove_prefix(std::min(rest.find('\n'), rest.size()));
            continue;
        }
        const std::size_t stop = std::min(rest.find_first_of(";{="), rest.size());
        if (stop == rest.size()) break;
        if (rest[stop] != '{') {  // a declaration; '=' may be followed by values in braces
            const std::size_t end = rest.find(';');
            add_global(rest.substr(0, end));
            rest.remove_prefix(end + 1);
            continue;
        }
        std::string_view head = rest.substr(0, stop);
        std::size_t end = stop;
        for (int depth = 0; end < rest.size(); ++end) {
            depth += (rest[end] == '{') - (rest[end] == '}');
            if (depth == 0) break;
        }
        const std::size_t entry = head.find(".entry"), func = head.find(".func");
        const bool kernel = entry != head.npos;
        if (!kernel && func == head.npos) throw Failure("neither a kernel nor a function: " + std::string(head));
        head = trimmed(head.substr(kernel ? entry + 6 : func + 5));
        std::string_view named = head;
        if (named.starts_with("(")) named.remove_prefix(named.find(')') + 1);
        named = trimmed(named.substr(0, named.find('(')));
        sources_.emplace(std::string(words(named).front()),
                         Source{head, rest.substr(stop + 1, end - stop - 1), kernel});
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
}

// Adds arrays with their initial values. Skips declarations of functions, which their definitions repeat.
void Program::add_global(std::string_view declaration) {
    const std::size_t equals = declaration.find('=');
    const std::string_view head = declaration.substr(0, equals);
    if (head.find(".func") != head.npos || head.find(".extern") != head.npos || head.find(".shared") != head.npos)
        return;
    if (head.find(".global") == head.npos && head.find(".const") == head.npos) return;
    const Declared d = declared(head);
    auto memory = std::make_unique<std::byte[]>(d.bytes + 16);
    if (equals != declaration.npos) {
        const std::size_t bytes = bytes_of_type(d.type);
        std::size_t place = 0;
        std::string_view values = trimmed(declaration.substr(equals + 1));
        if (values.starts_with("{")) values = in_brackets(values, '{', '}');
        for (const std::string_view value : split(values, ',')) {
            const std::uint64_t bits = number(value);
            std::memcpy(memory.get() + place, &bits, bytes);
            place += bytes;
        }
    }
    globals_.emplace(std::string(d.name), std::move(memory));
}

std::vector<std::string> Program::kernels() const {
    std::vector<std::string> names;
    for (const auto& [name, source] : sources_)
        if (source.kernel) names.push_back(name);
    return names;
}

const Function& Program::function(std::string_view name) {
    if (const auto known = functions_.find(name); known != functions_.end()) return *known->second;
    const auto source = sources_.find(name);
    if (source == sources_.end()) throw Failure("PTX calls a function that is not there: " + std::string(name));
    auto& made = functions_[std::string(name)];
    made = std::make_unique<Function>();
    Decoder(*this, source->second, *made).decode();
    return *made;
}

}  // namespace crumple::ptx
