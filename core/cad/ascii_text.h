// Names in letters that every program can type.
#pragma once

#include <string>

namespace pcm {

// `text` is UTF-8: letters and digits of ASCII, "-" and "$" stay; letters of Latin with marks, Greek and Cyrillic
// become those that they are usually written with; other characters above U+007F that can be part of a word become "U"
// and four or more hexadecimal digits; everything else becomes "_".
std::string ascii_text(const std::string& text);

}  // namespace pcm
