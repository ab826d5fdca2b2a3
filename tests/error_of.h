#pragma once

#include <gtest/gtest.h>

#include "crumple/error.h"

namespace crumple::test {

/// Returns the error that the call throws; fails the test if it throws none.
template <class Call>
Error error_of(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "no error";
    return Error(ErrorCode::invalid_argument, "");
}

}  // namespace crumple::test
