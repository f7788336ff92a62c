// Settings of an L1 for parametrised tests, and the naive model with the same settings.
#pragma once

#include "pcm/gl/l1/l1_cache.h"

#include "tests/gl/l1_model.h"

#include <gtest/gtest.h>

#include <string>

namespace pcm::test {

inline constexpr std::uint32_t pages_per_block = (1u << 20) / L1Cache::page_bytes;

inline L1Model model_of(const L1Options& options)
{
    L1Model model;
    model.policy = options.policy;
    model.pages_per_block = pages_per_block;
    model.max_blocks = static_cast<std::uint32_t>(options.capacity_bytes / options.block_bytes);
    return model;
}

inline void expect_same_counts(const L1Statistics& s, const L1Counts& counts)
{
    EXPECT_EQ(s.hits, counts.hits);
    EXPECT_EQ(s.compulsory_misses, counts.compulsory_misses);
    EXPECT_EQ(s.capacity_misses, counts.capacity_misses);
    EXPECT_EQ(s.forced_misses, counts.forced_misses);
    EXPECT_EQ(s.evictions, counts.evictions);
    EXPECT_EQ(s.refused, counts.refused);
}

struct L1Setting {
    L1Policy policy;
    L1Container container;
};

inline constexpr L1Setting l1_settings[] = {{L1Policy::lru, L1Container::hash_map},
                                            {L1Policy::lru, L1Container::ordered_map},
                                            {L1Policy::naive, L1Container::hash_map},
                                            {L1Policy::naive, L1Container::ordered_map}};
inline std::string name_of(const L1Setting& setting)
{
    return std::string(setting.policy == L1Policy::lru ? "Lru" : "Naive") +
           (setting.container == L1Container::hash_map ? "HashMap" : "OrderedMap");
}

inline L1Options options_of(const L1Setting& setting)
{
    L1Options options;
    options.block_bytes = 1u << 20;
    options.capacity_bytes = 5 * (1u << 20) + 12345;  // not a whole number of blocks
    options.policy = setting.policy;
    options.container = setting.container;
    return options;
}

}  // namespace pcm::test
