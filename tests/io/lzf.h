// An LZF compressor for tests: greedy, slow, and apart from the decoder under test.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>

namespace pcm::test {

// Uses copies of at most `longest` bytes; 0: only literals.
inline std::string lzf_compress(const std::string& data, std::size_t longest = 264)
{
    std::string out, literals;
    const auto flush = [&] {
        for (std::size_t i = 0; i < literals.size(); i += 32) {
            const std::string run = literals.substr(i, 32);
            out += static_cast<char>(run.size() - 1);
            out += run;
        }
        literals.clear();
    };
    for (std::size_t at = 0; at < data.size();) {
        std::size_t best = 0, best_back = 0;
        for (std::size_t back = 1; longest >= 3 && back <= std::min<std::size_t>(at, 8192); ++back) {
            std::size_t length = 0;
            while (length < longest && at + length < data.size() && data[at + length] == data[at + length - back])
                ++length;
            if (length > best) best = length, best_back = back;
            if (best == longest) break;
        }
        if (best < 3) {
            literals += data[at++];
            continue;
        }
        flush();
        const std::size_t length = best - 2, back = best_back - 1;
        out += static_cast<char>(std::min<std::size_t>(length, 7) << 5 | back >> 8);
        if (length >= 7) out += static_cast<char>(length - 7);
        out += static_cast<char>(back & 255);
        at += best;
    }
    flush();
    return out;
}

}  // namespace pcm::test
