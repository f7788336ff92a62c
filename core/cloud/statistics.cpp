#include "pcm/cloud/statistics.h"

#include "pcm/cloud/with_type.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace pcm {
namespace {

constexpr std::size_t first_places = std::size_t{1} << 16;

// The finalizer of SplitMix64 (Steele, Lea, Flood 2014): every bit of the result depends on every bit of the input.
std::uint64_t mixed(std::uint64_t bits)
{
    bits += 0x9e3779b97f4a7c15u;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
    return bits ^ bits >> 31;
}

std::uint64_t hash_of(std::uint64_t x, std::uint64_t y, std::uint64_t z) { return mixed(mixed(mixed(x) ^ y) ^ z); }

std::uint64_t bits_of(double value)
{
    value += 0.0;  // -0 is 0
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

void widen(ValueStatistics& statistics, double least, double most, std::uint64_t values)
{
    if (values == 0) return;
    statistics.least = statistics.values ? std::min(statistics.least, least) : least;
    statistics.most = statistics.values ? std::max(statistics.most, most) : most;
    statistics.values += values;
}

// Raw values of one component. Returns their sum, of integers exactly. The sum of doubles may be larger than a double.
template <class T>
long double add_raw(const T* values, std::size_t count, std::size_t step, ValueStatistics& statistics)
{
    using Sum =
        std::conditional_t<std::is_same_v<T, double>, long double,
                           std::conditional_t<(sizeof(T) > 4 || std::is_floating_point_v<T>), double, std::int64_t>>;
    Sum sum = 0;
    T least = std::numeric_limits<T>::max(), most = std::numeric_limits<T>::lowest();
    std::uint64_t finite = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const T value = values[i * step];
        if constexpr (std::is_floating_point_v<T>)
            if (!std::isfinite(value)) continue;
        sum += static_cast<Sum>(value);
        least = std::min(least, value);
        most = std::max(most, value);
        ++finite;
    }
    statistics.not_finite += count - finite;
    widen(statistics, static_cast<double>(least), static_cast<double>(most), finite);
    return static_cast<long double>(sum);
}

bool is_counted(const Attribute& attribute)
{
    return attribute.components == 1 && attribute.scale == 1 && attribute.offset == 0 &&
           attribute.type != ScalarType::f32 && attribute.type != ScalarType::f64;
}

// Number of points by value; returns how many values are outside.
std::uint64_t count_values(const Column& column, std::vector<std::uint64_t>& counts)
{
    std::uint64_t outside = 0;
    counts.resize(256);
    with_type(column.type(), [&](auto zero) {
        using T = decltype(zero);
        const T* const values = column.as<T>();
        for (std::size_t i = 0, n = column.size(); i < n; ++i) {
            const double value = static_cast<double>(values[i]);
            if (value >= 0 && value < 256)
                ++counts[static_cast<std::size_t>(value)];
            else
                ++outside;
        }
    });
    return outside;
}

// From raw numbers to values.
void scale(ValueStatistics& statistics, long double sum, double scale, double offset)
{
    if (statistics.values == 0) return;
    statistics.mean = static_cast<double>(sum / static_cast<long double>(statistics.values)) * scale + offset;
    statistics.least = statistics.least * scale + offset;
    statistics.most = statistics.most * scale + offset;
    if (scale < 0) std::swap(statistics.least, statistics.most);
}

}  // namespace

StatisticsCollector::StatisticsCollector(const Schema& schema, const std::optional<Grid>& grid,
                                         std::size_t most_positions)
    : schema_(schema),
      grid_(grid),
      most_positions_(std::max<std::size_t>(most_positions, 1)),
      table_(std::min(first_places, 2 * most_positions_))
{
    for (const Attribute& attribute : schema_) {
        found_.attributes.emplace_back(attribute.components);
        sums_.emplace_back(attribute.components);
    }
}

void StatisticsCollector::add(const PointBatch& batch)
{
    add_positions(batch);
    for (std::size_t k = 0; k < schema_.size(); ++k) add_attribute(batch.attributes[k], k);
    found_.points += batch.size;
}

void StatisticsCollector::add_positions(const PointBatch& batch)
{
    for (std::size_t a = 0; a < 3; ++a)
        position_sums_[a] += grid_ ? add_raw(batch.grid_xyz[a].data(), batch.size, 1, found_.position[a])
                                   : add_raw(batch.xyz[a].data(), batch.size, 1, found_.position[a]);
    for (std::size_t i = 0; i < batch.size; ++i) {
        if (grid_) {
            const auto bits = [&](std::size_t a) { return static_cast<std::uint64_t>(batch.grid_xyz[a][i]); };
            found_.box.extend(
                grid_->to_source(Vec3i{batch.grid_xyz[0][i], batch.grid_xyz[1][i], batch.grid_xyz[2][i]}));
            count_position(hash_of(bits(0), bits(1), bits(2)));
            continue;
        }
        const Vec3d p{batch.xyz[0][i], batch.xyz[1][i], batch.xyz[2][i]};
        if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
            ++found_.not_finite;
            continue;
        }
        found_.box.extend(p);
        count_position(hash_of(bits_of(p[0]), bits_of(p[1]), bits_of(p[2])));
    }
}

void StatisticsCollector::add_attribute(const Column& column, std::size_t attribute)
{
    const Attribute& of = schema_[attribute];
    with_type(column.type(), [&](auto zero) {
        using T = decltype(zero);
        for (std::uint32_t c = 0; c < of.components; ++c)
            sums_[attribute][c] +=
                add_raw(column.as<T>() + c, column.size(), of.components, found_.attributes[attribute][c]);
    });
    if (!is_counted(of)) return;
    if (of.name == attribute_name::classification) found_.other_classes += count_values(column, found_.classes);
    if (of.name == "return_number") count_values(column, found_.return_numbers);
    if (of.name == "number_of_returns") count_values(column, found_.numbers_of_returns);
}

void StatisticsCollector::count_position(std::uint64_t hash)
{
    if (hash & ((std::uint64_t{1} << level_) - 1)) return;
    insert(hash, 1);
    if (2 * entries_ <= table_.size()) return;
    if (entries_ <= most_positions_) return rebuild(2 * table_.size());
    while (entries_ > most_positions_) {
        ++level_;
        rebuild(table_.size());
    }
}

void StatisticsCollector::insert(std::uint64_t hash, std::uint64_t points)
{
    // The lowest bits decide what is counted; the place comes from others.
    std::size_t place = (hash >> 20) % table_.size();
    while (table_[place].points && table_[place].hash != hash) place = place + 1 == table_.size() ? 0 : place + 1;
    entries_ += table_[place].points == 0;
    table_[place].hash = hash;
    table_[place].points += points;
}

void StatisticsCollector::rebuild(std::size_t places)
{
    std::vector<Entry> before(places);
    before.swap(table_);
    entries_ = 0;
    for (const Entry& entry : before)
        if (entry.points && !(entry.hash & ((std::uint64_t{1} << level_) - 1))) insert(entry.hash, entry.points);
}

CloudStatistics StatisticsCollector::result() const
{
    CloudStatistics result = found_;
    for (std::size_t a = 0; a < 3; ++a)
        scale(result.position[a], position_sums_[a], grid_ ? grid_->scale[a] : 1, grid_ ? grid_->offset[a] : 0);
    for (std::size_t k = 0; k < schema_.size(); ++k)
        for (std::size_t c = 0; c < sums_[k].size(); ++c)
            scale(result.attributes[k][c], sums_[k][c], schema_[k].scale, schema_[k].offset);
    double repeated = 0, squares = 0;
    for (const Entry& entry : table_) {
        if (entry.points < 2) continue;
        const auto more = static_cast<double>(entry.points - 1);
        repeated += more;
        squares += more * more;
    }
    // Each position is in the share with probability 1 / one_in: the variance of the Horvitz-Thompson estimate.
    const double one_in = std::ldexp(1.0, static_cast<int>(level_));
    result.duplicates = {repeated * one_in, level_ == 0, std::uint64_t{1} << level_,
                         one_in * std::sqrt((1 - 1 / one_in) * squares)};
    return result;
}

}  // namespace pcm
