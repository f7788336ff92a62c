// An OpenGL context without a window, where this machine has one.
#pragma once

#include "pcm/offscreen/offscreen.h"
#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace pcm::test {

// Null, with the reason in `why`, where this machine has no OpenGL. `share` may be null.
inline std::unique_ptr<Offscreen> make_offscreen(int width, int height, std::string& why,
                                                 OffscreenProfile profile = OffscreenProfile::compatibility,
                                                 const Offscreen* share = nullptr)
{
    try {
        return std::make_unique<Offscreen>(width, height, profile, share);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::unsupported) << error.what();
        why = error.what();
        EXPECT_NE(why.find("no OpenGL context"), std::string::npos) << why;
        EXPECT_NE(why.find("apt-get install"), std::string::npos) << why;
        return nullptr;
    }
}

}  // namespace pcm::test
