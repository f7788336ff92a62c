#include "pcm/gl/compute/gpu_cursor.h"

#include "pcm/gl/base/gl_state.h"
#include "pcm/system/error.h"
#include "pcm/tree/selected_nodes.h"

#include <GL/glew.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <unordered_map>
#include <utility>

namespace pcm {

namespace {

std::uint32_t stride_of(GpuPositions positions)
{
    switch (positions) {
        case GpuPositions::none:
            return 0;
        case GpuPositions::f32:
        case GpuPositions::u32:
            return 12;
        case GpuPositions::u64:
            return 24;
    }
    return 0;
}

std::string megabytes(std::uint64_t bytes) { return std::to_string((bytes + (1u << 20) - 1) >> 20) + " MB"; }

// `To` is a coordinate's type in video memory, little-endian.
template <class To, class Values, class Convert>
void interleave(std::byte* to, const std::array<Values, 3>& xyz, std::size_t first, std::size_t count,
                const Convert& convert)
{
    for (std::size_t i = 0; i < count; ++i, to += 3 * sizeof(To)) {
        To position[3];
        for (std::size_t a = 0; a < 3; ++a) position[a] = convert(xyz[a][first + i], a);
        std::memcpy(to, position, sizeof position);
    }
}

template <class Values>
void copy_positions(std::byte* to, GpuPositions form, const std::array<Values, 3>& xyz, const Vec3d& scale,
                    std::size_t first, std::size_t count)
{
    using From = typename Values::value_type;
    if (form == GpuPositions::f32)
        // The product is computed in double, so that it is rounded only once.
        interleave<float>(to, xyz, first, count,
                          [&](From v, std::size_t a) { return static_cast<float>(static_cast<double>(v) * scale[a]); });
    else if (form == GpuPositions::u32)
        interleave<std::uint32_t>(to, xyz, first, count,
                                  [](From v, std::size_t) { return static_cast<std::uint32_t>(v); });
    else
        interleave<std::uint64_t>(to, xyz, first, count, [](From v, std::size_t) { return std::uint64_t(v); });
}

// Writes back into the cloud's L2.
class CloudWriteBack final : public L1WriteBack {
public:
    CloudWriteBack(std::shared_ptr<PointCloud> cloud, std::vector<std::size_t> slots)
        : cloud_(std::move(cloud)), slots_(std::move(slots))
    {
    }
    void write(NodeId node, const ChangedColumns& changed) override
    {
        ColumnSet columns;
        columns.positions = false;
        for (const std::size_t k : changed.columns()) columns.attributes.set(slots_[k]);
        L2Cache::Edit edit = cloud_->cache().edit(node, columns);
        for (const std::size_t k : changed.columns()) {
            Column& column = edit.column(slots_[k]);
            if (column.size() != changed.points())
                throw Error(ErrorCode::corrupt, cloud_->tree()->folder(),
                            "node " + std::to_string(node) + " has " + std::to_string(column.size()) +
                                " points; there were " + std::to_string(changed.points()) + " in video memory");
            changed.read(k, column.data());
        }
        edit.mark_written();
    }

private:
    std::shared_ptr<PointCloud> cloud_;
    std::vector<std::size_t> slots_;
};

}  // namespace

struct GpuCursor::State {
    std::shared_ptr<PointCloud> cloud;
    std::shared_ptr<L1Cache> l1;
    GpuOptions options;
    ProgressFunction progress;
    std::size_t reads_in_flight = 0;
    std::vector<std::string> names;
    std::vector<std::size_t> slots;  // in the schema, of the query's attributes
    ColumnSet columns;
    std::vector<NodeId> nodes;
    std::unordered_map<NodeId, std::uint32_t> points;  // down to the query's level
    L1Cache::Owner owner = 0;
    bool may_write = false;  // L2 has accepted a write once

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State()
    {
        if (owner) l1->remove_owner(owner);
    }

    // Positions, where there are any, are the entry's first column.
    std::size_t entry_column(std::size_t attribute) const
    {
        return attribute + (options.positions == GpuPositions::none ? 0 : 1);
    }
    std::uint32_t stride(std::size_t attribute) const
    {
        return static_cast<std::uint32_t>(cloud->info().schema[slots[attribute]].bytes());
    }
    std::string name_of(NodeId node) const
    {
        return "node " + std::to_string(node) + " of " + cloud->tree()->folder().string();
    }

    void check_attribute(std::size_t attribute) const
    {
        if (attribute >= slots.size())
            throw Error(ErrorCode::invalid_argument, cloud->tree()->folder(),
                        "no attribute number " + std::to_string(attribute) + " in a query of " +
                            std::to_string(slots.size()) + " attributes");
    }

    // Makes the node resident, waiting for L2; null when there is no room.
    const ColumnEntry* upload(NodeId node)
    {
        const L2Cache::Handle chunk = cloud->cache().get(node, columns);
        std::vector<ColumnSource> sources;
        if (options.positions != GpuPositions::none)
            sources.push_back({stride_of(options.positions), [&](std::byte* to, std::size_t first, std::size_t count) {
                                   const ChunkPositions& p = *chunk->positions;
                                   const Vec3d& scale = cloud->info().grid.scale;
                                   p.wide ? copy_positions(to, options.positions, p.wide_xyz, scale, first, count)
                                          : copy_positions(to, options.positions, p.narrow_xyz, scale, first, count);
                               }});
        for (std::size_t k = 0; k < slots.size(); ++k)
            sources.push_back({stride(k), [&column = *chunk->attributes[slots[k]], bytes = stride(k)](
                                              std::byte* to, std::size_t first, std::size_t count) {
                                   std::memcpy(to, column.data() + first * bytes, count * bytes);
                               }});
        return l1->upload_columns(owner, node, chunk->points, chunk->positions ? chunk->positions->origin : Vec3i{},
                                  sources, true);
    }

    std::uint64_t pages_of(NodeId node) const
    {
        const std::uint32_t count = cloud->tree()->node(node).points;
        std::uint64_t pages = columns.positions ? L1Cache::pages_of(stride_of(options.positions), count) : 0;
        for (std::size_t k = 0; k < slots.size(); ++k) pages += L1Cache::pages_of(stride(k), count);
        return pages;
    }

    [[noreturn]] void refuse(NodeId node) const
    {
        if (const std::exception_ptr error = l1->write_back_error()) std::rethrow_exception(error);
        throw Error(ErrorCode::no_space, {},
                    "video memory has no room for " + name_of(node) + ", which needs " +
                        megabytes(pages_of(node) * L1Cache::page_bytes) + "; of the L1's " +
                        megabytes(l1->options().capacity_bytes) + ", too much is held by views or shown on the screen",
                    "release views that are not needed any more, or give the L1 more memory");
    }
};

struct GpuView::Hold {
    std::shared_ptr<GpuCursor::State> state;
    NodeId node;
    Hold(std::shared_ptr<GpuCursor::State> s, NodeId n) : state(std::move(s)), node(n)
    {
        state->l1->pin(state->owner, node);
    }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;
    ~Hold() { state->l1->unpin(state->owner, node); }
};

const Grid& GpuView::grid() const
{
    if (!hold_) throw Error(ErrorCode::invalid_argument, {}, "an empty view has no grid");
    return hold_->state->cloud->info().grid;
}

void GpuView::mark_written(std::size_t attribute)
{
    if (!hold_) throw Error(ErrorCode::invalid_argument, {}, "an empty view cannot be marked as written");
    GpuCursor::State& s = *hold_->state;
    s.check_attribute(attribute);
    if (!s.may_write) {
        // Reports now, rather than when the chunk is evicted, that the cloud cannot be written to.
        ColumnSet columns;
        columns.positions = false;
        columns.attributes.set(s.slots[attribute]);
        s.cloud->cache().edit(node_, columns).discard();
        s.may_write = true;
    }
    if (glMemoryBarrier) glMemoryBarrier(GL_ALL_BARRIER_BITS);
    s.l1->mark_written(s.owner, node_, s.entry_column(attribute));
}

std::vector<std::byte> GpuView::read(std::size_t attribute) const
{
    if (!hold_) throw Error(ErrorCode::invalid_argument, {}, "an empty view has nothing to read");
    const GpuCursor::State& s = *hold_->state;
    s.check_attribute(attribute);
    std::vector<std::byte> bytes = s.l1->read(s.owner, node_, s.entry_column(attribute));
    bytes.resize(size_ * s.stride(attribute));
    return bytes;
}

GpuCursor::GpuCursor(std::shared_ptr<PointCloud> cloud, std::shared_ptr<L1Cache> l1, const Query& query,
                     const GpuOptions& options)
    : state_(std::make_shared<State>())
{
    State& s = *state_;
    s.cloud = std::move(cloud);
    s.l1 = std::move(l1);
    s.options = options;
    s.progress = query.progress;
    s.reads_in_flight = std::min<std::size_t>(query.reads_in_flight, 16);  // L2 keeps no more hints
    s.columns.positions = options.positions != GpuPositions::none;
    s.names = query.attributes;
    const TreeInfo& info = s.cloud->info();
    const std::filesystem::path folder = s.cloud->tree()->folder();
    if (!query.where.empty())
        throw Error(ErrorCode::invalid_argument, folder, "conditions on attributes are not tested on whole chunks",
                    "test the points in the shader, or use PointCloud::points()");
    if (info.wide && options.positions == GpuPositions::u32)
        throw Error(ErrorCode::unsupported, folder, "the positions of this cloud do not fit into 32 bits",
                    "ask for GpuPositions::u64 or f32");
    for (const std::string& name : query.attributes) {
        const auto slot = info.schema.find(name);
        if (!slot) throw Error(ErrorCode::invalid_argument, folder, "this cloud has no attribute '" + name + "'");
        if (info.schema[*slot].bytes() > L1Cache::max_stride)
            throw Error(ErrorCode::unsupported, folder,
                        "attribute '" + name + "' has " + std::to_string(info.schema[*slot].bytes()) +
                            " bytes per point; at most " + std::to_string(L1Cache::max_stride) +
                            " fit into video memory");
        s.slots.push_back(*slot);
        s.columns.attributes.set(*slot);
    }
    for (const SelectedNode& node :
         selected_nodes(*s.cloud->tree(), Selector(query.selection(), info.schema), query.level)) {
        if (node.points == 0) continue;
        s.nodes.push_back(node.node);
        s.points[node.node] = node.points;
    }
    std::vector<std::size_t> columns = s.slots;
    if (s.columns.positions) columns.insert(columns.begin(), 0);  // never marked
    s.owner = s.l1->add_owner(std::make_shared<CloudWriteBack>(s.cloud, std::move(columns)));
}

GpuCursor::GpuCursor(GpuCursor&&) noexcept = default;
GpuCursor& GpuCursor::operator=(GpuCursor&&) noexcept = default;
GpuCursor::~GpuCursor() = default;

const std::vector<NodeId>& GpuCursor::nodes() const { return state_->nodes; }

void GpuCursor::rewind() { next_ = prefetched_ = 0; }

void GpuCursor::flush() { state_->l1->flush(state_->owner); }
void GpuCursor::discard() { state_->l1->discard(state_->owner); }

GpuView GpuCursor::get(NodeId node)
{
    State& s = *state_;
    const auto points = s.points.find(node);
    if (points == s.points.end())
        throw Error(ErrorCode::invalid_argument, s.cloud->tree()->folder(),
                    "node " + std::to_string(node) + " is not among those of the query");
    if (!gl_functions_loaded())
        throw Error(ErrorCode::unsupported, {}, "OpenGL 3.3 is not available: its functions are not loaded",
                    "make a context current and call glewInit() first");
    s.l1->begin_frame(s.owner);
    const ColumnEntry* entry = s.l1->use_columns(s.owner, node);
    if (!entry) entry = s.upload(node);
    if (!entry) s.refuse(node);

    GpuView view;
    view.hold_ = std::make_shared<GpuView::Hold>(state_, node);
    view.node_ = node;
    view.size_ = points->second;
    view.origin_ = entry->origin;
    for (const ColumnPiece& from : entry->pieces) {
        if (from.first >= view.size_) break;
        GpuPiece piece;
        piece.first = from.first;
        piece.count = static_cast<std::uint32_t>(std::min<std::size_t>(from.count, view.size_ - from.first));
        for (std::size_t k = 0; k < from.columns.size(); ++k) {
            BufferRange range = from.columns[k];
            range.bytes = std::uint64_t(piece.count) * entry->strides[k];
            if (s.columns.positions && k == 0)
                piece.positions = range;
            else
                piece.attributes.push_back(range);
        }
        view.pieces_.push_back(std::move(piece));
    }
    return view;
}

std::vector<GpuView> GpuCursor::load_all()
{
    State& s = *state_;
    std::uint64_t pages = 0;
    for (const NodeId node : s.nodes) pages += s.pages_of(node);
    const std::uint64_t available = s.l1->pages_available(s.owner);
    if (pages > available)
        throw Error(
            ErrorCode::no_space, {},
            "all " + std::to_string(s.nodes.size()) + " chunks together need " +
                megabytes(pages * L1Cache::page_bytes) + " of video memory; " +
                megabytes(available * L1Cache::page_bytes) + " are available",
            "ask for a coarser level or a smaller box, give the L1 more memory, or visit one chunk after the other");
    std::vector<GpuView> views;
    s.l1->request(
        s.nodes, std::nullopt, [](NodeId) { return Supply::ready; },
        [&](NodeId node) {
            views.push_back(get(node));
            return true;
        });
    return views;
}

// Checks that the unmarked columns of the last chunk in view are unchanged.
void GpuCursor::check_last()
{
    State& s = *state_;
    const NodeId node = std::exchange(last_, no_node);
    const std::vector<std::vector<std::byte>> columns = std::exchange(last_columns_, {});
    const ColumnEntry* const entry = node == no_node ? nullptr : s.l1->find_columns(s.owner, node);
    if (!entry) return;
    if (glMemoryBarrier) glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (entry->written[k] || s.l1->read(s.owner, node, k) == columns[k]) continue;
        const bool is_position = s.columns.positions && k == 0;
        throw Error(ErrorCode::invalid_argument, s.cloud->tree()->folder(),
                    is_position ? "positions of node " + std::to_string(node) +
                                      " were changed in video memory; they cannot be written back"
                                : "attribute '" + s.names[k - s.entry_column(0)] + "' of node " + std::to_string(node) +
                                      " was changed in video memory and not marked",
                    is_position ? "" : "call mark_written() on the view, or the change is lost");
    }
}

bool GpuCursor::getNextDataGPU(GpuView& view)
{
    State& s = *state_;
    view = GpuView();
    check_last();
    if (s.progress) {
        ProgressUpdate update;
        update.stage = "Computing on points";
        update.fraction = s.nodes.empty() ? 1.0 : static_cast<double>(next_) / static_cast<double>(s.nodes.size());
        if (!s.progress(update)) throw Error(ErrorCode::cancelled, {}, "cancelled");
    }
    if (next_ == s.nodes.size()) {
        flush();
        return false;
    }
    prefetched_ = std::max(prefetched_, next_ + 1);
    for (; prefetched_ < std::min(s.nodes.size(), next_ + 1 + s.reads_in_flight); ++prefetched_)
        if (!s.l1->find_columns(s.owner, s.nodes[prefetched_]))
            s.cloud->cache().prefetch({s.nodes[prefetched_], s.columns});
    view = get(s.nodes[next_]);
    ++next_;
    if (s.options.check_marks) {
        last_ = view.node();
        const ColumnEntry* const entry = s.l1->find_columns(s.owner, last_);
        for (std::size_t k = 0; k < entry->strides.size(); ++k) last_columns_.push_back(s.l1->read(s.owner, last_, k));
    }
    return true;
}

void require_compute_shaders()
{
    const GLubyte* const version = glGetString(GL_VERSION);
    if (!version)
        throw Error(ErrorCode::unsupported, {}, "no OpenGL context is current",
                    "make one current and call glewInit(); EGL makes one without a window");
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    const bool by_version = major > 4 || (major == 4 && minor >= 3);
    const bool by_extension = GLEW_ARB_compute_shader && GLEW_ARB_shader_storage_buffer_object;
    if ((by_version || by_extension) && glDispatchCompute && glBindBufferRange && glMemoryBarrier) return;
    drain_gl_errors();
    throw Error(
        ErrorCode::unsupported, {},
        std::string("compute shaders need OpenGL 4.3; this context has ") + reinterpret_cast<const char*>(version),
        "ask for a context of version 4.3 or newer (Mesa's software renderer gives one), or use PointCloud::points() "
        "on the processor");
}

}  // namespace pcm
