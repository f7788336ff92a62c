#include "pcm/build/nodes/draft_record.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"

namespace pcm {

void put_draft(ByteWriter& out, const Draft& draft)
{
    out.put(draft.path.depth);
    for (const std::uint64_t bits : draft.path.bits) out.put(bits);
    for (const std::int64_t c : draft.box.min) out.put(c);
    for (const std::int64_t c : draft.box.max) out.put(c);
    out.put(draft.points);
    out.put(draft.first_level);
    out.put(static_cast<std::uint32_t>(draft.level_points.size()));
    for (const std::uint32_t points : draft.level_points) out.put(points);
    out.put(draft.spacing);
    out.put(draft.extent.file);
    out.put(draft.extent.offset);
    out.put(draft.extent.bytes);
    out.put(draft.extent.header_bytes);
    for (const Draft* child : draft.children) out.put(static_cast<std::uint8_t>(child != nullptr));
}

// Sets `has_child`; the children are not linked.
Draft* get_draft(ByteReader& in, DraftStore& drafts, std::array<bool, 2>& has_child)
{
    NodePath path;
    path.depth = in.get<std::uint16_t>();
    for (std::uint64_t& bits : path.bits) bits = in.get<std::uint64_t>();
    Draft* draft = drafts.add(path);
    for (std::int64_t& c : draft->box.min) c = in.get<std::int64_t>();
    for (std::int64_t& c : draft->box.max) c = in.get<std::int64_t>();
    draft->points = in.get<std::uint32_t>();
    draft->first_level = in.get<std::uint16_t>();
    const auto levels = in.get<std::uint32_t>();
    for (std::uint32_t i = 0; i < levels; ++i) draft->level_points.push_back(in.get<std::uint32_t>());
    draft->spacing = in.get<double>();
    draft->extent.file = in.get<std::uint32_t>();
    draft->extent.offset = in.get<std::uint64_t>();
    draft->extent.bytes = in.get<std::uint64_t>();
    draft->extent.header_bytes = in.get<std::uint32_t>();
    for (bool& has : has_child) has = in.get<std::uint8_t>() != 0;
    return draft;
}

void put_subtree(ByteWriter& out, const Draft& draft)
{
    put_draft(out, draft);
    for (const Draft* child : draft.children)
        if (child) put_subtree(out, *child);
}

Draft* get_subtree(ByteReader& in, DraftStore& drafts, const std::function<void(Draft&)>& read)
{
    std::array<bool, 2> has_child{};
    Draft* draft = get_draft(in, drafts, has_child);
    read(*draft);
    if (draft->path.depth > NodePath::max_depth)
        throw Error(ErrorCode::corrupt, {}, "a checkpoint has an invalid tree of nodes");
    for (std::size_t side = 0; side < 2; ++side)
        if (has_child[side]) {
            draft->children[side] = get_subtree(in, drafts, read);
            if (draft->children[side]->path.depth != draft->path.depth + 1)
                throw Error(ErrorCode::corrupt, {}, "a checkpoint has an invalid tree of nodes");
        }
    return draft;
}

}  // namespace pcm
