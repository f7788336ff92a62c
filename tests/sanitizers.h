// A test that a sanitizer's build leaves out states that in its name, TEST_F(Suite, PCM_NOT_UNDER_THREAD(Name)), and
// the reason above it. There it is counted as skipped; --gtest_also_run_disabled_tests runs it nevertheless.
#pragma once

#if defined(__SANITIZE_ADDRESS__)
#define PCM_NOT_UNDER_ADDRESS(name) DISABLED_##name
#else
#define PCM_NOT_UNDER_ADDRESS(name) name
#endif

#if defined(__SANITIZE_THREAD__)
#define PCM_NOT_UNDER_THREAD(name) DISABLED_##name
#else
#define PCM_NOT_UNDER_THREAD(name) name
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PCM_NOT_UNDER_SANITIZERS(name) DISABLED_##name
#else
#define PCM_NOT_UNDER_SANITIZERS(name) name
#endif

// A number of tries: the second one under a sanitizer, which makes each of them many times slower.
template <typename T>
constexpr T tries([[maybe_unused]] T many, [[maybe_unused]] T under_sanitizers)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return under_sanitizers;
#else
    return many;
#endif
}

// TYPED_TEST with such a name: its own macro would not see what stands for the name.
#define PCM_TYPED_TEST(suite, name) TYPED_TEST(suite, name)
