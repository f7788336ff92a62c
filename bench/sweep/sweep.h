// Draws the curve of a tuned number again: the figures of a benchmark for several values of it. See README.md.
#pragma once

#include "pcm/system/tuned_value.h"

#include <functional>
#include <string>
#include <vector>

namespace pcm::bench {

// Those of all rooms: "fit.consensus.max_chance" and so on.
std::vector<TunedValue> tuned_values();

struct Sweep {
    TunedValue tuned;
    std::vector<double> values;  // ascending, each once; the present one is among them
};

// "NAME": the present value and six from half of it to twice; "NAME=FROM:TO:STEPS": evenly, and the present one. Throws
// std::invalid_argument for what is neither.
Sweep read_sweep(const std::string& text);

// Prints a table with a row for each value, the present one in bold; `figures` gives the cells of a row, under the
// heads. The last column is processor time in seconds. The value is restored, after an exception too.
void print_sweep(const Sweep& sweep, const std::vector<std::string>& heads,
                 const std::function<std::vector<std::string>()>& figures);

// "0.42": as few digits as the value needs.
std::string text_of_value(double value);

// Each of `texts`, see read_sweep(). "list" alone prints the names, and gives none.
std::vector<Sweep> read_sweeps(const std::vector<std::string>& texts);

}  // namespace pcm::bench
