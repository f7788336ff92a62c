// How a tree of floats or doubles returns the source's own numbers.
//
// On a grid of a power of two a coordinate small relative to the largest loses its last bits. They come back
// where it is known which numbers the source had: floats, or decimals with few digits, as text files hold them. For
// decimals the tree has a metadata block "pcm.decimals": for each axis the number of digits after the point, or "-".
#pragma once

#include "pcm/cloud/metadata.h"
#include "pcm/cloud/nearest_float.h"
#include "pcm/tree/tree.h"

#include <array>
#include <cmath>
#include <vector>

namespace pcm {

inline constexpr int no_decimals = -1;
using DecimalPlaces = std::array<int, 3>;  // digits after the point, of each axis; no_decimals: others than decimals

inline constexpr int most_decimal_places = 15;
double power_of_ten(int places);  // 0 to most_decimal_places, exact

class ByteReader;
class ByteWriter;

// Finds the number of digits after the point of all numbers that it sees. The result does not depend on their order.
class DecimalCount {
public:
    void see(double v)
    {
        if (places_ > most_decimal_places) return;
        largest_ = std::max(largest_, std::fabs(v));
        while (places_ <= most_decimal_places && !holds(v)) ++places_;
    }
    void merge(const DecimalCount& other);
    // Digits such that each number is the double nearest to a decimal with them; no_decimals where there are none.
    int places() const;
    void save(ByteWriter& out) const;
    static DecimalCount load(ByteReader& in);

private:
    static constexpr double most_integer = 1125899906842624.0;  // 2^50: quotients by a power of ten are far apart
    bool holds(double v) const
    {
        const double power = power_of_ten(places_), n = std::nearbyint(v * power);
        return std::fabs(n) < most_integer && n / power == v;
    }
    int places_ = 0;
    double largest_ = 0;
};

class SourceRounding {
public:
    explicit SourceRounding(const TreeInfo& info);
    explicit SourceRounding(const DecimalPlaces& places);

    // The source's number for a coordinate of the tree. Increases with it.
    double operator()(double coordinate, std::size_t axis) const
    {
        if (single_) return nearest_float(coordinate);
        if (power_[axis] == 0) return coordinate;
        return std::nearbyint(coordinate * power_[axis]) / power_[axis];
    }
    Vec3d operator()(const Vec3d& p) const { return {(*this)(p[0], 0), (*this)(p[1], 1), (*this)(p[2], 2)}; }
    Box3d operator()(const Box3d& box) const { return {(*this)(box.min), (*this)(box.max)}; }

    bool single_precision() const { return single_; }
    bool has_decimals() const { return power_[0] != 0 || power_[1] != 0 || power_[2] != 0; }

private:
    bool single_ = false;
    Vec3d power_{0, 0, 0};  // 0: unchanged
};

// Sets the block of decimals, or removes it when there are none.
void set_decimals(std::vector<Metadata>& metadata, const DecimalPlaces& places);

}  // namespace pcm
