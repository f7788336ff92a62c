#include "pcm/query/chunk_stream.h"

#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>

namespace pcm {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

// Appends the numbers of the points [begin, end) whose grid position is in a box.
void points_in(const ChunkPositions& positions, const Box3i& box, std::uint32_t begin, std::uint32_t end,
               std::vector<std::uint32_t>& points)
{
    const std::size_t before = points.size();
    points.resize(before + (end - begin));
    std::uint32_t* const kept = points.data() + before;
    std::size_t n = 0;
    const auto keep = [&](const auto& xyz) {
        // Relative to the chunk's origin, as its positions are, the box begins at `low` and is `width` + 1 wide.
        using Number = std::remove_const_t<std::remove_reference_t<decltype(xyz[0][0])>>;
        std::array<Number, 3> low, width;
        for (std::size_t a = 0; a < 3; ++a) {
            if (box.max[a] < positions.origin[a]) return;
            const auto origin = static_cast<std::uint64_t>(positions.origin[a]);
            const std::uint64_t from =
                box.min[a] > positions.origin[a] ? static_cast<std::uint64_t>(box.min[a]) - origin : 0;
            const std::uint64_t to = std::min<std::uint64_t>(static_cast<std::uint64_t>(box.max[a]) - origin,
                                                             std::numeric_limits<Number>::max());
            if (from > to) return;
            low[a] = static_cast<Number>(from);
            width[a] = static_cast<Number>(to - from);
        }
        const Number *x = xyz[0].data(), *y = xyz[1].data(), *z = xyz[2].data();
        for (std::uint32_t i = begin; i < end; ++i) {
            const bool in_x = static_cast<Number>(x[i] - low[0]) <= width[0],
                       in_y = static_cast<Number>(y[i] - low[1]) <= width[1],
                       in_z = static_cast<Number>(z[i] - low[2]) <= width[2];
            kept[n] = i;
            n += static_cast<std::size_t>(in_x & in_y & in_z);
        }
    };
    if (positions.wide)
        keep(positions.wide_xyz);
    else
        keep(positions.narrow_xyz);
    points.resize(before + n);
}

}  // namespace

std::uint64_t decoded_bytes(const Tree& tree, const ColumnSet& columns)
{
    std::uint64_t bytes = columns.positions ? (tree.info().wide ? 24 : 12) : 0;
    for (std::size_t k = 0; k < tree.info().schema.size(); ++k)
        if (columns.attributes.test(k)) bytes += tree.info().schema[k].bytes();
    return bytes;
}

std::uint32_t SelectedChunk::number(std::size_t index) const
{
    if (begins.empty()) return static_cast<std::uint32_t>(index);
    const auto part =
        static_cast<std::size_t>(std::upper_bound(begins.begin(), begins.end(), index) - begins.begin()) - 1;
    return first[part] + static_cast<std::uint32_t>(index - begins[part]);
}

ChunkStream::ChunkStream(L2Cache& cache, TaskPool& pool, ReadRates& rates, Selector selector,
                         const std::optional<std::uint16_t>& level, const ColumnSet& columns, unsigned in_flight)
    : cache_(cache),
      pool_(pool),
      rates_(rates),
      selector_(std::move(selector)),
      rounding_(cache.tree().info()),
      level_(level),
      columns_(columns),
      in_flight_(std::clamp(in_flight, 1u, TaskPool::most_threads)),
      nodes_(selected_nodes(cache.tree(), selector_, level)),
      passes_cache_(fills_cache())
{
    box_ = selector_.bounds() ? grid_box(cache.tree(), *selector_.bounds()) : cache.tree().info().box;
}

ChunkStream::~ChunkStream()
{
    for (const auto& job : ahead_) job->task->cancel();
}

const SelectedChunk* ChunkStream::next()
{
    current_.reset();
    const double start = now();
    double worked = 0;
    while (next_ < nodes_.size() || !ahead_.empty()) {
        for (; next_ < nodes_.size() && ahead_.size() < in_flight_; ++next_) {
            auto job = std::make_unique<Job>();
            job->node = nodes_[next_];
            job->task = std::make_shared<Task>([this, job = job.get()] { read(*job); });
            ahead_.push_back(std::move(job));
            // The caller runs the first one itself.
            if (ahead_.size() > 1) pool_.submit(ahead_.back()->task, static_cast<unsigned>(in_flight_ - 1));
        }
        current_ = std::move(ahead_.front());
        ahead_.pop_front();
        current_->task->finish();
        worked += current_->seconds;
        points_read_ += current_->result.points;
        bytes_read_ += current_->bytes;
        ++chunks_;
        cached_ += current_->cached;
        if (current_->result.size() > 0) {
            rates_.add_wait(worked, now() - start);
            return &current_->result;
        }
    }
    rates_.add_wait(worked, now() - start);
    current_.reset();
    return nullptr;
}

double ChunkStream::fraction() const
{
    return nodes_.empty() ? 1.0 : static_cast<double>(next_ - ahead_.size()) / static_cast<double>(nodes_.size());
}

bool ChunkStream::fills_cache() const
{
    std::uint64_t points = 0;
    for (const SelectedNode& node : nodes_)
        if (node.relation == BoxRelation::inside) points += node.points;
    return points * decoded_bytes(cache_.tree(), columns_) > cache_.capacity() / 4;
}

// On any thread.
void ChunkStream::read(Job& job) const
{
    const Tree& tree = cache_.tree();
    const SelectedNode& node = job.node;
    SelectedChunk& result = job.result;
    result.node = node.node;
    const double start = now();
    std::vector<BoxRelation> relations;
    result.pin = cache_.find(node.node, columns_);
    if (result.pin) {
        job.cached = true;
        result.chunk = *result.pin;
        result.points = node.points;
    } else if (!passes_cache_ && node.relation == BoxRelation::inside && node.points == tree.node(node.node).points) {
        result.pin = cache_.get(node.node, columns_);
        result.chunk = *result.pin;
        result.points = node.points;
    } else if (auto part = cache_.read_part(node.node, columns_, [&](const Box3i& box, std::uint16_t level) {
                   if (level_ && level > *level_) return false;
                   const BoxRelation relation = node.relation == BoxRelation::inside
                                                    ? node.relation
                                                    : selector_.relation(source_box(tree.info().grid, box, rounding_));
                   if (relation == BoxRelation::outside) return false;
                   relations.push_back(relation);
                   return true;
               })) {
        result.chunk = std::move(part->chunk);
        result.points = result.chunk.points;
        result.first = std::move(part->first);
        std::uint32_t begin = 0;
        for (const std::uint32_t count : part->count) {
            result.begins.push_back(begin);
            begin += count;
        }
        job.bytes = part->bytes_read;
    } else {
        result.pin = cache_.get(node.node, columns_);
        result.chunk = *result.pin;
        result.points = node.points;
    }
    select(job, relations);
    if (!job.cached) {
        job.seconds = now() - start;
        rates_.add_read(result.chunk.points * decoded_bytes(tree, columns_), job.seconds);
    }
}

void ChunkStream::select(Job& job, const std::vector<BoxRelation>& relations) const
{
    SelectedChunk& result = job.result;
    const auto of_part = [&](std::size_t k) { return relations.empty() ? job.node.relation : relations[k]; };
    const std::size_t parts = relations.empty() ? 1 : relations.size();
    if (result.points == 0) return;
    result.all = !selector_.tests_attributes();
    for (std::size_t k = 0; k < parts; ++k) result.all = result.all && of_part(k) == BoxRelation::inside;
    if (result.all) return;

    std::vector<const Column*> columns(result.chunk.attributes.size(), nullptr);
    for (const std::size_t k : selector_.tested()) columns[k] = result.chunk.attributes[k].get();
    const ChunkPositions& positions = *result.chunk.positions;
    const Grid& grid = cache_.tree().info().grid;
    std::vector<std::uint32_t> some;
    for (std::size_t k = 0; k < parts; ++k) {
        const auto begin = relations.empty() ? 0 : result.begins[k];
        const auto end = k + 1 == parts ? static_cast<std::uint32_t>(result.points) : result.begins[k + 1];
        some.clear();
        // Comparing integers is fast, and leaves few points for the tests in double.
        BoxRelation relation = of_part(k);
        points_in(positions, relation == BoxRelation::inside ? cache_.tree().info().box : box_, begin, end, some);
        if (selector_.is_box()) relation = BoxRelation::inside;
        selector_.narrow(
            columns, [&](std::size_t i) { return rounding_(grid.to_source(positions.grid(i))); }, some, relation);
        result.selected.insert(result.selected.end(), some.begin(), some.end());
    }
}

}  // namespace pcm
