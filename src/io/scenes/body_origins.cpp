#include "io/scenes/body_origins.h"

#include <charconv>
#include <string_view>

#include "io/bytes/source.h"

namespace crumple::io {
namespace {

/// Returns the message with its origin. Replaces "body 7: " at its start by the file, the configuration and the name of
/// that body; puts the names of all files in front of any other message.
std::string message_with_body_name(const std::string& message, const BodyOrigins& origins,
                                   std::int64_t first_configuration) {
    constexpr std::string_view title = "body ";
    const std::size_t count = origins.names.size();
    std::size_t body = 0;
    const char* const end = message.data() + message.size();
    const char* rest = end;
    if (message.starts_with(title) && count > 0) {
        const auto number = std::from_chars(message.data() + title.size(), end, body);
        if (number.ec == std::errc()) rest = number.ptr;
    }
    if (rest == end || *rest != ':') return origins.files + ": " + message;
    const auto configuration = first_configuration + static_cast<std::int64_t>(body / count);
    return origins.file_of_body[body % count] + ": " +
           (first_configuration < 0 ? "" : "configuration " + std::to_string(configuration) + ", ") + "body " +
           in_quotes(origins.names[body % count]) + std::string(rest, end);
}

}  // namespace

Error with_body_name(const Error& error, const BodyOrigins& origins, std::int64_t first_configuration) {
    Error named(error.code, message_with_body_name(error.what(), origins, first_configuration), error.element,
                error.index, error.bytes_needed, error.system_error);
    named.rank = error.rank;
    return named;
}

}  // namespace crumple::io
