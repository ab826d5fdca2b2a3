#pragma once

// What two backends say of the same question, compared byte by byte: answers by require_same of the target, errors
// here.

#include <cstring>
#include <string>
#include <utility>
#include <variant>

#include "crumple/array.h"
#include "crumple/error.h"
#include "fuzz/fail.h"

namespace crumple::fuzz {

template <class Answer>
using Outcome = std::variant<Answer, Error>;

template <class Answer, class Call>
Outcome<Answer> outcome_of(Call&& call) {
    try {
        return Answer(call());
    } catch (const Error& error) {
        return error;
    }
}

template <class T>
void require_same_bytes(const Array<T>& found, const Array<T>& expected, const std::string& what) {
    if (found.size() != expected.size())
        fail(what + ": " + std::to_string(found.size()) + " instead of " + std::to_string(expected.size()));
    for (std::size_t i = 0; i < found.size(); ++i)
        if (std::memcmp(&found[i], &expected[i], sizeof(T)) != 0) fail(what + " differ at " + std::to_string(i));
}

/// `same(found, expected, what)` compares answers.
template <class Answer, class Same>
void compare(const Outcome<Answer>& found, const Outcome<Answer>& expected, const std::string& what, Same same) {
    const Error *error = std::get_if<Error>(&found), *wanted = std::get_if<Error>(&expected);
    if (error && !wanted) fail(what + " throws: " + error->what());
    if (wanted && !error) fail(what + " does not throw: " + wanted->what());
    if (!error) return same(std::get<Answer>(found), std::get<Answer>(expected), what);
    if (error->code != wanted->code || error->element != wanted->element || error->index != wanted->index ||
        std::strcmp(error->what(), wanted->what()) != 0)
        fail(what + " throws " + error->what() + " instead of " + wanted->what());
}

}  // namespace crumple::fuzz
