// What a tree's chunks do not say about the tree: in the index, and in a file of its own that helps to make the index
// again.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/tree/tree.h"

#include <filesystem>

namespace pcm {

inline constexpr const char* about_file_name = "about.pct";

inline void put_vec(ByteWriter& out, const Vec3i& v)
{
    for (const std::int64_t c : v) out.put(c);
}
inline Vec3i get_vec(ByteReader& in)
{
    Vec3i v;
    for (std::int64_t& c : v) c = in.get<std::int64_t>();
    return v;
}

// All of the info but `bytes`, which the nodes' extents tell.
void put_tree_info(ByteWriter& out, const TreeInfo& info);
// Throws Error(corrupt) for what no tree has.
TreeInfo get_tree_info(ByteReader& in, const std::filesystem::path& path);

// Whether both say the same, `bytes` aside.
bool same_info(const TreeInfo& a, const TreeInfo& b);

// Writes about.pct; at any instant it is the old file or the new one. It is written before the index: after an
// interruption between the two it is one generation ahead.
void write_about(const std::filesystem::path& folder, const TreeInfo& info);
// Throws Error(not_found | corrupt | unsupported | permission | io).
TreeInfo read_about(const std::filesystem::path& folder);

}  // namespace pcm
