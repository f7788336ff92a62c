// The properties of a tree as bytes (TreeInfo). They stand in the index and, since the chunks do not have them, a
// second time in about.pct, from which a lost index is rebuilt.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/system/tree_folder.h"
#include "pcm/tree/tree.h"

#include <filesystem>
#include <optional>
#include <string>

namespace pcm {

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

// All of the info but `bytes`, which follows from the data files.
void put_tree_info(ByteWriter& out, const TreeInfo& info);
// Throws Error(corrupt) for values that no tree has.
TreeInfo get_tree_info(ByteReader& in, const std::filesystem::path& path);

// Whether both are equal in everything but `bytes`.
bool same_info(const TreeInfo& a, const TreeInfo& b);

// Replaces about.pct atomically. It is written before the index: after an interruption between the two it is one
// generation ahead of the index.
void write_about(const std::filesystem::path& folder, const TreeInfo& info);
// Throws Error(not_found | corrupt | unsupported | permission | io).
TreeInfo read_about(const std::filesystem::path& folder);

// What is wrong with a tree's about.pct.
struct AboutFault {
    std::string what;
    // It is one generation ahead: an update was interrupted before it replaced the index. That is not damage.
    bool left_by_update = false;
};
// Compares about.pct with the index; nothing when they agree. Throws Error(permission | io).
std::optional<AboutFault> check_about(const std::filesystem::path& folder, const TreeInfo& index);

}  // namespace pcm
