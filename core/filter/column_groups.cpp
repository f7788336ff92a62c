#include "pcm/filter/column_groups.h"

#include "pcm/cloud/with_type.h"
#include "pcm/filter/compensated_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <type_traits>

namespace pcm {
namespace {

__extension__ using Int128 = __int128;

// Sums of integers are exact: the points of a cloud are fewer than 2^47.
template <class T>
using IntegerSum = std::conditional_t<sizeof(T) <= 2, std::int64_t, Int128>;

// The nearest integer to sum / count, halves up. It lies between the smallest and the largest number summed.
template <class T, class Sum>
T mean_of(Sum sum, std::uint64_t count)
{
    const Sum n = static_cast<Sum>(count), twice = 2 * sum + n;
    Sum quotient = twice / (2 * n);
    if (twice % (2 * n) < 0) --quotient;
    return static_cast<T>(quotient);
}

template <class T>
class IntegerMeans final : public ColumnCombiner {
public:
    IntegerMeans(const Attribute& attribute, std::size_t groups)
        : attribute_(attribute), sums_(groups * attribute.components), counts_(groups)
    {
    }

    void add(const Column& column, const PointGroups& groups) override
    {
        const std::size_t components = attribute_.components;
        const T* const values = column.as<T>();
        for (std::size_t g = 0; g < counts_.size(); ++g) {
            counts_[g] += groups.points_of(g);
            for (std::size_t c = 0; c < components; ++c) {
                IntegerSum<T> sum = 0;
                for (std::size_t i = groups.begins[g]; i < groups.begins[g + 1]; ++i)
                    sum += values[groups.order[i] * components + c];
                sums_[g * components + c] += sum;
            }
        }
    }

    void finish(Column& out) override
    {
        out = Column(attribute_);
        out.resize(counts_.size());
        for (std::size_t i = 0; i < sums_.size(); ++i)
            out.as<T>()[i] = mean_of<T>(sums_[i], counts_[i / attribute_.components]);
    }

private:
    const Attribute attribute_;
    std::vector<IntegerSum<T>> sums_;
    std::vector<std::uint64_t> counts_;
};

template <class T>
class FloatMeans final : public ColumnCombiner {
public:
    FloatMeans(const Attribute& attribute, std::size_t groups, bool directions)
        : attribute_(attribute), directions_(directions), sums_(groups * attribute.components), counts_(sums_.size())
    {
        if (directions) first_.resize(sums_.size());
    }

    void add(const Column& column, const PointGroups& groups) override
    {
        const std::size_t components = attribute_.components;
        const T* const values = column.as<T>();
        for (std::size_t g = 0; g < groups.size(); ++g) {
            for (std::size_t c = 0; c < components; ++c) {
                CompensatedSum sum = sums_[g * components + c];
                std::uint64_t count = 0;
                for (std::size_t i = groups.begins[g]; i < groups.begins[g + 1]; ++i) {
                    const double value = static_cast<double>(values[groups.order[i] * components + c]);
                    if (!std::isfinite(value)) continue;
                    sum.add(value);
                    ++count;
                }
                sums_[g * components + c] = sum;
                counts_[g * components + c] += count;
            }
            if (directions_) find_first(values, groups, g);
        }
    }

    void finish(Column& out) override
    {
        out = Column(attribute_);
        const std::size_t components = attribute_.components;
        out.resize(sums_.size() / components);
        T* const to = out.as<T>();
        for (std::size_t i = 0; i < sums_.size(); ++i)
            to[i] = counts_[i] ? static_cast<T>(sums_[i].value() / static_cast<double>(counts_[i]))
                               : std::numeric_limits<T>::quiet_NaN();
        if (directions_)
            for (std::size_t g = 0; g < sums_.size(); g += 3) set_direction(to + g, g);
    }

private:
    void find_first(const T* values, const PointGroups& groups, std::size_t g)
    {
        T* const first = first_.data() + 3 * g;
        for (std::size_t i = groups.begins[g]; i < groups.begins[g + 1]; ++i) {
            if (first[0] != 0 || first[1] != 0 || first[2] != 0) return;
            const T* const value = values + 3 * std::size_t(groups.order[i]);
            if (std::isfinite(value[0]) && std::isfinite(value[1]) && std::isfinite(value[2]))
                std::copy(value, value + 3, first);
        }
    }

    // A sum of unit vectors below this share of their number is noise.
    void set_direction(T* to, std::size_t at) const
    {
        constexpr double least = 1e-6;
        const double length =
            std::hypot(static_cast<double>(to[0]), static_cast<double>(to[1]), static_cast<double>(to[2]));
        if (std::isnan(length)) return;
        if (length < least) {
            std::copy(first_.data() + at, first_.data() + at + 3, to);
            return;
        }
        Vec3d mean;
        for (std::size_t c = 0; c < 3; ++c) mean[c] = sums_[at + c].value() / static_cast<double>(counts_[at + c]);
        const double exact_length = std::hypot(mean[0], mean[1], mean[2]);
        for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<T>(mean[c] / exact_length);
    }

    const Attribute attribute_;
    const bool directions_;
    std::vector<CompensatedSum> sums_;
    std::vector<std::uint64_t> counts_;
    std::vector<T> first_;
};

template <class T>
class Majorities final : public ColumnCombiner {
public:
    Majorities(const Attribute& attribute, std::size_t groups) : attribute_(attribute), groups_(groups)
    {
        if (groups == 1) counts_.resize(attribute.components);
        result_ = Column(attribute);
        result_.resize(groups);
    }

    void add(const Column& column, const PointGroups& groups) override
    {
        const std::size_t components = attribute_.components;
        const T* const values = column.as<T>();
        for (std::size_t g = 0; g < groups_; ++g)
            for (std::size_t c = 0; c < components; ++c) {
                some_.clear();
                for (std::size_t i = groups.begins[g]; i < groups.begins[g + 1]; ++i)
                    some_.push_back(values[groups.order[i] * components + c]);
                if (groups_ == 1)
                    count(counts_[c]);
                else
                    result_.as<T>()[g * components + c] = most_frequent();
            }
    }

    void finish(Column& out) override
    {
        for (std::size_t c = 0; c < counts_.size(); ++c) {
            std::uint64_t most = 0;
            for (const auto& [value, count] : counts_[c])
                if (count > most) {
                    most = count;
                    result_.as<T>()[c] = value;
                }
        }
        out = std::move(result_);
    }

private:
    static constexpr std::size_t most_values = 1000000;

    // Calls run(value, count) for each value of some_, ascending.
    template <class Run>
    void for_each_run(const Run& run)
    {
        std::sort(some_.begin(), some_.end());
        for (std::size_t i = 0; i < some_.size();) {
            std::size_t end = i + 1;
            while (end < some_.size() && some_[end] == some_[i]) ++end;
            run(some_[i], end - i);
            i = end;
        }
    }
    void count(std::map<T, std::uint64_t>& counts)
    {
        for_each_run([&](T value, std::size_t number) {
            const auto found = counts.find(value);
            if (found != counts.end())
                found->second += number;
            else if (counts.size() < most_values)
                counts.emplace(value, number);
        });
    }
    T most_frequent()
    {
        const T first = some_.front();
        if (std::all_of(some_.begin() + 1, some_.end(), [first](T value) { return value == first; })) return first;
        T best = 0;
        std::size_t most = 0;
        for_each_run([&](T value, std::size_t number) {
            if (number <= most) return;
            most = number;
            best = value;
        });
        return best;
    }

    const Attribute attribute_;
    const std::size_t groups_;
    std::vector<std::map<T, std::uint64_t>> counts_;  // with one group: of each component
    Column result_;
    std::vector<T> some_;
};

}  // namespace

std::unique_ptr<ColumnCombiner> make_combiner(const Attribute& attribute, Combination combination, std::size_t groups)
{
    return with_type(attribute.type, [&](auto zero) -> std::unique_ptr<ColumnCombiner> {
        using T = decltype(zero);
        if constexpr (std::is_floating_point_v<T>) {
            return std::make_unique<FloatMeans<T>>(attribute, groups, combination == Combination::direction);
        } else {
            if (combination == Combination::majority) return std::make_unique<Majorities<T>>(attribute, groups);
            return std::make_unique<IntegerMeans<T>>(attribute, groups);
        }
    });
}

}  // namespace pcm
