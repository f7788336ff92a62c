// Answers of operations as they are kept in files: without what differs from run to run, long lists as a few sums.
#pragma once

#include "pcm/ops/operation.h"

#include <filesystem>
#include <string>

namespace pcm::test {

// Without times, memory, version and `folder`, and the texts of `lines` as frozen_line() gives them; every list of more
// than twelve numbers is their number, sum and a sum in which each weighs as much as its place, so that their order
// counts.
ops::Json frozen(const ops::Json& answer, const std::filesystem::path& folder);

// The numbers of a text and its words, of a drawing say, as above.
ops::Json frozen_text(const std::string& text, const std::filesystem::path& folder);

// A line for people with # for each number and its unit, which may be those of a time, and one blank for several.
std::string frozen_line(const std::string& line);

// As it is kept: members of the outer objects a line each.
std::string kept_text(const ops::Json& frozen, int outer = 4);

// Where two frozen answers differ, a line each, at most ten; empty: nowhere. Numbers may differ by a millionth, which
// another compiler's or library's last digits stay below.
std::string differences(const ops::Json& kept, const ops::Json& now);

}  // namespace pcm::test
