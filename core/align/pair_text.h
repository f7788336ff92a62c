// Pairs of points as text, a pair a line: x y z of the moving point, x y z of the fixed one, and optionally a weight.
//
//     # moving                      fixed                          weight
//     500010.25 4800020.5 131.5     12.125 -3.25 1.5
//     500031.75 4800011.0 128.25    33.5 -12.75 -1.75             0.5
//
// Numbers are separated by blanks, tabs, commas or semicolons. What follows # is a comment; empty lines are skipped.
#pragma once

#include "pcm/align/rigid_fit.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace pcm {

// `name` is what the text is called in errors: a file or a field. Throws Error(bad_format), with the line, for lines of
// another number of values, and for what is not a number.
std::vector<PointPair> parse_pairs(std::string_view text, const std::filesystem::path& name);

// Throws Error(not_found | permission | io), and what parse_pairs() throws. Files of up to 16 MB.
std::vector<PointPair> read_pairs(const std::filesystem::path& file);

// All digits; a weight of 1 is left out.
std::string text_of(const std::vector<PointPair>& pairs);
// Replaces a file of this name. Throws what OutputFile throws.
void write_pairs(const std::vector<PointPair>& pairs, const std::filesystem::path& file);

}  // namespace pcm
