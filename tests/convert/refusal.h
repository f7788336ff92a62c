// What a conversion says when it refuses.
#pragma once

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace pcm::test {

// The message of the error that `f` throws, which must be of this code.
inline std::string refusal(ErrorCode code, const std::function<void()>& f)
{
    try {
        f();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "nothing was refused";
    return {};
}

}  // namespace pcm::test
