// The words of a line of text, read as numbers of the types that a header states.
#pragma once

#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <string_view>

namespace pcm {

// Reads the words of one line in order. One thread.
class LineWords {
public:
    // Words are separated by blanks; with `or_commas` also by commas, where several count as one.
    explicit LineWords(std::string_view line, bool or_commas = false)
        : at_(line.data()), end_(line.data() + line.size()), or_commas_(or_commas)
    {
    }

    std::string_view next();  // empty at the end of the line
    bool at_end();

    // Stores the next word as a number of `type` at `to`. False, with the word in `word`, when it is not a number of
    // that type, and at the end of the line. Whole numbers may be written as "+7" and "7.0"; reals beyond the range of
    // the type become infinite or zero; "nan", "inf", "1.#IND" and "1.#INF" are accepted.
    bool next_number(ScalarType type, std::byte* to, std::string_view& word);

private:
    bool separates(char c) const { return c == ' ' || (c >= '\t' && c <= '\r') || (or_commas_ && c == ','); }
    void skip_separators()
    {
        while (at_ != end_ && separates(*at_)) ++at_;
    }
    template <class T>
    bool take(std::byte* to, std::string_view& word);

    const char* at_;
    const char* end_;
    bool or_commas_;
};

}  // namespace pcm
