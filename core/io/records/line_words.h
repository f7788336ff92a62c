// Numbers in lines of text, as headers promise them: a type for each.
#pragma once

#include "pcm/cloud/attribute.h"

#include <cstddef>
#include <string_view>

namespace pcm {

// Goes through the words of one line.
class LineWords {
public:
    // Words stand between blanks; `or_commas`: or between commas, of which several count as one.
    explicit LineWords(std::string_view line, bool or_commas = false)
        : at_(line.data()), end_(line.data() + line.size()), or_commas_(or_commas)
    {
    }

    std::string_view next();  // empty at the end of the line
    bool at_end();

    // The next word as a number of `type`, stored at `to`; or false, with `word` as it stands there, when it is none of
    // that type or the line is at its end. Whole numbers may be written as "+7" and "7.0"; reals beyond the range of
    // the type become infinite or zero; "nan", "inf", "1.#IND" and "1.#INF" are numbers.
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
