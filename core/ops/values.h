// What is written behind an option, as numbers and sizes. Each function returns why a word is not what the option
// takes, as the end of a message: "'abc' is not a number from 0.5 to 10"; empty: it is. A word may be rewritten into
// the form that the parser of the command line takes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace pcm::ops {

// Which numbers are allowed.
struct AllowedNumbers {
    std::optional<double> least, most;
    bool above_least = false;  // the least is not allowed itself
    bool whole = false;
};
std::string text_of(const AllowedNumbers& allowed);  // "a whole number from 1 to 8", "a number greater than 0"
// For a list of options: "1 to 8", "above 0".
std::string brief_text_of(const AllowedNumbers& allowed);
// Ten significant digits: limits and defaults in texts.
std::string short_text(double value);

std::string number_fault(const std::string& word, const AllowedNumbers& allowed);
// A whole number from 0 to `most`, also as 1e6. Rewritten in decimal digits.
std::string whole_fault(std::string& word, std::uint64_t most);
// A number of bytes with a unit, powers of 1024: 512M, 1.5G, 100 kB. Rewritten in decimal digits.
std::string bytes_fault(std::string& word);
std::string choice_fault(const std::string& word, const std::vector<std::string>& choices);

// What was meant by a word that is none of the names, as the end of a message: "; perhaps build". May be empty.
std::string perhaps(const std::string& word, const std::vector<std::string>& names);

}  // namespace pcm::ops
