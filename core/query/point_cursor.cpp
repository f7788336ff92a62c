#include "pcm/query/point_cursor.h"

#include "pcm/query/chunk_stream.h"
#include "pcm/query/query_source.h"
#include "pcm/system/error.h"

namespace pcm {

struct PointCursor::State {
    std::shared_ptr<QuerySource> source;
    ProgressFunction progress;
    std::vector<std::size_t> slots;
    ChunkStream stream;
};

std::uint32_t PointView::number(std::size_t i) const { return part_->number(index(i)); }

PointCursor::PointCursor(std::shared_ptr<QuerySource> source, const Query& query)
{
    Selector selector(query.selection(), source->info().schema);
    std::vector<std::size_t> slots = slots_of(*source, query);
    const ColumnSet columns = columns_of(slots, selector);
    QuerySource& from = *source;
    state_.reset(new State{
        std::move(source),
        query.progress,
        std::move(slots),
        {from.cache, from.pool, from.rates, std::move(selector), query.level, columns, query.reads_in_flight}});
}

PointCursor::PointCursor(PointCursor&&) noexcept = default;
PointCursor& PointCursor::operator=(PointCursor&&) noexcept = default;
PointCursor::~PointCursor() = default;

bool PointCursor::getNextData(PointView& view)
{
    State& s = *state_;
    view = PointView();
    if (s.progress) {
        ProgressUpdate update;
        update.stage = "Reading points";
        update.fraction = s.stream.fraction();
        if (!s.progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    const SelectedChunk* const part = s.stream.next();
    if (!part) return false;
    view.node_ = part->node;
    view.grid_ = &s.source->info().grid;
    view.rounding_ = &s.stream.rounding();
    view.chunk_ = &part->chunk;
    view.part_ = part;
    view.slots_ = &s.slots;
    view.count_ = part->points;
    if (!part->all) view.selected_ = &part->selected;
    return true;
}

CursorStatistics PointCursor::statistics() const
{
    const ChunkStream& stream = state_->stream;
    return {stream.chunks(), stream.cached(), stream.points_read(), stream.bytes_read()};
}

}  // namespace pcm
