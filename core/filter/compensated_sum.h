// A sum of doubles whose error does not grow with their number.
#pragma once

namespace pcm {

// Knuth's two-sum: the rounding error of every addition is kept and added at the end. The result is off by about one
// rounding of the sum, plus n^2 times 2^-106 of the sum of magnitudes for n numbers. For finite numbers.
class CompensatedSum {
public:
    void add(double value)
    {
        const double sum = sum_ + value, part = sum - sum_;
        error_ += (sum_ - (sum - part)) + (value - part);
        sum_ = sum;
    }
    double value() const { return sum_ + error_; }

private:
    double sum_ = 0, error_ = 0;
};

}  // namespace pcm
