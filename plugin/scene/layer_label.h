// The names of layers that show trees.
#pragma once

#include <QString>

#include <cstdint>
#include <filesystem>

namespace pcm::host {

// The name of a layer that shows `shown` of a tree's `total` points: "city (48,947 of 20,000,000)", or "city" if it
// has all of them. `present` is the layer's name so far. A name that a user has given, such as "roof", is kept; one
// that MeshLab or this function made of a file's name is replaced. `opened` is what the layer was opened from: the
// tree's folder, a file in it, or the file of which the tree was built; the name comes from it.
QString tree_label(const QString& present, const std::filesystem::path& opened, const std::filesystem::path& tree,
                   std::uint64_t shown, std::uint64_t total);

}  // namespace pcm::host
