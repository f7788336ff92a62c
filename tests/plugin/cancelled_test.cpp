// The messages about an operation that was cancelled.
#include "plugin/panels/cancelled.h"

#include "pcm/system/error.h"

#include <gtest/gtest.h>

#include <new>

using namespace pcm;
using namespace pcm::host;

namespace {

template <class Thrown>
std::optional<QString> text_of(const Thrown& thrown)
{
    try {
        throw thrown;
    } catch (...) {
        return cancelled_text("Opening a.las");
    }
}

TEST(Cancelled, IsSaidOnceAndWithItsReason)
{
    EXPECT_EQ(text_of(Error(ErrorCode::cancelled, {}, "cancelled")), QString("Opening a.las was cancelled."));
    EXPECT_EQ(text_of(Error(ErrorCode::cancelled, "/b/a.las", "cancelled")), QString("Opening a.las was cancelled."));
    EXPECT_EQ(text_of(Error(ErrorCode::cancelled, "/b/a.las", "it does not fit the other clouds")),
              QString("Opening a.las was cancelled: it does not fit the other clouds."));
}

TEST(Cancelled, FailuresAreNot)
{
    EXPECT_FALSE(text_of(Error(ErrorCode::corrupt, "/b/a.las", "cancelled")));
    EXPECT_FALSE(text_of(std::bad_alloc()));
    EXPECT_FALSE(text_of(7));
}

}  // namespace
