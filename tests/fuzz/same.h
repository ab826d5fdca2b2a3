#pragma once

// Compares the outcomes of one query by two backends byte by byte. The fuzz target provides the function `same`, which
// compares results; errors are compared in this file.

#include <cstring>
#include <string>
#include <utility>
#include <variant>

#include "crumple/array.h"
#include "crumple/error.h"
#include "fuzz/fail.h"

namespace crumple::fuzz {

template <class Result>
using Outcome = std::variant<Result, Error>;

template <class Result, class Call>
Outcome<Result> outcome_of(Call&& call) {
    try {
        return Result(call());
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

/// Requires equal results by `same(found, expected, what)`, or equal errors.
template <class Result, class Same>
void compare(const Outcome<Result>& found, const Outcome<Result>& expected, const std::string& what, Same same) {
    const Error *error = std::get_if<Error>(&found), *expected_error = std::get_if<Error>(&expected);
    if (error && !expected_error) fail(what + " throws: " + error->what());
    if (expected_error && !error) fail(what + " does not throw: " + expected_error->what());
    if (!error) return same(std::get<Result>(found), std::get<Result>(expected), what);
    if (error->code != expected_error->code || error->element != expected_error->element ||
        error->index != expected_error->index || std::strcmp(error->what(), expected_error->what()) != 0)
        fail(what + " throws " + error->what() + " instead of " + expected_error->what());
}

}  // namespace crumple::fuzz
