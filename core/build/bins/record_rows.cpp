#include "pcm/build/bins/record_rows.h"

#include "pcm/system/copy_strided.h"

#include <algorithm>
#include <cstring>

namespace pcm {
namespace {

constexpr std::size_t block_rows = 256;  // stay in the first-level cache from field to field

// From a record to a row. Whole fields that follow one another in the record, as all do in the row, are one.
struct Step {
    FieldPlace from;
    std::size_t to = 0;
};

std::vector<Step> steps_of(const std::vector<FieldPlace>& fields, const RowLayout& layout)
{
    std::vector<Step> steps;
    for (std::size_t k = 0; k < fields.size(); ++k) {
        if (!fields[k].mask && !steps.empty()) {
            Step& before = steps.back();
            if (!before.from.mask && before.from.offset + before.from.bytes == fields[k].offset) {
                before.from.bytes += fields[k].bytes;
                continue;
            }
        }
        steps.push_back({fields[k], layout.offsets[k]});
    }
    return steps;
}

void put(const Step& step, const std::byte* records, std::size_t stride, std::size_t count, std::byte* rows,
         std::size_t row_bytes)
{
    const std::byte* const from = records + step.from.offset;
    std::byte* const to = rows + step.to;
    if (step.from.mask == 0) return copy_strided(step.from.bytes, from, stride, to, row_bytes, count);
    for (std::size_t i = 0; i < count; ++i)
        to[i * row_bytes] = (from[i * stride] >> step.from.shift) & static_cast<std::byte>(step.from.mask);
}

}  // namespace

std::array<std::uint32_t, 3> coordinates_of(const RecordBatch& batch, std::size_t i)
{
    std::array<std::int32_t, 3> grid;
    std::memcpy(grid.data(), batch.bytes.data() + i * batch.stride, sizeof grid);
    return {to_coordinate<std::uint32_t>(grid[0]), to_coordinate<std::uint32_t>(grid[1]),
            to_coordinate<std::uint32_t>(grid[2])};
}

void put_record_rows(const RecordBatch& batch, const RowLayout& layout, std::vector<std::byte>& rows,
                     Observed& observed)
{
    const std::vector<Step> steps = steps_of(*batch.fields, layout);
    const std::size_t row_bytes = layout.bytes, stride = batch.stride;
    rows.resize(batch.size * row_bytes);
    std::array<std::array<std::int32_t, block_rows>, 3> grid;
    for (std::size_t first = 0; first < batch.size; first += block_rows) {
        const std::size_t count = std::min(block_rows, batch.size - first);
        const std::byte* const records = batch.bytes.data() + first * stride;
        std::byte* const to = rows.data() + first * row_bytes;
        for (std::size_t i = 0; i < count; ++i) {
            std::array<std::int32_t, 3> c;
            std::memcpy(c.data(), records + i * stride, sizeof c);
            for (std::size_t a = 0; a < 3; ++a) grid[a][i] = c[a];
            const std::array<std::uint32_t, 3> biased{to_coordinate<std::uint32_t>(c[0]),
                                                      to_coordinate<std::uint32_t>(c[1]),
                                                      to_coordinate<std::uint32_t>(c[2])};
            std::memcpy(to + i * row_bytes, biased.data(), sizeof biased);
        }
        for (const Step& step : steps) put(step, records, stride, count, to, row_bytes);
        observed.see(grid, count);
        observed.hash += hash_rows(to, count, row_bytes);
    }
}

}  // namespace pcm
