// The calls of operations whose answers are kept.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace pcm::test {

struct FrozenCall {
    using Values = std::vector<std::pair<std::string, std::string>>;

    std::string name;  // of the test and of its file
    std::string operation;
    Values values;  // by key; words apart by blanks, or after = one word; @ is the folder of the test,
                    // @out/copy.pct a copy of its site.pct
};

inline void PrintTo(const FrozenCall& call, std::ostream* out) { *out << call.name; }
std::vector<std::string> words_of(const std::string& text);
std::vector<FrozenCall> frozen_calls();

}  // namespace pcm::test
