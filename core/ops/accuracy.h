// How far an answer may be from the exact one: what an operation traded for its time. Every answer has it, in the same
// words (result.h: error, error_unit, error_kind, error_of).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pcm::ops {

enum class ErrorKind : std::uint8_t {
    exact,       // what was asked for, but for the rounding of the numbers that are answered
    bound,       // never more
    percent_95,  // no more for 95 % of the values, or with a probability of 95 %
    estimated,   // about so much; how often it is more is not known
};
const char* name_of(ErrorKind kind);  // "exact", "bound", "95 %", "estimated"

struct Accuracy {
    ErrorKind kind = ErrorKind::exact;
    double error = 0;  // in `unit`; 0 where exact, infinite where nothing is known
    std::string unit;  // "source units", "%", "degrees", "points"; empty where exact
    std::string of;    // what is off by it, as a noun; empty where exact
};

// Nothing was traded.
Accuracy exact_answer();
// A bound of an error in source units; exact where it is 0.
Accuracy bounded(double error, const std::string& of);
// Coordinates were rounded, each by at most this, as BuildReport::outcome.error says.
Accuracy rounded_positions(double error);
// Points beyond a level were left out: each has one of the level nearer than `spacing` (query/nearest.h), and
// coordinates were rounded besides.
Accuracy without_finer_levels(double spacing, double rounding = 0);
// `sigma`: one standard deviation of a value whose error is about normally distributed; of a place in 2 or 3 dimensions
// along the axis where it is largest. The error is the radius that holds 95 % of such places, where all axes are as
// uncertain.
Accuracy from_deviation(double sigma, const std::string& unit, const std::string& of, std::size_t dimensions = 1);
// Accuracy of a chain in which each step works on the result of the one before.
Accuracy of_steps(const std::vector<Accuracy>& steps);

// "error 0 (exact)", "error 0.005 source units (bound, of positions)".
std::string text_of(const Accuracy& accuracy);

}  // namespace pcm::ops
